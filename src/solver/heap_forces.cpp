// SPDX-License-Identifier: Apache-2.0
#include "solver/heap_forces.h"

#include <algorithm>
#include <type_traits>

namespace iota::solver {

namespace {

/// visit(pool, number): each pool whose forces are swept. Hands pull before that, and come and go without a change of structure: were
/// theirs counted, the others would have other numbers.
template <class P, class Visit>
void visit_swept(P& problem, Visit visit) {
  std::uint8_t number = 0;
  problem.for_each_force_pool([&](auto& pool) {
    using Force = typename std::decay_t<decltype(pool.items)>::value_type;
    if constexpr (!std::is_same_v<Force, GripForce>) visit(pool, number++);
  });
}

}  // namespace

template <class P, class Items, class Visit>
void HeapForces::visit_forces(P& problem, Items& items, Visit visit) {
  std::size_t next = 0;
  visit_swept(problem, [&](auto& pool, std::uint8_t number) {
    for (; next < items.size() && items[next].pool == number; ++next)
      visit(items[next], pool.items[items[next].number]);
  });
}

void HeapForces::find(const Problem& problem, const HeapBodies& bodies) {
  items_.clear(), between_ = 0;
  visit_swept(problem, [&](const auto& pool, std::uint8_t number) {
    for (std::size_t i = 0; i < pool.items.size(); ++i) {
      Item item{.number = static_cast<std::uint32_t>(i), .pool = number};
      const ForceArm& arm = pool.items[i].arm;
      for (std::uint32_t k = 0; k < arm.count; ++k) {
        const std::uint32_t body = bodies.owner[arm.nodes[k]];
        const auto end = item.sides.begin() + item.count;
        if (bodies.all[body].is_driven ||
            std::any_of(item.sides.begin(), end, [&](const Side& side) { return side.body == body; }))
          continue;
        item.sides[item.count++].body = body;
      }
      if (item.count == 0) continue;
      between_ += item.count > 1;
      items_.push_back(item);
    }
  });
}

void HeapForces::begin() {
  for (Item& item : items_) item.impulse = {};
}

void HeapForces::refresh(Problem& problem, const HeapBodies& bodies, std::span<const HeapMotion> motions, double h,
                         double from, double to) {
  if (items_.empty()) return;
  bodies.find_places(problem, from, to, x_, x_next_);
  visit_forces(problem, items_, [&]<class F>(Item& item, F& force) {
    const ForceArm& arm = force.arm;
    item.start = arm.value(x_.data()), item.drift = {};
    for (std::uint32_t i = 0; i < item.count; ++i) item.sides[i].part = 0, item.sides[i].moment = {};
    for (std::uint32_t k = 0; k < arm.count; ++k) {
      const std::uint32_t node = arm.nodes[k], body = bodies.owner[node];
      if (bodies.all[body].is_driven) {
        item.drift += (arm.weights[k] / h) * (x_next_[node] - x_[node]);
        continue;
      }
      Side& side = *std::find_if(item.sides.begin(), item.sides.end(), [&](const Side& s) { return s.body == body; });
      side.part += arm.weights[k];
      side.moment += arm.weights[k] * (x_[node] - bodies.all[body].center_now());
    }
    item.changes = {};
    for (int column = 0; column < 3; ++column) {
      const Vec3 unit = unit_vector(column);
      Vec3 change;
      for (std::uint32_t i = 0; i < item.count; ++i) {
        const Side& side = item.sides[i];
        const HeapMotion& motion = motions[side.body];
        change += (side.part * side.part * motion.by_mass) * unit +
                  cross(motion.by_inertia * cross(side.moment, unit), side.moment);
      }
      item.changes.set_column(column, change);
    }
    if constexpr (std::is_same_v<F, VelocityForce>) force.begin(rate_of(item, motions), h);
  });
}

Vec3 HeapForces::rate_of(const Item& item, std::span<const HeapMotion> motions) {
  Vec3 rate = item.drift;
  for (std::uint32_t i = 0; i < item.count; ++i) {
    const Side& side = item.sides[i];
    rate += side.part * motions[side.body].velocity + cross(motions[side.body].spin, side.moment);
  }
  return rate;
}

void HeapForces::give(const Item& item, const Vec3& impulse, std::span<HeapMotion> motions) {
  for (std::uint32_t i = 0; i < item.count; ++i) {
    const Side& side = item.sides[i];
    HeapMotion& motion = motions[side.body];
    motion.velocity += (side.part * motion.by_mass) * impulse;
    motion.spin += motion.by_inertia * cross(side.moment, impulse);
  }
}

void HeapForces::warm(std::span<HeapMotion> motions) const {
  for (const Item& item : items_) give(item, item.impulse, motions);
}

void HeapForces::sweep(const Problem& problem, std::span<HeapMotion> motions, double h) {
  const ForceStage stage{.h = h, .clamp = true};
  visit_forces(problem, items_, [&](Item& item, const auto& force) {
    // p + dp = h F(e + h A dp), with F linear about e.
    const Vec3 end = item.start + h * rate_of(item, motions);
    const Mat3 matrix = Mat3::diagonal(1) + h * h * (force.stiffness_matrix(item.start, end, stage) * item.changes);
    const Vec3 change = solve(matrix, h * force.force(item.start, end, stage) - item.impulse);
    item.impulse += change;
    give(item, change, motions);
  });
}

double HeapForces::work(const Problem& problem, std::span<const HeapMotion> motions) const {
  double work = 0;
  visit_forces(problem, items_, [&]<class F>(const Item& item, const F&) {
    if (F::is_external) work += dot(item.impulse, rate_of(item, motions));
  });
  return work;
}

}  // namespace iota::solver
