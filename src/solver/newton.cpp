// SPDX-License-Identifier: Apache-2.0
#include "solver/newton.h"

#include "solver/newton_slots.h"

#include "solver/step_equations.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace iota::solver {

namespace {

constexpr int max_halvings = 12;
constexpr double largest_violation = 1e-6;  // that still counts as met
constexpr double round_off_floor = 1e-8;    // a residual below it that no step lessens is as good as zero
constexpr double largest_noise = 1e-8;      // of the scaled force residual
constexpr double round_off = 4e-15;         // of the largest scaled force: below it a residual is noise
constexpr double closed_gap = 1e-6;         // relative: below it a bounded row is met
constexpr double infinity = std::numeric_limits<double>::infinity();

/// Largest of many, where a NaN counts as infinite (std::max would drop it).
struct Largest {
  double value = 0;
  void add(double v) {
    if (!(v <= value)) value = v == v ? v : infinity;
  }
};

double largest_component(const Vec3& v) {
  Largest l;
  l.add(std::abs(v.x)), l.add(std::abs(v.y)), l.add(std::abs(v.z));
  return l.value;
}

/// The equation of a row: value - softness * lambda = 0.
struct RowEquation {
  double value, softness;
};

/// A spring takes its mean stretch in the mid-point scheme, so that its energy is kept exactly.
RowEquation equation_of(const RowLaw& law, const RowState& state, double g, const Stage& stage) {
  if (law.hold) g -= state.start + law.rate * stage.h;
  if (!law.is_compliant()) return {g, 0};
  const double part = stage.midpoint ? 0.5 : 1;
  const double stiffness = 1 / law.compliance, damping = law.damping / stage.h;
  const double total = part * stiffness + damping;
  const double before = law.hold ? 0 : state.start;
  return {g + ((1 - part) * stiffness - damping) / total * before, 1 / total};
}

struct Bounds {
  double lower, upper;
};

Bounds bounds_of(const RowLaw& law, const Stage& stage) {
  if (stage.is_projection()) return {law.lower_impulse(), law.upper_impulse()};
  return {law.lower, law.upper};
}

/// Whether all rows of an item are at a bound that is zero: then it is as if it were not there.
template <class C>
bool is_out_of_play(const ConstraintPool<C>& pool, std::size_t item) {
  for (std::size_t row = item * C::rows; row < (item + 1) * C::rows; ++row)
    if (pool.states[row].side == 0 || pool.multipliers[row] != 0) return false;
  return true;
}

struct NoGradients {
  NoGradients(const auto&, const Vec3*, double) {}
};
/// Only the mid-point scheme takes gradients at the start.
template <bool Midpoint, class C>
using StartGradients = std::conditional_t<Midpoint, Gradients<C>, NoGradients>;

}  // namespace

void Newton::compile(Problem& problem) {
  const auto n = static_cast<std::uint32_t>(problem.size());
  CouplingGraph graph;
  graph.node_count = n;
  for (const auto& c : problem.mass_couplings) graph.couplings.push_back({c.a, c.b});
  problem.for_each_force_pool([&](const auto& pool) {
    for (const auto& f : pool.items)
      for (std::uint32_t i = 0; i < f.arm.count; ++i)
        for (std::uint32_t j = i + 1; j < f.arm.count; ++j) graph.couplings.push_back({f.arm.nodes[i], f.arm.nodes[j]});
  });
  double length_sum = 0;
  std::size_t constraint_count = 0;
  problem.for_each_constraint_pool([&]<class C>(const ConstraintPool<C>& pool) {
    for (const C& c : pool.items) {
      auto& added = graph.constraints.emplace_back();
      added.rows = C::rows;
      added.node_count = static_cast<std::uint8_t>(c.node_count());
      for (int i = 0; i < c.node_count(); ++i) added.nodes[i] = c.nodes[i];
      if constexpr (GeneralConstraint<C>) {
        added.apart = true;
        added.first_side = static_cast<std::uint8_t>(c.first_side);
      } else {
        length_sum += c.reference_length();
        ++constraint_count;
      }
    }
  });
  reference_length_ = constraint_count ? length_sum / static_cast<double>(constraint_count) : 1;

  pattern_.analyse(graph);
  factor_.reset(pattern_);

  for (auto& c : problem.mass_couplings) c.slot = pattern_.pair_slot(c.a, c.b);
  std::size_t index = 0, multiplier_count = 0;
  problem.for_each_constraint_pool([&]<class C>(ConstraintPool<C>& pool) {
    pool.multipliers.resize(pool.items.size() * C::rows, 0.0);
    pool.offsets.assign(pool.multipliers.size(), 0.0);
    multiplier_count += pool.multipliers.size();
    if (pool.has_laws()) pool.laws.resize(pool.multipliers.size());
    pool.states.assign(pool.laws.size(), {});
    pool.slots.assign(pool.items.size(), {});
    for (std::size_t i = 0; i < pool.items.size(); ++i) set_slots(pool, i, pattern_.constraint_slot(index++));
  });
  problem.for_each_force_pool([&](auto& pool) {
    pool.slots.assign(pool.items.size(), {});
    for (std::size_t i = 0; i < pool.items.size(); ++i) set_slots(pool, i);
  });
  multipliers_saved_.resize(multiplier_count), merit_weights_.resize(multiplier_count);
  pattern_.forget_slots();
  has_laws_ = problem.has_laws();
  set_node_places(problem);
}

template <bool Midpoint>
double Newton::residual(const Problem& problem, const Stage& stage, const Vec3* x) {
  const std::size_t n = problem.size();
  const Vec3* const x0 = problem.position.data();
  const double h = stage.h;
  const bool push = !stage.is_projection();

  for (std::size_t i = 0; i < n; ++i) {
    Vec3 f = (stage.inertia * problem.mass[i]) * u_[i];
    if (push) f -= problem.force[i] + problem.mass[i] * problem.gravity;
    momentum_[i] = f;
  }
  for (const auto& c : problem.mass_couplings) {
    momentum_[c.a] += (stage.inertia * c.mass) * u_[c.b];
    momentum_[c.b] += (stage.inertia * c.mass) * u_[c.a];
    if (push) {
      momentum_[c.a] -= c.mass * problem.gravity;
      momentum_[c.b] -= c.mass * problem.gravity;
    }
  }
  if (push) {
    const ForceStage force_stage{h, Midpoint, false};
    problem.for_each_force_pool([&](const auto& pool) {
      for (const auto& f : pool.items) {
        const Vec3 force = f.force(f.arm.value(x0), f.arm.value(x), force_stage);
        for (std::uint32_t i = 0; i < f.arm.count; ++i) momentum_[f.arm.nodes[i]] -= f.arm.weights[i] * force;
      }
    });
  }

  worst_ = violation_ = largest_multiplier_ = 0;
  problem.for_each_constraint_pool([&](const auto& pool) {
    pool.has_laws() ? add_rows<Midpoint, true>(problem, stage, pool, x)
                    : add_rows<Midpoint, false>(problem, stage, pool, x);
  });
  Largest worst_force;
  double largest_inverse_scale = 0;
  for (std::size_t i = 0; i < n; ++i) {
    double* const r = residual_.data() + node_unknown_[i];
    r[0] = momentum_[i].x, r[1] = momentum_[i].y, r[2] = momentum_[i].z;
    worst_force.add(largest_component(momentum_[i]) * inverse_scale_[i]);
    largest_inverse_scale = std::max(largest_inverse_scale, inverse_scale_[i]);
  }
  imbalance_ = worst_force.value;
  // Forces that cancel leave round-off; do not chase it. Enormous multipliers mean a conflict, not noise.
  noise_ = std::min(round_off * largest_multiplier_ * largest_inverse_scale, largest_noise);
  Largest worst{worst_};
  worst.add(worst_force.value > noise_ ? worst_force.value : 0);
  return worst.value;
}

// The constraint forces of a pool, and what is left of its equations.
template <bool Midpoint, bool Laws, class C>
void Newton::add_rows(const Problem& problem, const Stage& stage, const ConstraintPool<C>& pool, const Vec3* x) {
  const Vec3* const x0 = problem.position.data();
  Largest worst{worst_}, violation{violation_};
  for (std::size_t k = 0; k < pool.items.size(); ++k) {
    const C& c = pool.items[k];
    const double* const lambda = pool.multiplier(k);
    if constexpr (Laws)
      if (is_out_of_play(pool, k)) {
        for (int r = 0; r < C::rows; ++r) residual_[pool.slots[k].unknown + r] = 0;
        continue;
      }
    double g[C::rows];
    pool.value(k, x, stage.fraction, g);
    double compliance = 0, compliances[C::rows] = {};
    const Gradients<C> gradients(c, x, stage.fraction);
    [[maybe_unused]] const StartGradients<Midpoint, C> start_gradients(c, x0, stage.fraction_start);
    for (int i = 0; i < c.node_count(); ++i) {
      Vec3 rows[C::rows];
      gradients.of_node(i, rows);
      if constexpr (Laws)
        for (int r = 0; r < C::rows; ++r) compliances[r] += dot(rows[r], rows[r]) / problem.mass[c.nodes[i]];
      else if (stage.compliance != 0)
        compliance += dot(rows[0], rows[0]) / problem.mass[c.nodes[i]];
      Vec3 start_rows[C::rows];
      if constexpr (Midpoint) start_gradients.of_node(i, start_rows);
      for (int r = 0; r < C::rows; ++r) {
        const Vec3 direction = Midpoint ? 0.5 * (rows[r] + start_rows[r]) : rows[r];
        momentum_[c.nodes[i]] += lambda[r] * direction;
      }
    }
    const double per_length = 1 / c.reference_length();
    compliance *= stage.compliance / stage.inertia;
    for (int r = 0; r < C::rows; ++r) {
      double value, gap = g[r];
      if constexpr (Laws) {
        const RowState& state = pool.states[k * C::rows + r];
        const RowEquation equation = equation_of(pool.law(k)[r], state, g[r], stage);
        if (state.side != 0)
          value = gap = 0;
        else
          value = equation.value - (equation.softness + compliances[r] * stage.compliance / stage.inertia) * lambda[r];
        if (equation.softness > 0) gap = 0;
        if (pool.law(k)[r].hold && state.side == 0) gap = equation.value;
      } else {
        value = g[r] - compliance * lambda[r];
      }
      residual_[pool.slots[k].unknown + r] = value;
      worst.add(std::abs(value) * per_length);
      violation.add(std::abs(gap) * per_length);
      largest_multiplier_ = std::max(largest_multiplier_, std::abs(lambda[r]));
    }
  }
  worst_ = worst.value, violation_ = violation.value;
}

void Newton::add_to_node(std::uint32_t node, double value) {
  double* const d = factor_.lower() + node_diagonal_[node];
  const int s = node_stride_[node];
  d[0] += value, d[s + 1] += value, d[2 * s + 2] += value;
}

template <bool Midpoint>
void Newton::add_to_pair(const BlockPattern::PairSlot& slot, double value) {
  const int s = slot.stride;
  for (int r = 0; r < 3; ++r) factor_.lower()[slot.offset + r * (s + 1)] += value;
  if constexpr (Midpoint)
    for (int r = 0; r < 3; ++r) factor_.upper()[slot.offset + r * (s + 1)] += value;
}

template <bool Midpoint, class C>
void Newton::add_curvature(const C& c, const typename ConstraintPool<C>::Slots& slots, const Stage& stage,
                           const double* lambda, bool clamp) {
  Mat3 blocks[C::max_nodes * (C::max_nodes + 1) / 2];
  c.curvature(x_.data(), stage.fraction, lambda, clamp, blocks);
  const Mat3* block = blocks;
  for (int i = 0, pair = 0; i < c.node_count(); ++i) {
    double* const d = factor_.lower() + node_diagonal_[c.nodes[i]];
    const int stride = node_stride_[c.nodes[i]];
    for (int r = 0; r < 3; ++r)
      for (int k = 0; k < 3; ++k) d[r * stride + k] += block->m[r][k];
    ++block;
    for (int j = i + 1; j < c.node_count(); ++j, ++pair, ++block) {
      const auto& slot = slots.pairs[pair];
      for (int r = 0; r < 3; ++r)
        for (int k = 0; k < 3; ++k) {
          const double value = slot.a_first ? block->m[k][r] : block->m[r][k];
          factor_.lower()[slot.offset + r * slot.stride + k] += value;
          if constexpr (Midpoint) factor_.upper()[slot.offset + r * slot.stride + k] += value;
        }
    }
  }
}

template <bool Midpoint>
void Newton::assemble(const Problem& problem, const Stage& stage, Hessian hessian) {
  const Vec3* const x0 = problem.position.data();
  const Vec3* const x = x_.data();
  const bool clamp = hessian == Hessian::clamped;
  factor_.clear(!Midpoint);
  double* const lower = factor_.lower();
  [[maybe_unused]] double* const upper = factor_.upper();

  for (std::uint32_t i = 0; i < problem.size(); ++i) add_to_node(i, stage.inertia * problem.mass[i]);
  for (const auto& c : problem.mass_couplings) add_to_pair<Midpoint>(c.slot, stage.inertia * c.mass);

  problem.for_each_constraint_pool([&](const auto& pool) {
    pool.has_laws() ? assemble_rows<Midpoint, true>(problem, stage, pool, hessian)
                    : assemble_rows<Midpoint, false>(problem, stage, pool, hessian);
  });

  if (!stage.is_projection()) {
    const ForceStage force_stage{stage.h, Midpoint, clamp};
    problem.for_each_force_pool([&](const auto& pool) {
      for (std::size_t k = 0; k < pool.items.size(); ++k) {
        const auto& f = pool.items[k];
        const Mat3 stiffness = f.stiffness_matrix(f.arm.value(x0), f.arm.value(x), force_stage);
        for (std::uint32_t i = 0, pair = 0; i < f.arm.count; ++i) {
          double* const d = lower + node_diagonal_[f.arm.nodes[i]];
          const int s = node_stride_[f.arm.nodes[i]];
          const double w = f.arm.weights[i];
          for (int r = 0; r < 3; ++r)
            for (int c = 0; c < 3; ++c) d[r * s + c] += w * w * stiffness.m[r][c];
          for (std::uint32_t j = i + 1; j < f.arm.count; ++j, ++pair) {
            const auto& slot = pool.slots[k].pairs[pair];
            for (int r = 0; r < 3; ++r)
              for (int c = 0; c < 3; ++c) {
                const std::uint32_t at = slot.offset + r * slot.stride + c;
                lower[at] += w * f.arm.weights[j] * stiffness.m[r][c];
                if constexpr (Midpoint) upper[at] += w * f.arm.weights[j] * stiffness.m[c][r];
              }
          }
        }
      }
    });
  }
}

template <bool Midpoint, bool Laws, class C>
void Newton::assemble_rows(const Problem& problem, const Stage& stage, const ConstraintPool<C>& pool, Hessian hessian) {
  const Vec3* const x0 = problem.position.data();
  const Vec3* const x = x_.data();
  const bool clamp = hessian == Hessian::clamped;
  double* const lower = factor_.lower();
  [[maybe_unused]] double* const upper = factor_.upper();
  for (std::size_t k = 0; k < pool.items.size(); ++k) {
    const C& c = pool.items[k];
    const auto& slots = pool.slots[k];
    if constexpr (Laws)
      if (is_out_of_play(pool, k)) {
        for (int r = 0; r < C::rows; ++r) lower[slots.diagonal + r * (slots.stride + 1)] = -1;
        continue;
      }
    double compliance = 0, compliances[C::rows] = {};
    const Gradients<C> gradients(c, x, stage.fraction);
    [[maybe_unused]] const StartGradients<Midpoint, C> start_gradients(c, x0, stage.fraction_start);
    for (int i = 0; i < c.node_count(); ++i) {
      Vec3 rows[C::rows], directions[C::rows];
      gradients.of_node(i, rows);
      if constexpr (Laws)
        for (int r = 0; r < C::rows; ++r) compliances[r] += dot(rows[r], rows[r]) / problem.mass[c.nodes[i]];
      else
        compliance += dot(rows[0], rows[0]) / problem.mass[c.nodes[i]];
      if constexpr (Midpoint) {
        start_gradients.of_node(i, directions);
        for (int r = 0; r < C::rows; ++r) directions[r] = 0.5 * (directions[r] + rows[r]);
      }
      const auto& slot = slots.gradients[i];
      for (int r = 0; r < C::rows; ++r) {
        if constexpr (Laws)
          if (pool.states[k * C::rows + r].side != 0) continue;
        const Vec3& in_row = rows[r];
        const Vec3& in_column = Midpoint ? directions[r] : rows[r];
        const Vec3& below = slot.lower_is_row ? in_row : in_column;
        double* const l = lower + slot.offset + r * slot.row_stride;
        l[0] = below.x, l[slot.column_stride] = below.y, l[2 * slot.column_stride] = below.z;
        if constexpr (Midpoint) {
          const Vec3& above = slot.lower_is_row ? in_column : in_row;
          double* const u = slot.in_diagonal ? lower + slot.mirror + r : upper + (l - lower);
          const int s = slot.in_diagonal ? slot.pivot : slot.column_stride;
          u[0] = above.x, u[s] = above.y, u[2 * s] = above.z;
        }
      }
    }
    for (int r = 0; r < C::rows; ++r) {
      double& diagonal = lower[slots.diagonal + r * (slots.stride + 1)];
      if constexpr (Laws) {
        const RowState& state = pool.states[k * C::rows + r];
        diagonal = state.side != 0 ? -1
                                   : -compliances[r] * stage.compliance / stage.inertia -
                                         equation_of(pool.law(k)[r], state, 0, stage).softness;
      } else {
        diagonal = -compliance * stage.compliance / stage.inertia;
      }
    }
    if constexpr (C::has_curvature) {
      if (hessian == Hessian::none) continue;
      double lambda[C::rows];
      if constexpr (GeneralConstraint<C>) {
        for (int r = 0; r < C::rows; ++r) lambda[r] = (Midpoint ? 0.5 : 1) * pool.multiplier(k)[r];
        add_curvature<Midpoint>(c, slots, stage, lambda, clamp);
      } else {
        for (int r = 0; r < C::rows; ++r)
          lambda[r] = (Midpoint ? 0.5 : 1) * (clamp ? std::max(pool.multiplier(k)[r], 0.0) : pool.multiplier(k)[r]);
        for (int i = 0, pair = 0; i < c.node_count(); ++i) {
          add_to_node(c.nodes[i], c.curvature(lambda, i, i));
          for (int j = i + 1; j < c.node_count(); ++j, ++pair)
            add_to_pair<Midpoint>(slots.pairs[pair], c.curvature(lambda, i, j));
        }
      }
    }
  }
}

double Newton::merit(const Problem& problem, const Stage& stage, const Vec3* x) const {
  double value = 0;
  for (std::size_t i = 0; i < problem.size(); ++i) {
    const Vec3 u = x[i] - problem.position[i] - stage.h * problem.velocity[i];
    value += 0.5 * stage.inertia * problem.mass[i] * dot(u, u);
    if (!stage.is_projection()) value -= dot(problem.force[i], x[i]);
  }
  for (const auto& c : problem.mass_couplings) {
    const auto u = [&](std::uint32_t i) { return x[i] - problem.position[i] - stage.h * problem.velocity[i]; };
    value += stage.inertia * c.mass * dot(u(c.a), u(c.b));
  }
  if (!stage.is_projection()) value += problem.potential_energy(x, true);
  std::size_t index = 0;
  problem.for_each_constraint_pool([&]<class C>(const ConstraintPool<C>& pool) {
    for (std::size_t k = 0; k < pool.items.size(); ++k) {
      double g[C::rows];
      pool.value(k, x, stage.fraction, g);
      for (int r = 0; r < C::rows; ++r, ++index) {
        if (pool.has_laws()) {
          const RowState& state = pool.states[k * C::rows + r];
          const double lambda = pool.multiplier(k)[r];
          const RowEquation equation = equation_of(pool.law(k)[r], state, g[r], stage);
          if (state.side != 0) {
            value += lambda * g[r];  // a constant force
            continue;
          }
          g[r] = equation.value - equation.softness * lambda;
        }
        value += merit_weights_[index] * std::abs(g[r]);
      }
    }
  });
  return value;
}

void Newton::solve_linear() {
  for (std::size_t i = 0; i < residual_.size(); ++i) step_[i] = -residual_[i];
  factor_.solve(step_);
}

void Newton::save(const Problem& problem) {
  x_saved_.swap(x_), u_saved_.swap(u_);
  std::size_t index = 0;
  problem.for_each_constraint_pool([&](const auto& pool) {
    for (const double m : pool.multipliers) multipliers_saved_[index++] = m;
  });
}

void Newton::move(Problem& problem, const Stage& stage, double t) {
  for (std::size_t i = 0; i < x_.size(); ++i) {
    const double* const d = step_.data() + node_unknown_[i];
    u_[i] = u_saved_[i] + t * Vec3{d[0], d[1], d[2]};
    x_[i] = problem.position[i] + stage.h * problem.velocity[i] + u_[i];
  }
  std::size_t index = 0;
  problem.for_each_constraint_pool([&]<class C>(ConstraintPool<C>& pool) {
    for (std::size_t k = 0; k < pool.items.size(); ++k)
      for (int r = 0; r < C::rows; ++r)
        pool.multiplier(k)[r] = multipliers_saved_[index++] + t * step_[pool.slots[k].unknown + r];
  });
}

// The tolerance is a displacement. Divided by a short step it is a velocity and a force that count: a slow thing would
// stop short of its rest, and momentum of a spinning body leak by 1e-8 of itself. A step or two more with the factor that
// is there anyway take the residual to round-off (measured: 10 % of a step in the energy-keeping mode; the robust mode,
// which dissipates far more, pays it only where the guess was good enough by itself).
template <bool Midpoint>
double Newton::polish(Problem& problem, const Stage& stage, NewtonReport& report, bool factor_is_old) {
  constexpr int most_steps = 3;
  const auto balanced = [&] {
    Largest displacement;
    for (const Vec3& u : u_) displacement.add(largest_component(u));
    return imbalance_ <= std::max(noise_, round_off * displacement.value / reference_length_);
  };
  double now = report.residual;
  if (!(now <= stage.tolerance) || (violation_ <= round_off && balanced())) return now;
  // A factor that has served on from further away leaves more: angular momentum of a loop drifted fifty times as far.
  if (report.iterations == 0 || factor_is_old) {
    ++report.iterations;
    if (assemble_and_factor<Midpoint>(problem, stage, Hessian::exact) > 0)
      (void)assemble_and_factor<Midpoint>(problem, stage, Hessian::clamped);
  }
  for (int step = 0; step < most_steps; ++step) {
    const double imbalance = imbalance_;
    solve_linear();
    save(problem);
    move(problem, stage, 1);
    const double after = residual<Midpoint>(problem, stage, x_.data());
    if (!(after <= std::max(now, round_off))) {
      std::fill(step_.begin(), step_.end(), 0.0);
      move(problem, stage, 0);
      return residual<Midpoint>(problem, stage, x_.data());
    }
    now = after;
    if (balanced() || imbalance_ > 0.1 * imbalance) break;
  }
  return now;
}

template <bool Midpoint>
NewtonReport Newton::solve_as(Problem& problem, const Stage& stage) {
  NewtonReport report;
  if (has_laws_) begin_sides(problem, stage), choose_sides(problem, stage);
  report.residual = residual<Midpoint>(problem, stage, x_.data());
  Hessian hessian = Hessian::exact;
  bool stuck = false, settled = true, factor_will_do = false, served_on = false;
  int most_iterations = stage.max_iterations;
  while (true) {
    if (has_laws_ && report.iterations > 0) {
      settled = !choose_sides(problem, stage);
      if (!settled) {
        factor_will_do = false;
        report.residual = residual<Midpoint>(problem, stage, x_.data());
        most_iterations = std::min(most_iterations + 1, 4 * stage.max_iterations);  // choosing sides takes turns, too
      }
    }
    if (!(report.residual > stage.tolerance) || report.iterations >= most_iterations) break;
    ++report.iterations;
    served_on = factor_will_do;
    if (!factor_will_do && assemble_and_factor<Midpoint>(problem, stage, hessian) > 0 && hessian == Hessian::exact)
      (void)assemble_and_factor<Midpoint>(problem, stage, Hessian::clamped);
    solve_linear();
    save(problem);
    move(problem, stage, 1);
    const double before = report.residual;
    double after = residual<Midpoint>(problem, stage, x_.data());
    if (!(after <= 0.5 * before)) {
      // Weights above the new multipliers make the merit exact: it cannot fall by leaving the constraints.
      std::size_t index = 0;
      problem.for_each_constraint_pool([&](const auto& pool) {
        for (const double m : pool.multipliers) merit_weights_[index++] = 1.5 * std::abs(m);
      });
      const double merit_before = merit(problem, stage, x_saved_.data());
      double t = 1;
      int halvings = 0;
      while (!(after < (1 - 1e-4 * t) * before) && !(merit(problem, stage, x_.data()) < merit_before) &&
             halvings < max_halvings) {
        t *= 0.5;
        ++halvings;
        move(problem, stage, t);
        after = residual<Midpoint>(problem, stage, x_.data());
      }
      if (halvings == max_halvings && !(after < before)) {
        report.residual = after;
        stuck = true;  // at the bottom of round-off, or lost
        break;
      }
      // A full step that merely helped is no reason to give up quadratic convergence: wrong pivots would tell.
      hessian = halvings == 0 && after < before ? Hessian::exact : Hessian::clamped;
    } else {
      hessian = Hessian::exact;
    }
    // Near the solution the factor at hand serves on, where making another costs much more than an iteration.
    factor_will_do = factor_.is_dear() && after <= (factor_will_do ? 0.1 : 0.03) * before;
    report.residual = after;
  }
  if (!stuck && !stage.is_projection() && (Midpoint || report.iterations == 0))
    report.residual = polish<Midpoint>(problem, stage, report, served_on);
  report.violation = violation_;
  if (has_laws_) report.met = count_met(problem);
  const bool exact = stage.compliance <= 1e-12;
  report.converged = settled && report.residual <= std::max(stage.tolerance, stuck ? round_off_floor : 0) &&
                     (!exact || violation_ <= largest_violation);
  return report;
}

NewtonReport Newton::solve(Problem& problem, const Stage& stage, std::span<const Vec3> guess) {
  has_laws_ = problem.has_laws();
  const auto start = [&] {
    for (std::size_t i = 0; i < problem.size(); ++i) {
      u_[i] = guess[i];
      x_[i] = problem.position[i] + stage.h * problem.velocity[i] + guess[i];
    }
  };
  start();
  for (std::size_t i = 0; i < problem.size(); ++i) {
    inverse_scale_[i] = 1 / (stage.inertia * problem.mass[i] * reference_length_);
  }
  if (external_ && !stage.is_projection()) {
    NewtonReport report = solve_externally(problem, stage);
    if (report.converged) return report;
    start();
    report = stage.midpoint ? solve_as<true>(problem, stage) : solve_as<false>(problem, stage);
    report.handed_back = true;
    return report;
  }
  return stage.midpoint ? solve_as<true>(problem, stage) : solve_as<false>(problem, stage);
}

// Another solver finds the root for rows as they stand, and rows change sides between its calls.
NewtonReport Newton::solve_externally(Problem& problem, const Stage& stage) {
  constexpr int most_rounds = 30;
  NewtonReport report;
  std::size_t index = 0;
  problem.for_each_constraint_pool([&](const auto& pool) {
    for (const double m : pool.multipliers) multipliers_saved_[index++] = m;
  });
  if (has_laws_) begin_sides(problem, stage), choose_sides(problem, stage);
  bool settled = false;
  for (int round = 0; round < most_rounds && !settled; ++round) {
    StepEquations equations(*this, problem, stage);
    std::vector<double> unknowns = equations.unknowns();
    try {
      const SolverReport solved =
          external_->solve(equations, unknowns, {.tolerance = stage.tolerance, .max_iterations = stage.max_iterations});
      report.iterations += solved.iterations;
    } catch (const std::exception&) {  // nothing throws inside a step
      break;
    }
    report.residual = equations.assign(unknowns);
    settled = !has_laws_ || !choose_sides(problem, stage);
  }
  report.violation = violation_;
  if (has_laws_) report.met = count_met(problem);
  report.converged = settled && report.residual <= round_off_floor && violation_ <= largest_violation;
  if (!report.converged) {
    index = 0;
    problem.for_each_constraint_pool([&](auto& pool) {
      for (double& m : pool.multipliers) m = multipliers_saved_[index++];
    });
  }
  return report;
}

// Sides as the multipliers from the last step tell: nothing else needs to be remembered between steps.
namespace {

/// Whether velocities differ from what a hold row wants by more than a bent coordinate makes of a step. A motor that has
/// just been switched on would else be thrown back and forth about its speed for ever by the mid-point rule.
template <class C>
bool is_off_speed(const Problem& problem, const C& c, int row, double rate, const Stage& stage) {
  constexpr double bent = 1e-3, still = 1e-9;
  const Gradients<C> gradients(c, problem.position.data(), stage.fraction_start);
  double speed = 0, largest = std::abs(rate);
  for (int i = 0; i < c.node_count(); ++i) {
    Vec3 rows[C::rows];
    gradients.of_node(i, rows);
    const Vec3& v = problem.velocity[c.nodes[i]];
    speed += dot(rows[row], v);
    largest += norm(rows[row]) * norm(v);
  }
  return std::abs(speed - rate) * stage.h > bent * largest * stage.h + still * c.reference_length();
}

}  // namespace

void Newton::begin_sides(Problem& problem, const Stage& stage) {
  fewest_wrong_ = std::numeric_limits<int>::max(), stalled_ = 0;
  problem.for_each_constraint_pool([&]<class C>(ConstraintPool<C>& pool) {
    if (!pool.has_laws()) return;
    for (std::size_t k = 0; k < pool.items.size(); ++k) {
      double g[C::rows] = {};
      const RowLaw* const law = pool.law(k);
      if (std::any_of(law, law + C::rows, [](const RowLaw& l) { return !l.is_off() && (l.hold || l.is_compliant()); }))
        pool.value(k, problem.position.data(), stage.fraction_start, g);
      for (int r = 0; r < C::rows; ++r) {
        const Bounds bounds = bounds_of(law[r], stage);
        double& lambda = pool.multiplier(k)[r];
        RowState& state = pool.states[k * C::rows + r];
        state.start = g[r];
        state.side = lambda <= bounds.lower ? -1 : lambda >= bounds.upper ? 1 : 0;
        if (state.side != 0) lambda = state.side < 0 ? bounds.lower : bounds.upper;
        state.side_before = state.side;
        state.off_speed = law[r].hold && is_off_speed(problem, pool.items[k], r, law[r].rate, stage);
      }
    }
  });
}

int Newton::count_met(const Problem& problem) const {
  int count = 0;
  problem.for_each_constraint_pool([&](const auto& pool) {
    for (const RowState& state : pool.states) count += state.side == 0 && (state.side_before != 0 || state.off_speed);
  });
  return count;
}

// Moves rows between their bounds and freedom; returns whether any did. What is within the tolerance stays where it is.
bool Newton::choose_sides(Problem& problem, const Stage& stage) {
  constexpr int patience = 6;
  const bool one_only = stalled_ > patience;
  int wrong = 0;
  bool changed = false;
  problem.for_each_constraint_pool([&]<class C>(ConstraintPool<C>& pool) {
    if (!pool.has_laws()) return;
    for (std::size_t k = 0; k < pool.items.size(); ++k) {
      const C& c = pool.items[k];
      const RowLaw* const law = pool.law(k);
      RowState* const states = pool.states.data() + k * C::rows;
      double* const lambda = pool.multiplier(k);
      bool any = false, any_free = false;
      for (int r = 0; r < C::rows; ++r) {
        const Bounds bounds = bounds_of(law[r], stage);
        any = any || bounds.lower != bounds.upper;
        any_free = any_free || states[r].side == 0;
      }
      if (!any) continue;
      double g[C::rows], scale[C::rows] = {};
      pool.value(k, x_.data(), stage.fraction, g);
      if (any_free) {
        const Gradients<C> gradients(c, x_.data(), stage.fraction);
        for (int i = 0; i < c.node_count(); ++i) {
          Vec3 rows[C::rows];
          gradients.of_node(i, rows);
          for (int r = 0; r < C::rows; ++r)
            scale[r] += dot(rows[r], rows[r]) / (stage.inertia * problem.mass[c.nodes[i]]);
        }
      }
      for (int r = 0; r < C::rows; ++r) {
        const Bounds bounds = bounds_of(law[r], stage);
        RowState& state = states[r];
        if (bounds.lower == bounds.upper) continue;
        const RowEquation equation = equation_of(law[r], state, g[r], stage);
        const double open = equation.value - equation.softness * lambda[r];
        const double little = stage.tolerance * c.reference_length();
        int side = state.side;
        if (side == 0) {
          const double soft = scale[r] + equation.softness;
          if (open + soft * (lambda[r] - bounds.lower) < -little) side = -1;
          if (open + soft * (lambda[r] - bounds.upper) > little) side = 1;
        } else if (side * open < -little) {
          side = 0;
        }
        if (side == state.side) continue;
        ++wrong;
        if (one_only && changed) continue;
        state.side = static_cast<std::int8_t>(side), changed = true;
        if (side != 0) lambda[r] = side < 0 ? bounds.lower : bounds.upper;
      }
    }
  });
  if (wrong < fewest_wrong_)
    fewest_wrong_ = wrong, stalled_ = 0;
  else
    ++stalled_;
  return changed;
}

// Which bounded rows take part in a projection of velocities. `as_solved`: those that the latest solve left free, be they
// motors that have reached their speed or friction that sticks; else those that forbid something and have no gap.
void Newton::begin_impulse_sides(Problem& problem, bool as_solved) {
  problem.for_each_constraint_pool([&]<class C>(ConstraintPool<C>& pool) {
    if (!pool.has_laws()) return;
    for (std::size_t k = 0; k < pool.items.size(); ++k) {
      double g[C::rows];
      pool.value(k, problem.position.data(), as_solved ? 1 : 0, g);
      for (int r = 0; r < C::rows; ++r) {
        const RowLaw& law = pool.law(k)[r];
        RowState& state = pool.states[k * C::rows + r];
        if (as_solved) {
          if (law.is_compliant()) state.side = 1;
          continue;
        }
        const double touching = closed_gap * pool.items[k].reference_length();
        const bool pulls = law.upper_impulse() > 0 && g[r] > -touching;
        const bool pushes = law.lower_impulse() < 0 && g[r] < touching;
        state.side = pulls || pushes ? 0 : 1;
      }
    }
  });
}

// Lets go of rows whose impulse went the wrong way; returns whether there were any.
bool Newton::release_impulses(Problem& problem) {
  bool released = false;
  problem.for_each_constraint_pool([&]<class C>(ConstraintPool<C>& pool) {
    if (!pool.has_laws()) return;
    for (std::size_t row = 0; row < pool.states.size(); ++row) {
      const double impulse = impulses_[pool.slots[row / C::rows].unknown + row % C::rows];
      const RowLaw& law = pool.laws[row];
      if (pool.states[row].side != 0 || (impulse >= law.lower_impulse() && impulse <= law.upper_impulse())) continue;
      pool.states[row].side = 1, released = true;
    }
  });
  return released;
}

void Newton::project_velocities(Problem& problem, double h, bool as_solved, std::span<const Vec3> impulses) {
  std::copy(problem.position.begin(), problem.position.end(), x_.begin());
  std::copy(problem.velocity.begin(), problem.velocity.end(), u_saved_.begin());
  has_laws_ = problem.has_laws();  // which may have been lent since the last solve
  impulses_.resize(has_laws_ ? pattern_.unknown_count() : 0);
  if (has_laws_) begin_impulse_sides(problem, as_solved);
  bool found = project_onto_sides(problem, h, as_solved, impulses);
  while (has_laws_ && !as_solved && found && release_impulses(problem)) {
    std::copy(u_saved_.begin(), u_saved_.end(), problem.velocity.begin());
    found = project_onto_sides(problem, h, as_solved, impulses);
  }

  // Nearly redundant rows have huge multipliers that cancel only to round-off. Where nothing outside holds on, momentum
  // is given back by a translation, which no internal constraint notices.
  bool internal = found;
  problem.for_each_constraint_pool([&](const auto& pool) {
    for (const auto& c : pool.items) internal = internal && c.is_internal();
  });
  if (!internal) return;
  double mass = 0;
  Vec3 lost;
  for (std::size_t i = 0; i < problem.size(); ++i) {
    mass += problem.mass[i];
    lost += problem.mass[i] * (u_saved_[i] - problem.velocity[i]);
  }
  for (const auto& c : problem.mass_couplings) {
    mass += 2 * c.mass;
    lost += c.mass * (u_saved_[c.a] - problem.velocity[c.a] + u_saved_[c.b] - problem.velocity[c.b]);
  }
  for (const Vec3& impulse : impulses) lost += impulse;
  for (Vec3& v : problem.velocity) v += (1 / mass) * lost;
}

// min |v - velocity|_M with G v = rate: one linear solve with the matrix of a projection without curvature. Redundant
// rows (a closed loop in a plane) can leave no pivot at the usual compliance, so it may have to rise.
bool Newton::project_onto_sides(Problem& problem, double h, bool as_solved, std::span<const Vec3> impulses) {
  for (const double compliance : {1e-12, 1e-9, 1e-6, 1e-3}) {
    Stage stage = Stage::projection(compliance);
    stage.fraction = as_solved ? 1 : 0;
    (void)assemble_and_factor<false>(problem, stage, Hessian::none);
    std::fill(impulses_.begin(), impulses_.end(), 0.0);
    const double energy = problem.kinetic_energy();
    project_once(problem, h, impulses);
    for (int again = 0; again < 2; ++again) project_once(problem, h, {});  // compliance and round-off leave a little
    const double projected = problem.kinetic_energy();
    const bool given = h > 0 || !impulses.empty();  // then energy may come in
    if (std::isfinite(projected) && (given || projected <= energy * (1 + 1e-9))) return true;
    std::copy(u_saved_.begin(), u_saved_.end(), problem.velocity.begin());
  }
  return false;
}

void Newton::project_once(Problem& problem, double h, std::span<const Vec3> impulses) {
  std::fill(residual_.begin(), residual_.end(), 0.0);
  for (std::size_t i = 0; i < impulses.size(); ++i) {
    double* const r = residual_.data() + node_unknown_[i];
    r[0] = -impulses[i].x, r[1] = -impulses[i].y, r[2] = -impulses[i].z;
  }
  problem.for_each_constraint_pool([&]<class C>(const ConstraintPool<C>& pool) {
    for (std::size_t k = 0; k < pool.items.size(); ++k) {
      const C& c = pool.items[k];
      double* const row = residual_.data() + pool.slots[k].unknown;
      if (h > 0) {
        double start[C::rows], end[C::rows];
        c.value(problem.position.data(), 0, start);
        c.value(problem.position.data(), 1, end);
        for (int r = 0; r < C::rows; ++r) row[r] = (end[r] - start[r]) / h;
      }
      const Gradients<C> gradients(c, problem.position.data(), 0);
      for (int i = 0; i < c.node_count(); ++i) {
        Vec3 rows[C::rows];
        gradients.of_node(i, rows);
        for (int r = 0; r < C::rows; ++r) row[r] += dot(rows[r], problem.velocity[c.nodes[i]]);
      }
      if (pool.has_laws())
        for (int r = 0; r < C::rows; ++r) {
          if (pool.law(k)[r].hold) row[r] -= pool.law(k)[r].rate;
          if (pool.states[k * C::rows + r].side != 0) row[r] = 0;
        }
    }
  });
  solve_linear();
  for (std::size_t i = 0; i < impulses_.size(); ++i) impulses_[i] += step_[i];
  for (std::size_t i = 0; i < problem.size(); ++i) {
    const double* const d = step_.data() + node_unknown_[i];
    problem.velocity[i] += Vec3{d[0], d[1], d[2]};
  }
}

template double Newton::residual<false>(const Problem&, const Stage&, const Vec3*);
template double Newton::residual<true>(const Problem&, const Stage&, const Vec3*);
template void Newton::assemble<false>(const Problem&, const Stage&, Hessian);
template void Newton::assemble<true>(const Problem&, const Stage&, Hessian);

}  // namespace iota::solver
