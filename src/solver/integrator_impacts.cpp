// SPDX-License-Identifier: Apache-2.0
// Impacts with restitution e, of contacts (docs/contact.md).
//
// The rows of a step stop what meets. They leave it at the place, and the projection after the step gives it the velocity, from
// which it rises as far as the law says:
//   places      g = e^2 g_0 at the end, g_0 at the start. With the normal speed e v, v that of the approach at the start, it
//               rises to e^2 of the height from which it fell, under any force: (e v)^2/(2 a) + e^2 g_0 = e^2 (v^2/(2 a) + g_0).
//               A gap never grows while it pushes, so that a contact does no work on what it stops.
//   velocities  v+ = -e v- along the normal in the middle of the step, of all at once: Newton's law of impacts, simultaneous.
//               Below the speed that gravity gives in a step e is 0.
//   energy      the step with both is no higher in energy than before: else less of the rebound is given.
// With places at g = 0, heights were wrong by up to 2 % a bounce (fall of 0.9 m, 120 Hz). Steps of the end-point scheme have
// no mean velocity that reverses; so they are taken by the mid-point scheme, if anything bounces in them.
#include "solver/integrator.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace iota::solver {

// By straight paths. Contacts that meet against this prediction get the law of velocities only.
bool Integrator::find_bounces(Problem& problem, const Part& part) const {
  bool any = false;
  if (!problem.has_used<ContactConstraint>()) return false;
  auto& pool = problem.pool_of<ContactConstraint>();
  const double least = part.h * norm(problem.gravity);
  for (std::size_t k = 0; k < pool.items.size(); ++k) {
    ContactConstraint& c = pool.items[k];
    c.floor = 0, c.meets = c.leaves = false;
    if (!(c.restitution > 0)) continue;
    const Gradients<ContactConstraint> gradients(c, problem.position.data(), part.from);
    double speed = 0, fall = 0, at_start[ContactConstraint::rows], at_end[ContactConstraint::rows];
    ContactConstraint ahead = c;  // with its points at the places to which they move
    std::array<Vec3, ContactConstraint::max_nodes> places;
    for (std::uint32_t i = 0; i < c.count; ++i) {
      Vec3 rows[ContactConstraint::rows];
      gradients.of_node(static_cast<int>(i), rows);
      const Vec3& v = problem.velocity[c.nodes[i]];
      speed += dot(rows[0], v), fall += 0.5 * part.h * part.h * dot(rows[0], problem.gravity);
      ahead.nodes[i] = i, places[i] = problem.position[c.nodes[i]] + part.h * v;
    }
    if (!(speed < -least)) continue;
    pool.value(k, problem.position.data(), part.from, at_start);
    ahead.value(places.data(), part.to, at_end);
    if (!(at_end[0] + std::min(0.0, fall) < 0)) continue;
    c.floor = c.restitution * c.restitution * std::max(0.0, at_start[0]), c.meets = any = true;
  }
  return any;
}

void Integrator::forget_bounces(Problem& problem) {
  for (ContactConstraint& c : problem.items_of<ContactConstraint>()) c.floor = 0, c.meets = false;
}

// Overlaps that the search for touches leaves close evenly over the whole step. In the first of many parts they gave speed: 1e-7 m of an
// ellipsoid that rolls pushed with 140 times its weight in a 1024th of a step, and 1.5e-3 J a step came from nowhere.
void Integrator::spread_overlaps(Problem& problem, double from, double left) {
  if (!problem.has_used<ContactConstraint>()) return;
  auto& pool = problem.pool_of<ContactConstraint>();
  for (std::size_t k = 0; k < pool.items.size(); ++k) {
    ContactConstraint& c = pool.items[k];
    if (c.meets) continue;
    c.floor = 0;
    double g[ContactConstraint::rows];
    pool.value(k, problem.position.data(), from, g);
    c.floor = left * std::min(0.0, g[0]);
  }
}

// Without a restitution it is a projection as after each step, but for the friction: what was hit at the end of the step had
// none of it, and what was hit at its begin twice as much as its impulse allows.
bool Integrator::has_impacts(const Problem& problem, const Stage& stage) const {
  if (!problem.has_used<ContactConstraint>()) return false;
  const auto& pool = problem.pool_of<ContactConstraint>();
  const double least = stage.h * norm(problem.gravity), per_time = 2 / stage.h;
  for (std::size_t k = 0; k < pool.items.size(); ++k) {
    const ContactConstraint& c = pool.items[k];
    if (!pool.states.has_been_met(k * ContactConstraint::rows)) continue;
    if (c.restitution > 0) return true;
    if (!(c.friction > 0) || !stage.is_mid_point()) continue;
    const Gradients<ContactConstraint> gradients(c, problem.position.data(), stage.fraction);
    double speed = 0;  // before the step
    for (std::uint32_t i = 0; i < c.count; ++i) {
      Vec3 rows[ContactConstraint::rows];
      gradients.of_node(static_cast<int>(i), rows);
      const std::uint32_t node = c.nodes[i];
      speed += dot(rows[0], problem.velocity[node] - per_time * newton_.displacement()[node]);
    }
    if (speed < -least) return true;
  }
  return false;
}

// `step`: the balance of what was solved.
void Integrator::solve_impacts(Problem& problem, const Stage& stage, const StepEnergy& step, AdvanceReport& report) {
  const bool drives = drives_rows_ && has_driven_rows(problem);
  const bool any_bounces = std::ranges::any_of(problem.items_of<ContactConstraint>(),
                                               [](const ContactConstraint& c) { return c.restitution > 0; });
  const double allowed = step.total_before + step.external_work;
  // A rebound may not have what friction took, but has to give what friction made: what slips to and fro within a step.
  double spare = allowed - energy_.total;
  if (spare > 0) spare = std::max(0.0, spare - (any_bounces ? std::max(0.0, step.dissipated) : 0));
  const double most = drives ? std::numeric_limits<double>::infinity() : energy_.kinetic + spare;
  const std::optional<double> kinetic = newton_.solve_impacts(
      problem, stage, {.kinetic = energy_.kinetic, .drives_rows = drives, .is_isolated = holds_.count == 0}, most);
  has_corrected_ = has_corrected_ || kinetic.has_value();
  if (!kinetic) return;
  double taken = note_projection(problem, *kinetic, drives, report);
  auto& pool = problem.pool_of<ContactConstraint>();
  for (std::size_t k = 0; k < pool.items.size(); ++k)
    if (pool.items[k].leaves) {
      const double stored = strain_energy(pool.items[k], pool.multiplier(k));
      energy_.total -= stored, taken += stored;
      // Or the next part of the step would release it again.
      std::fill_n(pool.multiplier(k), ContactConstraint::rows, 0.0);
    }
  if (const double made = energy_.total - allowed, before = energy_.kinetic; made > 0 && any_bounces && !drives) {
    const double missing = energy_.missing;
    (void)change_kinetic_energy(problem, made, rigid_motion(problem));
    energy_.missing = missing, taken += before - energy_.kinetic;
  }
  report.dissipated += taken;  // if negative: of what the rows have taken
}

}  // namespace iota::solver
