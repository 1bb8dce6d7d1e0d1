// SPDX-License-Identifier: Apache-2.0
#include "solver/newton.h"

#include "base/slack.h"
#include "solver/largest.h"
#include "solver/loops.h"
#include "solver/row_equation.h"
#include "solver/step_equations.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace iota::solver {

namespace {

using Set = NewtonSettings;
constexpr double any_residual = std::numeric_limits<double>::infinity();

}  // namespace

bool Newton::compile(Problem& problem, const KnownOrder& order) {
  const bool is_alike = assembly_.compile(problem, order);
  make_room(problem);
  return is_alike;
}

void Newton::follow(Problem& problem) {
  assembly_.follow(problem);
  make_room(problem);
}

void Newton::make_room(const Problem& problem) {
  has_loops_.reset(), assembly_.look_for_redundant_rows(true);
  for (auto* list : {&x_, &u_, &u_saved_}) resize_with_slack(*list, problem.size());
  if (problem.has_laws()) resize_with_slack(impulses_, assembly_.unknown_count());
  multipliers_saved_.resize(problem.multiplier_count());
  reserve_for_rare_use(merit_weights_, problem.multiplier_count());
  reserve_for_rare_use(shares_, problem.multiplier_count());
}

void Newton::place(const Problem& problem, const Stage& stage) {
  for (std::size_t i = 0; i < problem.size(); ++i) x_[i] = problem.position[i] + stage.h * problem.velocity[i] + u_[i];
}

NewtonReport Newton::solve(Problem& problem, const Stage& stage) {
  has_laws_ = problem.has_laws();
  bool handed_back = false;
  if (external_ && !stage.is_projection()) {
    const std::vector<Vec3> guess = u_;
    place(problem, stage);
    const NewtonReport report = solve_externally(problem, stage);
    if (report.converged) return report;
    u_ = guess;
    handed_back = true;
  }
  place(problem, stage);
  NewtonReport report = solve_directly(problem, stage);
  report.handed_back = handed_back;
  return report;
}

void Newton::measure(const Problem& problem, const Stage& stage) {
  residual_ = assembly_.residual(problem, stage, x_.data(), u_.data());
}

// Far from the origin positions are too coarse for the directions of links and so for the forces along these: at 10 km,
// the error is 1e-11 of the force in a link of 0.1 m.
double Newton::blur_of_places(const Problem& problem) const {
  Largest place;
  for (const Vec3& x : problem.position) place.add(largest_component(x));
  return std::max(1.0, std::numeric_limits<double>::epsilon() / round_off * place.value / reference_length());
}

// With a new factor. Far from a solution, pivots of the wrong sign lead to a saddle, so the Hessian is clamped. Near a
// solution they may belong to it (a chain compressed in a whip), and a clamped Hessian would converge linearly or diverge
// from 1e-5. Then returns true: the step is tentative.
bool Newton::find_step(const Problem& problem, const Stage& stage, Hessian hessian) {
  const bool good = assembly_.factor_and_solve(problem, stage, x_.data(), hessian);
  if (good || hessian != Hessian::exact) return false;
  if (residual_.worst <= Set::exact_below) return true;
  measure(problem, stage);  // the step has overwritten the residuals
  (void)assembly_.factor_and_solve(problem, stage, x_.data(), Hessian::clamped);
  return false;
}

NewtonReport Newton::solve_directly(Problem& problem, const Stage& stage) {
  NewtonReport report;
  bool are_soft = has_stepped_ = false;
  if (!stage.is_projection()) shares_.clear();
  if (has_laws_) {
    active_set_.begin(problem, stage, x_.data()), active_set_.choose(problem, stage, x_.data());
    are_soft = stage.begins_softly && active_set_.has_changed_cones();
  }
  if (are_soft) ActiveSet::soften_cones(problem, Set::softening);
  measure(problem, stage);
  Hessian hessian = Hessian::exact;
  bool stuck = false, are_final = true;
  // The factors of the last step may do, too. Of bounded rows they may be those of other sides.
  const bool may_carry = stage.is_held && !has_laws_ && assembly_.is_dear();
  const bool carries = may_carry && assembly_.has_factors_of(stage);
  bool factor_will_do = carries, served_on = carries;
  int most_iterations = std::min(stage.max_iterations, stage.iterations_left);
  double limit = any_residual;  // of the residual after a change of sides: that before the step
  while (true) {
    if (has_laws_ && report.iterations > 0) {
      are_final = !choose_sides(problem, stage, limit);
      if (!are_final) {
        factor_will_do = false;
        for (int more = ActiveSet::most_softenings; more > 0 && !are_final && !(residual_.worst > stage.tolerance);
             --more) {
          are_final = !active_set_.choose(problem, stage, x_.data());  // what yields less may need no other motion
          measure(problem, stage);
        }
        const int most = active_set_.times_for_sides(stage) * stage.max_iterations;
        most_iterations = std::max(most_iterations, std::min({most_iterations + 1, most, stage.iterations_left}));
      }
    }
    if (are_soft && (stuck || report.iterations >= (are_final ? Set::few_soft : Set::most_soft) ||
                     !(residual_.worst > stage.tolerance))) {
      ActiveSet::soften_cones(problem, 1);
      are_soft = stuck = factor_will_do = false;
      limit = any_residual;
      measure(problem, stage);
      continue;
    }
    if (are_final && !(residual_.worst > stage.tolerance) && !stage.is_projection() &&
        active_set_.follow_reactions(problem, stage)) {
      factor_will_do = false;
      measure(problem, stage);
    }
    if (!(residual_.worst > stage.tolerance) || report.iterations >= most_iterations) break;
    ++report.iterations;
    served_on = factor_will_do;
    const double before = limit = residual_.worst;
    bool on_trial = false;
    if (factor_will_do)
      assembly_.solve();
    else
      on_trial = find_step(problem, stage, hessian);
    take_step(problem, stage);
    measure(problem, stage);
    if (carries && report.iterations == 1 && !(residual_.worst <= Set::fast * before)) {
      take_back_step(problem, stage);
      factor_will_do = false;
      continue;
    }
    const bool is_clamped = std::exchange(hessian, Hessian::exact) == Hessian::clamped;
    // If a Newton step does not reduce a residual below 10x the estimated round-off, treat it as converged: heavy loads on
    // small links leave ten times the estimate.
    const auto nothing = [&] {
      return std::min(Set::noise * blur_of_places(problem) * residual_.noise, Set::round_off_floor);
    };
    if (!(residual_.worst <= Set::fast * before)) {
      if (assembly_.is_round_off_of_laws(problem, stage, x_.data())) {
        residual_.worst = residual_.rows;
        stuck = true;
        if (are_soft) continue;
        break;
      }
      stuck = !is_clamped && (may_carry || !served_on) && before <= nothing();
      if ((stuck || on_trial) && !(residual_.worst < before)) {
        take_back_step(problem, stage);
        hessian = Hessian::clamped, limit = any_residual;
      } else if (!stuck) {
        const int halvings = stretch(problem, stage, before, is_clamped);
        stuck = halvings == Set::max_halvings && !(residual_.worst < before);  // lost
        // A small decrease by a full step does not end quadratic convergence; wrong pivots would.
        if (halvings > 0 || !(residual_.worst < before)) hessian = Hessian::clamped;
      }
      if (stuck && !are_soft) break;
    }
    // Near the solution the old factor is reused if a factorization costs much more than an iteration, and once more before
    // the residual counts as round-off: of a net of 100 x 100 a new one for that was a third of a step.
    const double wanted = (factor_will_do ? Set::reuse_again : Set::reuse_after) * before;
    factor_will_do = assembly_.is_dear() && residual_.worst <= (may_carry ? std::max(wanted, nothing()) : wanted);
  }
  if (are_soft) ActiveSet::soften_cones(problem, 1), are_final = false;
  // A problem that stands still keeps its factors: they are half of the time of a step of a tower.
  const bool stands = report.iterations == 0 && has_laws_ && assembly_.is_dear() && assembly_.has_factors_of(stage);
  if (!stuck && !stage.is_projection() && (stage.is_mid_point() || report.iterations == 0))
    polish(problem, stage, report, served_on || stands);
  report.residual = residual_.worst, report.violation = residual_.violation;
  if (!stage.is_projection() && has_stepped_) find_shares(problem, stage);
  if (has_laws_) report.met = ActiveSet::count_met(problem);
  const bool exact = stage.compliance <= exact_rows;
  report.converged =
      are_final && report.residual <= std::max(stage.tolerance, stuck ? Set::round_off_floor : 0) &&
      (!exact || report.violation <= (stage.is_mid_point() || stage.is_projection() ? closed_gap : strained_gap));
  return report;
}

// Many contacts change their states at once, for which the step was not made: it may be too long for the new ones. It is shortened
// until these leave less than was left before it. If nothing helps the whole step is taken.
bool Newton::choose_sides(Problem& problem, const Stage& stage, double limit) {
  constexpr int most = Set::halvings_for_sides;
  for (int halvings = 0;; ++halvings) {
    const bool have_changed = active_set_.choose(problem, stage, x_.data());
    if (have_changed) measure(problem, stage);
    if (!active_set_.has_many_cones() || !have_changed || halvings > most || !(residual_.worst >= limit))
      return have_changed;
    active_set_.take_back();
    scale_step(problem, stage, halvings < most ? 0.5 : std::exp2(most));
  }
}

// Halves the step until the residual or the merit falls; returns the number of halvings. Beside a saddle of springs, as
// of cloth that buckles, the clamped Hessian lacks what drives the points away: its steps lead in the right direction, but
// are a small part of the way. So one that need not be halved is doubled while the merit falls: 31 % fewer iterations of a
// cloth of 32 x 32 springs.
int Newton::stretch(Problem& problem, const Stage& stage, double before, bool is_clamped) {
  // Weights above the new multipliers make the merit exact: violating constraints cannot reduce it.
  merit_weights_.resize(problem.multiplier_count());
  problem.copy_multipliers_to(merit_weights_);
  for (double& weight : merit_weights_) weight = 1.5 * std::abs(weight);
  u_.swap(u_saved_), place(problem, stage);
  const double merit_before = merit(problem, stage, x_.data());
  u_.swap(u_saved_), place(problem, stage);
  double t = 1;
  int halvings = 0;
  while (!(residual_.worst < (1 - 1e-4 * t) * before) && !(merit(problem, stage, x_.data()) < merit_before) &&
         halvings < Set::max_halvings) {
    t *= 0.5;
    ++halvings;
    scale_step(problem, stage, 0.5);
    measure(problem, stage);
  }
  // Beside a saddle of rows, as of an arm pulled beyond its reach, the points would only leave faster (227 J instead of
  // 100).
  if (!is_clamped || halvings > 0 || !problem.has_used_springs()) return halvings;
  double least = merit(problem, stage, x_.data());
  int doublings = 0;
  while (doublings < Set::max_doublings) {
    scale_step(problem, stage, 2);
    const double value = merit(problem, stage, x_.data());
    if (!(value < least)) {
      scale_step(problem, stage, 0.5);
      break;
    }
    ++doublings, least = value;
  }
  if (doublings > 0) measure(problem, stage);
  return 0;
}

double Newton::merit(const Problem& problem, const Stage& stage, const Vec3* x) const {
  double value = 0;
  for (std::size_t i = 0; i < problem.size(); ++i) {
    const Vec3 u = x[i] - problem.position[i] - stage.h * problem.velocity[i];
    value += 0.5 * stage.inertia * problem.mass[i] * dot(u, u);
  }
  if (!stage.is_projection())
    for (std::size_t i = 0; i < problem.force.size(); ++i) value -= dot(problem.force[i], x[i]);
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
          const double lambda = pool.multiplier(k)[r];
          const RowEquation equation = equation_of(pool, k, r, g[r], stage);
          if (!pool.is_equation(k, r)) {
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

void Newton::take_step(Problem& problem, const Stage& stage) {
  has_stepped_ = true;
  u_saved_.swap(u_);
  for (std::size_t i = 0; i < x_.size(); ++i) {
    u_[i] = u_saved_[i] - assembly_.step_of(static_cast<std::uint32_t>(i));
    x_[i] = problem.position[i] + stage.h * problem.velocity[i] + u_[i];
  }
  const std::span<const double> step = assembly_.step();
  std::size_t index = 0;
  problem.for_each_constraint_pool([&]<class C>(ConstraintPool<C>& pool) {
    for (std::size_t k = 0; k < pool.items.size(); ++k)
      for (int r = 0; r < C::rows; ++r, ++index) {
        double& multiplier = pool.multiplier(k)[r];
        multipliers_saved_[index] = multiplier;
        multiplier -= step[pool.slots[k].unknown + r];
      }
  });
}

void Newton::scale_step(Problem& problem, const Stage& stage, double factor) {
  for (std::size_t i = 0; i < u_.size(); ++i) u_[i] = (1 - factor) * u_saved_[i] + factor * u_[i];
  place(problem, stage);
  auto saved = multipliers_saved_.begin();
  problem.for_each_constraint_pool([&](auto& pool) {
    for (double& multiplier : pool.multipliers) multiplier = (1 - factor) * *saved++ + factor * multiplier;
  });
}

void Newton::take_back_step(Problem& problem, const Stage& stage) {
  u_.swap(u_saved_);
  place(problem, stage);
  problem.set_multipliers(multipliers_saved_);
  measure(problem, stage);
}

bool Newton::is_balanced() const {
  Largest displacement;
  for (const Vec3& u : u_) displacement.add(largest_component(u));
  return residual_.imbalance <= std::max(residual_.noise, round_off * displacement.value / reference_length());
}

// The tolerance is a displacement. Divided by a short step it is a considerable velocity and force: a slow body would
// stop too early, and a spinning body would lose 1e-8 of its momentum. One or two more steps with the existing factor
// reduce the residual to round-off (measured: 10 % of a step in the energy-keeping mode; the robust mode, which
// dissipates far more, does it only if the guess met the tolerance).
//
// A reused factor is replaced if the residual stays above that: with redundant rows 1e-12 of their lengths remains, and
// the energy of a four-bar linkage drifted by 4e-7 instead of 5e-11.
void Newton::polish(Problem& problem, const Stage& stage, NewtonReport& report, bool factor_is_old) {
  if (!(residual_.worst <= stage.tolerance)) return;
  bool needs_factor = report.iterations == 0 && !factor_is_old;
  for (int step = 0; step < Set::polish_steps; ++step) {
    const bool met = residual_.rows <= round_off, balanced = is_balanced();
    if (met && balanced) return;
    const Residual before = residual_;
    report.iterations += needs_factor;
    if (std::exchange(needs_factor, false))
      (void)find_step(problem, stage, Hessian::exact);
    else
      assembly_.solve();
    take_step(problem, stage);
    measure(problem, stage);
    // Below 1e-12 the residual norm is noise. Keep the step anyway: it reduces the common error of all points, which
    // determines momentum and angular momentum (without it those of a tumbling mixture drifted twenty times as far).
    const bool worse = !(residual_.worst <= std::max(before.worst, Set::polish_noise));
    if (worse) take_back_step(problem, stage);
    if (!worse && ((!met && residual_.rows <= Set::polish_fast * before.rows) ||
                   (!balanced && residual_.imbalance <= Set::polish_fast * before.imbalance)))
      continue;  // it helps
    if (!factor_is_old || residual_.worst <= Set::polish_clean || report.iterations >= stage.iterations_left) return;
    factor_is_old = false, needs_factor = true;
  }
}

// Rows that hold the same are apart by round-off of places, say e. Divided by their compliance it is a force with which they press
// against each other: e / (1e-12 h^2) per mass. Two hinges of a door told 0.8 times its weight at 120 Hz, 9 times 100 m away, 26
// times at 1000 Hz. The same equations with gaps of zero share the load in the way that has the least of these forces. Their solution
// also moves points a little, and not where a heavy one would take a part of the load for that. The multipliers change after the
// step: wheels of points in a plane, whose spin is given back by what is left of their forces, lost 5 % of it.
void Newton::find_shares(Problem& problem, const Stage& stage) {
  constexpr double unbalanced = 1e-9;  // of the largest force
  // Without laws all rows act, and loops depend on the structure alone.
  if (!has_loops_ && (!has_laws_ || assembly_.may_have_redundant_rows()))
    assembly_.look_for_redundant_rows(*(has_loops_ = has_loops(problem)));
  if (!assembly_.may_have_redundant_rows() || !*has_loops_) return;
  if (assembly_.load_redundant_shares(problem, stage, x_.data())) {
    assembly_.solve();
    Largest left, largest;
    for (std::uint32_t i = 0; i < problem.size(); ++i)
      left.add(stage.inertia * problem.mass[i] * largest_component(assembly_.step_of(i)));
    bool are_within = true;
    problem.for_each_constraint_pool([&]<class C>(const ConstraintPool<C>& pool) {
      for (std::size_t k = 0; k < pool.items.size(); ++k)
        for (int r = 0; r < C::rows; ++r) {
          const double multiplier = pool.multiplier(k)[r];
          double share = !pool.has_laws() || pool.is_equation(k, r) ? assembly_.step()[pool.slots[k].unknown + r] : 0;
          largest.add(std::abs(multiplier));
          if constexpr (ConeConstraint<C>) {
            left.add(std::abs(share)), share = 0;  // it yields by far more, and its rows depend on each other
          } else if (share != 0 && pool.has_laws()) {
            const RowLaw& law = pool.law(k)[r];
            are_within = are_within && multiplier - share >= law.lower && multiplier - share <= law.upper;
          }
          shares_.push_back(share);
        }
    });
    if (!are_within || !(left.value <= unbalanced * largest.value)) shares_.clear();
  }
  measure(problem, stage);  // again, as the shares were found in the place of the residuals
}

void Newton::share_among_redundant(Problem& problem) {
  if (!shares_.empty() && shares_.size() == problem.multiplier_count()) {
    auto share = shares_.begin();
    problem.for_each_constraint_pool([&](auto& pool) {
      for (double& multiplier : pool.multipliers) multiplier -= *share++;
    });
  }
  shares_.clear();
}

// Another solver finds the root for the present sides of rows, and rows change sides between its calls.
NewtonReport Newton::solve_externally(Problem& problem, const Stage& stage) {
  constexpr int most_rounds = 30;
  NewtonReport report;
  problem.copy_multipliers_to(multipliers_saved_);
  if (has_laws_) active_set_.begin(problem, stage, x_.data()), active_set_.choose(problem, stage, x_.data());
  bool are_final = false;
  for (int round = 0; round < most_rounds && !are_final; ++round) {
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
    are_final = !has_laws_ || !active_set_.choose(problem, stage, x_.data());
  }
  report.violation = residual_.violation;
  if (has_laws_) report.met = ActiveSet::count_met(problem);
  report.converged = are_final && report.residual <= Set::round_off_floor && report.violation <= closed_gap;
  if (!report.converged) problem.set_multipliers(multipliers_saved_);
  return report;
}

}  // namespace iota::solver
