// SPDX-License-Identifier: Apache-2.0
#include "solver/assembly.h"

#include "solver/largest.h"
#include "solver/row_equation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace iota::solver {

namespace {

constexpr double largest_noise = 1e-8;  // of the scaled force residual

struct NoGradients {
  NoGradients(const auto&, const Vec3*, double, const auto&) {}
};
/// Only the mid-point scheme takes means.
template <Scheme S, class C>
using MeanGradientsOf = std::conditional_t<S == Scheme::mid_point, MeanGradients<C>, NoGradients>;

/// A small constraint is copied, so that the compiler knows that writes do not change it.
template <class C>
using Kept = std::conditional_t<sizeof(C) <= 32, const C, const C&>;

/// sum |G|^2 / m of each row.
template <class C>
std::array<double, C::rows> mobilities_of(const Problem& problem, const C& c, const Gradients<C>& gradients) {
  std::array<double, C::rows> sum{};
  for (int i = 0; i < c.node_count(); ++i) {
    Vec3 rows[C::rows];
    gradients.of_node(i, rows);
    for (std::size_t r = 0; r < sum.size(); ++r) sum[r] += dot(rows[r], rows[r]) / problem.mass[c.nodes[i]];
  }
  return sum;
}

/// Neither at a bound, nor with a rate or a compliance of its own.
template <class C>
bool is_rigid(const ConstraintPool<C>& pool, std::size_t k, int r) {
  return !pool.has_laws() || (pool.is_equation(k, r) && !pool.law(k)[r].is_rate && !pool.law(k)[r].is_compliant());
}

}  // namespace

void Assembly::add_momentum(const Problem& problem, const Stage& stage, const Vec3* x, const Vec3* u) {
  const std::size_t n = problem.size();
  const Vec3* const x0 = problem.position.data();
  const bool push = !stage.is_projection();

  for (std::size_t i = 0; i < n; ++i) {
    Vec3 f = (stage.inertia * problem.mass[i]) * u[i];
    if (push) f -= problem.mass[i] * problem.gravity;
    double* const r = unknowns_.data() + node_unknown_[i];
    r[0] = f.x, r[1] = f.y, r[2] = f.z;
  }
  for (const auto& c : problem.mass_couplings) {
    const Vec3 pull = push ? c.mass * problem.gravity : Vec3{};
    add_force(c.a, (stage.inertia * c.mass) * u[c.b] - pull);
    add_force(c.b, (stage.inertia * c.mass) * u[c.a] - pull);
  }
  if (!push) return;
  for (std::size_t i = 0; i < problem.force.size(); ++i) add_force(static_cast<std::uint32_t>(i), -problem.force[i]);
  for (const BodyTorque& t : problem.torques) add_torque(t, t.forces_in_step(x0, x, stage.is_mid_point()));
  const ForceStage force_stage{stage.h, stage.is_mid_point(), false};
  problem.for_each_force_pool([&](const auto& pool) {
    for (const auto& f : pool.items) {
      const Vec3 force = f.force(f.arm.value(x0), f.arm.value(x), force_stage);
      for (std::uint32_t i = 0; i < f.arm.count; ++i) add_force(f.arm.nodes[i], -f.arm.weights[i] * force);
    }
  });
}

Residual Assembly::residual(const Problem& problem, const Stage& stage, const Vec3* x, const Vec3* u) {
  const Timed timed(times_, &StepTimes::forces);
  add_momentum(problem, stage, x, u);
  if (has_extreme_masses()) resistance_.assign(problem.mass.begin(), problem.mass.end());
  worst_ = violation_ = largest_multiplier_ = redundancy_ = 0;
  problem.for_each_constraint_pool([&](const auto& pool) {
    if (pool.items.empty()) return;
    const auto add = [&]<Scheme S> {
      pool.has_laws() ? add_rows<S, true>(problem, stage, pool, x) : add_rows<S, false>(problem, stage, pool, x);
      if (has_extreme_masses()) add_resistance<S>(stage, pool, problem.position.data(), x);
    };
    stage.is_mid_point() ? add.template operator()<Scheme::mid_point>() : add.template operator()<Scheme::end_point>();
  });
  double worst_force = 0, mass_there = 1, lightest = std::numeric_limits<double>::infinity();
  const double* const masses = has_extreme_masses() ? resistance_.data() : problem.mass.data();
  for (std::size_t i = 0; i < problem.size(); ++i) {
    const double* const r = unknowns_.data() + node_unknown_[i];
    const double mass = masses[i], size = largest_component({r[0], r[1], r[2]});
    if (!(size * mass_there <= worst_force * mass)) worst_force = size, mass_there = mass;  // by the mass, undivided
    lightest = std::min(lightest, mass);
  }
  const double scale = inverse_scale(stage);
  Residual found{.rows = worst_, .violation = violation_, .imbalance = worst_force * scale / mass_there};
  // Canceling forces leave round-off, which counts as zero. Enormous multipliers mean a conflict, not noise.
  found.noise = std::min(round_off * largest_multiplier_ * scale / lightest, largest_noise);
  Largest worst{worst_};
  worst.add(found.imbalance > found.noise ? found.imbalance : 0);
  found.worst = worst.value;
  return found;
}

// A drag of 1e12 N s/m between places of about 1 m pulls with an uncertainty of 1e-2 N, far above what moves a gram by the
// tolerance. No step reduces that, and none is needed: the places are right to the last bit.
bool Assembly::is_round_off_of_laws(const Problem& problem, const Stage& stage, const Vec3* x) {
  constexpr double round_off_of_sums = 8 * std::numeric_limits<double>::epsilon();
  if (stage.is_projection() || !(worst_ <= stage.tolerance)) return false;
  blur_.assign(problem.size(), 0);
  const ForceStage force_stage{stage.h, stage.is_mid_point(), false};
  const Vec3* const x0 = problem.position.data();
  problem.for_each_force_pool([&](const auto& pool) {
    for (const auto& f : pool.items) {
      const Mat3 stiffness = f.stiffness_matrix(f.arm.value(x0), f.arm.value(x), force_stage);
      double size = 0, far = norm(f.arm.origin);
      for (const auto& row : stiffness.m) size += dot({row[0], row[1], row[2]}, {row[0], row[1], row[2]});
      for (std::uint32_t i = 0; i < f.arm.count; ++i) far += std::abs(f.arm.weights[i]) * norm(x[f.arm.nodes[i]]);
      for (std::uint32_t i = 0; i < f.arm.count; ++i)
        blur_[f.arm.nodes[i]] += std::abs(f.arm.weights[i]) * std::sqrt(size) * far;
    }
  });
  for (std::size_t i = 0; i < problem.size(); ++i) {
    const double* const r = unknowns_.data() + node_unknown_[i];
    const double allowed = stage.tolerance * problem.mass[i] / inverse_scale(stage) + round_off_of_sums * blur_[i];
    if (!(largest_component({r[0], r[1], r[2]}) <= allowed)) return false;
  }
  return true;
}

// The constraint forces of a pool, and the residuals of its equations.
template <Scheme S, bool Laws, class C>
void Assembly::add_rows(const Problem& problem, const Stage& stage, const ConstraintPool<C>& pool, const Vec3* x) {
  constexpr bool is_mid_point = S == Scheme::mid_point;
  const Vec3* const x0 = problem.position.data();
  const double start = stage.fraction_start, end = stage.fraction;
  const double give = row_compliance(stage);
  const bool gives = stage.compliance != 0;
  double largest_multiplier = largest_multiplier_, redundancy = redundancy_;
  const double* const reciprocal_pivots =
      factored_ && looks_for_redundant_rows_ ? factor_.diagonals() : nullptr;  // without factors: of another problem
  Largest worst{worst_}, violation{violation_};
  for (std::size_t k = 0; k < pool.items.size(); ++k) {
    const Kept<C> c = pool.items[k];
    double lambda[C::rows];  // a copy, too
    std::copy_n(pool.multiplier(k), C::rows, lambda);
    if constexpr (Laws)
      if (is_out_of_play(pool, k)) {
        for (int r = 0; r < C::rows; ++r) unknowns_[pool.slots[k].unknown + r] = 0;
        continue;
      }
    const Gradients<C> gradients(c, x, end);
    double g[C::rows], compliance = 0, compliances[C::rows] = {};
    pool.value(k, gradients, g);
    if (!Laws && gives) compliance = mobilities_of(problem, c, gradients)[0] * give;
    [[maybe_unused]] const MeanGradientsOf<S, C> means(c, x0, start, gradients);
    for (int i = 0; i < c.node_count(); ++i) {
      Vec3 rows[C::rows];
      gradients.of_node(i, rows);
      if constexpr (Laws)
        for (int r = 0; r < C::rows; ++r) compliances[r] += dot(rows[r], rows[r]) / problem.mass[c.nodes[i]];
      Vec3 mean_rows[C::rows];
      if constexpr (is_mid_point) means.of_node(i, rows, mean_rows);
      for (int r = 0; r < C::rows; ++r) add_force(c.nodes[i], lambda[r] * (is_mid_point ? mean_rows[r] : rows[r]));
    }
    const double per_length = 1 / c.reference_length();
    [[maybe_unused]] ConeEquations cone;
    if constexpr (Laws && ConeConstraint<C>) cone = equations_of(pool, k, g, compliances, stage);
    for (int r = 0; r < C::rows; ++r) {
      double value, gap = g[r];
      if constexpr (Laws && ConeConstraint<C>) {
        const bool is_equation = pool.is_equation(k, r);
        value = cone.value[r] - (is_equation ? compliances[r] * give * lambda[r] : 0);
        gap = is_equation ? cone.value[r] : 0;
      } else if constexpr (Laws) {
        const bool is_equation = pool.is_equation(k, r);
        const RowEquation equation = equation_of(pool, k, r, g[r], stage);
        if (!is_equation)
          value = gap = 0;
        else
          value = equation.value - (equation.softness + compliances[r] * give) * lambda[r];
        if (equation.softness > 0) gap = 0;
        if (pool.law(k)[r].is_rate && is_equation) gap = equation.value;
      } else {
        value = g[r] - compliance * lambda[r];
      }
      if constexpr (!ConeConstraint<C>) {
        const auto& slots = pool.slots[k];
        if (reciprocal_pivots && (!Laws || pool.is_equation(k, r))) {
          const double reciprocal = std::abs(reciprocal_pivots[slots.diagonal + r * (slots.stride + 1)]);
          redundancy = std::max(redundancy, reciprocal * (Laws ? compliances[r] * give : compliance));
        }
      }
      unknowns_[pool.slots[k].unknown + r] = value;
      worst.add(std::abs(value) * per_length);
      violation.add(std::abs(gap) * per_length);
      // To N, as rows of angles and directions have no lengths.
      const double size = GeneralConstraint<C> ? c.reference_length() / reference_length_ : 1;
      largest_multiplier = std::max(largest_multiplier, size * std::abs(lambda[r]));
    }
  }
  worst_ = worst.value, violation_ = violation.value, largest_multiplier_ = largest_multiplier;
  redundancy_ = redundancy;
}

// The stiffness of rows against the motion of their points: see weigh.
template <Scheme S, class C>
void Assembly::add_resistance(const Stage& stage, const ConstraintPool<C>& pool, const Vec3* x0, const Vec3* x) {
  constexpr bool is_mid_point = S == Scheme::mid_point;
  for (std::size_t k = 0; k < pool.items.size(); ++k) {
    const C& c = pool.items[k];
    const Gradients<C> gradients(c, x, stage.fraction);
    [[maybe_unused]] const MeanGradientsOf<S, C> means(c, x0, stage.fraction_start, gradients);
    for (int i = 0; i < c.node_count(); ++i) {
      Vec3 rows[C::rows], directions[C::rows];
      gradients.of_node(i, rows);
      if constexpr (is_mid_point) means.of_node(i, rows, directions);
      for (int r = 0; r < C::rows; ++r)
        resistance_[c.nodes[i]] +=
            std::abs(pool.multiplier(k)[r]) * norm(is_mid_point ? directions[r] : rows[r]) * inverse_scale(stage);
    }
  }
}

bool Assembly::load_redundant_shares(const Problem& problem, const Stage& stage, const Vec3* x) {
  constexpr double little = 0.1;  // of the tolerance
  if (stage.compliance > exact_rows) return false;
  const double give = row_compliance(stage);
  std::fill(unknowns_.begin(), unknowns_.end(), 0.0);
  bool are_strained = false;
  problem.for_each_constraint_pool([&]<class C>(const ConstraintPool<C>& pool) {
    if constexpr (ConeConstraint<C>) return;
    are_strained = are_strained || !pool.offsets.empty();
    for (std::size_t k = 0; k < pool.items.size() && !are_strained; ++k) {
      const C& c = pool.items[k];
      const auto mobilities = mobilities_of(problem, c, Gradients<C>(c, x, stage.fraction));
      for (int r = 0; r < C::rows; ++r) {
        if (!is_rigid(pool, k, r)) continue;
        const double mobility = mobilities[pool.has_laws() ? static_cast<std::size_t>(r) : 0];
        const double strain = give * mobility * pool.multiplier(k)[r];
        unknowns_[pool.slots[k].unknown + r] = -strain;
        are_strained = are_strained || !(std::abs(strain) <= little * stage.tolerance * c.reference_length());
      }
    }
  });
  return !are_strained;
}

Strain Assembly::strain_released(const Problem& problem, const Stage& stage, const Vec3* x,
                                 std::span<const double> multipliers_before) const {
  const double give = row_compliance(stage);
  Strain strain;
  const double* lambda = multipliers_before.data();
  problem.for_each_constraint_pool([&]<class C>(const ConstraintPool<C>& pool) {
    for (std::size_t k = 0; k < pool.items.size(); ++k) {
      const C& c = pool.items[k];
      double before[C::rows], after[C::rows];
      pool.value(k, problem.position.data(), stage.fraction_start, before);
      pool.value(k, x, stage.fraction, after);
      const auto mobilities = mobilities_of(problem, c, Gradients<C>(c, x, stage.fraction));
      for (int r = 0; r < C::rows; ++r, ++lambda) {
        if (!is_rigid(pool, k, r)) continue;
        const double compliance = give * mobilities[static_cast<std::size_t>(r)] + 1e-300;
        const double at_start = before[r] * before[r] / compliance, at_end = after[r] * after[r] / compliance;
        strain.released += (at_start - at_end) / 2;
        strain.of_stored += (std::min(at_start, std::abs(*lambda * before[r])) - at_end) / 2;
        if constexpr (!ConeConstraint<C>) strain.of_joints += (at_start - at_end) / 2;
      }
    }
  });
  return strain;
}

namespace {

/// v' H v of each row, H its Hessian: the second derivative of g along the velocities, m/s^2.
template <class C>
void calc_bends(const C& c, const Vec3* x, const Vec3* v, double* bends) {
  std::fill(bends, bends + C::rows, 0.0);
  if constexpr (C::has_curvature)
    for (int r = 0; r < C::rows; ++r) {
      double only[C::rows] = {};
      only[r] = 1;
      if constexpr (GeneralConstraint<C>) {
        Mat3 blocks[C::max_nodes * (C::max_nodes + 1) / 2];
        c.curvature(x, 1, only, false, blocks);
        const Mat3* block = blocks;
        for (int i = 0; i < c.node_count(); ++i)
          for (int j = i; j < c.node_count(); ++j, ++block)
            bends[r] += (i == j ? 1 : 2) * dot(v[c.nodes[i]], *block * v[c.nodes[j]]);
      } else {
        for (int i = 0; i < c.node_count(); ++i)
          for (int j = i; j < c.node_count(); ++j)
            bends[r] += (i == j ? 1 : 2) * c.curvature(only, i, j) * dot(v[c.nodes[i]], v[c.nodes[j]]);
      }
    }
  else if constexpr (requires { c.bend(x, v); })
    bends[0] = c.bend(x, v);
}

}  // namespace

void Assembly::load_rates(const Problem& problem) {
  const Vec3 *const x = problem.position.data(), *const v = problem.velocity.data();
  for (std::size_t i = 0; i < problem.size(); ++i) {
    double* const r = unknowns_.data() + node_unknown_[i];
    r[0] = r[1] = r[2] = 0;
    add_force(static_cast<std::uint32_t>(i), -problem.mass[i] * problem.gravity);
  }
  for (const auto& c : problem.mass_couplings)
    add_force(c.a, -c.mass * problem.gravity), add_force(c.b, -c.mass * problem.gravity);
  problem.for_each_drag_of_damping([&](std::uint32_t node, const Vec3& drag) { add_force(node, drag); });
  for (std::size_t i = 0; i < problem.force.size(); ++i) add_force(static_cast<std::uint32_t>(i), -problem.force[i]);
  for (const BodyTorque& t : problem.torques) add_torque(t, t.forces([&](std::uint32_t node) { return x[node]; }));
  problem.for_each_force_pool([&](const auto& pool) {
    for (const auto& f : pool.items) {
      const Vec3 e = f.arm.value(x), force = f.force(e - f.arm.rate(v), e, ForceStage::at_an_instant());
      for (std::uint32_t i = 0; i < f.arm.count; ++i) add_force(f.arm.nodes[i], -f.arm.weights[i] * force);
    }
  });
  problem.for_each_constraint_pool([&]<class C>(const ConstraintPool<C>& pool) {
    for (std::size_t k = 0; k < pool.items.size(); ++k) {
      double* const row = unknowns_.data() + pool.slots[k].unknown;
      calc_bends(pool.items[k], x, v, row);
      if (pool.has_laws()) load_row_forces(problem, pool, k, row);
    }
  });
}

template <class C>
void Assembly::load_row_forces(const Problem& problem, const ConstraintPool<C>& pool, std::size_t k, double* row) {
  const RowMotion<C> motion(problem, pool.items[k]);
  for (int r = 0; r < C::rows; ++r) {
    if (pool.is_equation(k, r)) continue;
    row[r] = multiplier_in_motion(pool.law(k)[r], pool.multiplier(k)[r], motion.value[r], motion.speed[r]);
    if (row[r] == 0) continue;
    for (int i = 0; i < pool.items[k].node_count(); ++i)
      add_force(pool.items[k].nodes[i], row[r] * motion.gradient(i, r));
  }
}

inline void Assembly::add_to_node(std::uint32_t node,
                                  double value) {  // said again: as an exported function it is not inlined
  double* const d = factor_.diagonals() + node_diagonal_[node];
  const int s = node_stride_[node];
  d[0] += value, d[s + 1] += value, d[2 * s + 2] += value;
}

template <Storage T>
void Assembly::add_to_pair(const BlockPattern::PairSlot& slot, double value) {
  const int s = slot.stride;
  for (int r = 0; r < 3; ++r) factor_.lower()[slot.offset + r * (s + 1)] += value;
  if constexpr (T == Storage::general)
    for (int r = 0; r < 3; ++r) factor_.upper()[slot.offset + r * (s + 1)] += value;
}

template <Storage T, class C, class Between>
void Assembly::add_isotropic_curvature(const C& c, const typename ConstraintPool<C>::Slots& slots, Between between) {
  for (int i = 0, pair = 0; i < c.node_count(); ++i) {
    add_to_node(c.nodes[i], between(i, i));
    for (int j = i + 1; j < c.node_count(); ++j, ++pair) add_to_pair<T>(slots.pairs[pair], between(i, j));
  }
}

template <Storage T, class C>
void Assembly::add_curvature(const C& c, const typename ConstraintPool<C>::Slots& slots, const Stage& stage,
                             const Vec3* x, const double* lambda, bool clamp) {
  if constexpr (requires { c.curvature_of_arms(lambda[0], clamp); }) {
    const auto of_arms = c.curvature_of_arms(lambda[0], clamp);
    add_isotropic_curvature<T>(c, slots, [&](int i, int j) { return c.curvature_between(of_arms, i, j); });
    return;
  }
  Mat3 blocks[C::max_nodes * (C::max_nodes + 1) / 2];
  c.curvature(x, stage.fraction, lambda, clamp, blocks);
  const Mat3* block = blocks;
  for (int i = 0, pair = 0; i < c.node_count(); ++i) {
    double* const d = factor_.diagonals() + node_diagonal_[c.nodes[i]];
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
          if constexpr (T == Storage::general) factor_.upper()[slot.offset + r * slot.stride + k] += value;
        }
    }
  }
}

template <Storage T, class F>
void Assembly::assemble_forces(const Problem& problem, const ForceStage& stage, const ForcePool<F>& pool,
                               const Vec3* x) {
  const Vec3* const x0 = problem.position.data();
  double* const lower = factor_.lower();
  [[maybe_unused]] double* const upper = factor_.upper();
  for (std::size_t k = 0; k < pool.items.size(); ++k) {
    const F& f = pool.items[k];
    const Mat3 stiffness = f.stiffness_matrix(f.arm.value(x0), f.arm.value(x), stage);
    for (std::uint32_t i = 0, pair = 0; i < f.arm.count; ++i) {
      double* const d = factor_.diagonals() + node_diagonal_[f.arm.nodes[i]];
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
            if constexpr (T == Storage::general) upper[at] += w * f.arm.weights[j] * stiffness.m[c][r];
          }
      }
    }
  }
}

void Assembly::assemble(const Problem& problem, const Stage& stage, const Vec3* x, Hessian hessian) {
  forget_factors();
  if (stage.is_mid_point())
    assemble_all<Scheme::mid_point, Storage::general>(problem, stage, x, hessian);
  else if (stage.storage == Storage::general || problem.is_unsymmetric())
    assemble_all<Scheme::end_point, Storage::general>(problem, stage, x, hessian);
  else
    assemble_all<Scheme::end_point, Storage::symmetric>(problem, stage, x, hessian);
}

template <Scheme S, Storage T>
void Assembly::assemble_all(const Problem& problem, const Stage& stage, const Vec3* x, Hessian hessian) {
  factor_.clear(T);
  for (std::uint32_t i = 0; i < problem.size(); ++i) add_to_node(i, stage.inertia * problem.mass[i]);
  for (const auto& c : problem.mass_couplings) add_to_pair<T>(c.slot, stage.inertia * c.mass);
  problem.for_each_constraint_pool([&](const auto& pool) {
    if (pool.items.empty()) return;
    pool.has_laws() ? assemble_rows<S, T, true>(problem, stage, pool, x, hessian)
                    : assemble_rows<S, T, false>(problem, stage, pool, x, hessian);
  });
  if (stage.is_projection()) return;
  const ForceStage force_stage{stage.h, S == Scheme::mid_point, hessian == Hessian::clamped};
  problem.for_each_force_pool([&](const auto& pool) { assemble_forces<T>(problem, force_stage, pool, x); });
}

namespace {

/// The equations of a cone, which are needed before the gradients are visited; of others nothing.
template <bool IsCone, class C>
ConeEquations cone_equations([[maybe_unused]] const Problem& problem, [[maybe_unused]] const Stage& stage,
                             [[maybe_unused]] const ConstraintPool<C>& pool, [[maybe_unused]] std::size_t k,
                             [[maybe_unused]] const Gradients<C>& gradients) {
  if constexpr (!IsCone) {
    return {};
  } else {
    double g[C::rows];
    pool.value(k, gradients, g);
    return equations_of(pool, k, g, mobilities_of(problem, pool.items[k], gradients).data(), stage);
  }
}

}  // namespace

template <Scheme S, Storage T, bool Laws, class C>
void Assembly::assemble_rows(const Problem& problem, const Stage& stage, const ConstraintPool<C>& pool, const Vec3* x,
                             Hessian hessian) {
  constexpr bool is_mid_point = S == Scheme::mid_point, is_general = T == Storage::general;
  const Vec3* const x0 = problem.position.data();
  const bool clamp = hessian == Hessian::clamped;
  const double give = row_compliance(stage);
  double *const diagonals = factor_.diagonals(), *const lower = factor_.lower();
  [[maybe_unused]] double* const upper = factor_.upper();
  const double start = stage.fraction_start, end = stage.fraction;
  for (std::size_t k = 0; k < pool.items.size(); ++k) {
    const Kept<C> c = pool.items[k];
    const auto& slots = pool.slots[k];
    if constexpr (Laws)
      if (is_out_of_play(pool, k)) {
        for (int r = 0; r < C::rows; ++r) diagonals[slots.diagonal + r * (slots.stride + 1)] = -1;
        continue;
      }
    constexpr bool is_cone = Laws && ConeConstraint<C>;
    double compliance = 0, compliances[C::rows] = {};
    const Gradients<C> gradients(c, x, end);
    [[maybe_unused]] const MeanGradientsOf<S, C> means(c, x0, start, gradients);
    [[maybe_unused]] const ConeEquations cone = cone_equations<is_cone>(problem, stage, pool, k, gradients);
    for (int i = 0; i < c.node_count(); ++i) {
      Vec3 rows[C::rows], directions[C::rows];
      gradients.of_node(i, rows);
      if constexpr (Laws)
        for (int r = 0; r < C::rows; ++r) compliances[r] += dot(rows[r], rows[r]) / problem.mass[c.nodes[i]];
      else
        compliance += dot(rows[0], rows[0]) / problem.mass[c.nodes[i]];
      if constexpr (is_mid_point) means.of_node(i, rows, directions);
      const Vec3* in_rows = rows;
      [[maybe_unused]] Vec3 of_cone[is_cone ? C::rows : 1];
      if constexpr (is_cone) {
        for (std::size_t r = 0; r < 3; ++r) {
          const auto& by = cone.by_value[r];
          of_cone[r] = by[0] * rows[0] + by[1] * rows[1] + by[2] * rows[2];
        }
        in_rows = of_cone;
      }
      const auto& slot = slots.gradients[i];
      for (int r = 0; r < C::rows; ++r) {
        if constexpr (Laws && !is_cone)
          if (!pool.is_equation(k, r)) continue;
        const Vec3& in_row = in_rows[r];
        const Vec3& in_column = is_mid_point ? directions[r] : rows[r];
        const Vec3& below = slot.lower_is_row ? in_row : in_column;
        double* const l = (slot.in_diagonal ? diagonals : lower) + slot.offset + r * slot.row_stride;
        l[0] = below.x, l[slot.column_stride] = below.y, l[2 * slot.column_stride] = below.z;
        if constexpr (is_general) {
          const Vec3& above = slot.lower_is_row ? in_column : in_row;
          double* const u = slot.in_diagonal ? diagonals + slot.offset + slot.mirror + r : upper + (l - lower);
          const int s = slot.in_diagonal ? slot.row_stride : slot.column_stride;
          u[0] = above.x, u[s] = above.y, u[2 * s] = above.z;
        }
      }
    }
    [[maybe_unused]] double g[C::rows] = {};
    if constexpr (Laws && !is_cone) {
      const RowLaw* const law = pool.law(k);
      if (std::any_of(law, law + C::rows, [](const RowLaw& l) { return l.is_compliant(); }))
        pool.value(k, x, stage.fraction, g);
    }
    for (int r = 0; r < C::rows; ++r) {
      double& diagonal = diagonals[slots.diagonal + r * (slots.stride + 1)];
      if constexpr (is_cone) {
        for (int q = 0; q < C::rows; ++q) diagonals[slots.diagonal + r * slots.stride + q] = cone.by_multiplier[r][q];
        if (pool.is_equation(k, r)) diagonal -= compliances[r] * give;
      } else if constexpr (Laws) {
        diagonal = pool.is_equation(k, r) ? -compliances[r] * give - equation_of(pool, k, r, g[r], stage).softness : -1;
      } else {
        diagonal = -compliance * give;
      }
    }
    if constexpr (C::has_curvature) {
      if (hessian == Hessian::none) continue;
      double lambda[C::rows];
      if constexpr (GeneralConstraint<C>) {
        for (int r = 0; r < C::rows; ++r) lambda[r] = (is_mid_point ? 0.5 : 1) * pool.multiplier(k)[r];
        add_curvature<T>(c, slots, stage, x, lambda, clamp);
      } else {
        for (int r = 0; r < C::rows; ++r)
          lambda[r] = (is_mid_point ? 0.5 : 1) * (clamp ? std::max(pool.multiplier(k)[r], 0.0) : pool.multiplier(k)[r]);
        add_isotropic_curvature<T>(c, slots, [&](int i, int j) { return c.curvature(lambda, i, j); });
      }
    }
  }
}

bool Assembly::has_factors_of(const Stage& stage) const {
  return factored_ && factored_->h == stage.h && factored_->scheme == stage.scheme &&
         factored_->compliance == stage.compliance && factored_->part == stage.part;
}

bool Assembly::factor_and_solve(const Problem& problem, const Stage& stage, const Vec3* x, Hessian hessian) {
  bool good = false;
  {
    const Timed timed(times_, &StepTimes::factor);
    assemble(problem, stage, x, hessian);
    good = factor_.factorize(unknowns_) == 0;
    factored_ = stage;
  }
  const Timed timed(times_, &StepTimes::solve);
  factor_.finish(unknowns_);
  return good;
}

}  // namespace iota::solver
