// SPDX-License-Identifier: Apache-2.0
#include "solver/newton.h"

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
      length_sum += c.reference_length();
      ++constraint_count;
    }
  });
  reference_length_ = constraint_count ? length_sum / static_cast<double>(constraint_count) : 1;

  pattern_.analyse(graph);
  factor_.reset(pattern_);

  node_unknown_.resize(n), node_diagonal_.resize(n), node_stride_.resize(n);
  for (std::uint32_t i = 0; i < n; ++i) {
    node_unknown_[i] = pattern_.node_unknown(i);
    node_diagonal_[i] = pattern_.node_diagonal(i);
    node_stride_[i] = pattern_.node_stride(i);
  }
  for (auto& c : problem.mass_couplings) c.slot = pattern_.pair_slot(c.a, c.b);
  std::size_t index = 0, multiplier_count = 0;
  problem.for_each_constraint_pool([&]<class C>(ConstraintPool<C>& pool) {
    pool.multipliers.resize(pool.items.size() * C::rows, 0.0);
    pool.offsets.assign(pool.multipliers.size(), 0.0);
    multiplier_count += pool.multipliers.size();
    pool.slots.assign(pool.items.size(), {});
    for (std::size_t i = 0; i < pool.items.size(); ++i, ++index) {
      const auto& where = pattern_.constraint_slot(index);
      auto& slots = pool.slots[i];
      slots.unknown = where.unknown, slots.diagonal = where.diagonal, slots.stride = where.stride;
      std::copy_n(where.gradients.begin(), C::max_nodes, slots.gradients.begin());
      if constexpr (C::has_curvature)
        for (int a = 0, pair = 0; a < C::max_nodes; ++a)
          for (int b = a + 1; b < C::max_nodes; ++b, ++pair)
            slots.pairs[pair] = pattern_.pair_slot(pool.items[i].nodes[a], pool.items[i].nodes[b]);
    }
  });
  problem.for_each_force_pool([&](auto& pool) {
    pool.slots.assign(pool.items.size(), {});
    for (std::size_t i = 0; i < pool.items.size(); ++i) {
      const ForceArm& arm = pool.items[i].arm;
      for (std::uint32_t a = 0, pair = 0; a < arm.count; ++a)
        for (std::uint32_t b = a + 1; b < arm.count; ++b, ++pair)
          pool.slots[i].pairs[pair] = pattern_.pair_slot(arm.nodes[a], arm.nodes[b]);
    }
  });

  x_.resize(n), x_saved_.resize(n), u_.resize(n), momentum_.resize(n), inverse_scale_.resize(n);
  residual_.resize(pattern_.unknown_count()), step_.resize(pattern_.unknown_count());
  multipliers_saved_.resize(multiplier_count), merit_weights_.resize(multiplier_count);
}

template <bool Midpoint>
double Newton::residual(const Problem& problem, const Stage& stage, const Vec3* x) {
  const std::size_t n = problem.size();
  const Vec3* const x0 = problem.position.data();
  const double h = stage.h;
  const bool push = !stage.is_projection();

  for (std::size_t i = 0; i < n; ++i) {
    u_[i] = x[i] - x0[i] - h * problem.velocity[i];
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

  Largest worst, violation;
  double largest_multiplier = 0;
  problem.for_each_constraint_pool([&]<class C>(const ConstraintPool<C>& pool) {
    for (std::size_t k = 0; k < pool.items.size(); ++k) {
      const C& c = pool.items[k];
      const double* const lambda = pool.multiplier(k);
      double g[C::rows];
      pool.value(k, x, stage.fraction, g);
      double compliance = 0;
      for (int i = 0; i < c.node_count(); ++i) {
        Vec3 rows[C::rows];
        c.gradient(x, i, rows);
        if (stage.compliance != 0) compliance += dot(rows[0], rows[0]) / problem.mass[c.nodes[i]];
        Vec3 start_rows[C::rows];
        if constexpr (Midpoint) c.gradient(x0, i, start_rows);
        for (int r = 0; r < C::rows; ++r) {
          const Vec3 direction = Midpoint ? 0.5 * (rows[r] + start_rows[r]) : rows[r];
          momentum_[c.nodes[i]] += lambda[r] * direction;
        }
      }
      compliance *= stage.compliance / stage.inertia;
      for (int r = 0; r < C::rows; ++r) {
        const double value = g[r] - compliance * lambda[r];
        residual_[pool.slots[k].unknown + r] = value;
        worst.add(std::abs(value) / c.reference_length());
        violation.add(std::abs(g[r]) / c.reference_length());
        largest_multiplier = std::max(largest_multiplier, std::abs(lambda[r]));
      }
    }
  });
  violation_ = violation.value;
  Largest worst_force;
  double largest_inverse_scale = 0;
  for (std::size_t i = 0; i < n; ++i) {
    double* const r = residual_.data() + node_unknown_[i];
    r[0] = momentum_[i].x, r[1] = momentum_[i].y, r[2] = momentum_[i].z;
    worst_force.add(largest_component(momentum_[i]) * inverse_scale_[i]);
    largest_inverse_scale = std::max(largest_inverse_scale, inverse_scale_[i]);
  }
  // Forces that cancel leave round-off; do not chase it. Enormous multipliers mean a conflict, not noise.
  const double noise = std::min(round_off * largest_multiplier * largest_inverse_scale, largest_noise);
  worst.add(worst_force.value > noise ? worst_force.value : 0);
  return worst.value;
}

template <bool Midpoint>
int Newton::assemble_and_factor(const Problem& problem, const Stage& stage, Hessian hessian) {
  const Vec3* const x0 = problem.position.data();
  const Vec3* const x = x_.data();
  const bool clamp = hessian == Hessian::clamped;
  factor_.clear(!Midpoint);
  double* const lower = factor_.lower();
  [[maybe_unused]] double* const upper = factor_.upper();

  const auto add_node = [&](std::uint32_t node, double value) {
    double* const d = lower + node_diagonal_[node];
    const int s = node_stride_[node];
    d[0] += value, d[s + 1] += value, d[2 * s + 2] += value;
  };
  const auto add_pair = [&](const BlockPattern::PairSlot& slot, double value) {
    const int s = slot.stride;
    for (int r = 0; r < 3; ++r) lower[slot.offset + r * (s + 1)] += value;
    if constexpr (Midpoint)
      for (int r = 0; r < 3; ++r) upper[slot.offset + r * (s + 1)] += value;
  };

  for (std::uint32_t i = 0; i < problem.size(); ++i) add_node(i, stage.inertia * problem.mass[i]);
  for (const auto& c : problem.mass_couplings) add_pair(c.slot, stage.inertia * c.mass);

  problem.for_each_constraint_pool([&]<class C>(const ConstraintPool<C>& pool) {
    for (std::size_t k = 0; k < pool.items.size(); ++k) {
      const C& c = pool.items[k];
      const auto& slots = pool.slots[k];
      double compliance = 0;
      for (int i = 0; i < c.node_count(); ++i) {
        Vec3 rows[C::rows], directions[C::rows];
        c.gradient(x, i, rows);
        compliance += dot(rows[0], rows[0]) / problem.mass[c.nodes[i]];
        if constexpr (Midpoint) {
          c.gradient(x0, i, directions);
          for (int r = 0; r < C::rows; ++r) directions[r] = 0.5 * (directions[r] + rows[r]);
        }
        const auto& slot = slots.gradients[i];
        for (int r = 0; r < C::rows; ++r) {
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
      for (int r = 0; r < C::rows; ++r)
        lower[slots.diagonal + r * (slots.stride + 1)] = -compliance * stage.compliance / stage.inertia;
      if constexpr (C::has_curvature) {
        if (hessian == Hessian::none) continue;
        double lambda[C::rows];
        for (int r = 0; r < C::rows; ++r)
          lambda[r] = (Midpoint ? 0.5 : 1) * (clamp ? std::max(pool.multiplier(k)[r], 0.0) : pool.multiplier(k)[r]);
        for (int i = 0, pair = 0; i < c.node_count(); ++i) {
          add_node(c.nodes[i], c.curvature(lambda, i, i));
          for (int j = i + 1; j < c.node_count(); ++j, ++pair) add_pair(slots.pairs[pair], c.curvature(lambda, i, j));
        }
      }
    }
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
  return factor_.factorise();
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
      for (int r = 0; r < C::rows; ++r) value += merit_weights_[index++] * std::abs(g[r]);
    }
  });
  return value;
}

void Newton::solve_linear() {
  for (std::size_t i = 0; i < residual_.size(); ++i) step_[i] = -residual_[i];
  factor_.solve(step_);
}

void Newton::move(Problem& problem, double t) {
  for (std::size_t i = 0; i < x_.size(); ++i) {
    const double* const d = step_.data() + node_unknown_[i];
    x_[i] = x_saved_[i] + t * Vec3{d[0], d[1], d[2]};
  }
  std::size_t index = 0;
  problem.for_each_constraint_pool([&]<class C>(ConstraintPool<C>& pool) {
    for (std::size_t k = 0; k < pool.items.size(); ++k)
      for (int r = 0; r < C::rows; ++r)
        pool.multiplier(k)[r] = multipliers_saved_[index++] + t * step_[pool.slots[k].unknown + r];
  });
}

template <bool Midpoint>
NewtonReport Newton::solve_as(Problem& problem, const Stage& stage) {
  NewtonReport report;
  report.residual = residual<Midpoint>(problem, stage, x_.data());
  Hessian hessian = Hessian::exact;
  bool stuck = false;
  while (report.residual > stage.tolerance && report.iterations < stage.max_iterations) {
    ++report.iterations;
    if (assemble_and_factor<Midpoint>(problem, stage, hessian) > 0 && hessian == Hessian::exact)
      (void)assemble_and_factor<Midpoint>(problem, stage, Hessian::clamped);
    solve_linear();
    x_saved_.swap(x_);
    std::size_t index = 0;
    problem.for_each_constraint_pool([&](const auto& pool) {
      for (const double m : pool.multipliers) multipliers_saved_[index++] = m;
    });
    move(problem, 1);
    const double before = report.residual;
    double after = residual<Midpoint>(problem, stage, x_.data());
    if (!(after <= 0.5 * before)) {
      // Weights above the new multipliers make the merit exact: it cannot fall by leaving the constraints.
      index = 0;
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
        move(problem, t);
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
    report.residual = after;
  }
  report.violation = violation_;
  const bool exact = stage.compliance <= 1e-12;
  report.converged = report.residual <= std::max(stage.tolerance, stuck ? round_off_floor : 0) &&
                     (!exact || violation_ <= largest_violation);
  return report;
}

NewtonReport Newton::solve(Problem& problem, const Stage& stage, std::span<const Vec3> guess) {
  std::copy(guess.begin(), guess.end(), x_.begin());
  for (std::size_t i = 0; i < problem.size(); ++i)
    inverse_scale_[i] = 1 / (stage.inertia * problem.mass[i] * reference_length_);
  return stage.midpoint ? solve_as<true>(problem, stage) : solve_as<false>(problem, stage);
}

void Newton::project_velocities(Problem& problem, double h) {
  // min |v - velocity|_M with G v = rate: one linear solve with the matrix of a projection without curvature. Redundant
  // rows (a closed loop in a plane) can leave no pivot at the usual compliance, so it may have to rise.
  std::copy(problem.position.begin(), problem.position.end(), x_.begin());
  std::copy(problem.velocity.begin(), problem.velocity.end(), u_.begin());
  bool found = false;
  for (const double compliance : {1e-12, 1e-9, 1e-6, 1e-3}) {
    (void)assemble_and_factor<false>(problem, Stage::projection(compliance), Hessian::none);
    const double energy = problem.kinetic_energy();
    for (int pass = 0; pass < 3; ++pass) project_once(problem, h);  // again: compliance and round-off leave a little
    const double projected = problem.kinetic_energy();
    found = std::isfinite(projected) && (h > 0 || projected <= energy * (1 + 1e-9));
    if (found) break;
    std::copy(u_.begin(), u_.end(), problem.velocity.begin());
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
    lost += problem.mass[i] * (u_[i] - problem.velocity[i]);
  }
  for (const auto& c : problem.mass_couplings) {
    mass += 2 * c.mass;
    lost += c.mass * (u_[c.a] - problem.velocity[c.a] + u_[c.b] - problem.velocity[c.b]);
  }
  for (Vec3& v : problem.velocity) v += (1 / mass) * lost;
}

void Newton::project_once(Problem& problem, double h) {
  std::fill(residual_.begin(), residual_.end(), 0.0);
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
      for (int i = 0; i < c.node_count(); ++i) {
        Vec3 rows[C::rows];
        c.gradient(problem.position.data(), i, rows);
        for (int r = 0; r < C::rows; ++r) row[r] += dot(rows[r], problem.velocity[c.nodes[i]]);
      }
    }
  });
  solve_linear();
  for (std::size_t i = 0; i < problem.size(); ++i) {
    const double* const d = step_.data() + node_unknown_[i];
    problem.velocity[i] += Vec3{d[0], d[1], d[2]};
  }
}

}  // namespace iota::solver
