// SPDX-License-Identifier: Apache-2.0
#include "solver/heap_ties.h"

#include "solver/newton.h"
#include "solver/row_rates.h"
#include "solver/stage.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <type_traits>
#include <utility>

namespace iota::solver {

namespace {

template <class C>
bool has_laws(const ConstraintPool<C>& pool, std::size_t i) {
  return pool.has_laws() &&
         !std::all_of(pool.law(i), pool.law(i) + C::rows, [](const RowLaw& law) { return law == RowLaw{}; });
}

}  // namespace

// The ties of copies, which have no constraint, come after all others.
template <class P, class Visit>
std::size_t HeapTies::visit_rows(P& problem, Visit visit) {
  std::size_t next = 0;
  std::uint8_t number = 0;
  problem.for_each_constraint_pool([&](auto& pool) {
    for (; next < ties_.size() && ties_[next].pool == number; ++next) visit(ties_[next], pool);
    ++number;
  });
  return next;
}

HeapSoftness::HeapSoftness(double frequency, double h) {
  constexpr double damping = 10;  // of the critical one
  const double omega = 2 * std::numbers::pi * frequency, a1 = 2 * damping + h * omega, a2 = h * omega * a1;
  rate = omega / a1, mass = a2 / (1 + a2), impulse = 1 / (1 + a2);
}

HeapTies::HeapTies() = default;
HeapTies::~HeapTies() = default;
HeapTies::HeapTies(HeapTies&&) noexcept = default;
HeapTies& HeapTies::operator=(HeapTies&&) noexcept = default;

bool HeapTies::find(const Problem& problem, const HeapBodies& bodies) {
  ties_.clear();
  bool can_sweep = true, have_joints = !bodies.copies.empty();
  std::uint8_t number = 0;
  problem.for_each_constraint_pool([&]<class C>(const ConstraintPool<C>& pool) {
    if (std::is_same_v<C, ContactConstraint>) return void(++number);
    for (std::size_t i = 0; i < pool.items.size() && can_sweep; ++i) {
      const C& c = pool.items[i];
      if constexpr (std::is_same_v<C, DistanceConstraint>)
        if (!has_laws(pool, i)) continue;  // within a body
      Tie tie{.item = static_cast<std::uint32_t>(i), .pool = number, .rows = C::rows};
      tie.are_equations = !has_laws(pool, i);
      for (const bool are_shared : {false, true})  // a shared point may belong to a body that is there already
        for (const std::uint32_t node : pool.nodes_of(c)) {
          const std::uint32_t body = bodies.owner[node];
          if (bodies.all[body].is_driven || bodies.is_shared(node) != are_shared) continue;
          if ((tie.a != none && bodies.have(tie.a, node)) || (tie.b != none && bodies.have(tie.b, node))) continue;
          if (tie.a == none)
            tie.a = body;
          else if (tie.b == none)
            tie.b = body;
          else
            can_sweep = false;
        }
      if constexpr (ConeConstraint<C>) can_sweep = false;
      if (tie.a == none) continue;
      have_joints = have_joints || tie.are_equations;
      ties_.push_back(tie);
    }
    ++number;
  });
  if (!can_sweep) return false;
  for (std::uint32_t k = 0; k < bodies.copies.size(); ++k) {
    const HeapBodies::Copy& copy = bodies.copies[k];
    ties_.push_back({.a = bodies.owner[copy.node], .b = copy.body, .item = k, .rows = 3});
  }
  has_frame_ = is_frame_due_ = have_joints;
  return true;
}

void HeapTies::build_frame(const Problem& problem) {
  is_frame_due_ = false;
  frame_.clear();  // contacts come and go, and joints stay: then the pattern is kept
  frame_.add_nodes(problem.size());
  for (std::uint32_t i = 0; i < problem.size(); ++i) frame_.add_mass(i, problem.mass[i]);
  for (const auto& c : problem.mass_couplings) frame_.couple_masses(c.a, c.b, c.mass);
  problem.for_each_constraint_pool([&]<class C>(const ConstraintPool<C>& pool) {
    if constexpr (!std::is_same_v<C, ContactConstraint>)
      for (std::size_t i = 0; i < pool.items.size(); ++i)
        if (!has_laws(pool, i)) frame_.add(pool.items[i], {0, {}, static_cast<std::uint32_t>(i)});
  });
  if (!newton_) newton_ = std::make_unique<Newton>();
  newton_->compile(frame_);
  change_.resize(problem.size());
}

void HeapTies::begin(const Problem& problem, const HeapBodies& bodies, double h) {
  visit_rows(problem, [&]<class C>(Tie& tie, const ConstraintPool<C>& pool) {
    const C& c = pool.items[tie.item];
    tie.moves = c.is_moving();
    for (const std::uint32_t node : pool.nodes_of(c)) tie.moves = tie.moves || bodies.all[bodies.owner[node]].is_driven;
    tie.drives = tie.moves;
    for (int r = 0; r < C::rows; ++r) {
      tie.law[r] = pool.has_laws() ? pool.law(tie.item)[r] : RowLaw{};
      tie.impulse[r] = std::clamp(-h * pool.multiplier(tie.item)[r], -h * tie.law[r].upper, -h * tie.law[r].lower);
      tie.drives = tie.drives || (tie.law[r].hold && tie.law[r].rate != 0);
    }
  });
  for (Tie& tie : ties_) {
    tie.sum = {};
    if (tie.pool == of_copies) tie.impulse = {};
  }
}

void HeapTies::refresh(const Problem& problem, const HeapBodies& bodies, std::span<const HeapMotion> motions, double h,
                       double from, double to) {
  if (ties_.empty()) return;
  x_ = problem.position;
  for (std::size_t i = 0; i < bodies.all.size(); ++i) {
    const HeapBody& body = bodies.all[i];
    if (body.is_driven) continue;
    for (std::uint32_t k = 0; k < body.count; ++k)
      if (bodies.owner[body.nodes[k]] == i) x_[body.nodes[k]] = body.center_now() + body.arm_now(k);
  }
  x_next_ = x_;
  for (const AffineConstraint& c : problem.items_of<AffineConstraint>()) {
    if (c.count != 1 || !bodies.all[bodies.owner[c.nodes[0]]].is_driven) continue;
    x_[c.nodes[0]] = c.target_start + from * (c.target - c.target_start);
    x_next_[c.nodes[0]] = c.target_start + to * (c.target - c.target_start);
  }
  std::size_t next = visit_rows(problem, [&]<class C>(Tie& tie, const ConstraintPool<C>& pool) {
    const C& c = pool.items[tie.item];
    pool.value(tie.item, x_.data(), from, tie.value.data());
    tie.drift = {};
    if (tie.moves) {
      std::array<double, 3> later{};
      pool.value(tie.item, x_next_.data(), to, later.data());
      for (int r = 0; r < C::rows; ++r) tie.drift[r] = (later[r] - tie.value[r]) / h;
    }
    tie.way_a = tie.turn_a = tie.way_b = tie.turn_b = {};
    const Gradients<C> gradients(c, x_.data(), from);
    for (int i = 0; i < c.node_count(); ++i) {
      const std::uint32_t node = c.nodes[i];
      const bool is_of_a = tie.a != none && bodies.have(tie.a, node);
      if (!is_of_a && !(tie.b != none && bodies.have(tie.b, node))) continue;
      Vec3 rows[C::rows];
      gradients.of_node(i, rows);
      const Vec3 arm = x_[node] - bodies.all[is_of_a ? tie.a : tie.b].center_now();
      for (int r = 0; r < C::rows; ++r) {
        (is_of_a ? tie.way_a : tie.way_b)[r] += rows[r];
        (is_of_a ? tie.turn_a : tie.turn_b)[r] += cross(arm, rows[r]);
      }
    }
    weigh(tie, motions);
  });
  for (; next < ties_.size(); ++next) {
    Tie& tie = ties_[next];
    const HeapBodies::Copy& copy = bodies.copies[tie.item];
    const HeapBody &a = bodies.all[tie.a], &b = bodies.all[tie.b];
    const Vec3 place = b.center_now() + b.arm_now(copy.place), off = x_[copy.node] - place;
    const Vec3 arm_a = x_[copy.node] - a.center_now(), arm_b = place - b.center_now();
    for (int r = 0; r < 3; ++r) {
      const Vec3 unit{r == 0 ? 1.0 : 0, r == 1 ? 1.0 : 0, r == 2 ? 1.0 : 0};
      tie.value[r] = dot(off, unit);
      tie.way_a[r] = unit, tie.turn_a[r] = cross(arm_a, unit);
      tie.way_b[r] = -1.0 * unit, tie.turn_b[r] = -1.0 * cross(arm_b, unit);
    }
    weigh(tie, motions);
  }
}

void HeapTies::weigh(Tie& tie, std::span<const HeapMotion> motions) const {
  Mat3 matrix = Mat3::diagonal(0);
  for (int r = 0; r < tie.rows; ++r)
    for (int s = 0; s <= r; ++s) {
      double sum = 0;
      const auto add = [&](std::uint32_t body, const auto& way, const auto& turn) {
        if (body == none) return;
        const HeapMotion& m = motions[body];
        sum += m.by_mass * dot(way[r], way[s]) + dot(turn[r], m.by_inertia * turn[s]);
      };
      add(tie.a, tie.way_a, tie.turn_a), add(tie.b, tie.way_b, tie.turn_b);
      matrix.m[r][s] = matrix.m[s][r] = sum;
    }
  for (int r = 0; r < tie.rows; ++r) tie.by_mass[r] = matrix.m[r][r];
  if (tie.rows != 3 || !tie.are_equations) return;
  // A rod does not turn about its line: a little more in each direction keeps the matrix regular.
  const double size = std::max({matrix.m[0][0], matrix.m[1][1], matrix.m[2][2]});
  for (int r = 0; r < 3; ++r) matrix.m[r][r] += 1e-12 * size;
  for (int k = 0; k < 3; ++k) {
    const Vec3 column = solve(matrix, {k == 0 ? 1.0 : 0, k == 1 ? 1.0 : 0, k == 2 ? 1.0 : 0});
    tie.mass.m[0][k] = column.x, tie.mass.m[1][k] = column.y, tie.mass.m[2][k] = column.z;
  }
}

double HeapTies::rate_of(const Tie& tie, int r, std::span<const HeapMotion> motions) {
  double rate = tie.drift[r];
  if (tie.a != none) rate += dot(tie.way_a[r], motions[tie.a].velocity) + dot(tie.turn_a[r], motions[tie.a].spin);
  if (tie.b != none) rate += dot(tie.way_b[r], motions[tie.b].velocity) + dot(tie.turn_b[r], motions[tie.b].spin);
  return rate;
}

void HeapTies::give(Tie& tie, int r, double impulse, std::span<HeapMotion> motions) {
  const double before = tie.drives ? rate_of(tie, r, motions) : 0;
  const auto to = [&](std::uint32_t body, const Vec3& way, const Vec3& turn) {
    if (body == none) return;
    motions[body].velocity += (impulse * motions[body].by_mass) * way;
    motions[body].spin += motions[body].by_inertia * (impulse * turn);
  };
  to(tie.a, tie.way_a[r], tie.turn_a[r]), to(tie.b, tie.way_b[r], tie.turn_b[r]);
  if (tie.drives) work_ += impulse * (0.5 * (before + rate_of(tie, r, motions)) - tie.drift[r]);
}

void HeapTies::warm(std::span<HeapMotion> motions) {
  for (Tie& tie : ties_)
    for (int r = 0; r < tie.rows; ++r) give(tie, r, tie.impulse[r], motions);
}

void HeapTies::sweep(std::span<HeapMotion> motions, const HeapSoftness& soft, double h) {
  for (Tie& tie : ties_) {
    if (tie.rows == 3 && tie.are_equations) {
      const auto closing = [&](int r) { return rate_of(tie, r, motions) + soft.rate * tie.value[r]; };
      const Vec3 change = tie.mass * Vec3{closing(0), closing(1), closing(2)};
      const double changes[3] = {change.x, change.y, change.z};
      for (int r = 0; r < 3; ++r) {
        const double impulse = -soft.mass * changes[r] - soft.impulse * tie.impulse[r];
        tie.impulse[r] += impulse;
        give(tie, r, impulse, motions);
      }
      continue;
    }
    for (int r = 0; r < tie.rows; ++r) {
      const RowLaw& law = tie.law[r];
      if (law.is_off() || !(tie.by_mass[r] > 0)) continue;
      const double rate = rate_of(tie, r, motions), before = tie.impulse[r], mass = 1 / tie.by_mass[r];
      double after = before;
      if (law.is_compliant()) {
        const bool is_slack = tie.value[r] != 0 && law.stretch(tie.value[r]) == 0;
        const double stiff = std::isinf(law.compliance) ? 0 : h / law.compliance, s = h * stiff + h * law.damping;
        after = is_slack ? 0 : (-stiff * tie.value[r] - s * rate + s * before / mass) / (1 + s / mass);
      } else if (law.hold) {
        after = before - mass * (rate - law.rate);
      } else {
        const bool is_open = law.violation(tie.value[r]) == 0 && tie.value[r] != 0;
        const double push = is_open ? tie.value[r] / h : soft.rate * tie.value[r];
        after = before - mass * (is_open ? 1 : soft.mass) * (rate + push) - (is_open ? 0 : soft.impulse * before);
      }
      tie.impulse[r] = std::clamp(after, -h * law.upper, -h * law.lower);
      give(tie, r, tie.impulse[r] - before, motions);
    }
  }
}

double HeapTies::add_up() {
  for (Tie& tie : ties_)
    for (int r = 0; r < tie.rows; ++r) tie.sum[r] += tie.impulse[r];
  return std::exchange(work_, 0);
}

void HeapTies::store(Problem& problem, double h) {
  visit_rows(problem, [&]<class C>(const Tie& tie, ConstraintPool<C>& pool) {
    for (int r = 0; r < C::rows; ++r) pool.multiplier(tie.item)[r] = -tie.sum[r] / h;
  });
}

bool HeapTies::project(Problem& problem, double fraction) {
  if (!has_frame_) return true;
  if (is_frame_due_) build_frame(problem);
  newton_->forget_factors();  // a restored heap has none
  frame_.position = problem.position, frame_.velocity = problem.velocity, frame_.mass = problem.mass;
  for (std::size_t i = 0; i < frame_.mass_couplings.size(); ++i)
    frame_.mass_couplings[i].mass = problem.mass_couplings[i].mass;
  frame_.for_each_constraint_pool([&]<class C>(ConstraintPool<C>& pool) {
    const auto& items = problem.pool_of<C>().items;
    for (std::size_t i = 0; i < pool.items.size(); ++i) pool.items[i] = items[pool.keys[i].slot];
  });
  frame_.clear_multipliers();
  Stage stage = Stage::projection();
  stage.fraction = fraction, stage.max_iterations = 20;
  const auto displacement = newton_->displacement();
  std::fill(displacement.begin(), displacement.end(), Vec3{});
  if (!newton_->solve(frame_, stage).converged) return false;
  std::copy(newton_->solution().begin(), newton_->solution().end(), frame_.position.begin());
  find_row_rates(frame_, fraction, rates_);
  auto rate = rates_.begin();  // what follows a target has its rate already
  frame_.for_each_constraint_pool([&]<class C>(const ConstraintPool<C>& pool) {
    for (const C& c : pool.items) {
      if (c.is_moving()) std::fill(rate, rate + C::rows, 0.0);
      rate += C::rows;
    }
  });
  newton_->find_velocity_change(frame_, rates_, change_);
  if (!std::all_of(change_.begin(), change_.end(), [](const Vec3& v) { return is_finite(v); })) return false;
  std::copy(frame_.position.begin(), frame_.position.end(), problem.position.begin());
  for (std::size_t i = 0; i < problem.size(); ++i) problem.velocity[i] += change_[i];
  return true;
}

}  // namespace iota::solver
