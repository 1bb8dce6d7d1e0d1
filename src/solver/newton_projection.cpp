// SPDX-License-Identifier: Apache-2.0
// Projections of velocities on the constraints.
#include "solver/largest.h"
#include "solver/newton.h"
#include "solver/rigid_motion.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <type_traits>

namespace iota::solver {

namespace {

// A stop, or friction, and a gear on the same angle have parallel gradients at the body that is eliminated first: its
// pivot is that of their compliance, and 3e-6 of the angular momentum were lost where gears met a stop. Restored by a
// rotation, which internal constraints do not notice.
void give_back_angular_momentum(Problem& problem, std::span<const Vec3> before) {
  const RigidMotion now = rigid_motion_of(problem);
  const auto lost_by = [&](double mass, std::uint32_t a, std::uint32_t b) {
    return mass * cross(problem.position[a] - now.center, before[b] - problem.velocity[b]);
  };
  Vec3 lost;
  for (std::uint32_t i = 0; i < problem.size(); ++i) lost += lost_by(problem.mass[i], i, i);
  for (const auto& c : problem.mass_couplings) lost += lost_by(c.mass, c.a, c.b) + lost_by(c.mass, c.b, c.a);
  const Vec3 turn = solve_semidefinite(now.inertia, lost, 1e-12);
  for (std::size_t i = 0; i < problem.size(); ++i) problem.velocity[i] += cross(turn, problem.position[i] - now.center);
}

}  // namespace

void Newton::project_velocities(Problem& problem, double h, std::span<const Vec3> impulses) {
  std::copy(problem.velocity.begin(), problem.velocity.end(), u_saved_.begin());
  has_laws_ = problem.has_laws();  // which may have been added since the last solve
  impulses_.resize(has_laws_ || problem.adds_impulses() ? assembly_.unknown_count() : 0);
  if (has_laws_) ActiveSet::begin_impulses(problem);
  const Wanted wanted{.h = h, .impulses = impulses};
  const double energy = problem.kinetic_energy();
  bool found = project_onto_sides(problem, wanted, energy).has_value();
  while (has_laws_ && found && ActiveSet::release_impulses(problem, impulses_)) {
    std::copy(u_saved_.begin(), u_saved_.end(), problem.velocity.begin());
    found = project_onto_sides(problem, wanted, energy).has_value();
  }
  if (found && h > 0) add_impulses(problem);
  if (found && problem.is_isolated()) give_back_momentum(problem, impulses);
}

Newton::Wanted Newton::begin_after_step(Problem& problem, const Stage& stage, const AfterStep& known) {
  const double whole_step = stage.h / (stage.fraction - stage.fraction_start);
  if (has_laws_ || !problem.items_of<CouplingConstraint>().empty()) {
    mean_place_.resize(problem.size()), mean_velocity_.resize(problem.size());
    for (std::size_t i = 0; i < problem.size(); ++i) {
      mean_velocity_[i] = problem.velocity[i];
      if (stage.is_mid_point()) mean_velocity_[i] -= (1 / stage.h) * u_[i];
      mean_place_[i] = problem.position[i] - (0.5 * stage.h) * mean_velocity_[i];
    }
  }
  if (has_laws_) ActiveSet::begin_impulses_after_step(problem);
  std::copy(problem.velocity.begin(), problem.velocity.end(), u_saved_.begin());
  impulses_.resize(has_laws_ || problem.adds_impulses() ? assembly_.unknown_count() : 0);
  // A stack at rest saves a factor so. A single link that rests at a spring would gather the noise, and never sleep.
  const double noise = problem.has_used<ContactConstraint>() ? 10 * round_off : 0;
  return {.h = known.drives_rows ? whole_step : 0,
          .is_after_step = true,
          .still = noise * reference_length() / whole_step,
          .end = stage.fraction};
}

namespace {

/// Whether the end of a step takes energy from what moves faster than its contacts would move it within the step. What rests, begins to
/// slide or comes to rest may be beyond a cone by a little.
bool takes_much(Problem& problem, double before, double after, double h) {
  constexpr double much = 0.05;  // of the kinetic energy: in many steps a wave of dominoes would fade
  if (!(before - after > much * before) || !problem.has_used<ContactConstraint>()) return false;
  const auto& pool = problem.pool_of<ContactConstraint>();
  double impulse = 0;
  for (std::size_t k = 0; k < pool.items.size(); ++k) impulse += h * std::abs(pool.multiplier(k)[0]);
  const double mass = std::accumulate(problem.mass.begin(), problem.mass.end(), 0.0);
  return 2 * before * mass > impulse * impulse;
}

}  // namespace

std::optional<double> Newton::project_velocities_after(Problem& problem, const Stage& stage, const AfterStep& known) {
  if (!problem.has_used_constraints()) return {};
  const Wanted wanted = begin_after_step(problem, stage, known);
  std::optional<double> kinetic = project_onto_sides(problem, wanted, known.kinetic);
  if (kinetic && takes_much(problem, known.kinetic, *kinetic, stage.h)) {
    kinetic = project_within_cones(problem, wanted, stage.h, known.kinetic);
    forget_drags(problem);
  }
  if (kinetic) add_impulses(problem);
  if (kinetic && problem.adds_impulses()) note_late_impulses(problem, stage.h);
  if (!kinetic || !known.is_isolated) return kinetic;
  give_back_momenta(problem);
  return problem.kinetic_energy();
}

void Newton::give_back_momenta(Problem& problem) const {
  give_back_momentum(problem, {});
  if (has_laws_ || problem.has_used<CouplingConstraint>()) give_back_angular_momentum(problem, u_saved_);
}

// An impact of the mid-point rule is complete only with the velocities at its end; so is the start of what a target drives.
void Newton::add_impulses(Problem& problem) const {
  if (impulses_.empty() || !(problem.adds_impulses() || problem.has_used<ContactConstraint>())) return;
  problem.for_each_constraint_pool([&]<class C>(ConstraintPool<C>& pool) {
    const auto add = [&](auto sum_of) {
      for (std::size_t k = 0; k < pool.items.size(); ++k)
        for (std::size_t r = 0; r < C::rows; ++r) sum_of(k)[r] += impulses_[pool.slots[k].unknown + r];
    };
    if constexpr (std::is_same_v<C, ContactConstraint>)
      add([&](std::size_t k) { return pool.items[k].impulse.data(); });
    else if (!pool.impulses.empty())
      add([&](std::size_t k) { return pool.impulses.data() + k * C::rows; });
  });
}

// The multipliers of the mid-point rule have twice what a target takes that changes its speed, or a rope that becomes taut. The
// projection takes half of it back.
void Newton::note_late_impulses(Problem& problem, double h) const {
  constexpr double little = 1e-3;  // of the impulse of a driven row
  bool any = false;
  problem.for_each_constraint_pool([&]<class C>(const ConstraintPool<C>& pool) {
    for (std::size_t row = 0; row < pool.laws.size(); row += ConeConstraint<C> ? C::rows : 1) {  // of a cone the normal
      if (!pool.states.is_equation(row) || !(pool.laws[row].is_rate || pool.states.has_been_met(row))) continue;
      const double late = impulses_[pool.slots[row / C::rows].unknown + row % C::rows];
      any = any || std::abs(late) > little * h * std::abs(pool.multipliers[row]);
    }
  });
  if (any) problem.note_late_impulses();
}

void Newton::find_velocity_change(const Problem& problem, std::span<const Vec3> impulses, std::span<const double> rates,
                                  double fraction, std::span<Vec3> change) {
  constexpr int passes = 3;  // the later ones remove errors of compliance and round-off
  std::copy(problem.position.begin(), problem.position.end(), x_.begin());
  std::fill(change.begin(), change.end(), Vec3{});
  Stage stage = Stage::projection();
  stage.fraction = fraction;
  for (int pass = 0; pass < passes; ++pass) {
    const std::span<double> residuals = assembly_.residuals();
    std::fill(residuals.begin(), residuals.end(), 0.0);
    if (pass == 0) set_residuals(impulses);
    auto rate = rates.begin();
    problem.for_each_constraint_pool([&]<class C>(const ConstraintPool<C>& pool) {
      for (std::size_t k = 0; k < pool.items.size(); ++k) {
        const C& c = pool.items[k];
        double* const row = residuals.data() + pool.slots[k].unknown;
        for (int r = 0; r < C::rows && !rates.empty(); ++r) row[r] = *rate++;
        const Gradients<C> gradients(c, x_.data(), fraction);
        for (int i = 0; i < c.node_count(); ++i) {
          Vec3 rows[C::rows];
          gradients.of_node(i, rows);
          for (int r = 0; r < C::rows; ++r) row[r] += dot(rows[r], change[c.nodes[i]]);
        }
        for (int r = 0; r < C::rows; ++r)
          if (!pool.is_equation(k, r)) row[r] = 0;
      }
    });
    if (pass == 0)
      (void)assembly_.factor_and_solve(problem, stage, x_.data(), Hessian::none);
    else
      assembly_.solve();
    for (std::size_t i = 0; i < change.size(); ++i) change[i] -= assembly_.step_of(static_cast<std::uint32_t>(i));
  }
}

/// Sets the residuals of the nodes to minus these impulses.
void Newton::set_residuals(std::span<const Vec3> impulses) {
  for (std::size_t i = 0; i < impulses.size(); ++i) {
    double* const r = assembly_.residuals().data() + assembly_.unknown_of(static_cast<std::uint32_t>(i));
    r[0] = -impulses[i].x, r[1] = -impulses[i].y, r[2] = -impulses[i].z;
  }
}

// Nearly redundant rows have huge multipliers that cancel only to round-off. In an isolated problem momentum is
// restored by a translation, which does not affect internal constraints.
void Newton::give_back_momentum(Problem& problem, std::span<const Vec3> impulses) const {
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
// rows (a closed loop in a plane) can make pivots vanish at the default compliance, so it may have to rise. So it may
// for an almost straight arm with its end driven inwards: the speed of its elbow would be unbounded. Returns the
// kinetic energy afterwards; `energy` is that before. After a step, rates within the tolerance are left alone.
std::optional<double> Newton::project_onto_sides(Problem& problem, const Wanted& wanted, double energy) {
  constexpr double leverage = 10;  // of speeds relative to those that drive them
  // Two corners that rebound at different speeds can hardly stick both. With a softness of 1e-6 they pushed each other with a
  // thousand times the impulse of the impact, so that both seemed to slip.
  constexpr double softness_in_impacts = 1e-2;
  double most = energy * (1 + 1e-9);
  for (const double compliance : row_compliances) {
    Stage stage = Stage::projection(compliance);
    stage.fraction = wanted.fraction();
    if (wanted.has_impacts) stage.softness = softness_in_impacts;
    std::fill(impulses_.begin(), impulses_.end(), 0.0);
    double drive = find_rates(problem, wanted);
    if (wanted.is_after_step && !wanted.has_impacts && drive == 0) return {};
    set_residuals(wanted.impulses);
    if (wanted.h > 0) {  // energy may be added
      for (const Vec3& v : problem.velocity) drive = std::max(drive, norm(v));
      const double mass = std::accumulate(problem.mass.begin(), problem.mass.end(), 0.0);
      most = std::max(most, energy * (1 + 1e-9) + 0.5 * mass * (leverage * drive) * (leverage * drive));
    }
    (void)assembly_.factor_and_solve(problem, stage, problem.position.data(), Hessian::none);
    add_step_to_velocities(problem);
    const int most_passes =
        wanted.has_impacts ? 8 : 2;  // compliance and round-off; the turn since the middle of the step
    for (int pass = 0; pass < most_passes && find_rates(problem, wanted) > 0; ++pass) {
      assembly_.solve();
      add_step_to_velocities(problem);
    }
    const double projected = problem.kinetic_energy();
    if (std::isfinite(projected) && (projected <= most || !wanted.impulses.empty())) return projected;
    std::copy(u_saved_.begin(), u_saved_.end(), problem.velocity.begin());
  }
  return {};
}

namespace {

/// Rows that keep their average rate of the last step.
template <class C>
bool keeps_mean_rate(const ConstraintPool<C>& pool, std::size_t item) {
  if (std::is_same_v<C, CouplingConstraint>) return !pool.has_laws() || !pool.states.has_been_met(item);
  if (!pool.has_laws()) return false;
  const RowLaw* const law = pool.law(item);
  return std::any_of(law, law + C::rows, [](const RowLaw& l) { return l.is_rate && l.rate != 0; });
}

}  // namespace

template <class C>
void Newton::add_mean_rates(const C& c, double* row) const {
  const Gradients<C> gradients(c, mean_place_.data(), 1);
  for (int i = 0; i < c.node_count(); ++i) {
    Vec3 rows[C::rows];
    gradients.of_node(i, rows);
    for (int r = 0; r < C::rows; ++r) row[r] -= dot(rows[r], mean_velocity_[c.nodes[i]]);
  }
}

// Writes the violation of each row by the velocities into the residuals; returns the largest, 0 if it is within the tolerance.
double Newton::find_rates(const Problem& problem, const Wanted& wanted) {
  const std::span<double> residuals = assembly_.residuals();
  Largest worst;
  std::fill(residuals.begin(), residuals.end(), 0.0);
  problem.for_each_constraint_pool([&]<class C>(const ConstraintPool<C>& pool) {
    for (std::size_t k = 0; k < pool.items.size(); ++k) {
      const C& c = pool.items[k];
      double* const row = residuals.data() + pool.slots[k].unknown;
      const bool keeps_rate = wanted.is_after_step && keeps_mean_rate(pool, k);
      if (keeps_rate) {
        add_mean_rates(c, row);
      } else if (wanted.h > 0 && c.is_moving()) {
        double start[C::rows], end[C::rows];
        c.value(problem.position.data(), 0, start);
        c.value(problem.position.data(), 1, end);
        for (int r = 0; r < C::rows; ++r) row[r] = (end[r] - start[r]) / wanted.h;
      }
      const Gradients<C> gradients(c, problem.position.data(), wanted.fraction());
      for (int i = 0; i < c.node_count(); ++i) {
        Vec3 rows[C::rows];
        gradients.of_node(i, rows);
        for (int r = 0; r < C::rows; ++r) row[r] += dot(rows[r], problem.velocity[c.nodes[i]]);
      }
      if constexpr (BouncingConstraint<C>)
        for (int r = 0; wanted.is_after_step && r < C::rows; ++r) row[r] -= c.rate_of(r, wanted.end);
      if constexpr (BouncingConstraint<C>)
        if (wanted.has_impacts && c.rebound > 0) row[0] = rate_in_the_middle(c, problem.velocity) - c.rebound;
      if (pool.has_laws())
        for (int r = 0; r < C::rows; ++r) {
          const RowLaw& law = pool.law(k)[r];
          if (law.is_rate && !keeps_rate) row[r] -= law.rate;
          if (law.is_compliant()) row[r] -= pool.states.stretching(k * C::rows + static_cast<std::size_t>(r));
          if (!pool.is_equation(k, r)) row[r] = 0;
        }
      // To m/s, as rows of angles and directions have no lengths.
      const double size = GeneralConstraint<C> ? reference_length() / c.reference_length() : 1;
      for (int r = 0; r < C::rows; ++r) worst.add(size * std::abs(row[r]));
    }
  });
  Largest speed;
  for (const Vec3& v : problem.velocity) speed.add(largest_component(v));
  return worst.value <= std::max(wanted.tolerance() * speed.value, wanted.still) ? 0 : worst.value;
}

void Newton::add_step_to_velocities(Problem& problem) {
  for (std::size_t i = 0; i < impulses_.size(); ++i) impulses_[i] -= assembly_.step()[i];
  for (std::size_t i = 0; i < problem.size(); ++i)
    problem.velocity[i] -= assembly_.step_of(static_cast<std::uint32_t>(i));
}

}  // namespace iota::solver
