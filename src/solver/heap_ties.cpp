// SPDX-License-Identifier: Apache-2.0
#include "solver/heap_ties.h"

#include <algorithm>
#include <cmath>
#include <type_traits>
#include <utility>

namespace iota::solver {

namespace {

constexpr double left_by_rounding = 1e-24;  ///< of a square that should be zero

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

bool HeapTies::find(const Problem& problem, const HeapBodies& bodies) {
  ties_.clear(), sides_.clear();
  bool can_sweep = true;
  std::uint8_t number = 0;
  problem.for_each_constraint_pool([&]<class C>(const ConstraintPool<C>& pool) {
    if (std::is_same_v<C, ContactConstraint>) return void(++number);
    for (std::size_t i = 0; i < pool.items.size() && can_sweep; ++i) {
      const C& c = pool.items[i];
      if constexpr (std::is_same_v<C, DistanceConstraint>)
        if (!has_laws(pool, i)) continue;  // within a body
      Tie tie{.item = static_cast<std::uint32_t>(i), .pool = number, .rows = C::rows};
      tie.are_equations = !has_laws(pool, i);
      tie.first_side = static_cast<std::uint32_t>(sides_.size());
      for (const bool are_shared : {false, true})  // a shared point may belong to a body that is there already
        for (const std::uint32_t node : pool.nodes_of(c)) {
          const std::uint32_t body = bodies.owner[node];
          if (bodies.all[body].is_driven || bodies.is_shared(node) != are_shared) continue;
          if (std::any_of(sides_.begin() + tie.first_side, sides_.end(),
                          [&](const Side& side) { return bodies.have(side.body, node); }))
            continue;
          sides_.push_back({.body = body});
        }
      tie.side_count = static_cast<std::uint32_t>(sides_.size()) - tie.first_side;
      if constexpr (ConeConstraint<C>) can_sweep = false;
      if (tie.side_count > 0) ties_.push_back(tie);
    }
    ++number;
  });
  if (!can_sweep) return false;
  for (std::uint32_t k = 0; k < bodies.copies.size(); ++k) {
    const HeapBodies::Copy& copy = bodies.copies[k];
    ties_.push_back({.first_side = static_cast<std::uint32_t>(sides_.size()), .side_count = 2, .item = k, .rows = 3});
    sides_.push_back({.body = bodies.owner[copy.node]}), sides_.push_back({.body = copy.body});
  }
  equations_.clear();
  std::vector<DelassusFactor::Incidence> incidences;
  for (std::uint32_t k = 0; k < ties_.size(); ++k) {
    if (!ties_[k].are_equations) continue;
    for (const Side& side : sides_of(ties_[k]))
      incidences.push_back({static_cast<std::uint32_t>(equations_.size()), side.body});
    equations_.push_back(k);
  }
  return factor_.analyze(static_cast<std::uint32_t>(equations_.size()), incidences,
                         static_cast<std::uint32_t>(bodies.all.size()));
}

void HeapTies::begin(const Problem& problem, const HeapBodies& bodies, double h) {
  resistances_.clear();
  visit_rows(problem, [&]<class C>(Tie& tie, const ConstraintPool<C>& pool) {
    const C& c = pool.items[tie.item];
    if constexpr (std::is_same_v<C, ResistanceConstraint>)
      resistances_.push_back(static_cast<std::uint32_t>(&tie - ties_.data()));
    tie.moves = c.is_moving(), tie.size = c.reference_length();
    for (const std::uint32_t node : pool.nodes_of(c)) tie.moves = tie.moves || bodies.all[bodies.owner[node]].is_driven;
    for (int r = 0; r < C::rows; ++r) {
      tie.law[r] = pool.has_laws() ? pool.law(tie.item)[r] : RowLaw{};
      tie.impulse[r] = std::clamp(-h * pool.multiplier(tie.item)[r], -h * tie.law[r].upper, -h * tie.law[r].lower);
    }
  });
  for (Tie& tie : ties_) {
    tie.sum = {};
    if (tie.pool != of_copies) continue;
    tie.impulse = {}, tie.size = norm(bodies.all[sides_of(tie)[1].body].arms[bodies.copies[tie.item].place]);
  }
}

void HeapTies::refresh(const Problem& problem, const HeapBodies& bodies, std::span<const HeapMotion> motions, double h,
                       double from, double to) {
  if (ties_.empty()) return;
  bodies.find_places(problem, from, to, x_, x_next_);
  std::size_t next = visit_rows(problem, [&]<class C>(Tie& tie, const ConstraintPool<C>& pool) {
    const C& c = pool.items[tie.item];
    pool.value(tie.item, x_.data(), from, tie.value.data());
    tie.drift = {};
    if (tie.moves) {
      std::array<double, 3> later{};
      pool.value(tie.item, x_next_.data(), to, later.data());
      for (int r = 0; r < C::rows; ++r) tie.drift[r] = (later[r] - tie.value[r]) / h;
    }
    const std::span<Side> sides = sides_of(tie);
    for (Side& side : sides) side.way = side.turn = {};
    const Gradients<C> gradients(c, x_.data(), from);
    std::array<double, C::rows> apart{};  // what the points of a row would be moved, if they did not share a body
    for (int i = 0; i < c.node_count(); ++i) {
      const std::uint32_t node = c.nodes[i];
      const auto side = std::ranges::find_if(sides, [&](const Side& s) { return bodies.have(s.body, node); });
      if (side == sides.end()) continue;
      Vec3 rows[C::rows];
      gradients.of_node(i, rows);
      const Vec3 arm = x_[node] - bodies.all[side->body].center_now();
      const HeapMotion& m = motions[side->body];
      const double by_mass = m.by_mass + m.by_inertia.trace() * dot(arm, arm);
      for (int r = 0; r < C::rows; ++r)
        side->way[r] += rows[r], side->turn[r] += cross(arm, rows[r]), apart[r] += by_mass * dot(rows[r], rows[r]);
    }
    // A rod between two points of one body moves nothing: by what round-off leaves it shot the body away.
    for (int r = 0; r < C::rows; ++r)
      if (!(by_mass_of(tie, r, r, motions) > left_by_rounding * apart[r]))
        for (Side& side : sides) side.way[r] = side.turn[r] = {};
    weigh(tie, motions);
  });
  for (; next < ties_.size(); ++next) {
    Tie& tie = ties_[next];
    const HeapBodies::Copy& copy = bodies.copies[tie.item];
    Side &one = sides_of(tie)[0], &other = sides_of(tie)[1];
    const HeapBody &a = bodies.all[one.body], &b = bodies.all[other.body];
    const Vec3 place = b.center_now() + b.arm_now(copy.place), off = x_[copy.node] - place;
    const Vec3 arm_a = x_[copy.node] - a.center_now(), arm_b = place - b.center_now();
    for (int r = 0; r < 3; ++r) {
      const Vec3 unit = unit_vector(r);
      tie.value[r] = dot(off, unit);
      one.way[r] = unit, one.turn[r] = cross(arm_a, unit);
      other.way[r] = -1.0 * unit, other.turn[r] = -1.0 * cross(arm_b, unit);
    }
    weigh(tie, motions);
  }
}

double HeapTies::by_mass_of(const Tie& tie, int r, int s, std::span<const HeapMotion> motions) const {
  double sum = 0;
  for (const Side& side : sides_of(tie)) {
    const HeapMotion& m = motions[side.body];
    sum += m.by_mass * dot(side.way[r], side.way[s]) + dot(side.turn[r], m.by_inertia * side.turn[s]);
  }
  return sum;
}

void HeapTies::weigh(Tie& tie, std::span<const HeapMotion> motions) const {
  Mat3 matrix = Mat3::diagonal(0);
  for (int r = 0; r < tie.rows; ++r)
    for (int s = 0; s <= r; ++s) matrix.m[r][s] = matrix.m[s][r] = by_mass_of(tie, r, s, motions);
  for (int r = 0; r < tie.rows; ++r) tie.by_mass[r] = matrix.m[r][r];
  if (tie.rows != 3 || !tie.are_equations) return;
  // A rod does not turn about its line: a little more in each direction keeps the matrix regular.
  const double size = std::max({matrix.m[0][0], matrix.m[1][1], matrix.m[2][2]});
  if (!(size > 0)) {
    tie.mass = Mat3::diagonal(0);
    return;
  }
  for (int r = 0; r < 3; ++r) matrix.m[r][r] += 1e-12 * size;
  for (int k = 0; k < 3; ++k) tie.mass.set_column(k, solve(matrix, unit_vector(k)));
}

double HeapTies::rate_of(const Tie& tie, int r, std::span<const HeapMotion> motions) const {
  double rate = tie.drift[r];
  for (const Side& side : sides_of(tie))
    rate += dot(side.way[r], motions[side.body].velocity) + dot(side.turn[r], motions[side.body].spin);
  return rate;
}

// A motor works by the whole rate, all others by that of their targets: what they take off the rest is lost.
void HeapTies::give(Tie& tie, int r, double impulse, std::span<HeapMotion> motions) {
  const bool is_motor = tie.law[r].is_rate && tie.law[r].rate != 0;
  const double before = is_motor ? rate_of(tie, r, motions) : 0;
  for (const Side& side : sides_of(tie)) {
    HeapMotion& motion = motions[side.body];
    motion.velocity += (impulse * motion.by_mass) * side.way[r];
    motion.spin += motion.by_inertia * (impulse * side.turn[r]);
  }
  work_ -= impulse * tie.drift[r];
  if (is_motor) work_ += 0.5 * impulse * (before + rate_of(tie, r, motions));
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
      if ((law.is_off() && tie.impulse[r] == 0) || !(tie.by_mass[r] > 0)) continue;
      const double rate = rate_of(tie, r, motions), before = tie.impulse[r], mass = 1 / tie.by_mass[r];
      double after = before;
      if (law.is_compliant()) {
        const bool is_slack = tie.value[r] != 0 && law.stretch(tie.value[r]) == 0;
        const double stiff = std::isinf(law.compliance) ? 0 : h / law.compliance, s = h * stiff + h * law.damping;
        after = is_slack ? 0 : (-stiff * tie.value[r] - s * rate + s * before / mass) / (1 + s / mass);
      } else if (law.is_rate) {
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

double HeapTies::worst_gap() const {
  double worst = 0;
  for (const std::uint32_t k : equations_)
    for (int r = 0; r < ties_[k].rows; ++r) worst = std::max(worst, std::abs(ties_[k].value[r]));
  return worst;
}

bool HeapTies::are_copies_apart() const {
  constexpr double far = 1e-2;  // of the way to the point
  return std::ranges::any_of(ties_, [](const Tie& tie) {
    return tie.pool == of_copies && !(norm({tie.value[0], tie.value[1], tie.value[2]}) <= far * tie.size);
  });
}

bool HeapTies::are_met() const {
  constexpr double finest = 1e-11;
  return std::all_of(equations_.begin(), equations_.end(), [&](std::uint32_t k) {
    const Tie& tie = ties_[k];
    return std::all_of(tie.value.begin(), tie.value.begin() + tie.rows,
                       [&](double value) { return std::abs(value) <= finest * tie.size; });
  });
}

void HeapTies::factorize(std::span<const HeapMotion> motions) {
  factor_.factorize([&](std::uint32_t i, std::uint32_t j) {
    const Tie &one = ties_[equations_[i]], &two = ties_[equations_[j]];
    Mat3 block;
    for (const Side& side : sides_of(one))
      for (const Side& other : sides_of(two)) {
        if (side.body != other.body) continue;
        const HeapMotion& m = motions[side.body];
        for (int s = 0; s < two.rows; ++s) {
          const Vec3 way = m.by_mass * other.way[s], turn = m.by_inertia * other.turn[s];
          for (int r = 0; r < one.rows; ++r) block.m[r][s] += dot(side.way[r], way) + dot(side.turn[r], turn);
        }
      }
    return block;
  });
}

template <class Rows>
void HeapTies::find_changes(std::span<const HeapMotion> motions, Rows rows) {
  answers_.resize(equations_.size());
  for (std::size_t i = 0; i < equations_.size(); ++i) {
    const Tie& tie = ties_[equations_[i]];
    answers_[i] = {rows(tie, 0), tie.rows > 1 ? rows(tie, 1) : 0, tie.rows > 2 ? rows(tie, 2) : 0};
  }
  factor_.solve(answers_);
  changes_.assign(motions.size(), {});
  for (std::size_t i = 0; i < equations_.size(); ++i) {
    const Tie& tie = ties_[equations_[i]];
    const double impulses[3] = {answers_[i].x, answers_[i].y, answers_[i].z};
    for (const Side& side : sides_of(tie))
      for (int r = 0; r < tie.rows; ++r)
        changes_[side.body].velocity -= impulses[r] * side.way[r],
            changes_[side.body].spin -= impulses[r] * side.turn[r];
  }
  for (std::size_t b = 0; b < motions.size(); ++b)
    changes_[b].velocity = motions[b].by_mass * changes_[b].velocity,
    changes_[b].spin = motions[b].by_inertia * changes_[b].spin;
}

// Moves bodies onto the equations.
bool HeapTies::close(const Problem& problem, HeapBodies& bodies, std::span<HeapMotion> motions, double h, double at,
                     double later) {
  constexpr int most_iterations = 20;
  bodies_before_ = bodies.all;
  motions_before_.assign(motions.begin(), motions.end());
  for (int i = 0; i == 0 || !are_met(); ++i) {
    if (i == most_iterations) {
      bodies.all = bodies_before_;
      std::copy(motions_before_.begin(), motions_before_.end(), motions.begin());
      return false;
    }
    factorize(motions);
    find_changes(motions, [](const Tie& tie, int r) { return tie.value[r]; });
    for (std::size_t b = 0; b < bodies.all.size(); ++b) {
      HeapBody& body = bodies.all[b];
      if (motions[b].by_mass == 0) continue;
      body.moved += changes_[b].velocity;
      body.turn_to(normalized(multiply(turn_by(changes_[b].spin), body.turn)), body.angular_momentum(motions[b].spin),
                   motions[b]);
    }
    refresh(problem, bodies, motions, h, at, later);
  }
  return true;
}

bool HeapTies::project(const Problem& problem, HeapBodies& bodies, std::span<HeapMotion> motions, double h, double at,
                       double later, bool positions) {
  if (equations_.empty()) return true;
  refresh(problem, bodies, motions, h, at, later);
  if (!positions) factorize(motions);
  if (positions && !close(problem, bodies, motions, h, at, later)) return false;
  close_rates(motions);
  return true;
}

void HeapTies::close_rates(std::span<HeapMotion> motions) {
  constexpr int passes = 2;  // the second removes the errors of a factor at the places before
  if (equations_.empty()) return;
  for (int pass = 0; pass < passes; ++pass) {
    find_changes(motions, [&](const Tie& tie, int r) { return rate_of(tie, r, motions); });
    for (std::size_t b = 0; b < motions.size(); ++b)
      motions[b].velocity += changes_[b].velocity, motions[b].spin += changes_[b].spin;
  }
}

}  // namespace iota::solver
