// SPDX-License-Identifier: Apache-2.0
// Impacts with restitution: a projection of velocities, with a speed along the normals and friction.
#include "solver/newton.h"

#include <algorithm>
#include <cmath>

namespace iota::solver {

std::optional<double> Newton::solve_impacts(Problem& problem, const Stage& stage, const AfterStep& known, double most) {
  constexpr double round_off = 1e-14;
  Wanted wanted = begin_after_step(problem, stage, known);
  wanted.has_impacts = true;
  most += find_rebounds(problem, stage, wanted);
  const double limit = std::isfinite(most) ? 4 * std::max(known.kinetic, most) : most;
  const auto project = [&](double energy) {
    std::optional<double> kinetic = project_within_cones(problem, wanted, stage.h, energy);
    if (kinetic && known.is_isolated) give_back_momenta(problem), kinetic = problem.kinetic_energy();
    return kinetic;
  };
  std::optional<double> kinetic = project(limit);
  if (kinetic && *kinetic > most * (1 + round_off)) {
    // The law alone may gain: with friction, and where restitutions differ (Kane's pendulum). From the velocities without any
    // rebound or late friction, a projection, go as far towards those with it as the energy allows: T = a + b s + c s^2.
    x_.assign(problem.velocity.begin(), problem.velocity.end());
    const std::vector<double> impulses = impulses_;
    std::copy(u_saved_.begin(), u_saved_.end(), problem.velocity.begin());
    forget_drags(problem);
    const double a = project(known.kinetic).value_or(known.kinetic);
    const double c = problem.kinetic_energy([&](std::size_t i) { return x_[i] - problem.velocity[i]; });
    const double b = *kinetic - a - c, room = std::max(0.0, most - a);
    const double root = std::sqrt(std::max(0.0, b * b + 4 * c * room));
    // The stable form of the positive root.
    const double part = std::clamp(b > 0 ? 2 * room / (b + root) : c > 0 ? (root - b) / (2 * c) : 0.0, 0.0, 1.0);
    for (std::size_t i = 0; i < problem.size(); ++i) problem.velocity[i] += part * (x_[i] - problem.velocity[i]);
    for (std::size_t i = 0; i < impulses_.size(); ++i) impulses_[i] += part * (impulses[i] - impulses_[i]);
    kinetic = problem.kinetic_energy();
  }
  forget_drags(problem);
  if (kinetic) add_impulses(problem), problem.note_late_impulses();
  return kinetic;
}

void Newton::forget_drags(Problem& problem) {
  for (ContactConstraint& c : problem.items_of<ContactConstraint>())
    c.rebound = c.drags[0] = c.drags[1] = 0, c.stays_slipping = false;
}

// Principal pivoting: few rounds, as contacts only open, or begin to stick or to slip. Not for impacts alone: what sticks in the mean of a
// step may have to slip at its end, and projected without a bound of its friction, nine dominoes that fell stood still within a step.
std::optional<double> Newton::project_within_cones(Problem& problem, const Wanted& wanted, double h, double energy) {
  constexpr int most_rounds = 12;
  std::optional<double> kinetic;
  for (int round = 0; round < most_rounds; ++round) {
    std::copy(u_saved_.begin(), u_saved_.end(), problem.velocity.begin());
    kinetic = project_onto_sides(problem, wanted, energy);
    if (!kinetic || !ActiveSet::switch_impacts(problem, h, impulses_)) break;
  }
  return kinetic;
}

// By the mean of its gradients over the step, of which the middle has that: an impact of restitution 1 keeps the energy.
double Newton::rate_in_the_middle(const ContactConstraint& c, std::span<const Vec3> velocity) const {
  const Gradients<ContactConstraint> gradients(c, mean_place_.data(), 1);
  double rate = 0;
  for (int i = 0; i < c.node_count(); ++i) {
    Vec3 rows[ContactConstraint::rows];
    gradients.of_node(i, rows);
    rate += dot(rows[0], velocity[c.nodes[i]]);
  }
  return rate;
}

// An approach below what gravity gives in a step ends without a rebound. Contacts that slip get friction by their late
// impulse, too. Returns the energy that the rows of those that leave have stored, J: the motion gets it back.
double Newton::find_rebounds(Problem& problem, const Stage& stage, const Wanted& wanted) {
  constexpr double noise = 1e-9;  // of the fastest approach
  const double per_time = (stage.is_mid_point() ? 2 : 1) / stage.h;
  for (std::size_t i = 0; i < problem.size(); ++i) x_[i] = problem.velocity[i] - per_time * u_[i];  // before the step
  auto& pool = problem.pool_of<ContactConstraint>();
  const auto is_closed = [&](std::size_t k) {
    return pool.items[k].restitution > 0 && pool.states.cone(k * ContactConstraint::rows).mode != ConeState::Mode::open;
  };
  double least = stage.h * norm(problem.gravity);
  for (std::size_t k = 0; k < pool.items.size(); ++k) {
    ContactConstraint& c = pool.items[k];
    c.rebound = is_closed(k) ? -rate_in_the_middle(c, x_) : 0;  // the approach, for now
    least = std::max(least, noise * c.rebound);
  }
  bool any_leaves = false, any_waits = false;
  for (std::size_t k = 0; k < pool.items.size(); ++k) {
    ContactConstraint& c = pool.items[k];
    if (!is_closed(k)) continue;
    c.leaves = c.rebound > least && pool.states.has_been_met(k * ContactConstraint::rows);
    c.rebound = c.leaves ? c.restitution * c.rebound : 0;
    (c.leaves ? any_leaves : any_waits) = true;
  }
  if (any_leaves && any_waits) take_turns(problem, wanted, least);
  double stored = 0;
  for (std::size_t k = 0; k < pool.items.size(); ++k) {
    ContactConstraint& c = pool.items[k];
    const double* const l = pool.multiplier(k);
    if (pool.states.cone(k * ContactConstraint::rows).slips() && l[0] < 0)
      for (int i = 0; i < 2; ++i) c.drags[i] = l[1 + i] / l[0];
    if (c.leaves) stored += strain_energy(c, l);
  }
  return stored;
}

// Impacts that others pass on: a cradle. Those that approach act at once, by Newton's law, while all others that have a
// restitution are open; then those that approach by the velocities that this has given, until none does. Contacts without a
// restitution always act. The normal speeds at its end are the rebounds of the step, so that the step has one projection
// with its guards. Without friction, with which Newton's law may gain energy (Kane's pendulum).
void Newton::take_turns(Problem& problem, const Wanted& wanted, double least) {
  constexpr int most_rounds = 24;
  constexpr double little = 1e-3;  // of the first approach
  auto& pool = problem.pool_of<ContactConstraint>();
  turns_.clear();
  for (std::size_t k = 0; k < pool.items.size(); ++k)
    if (const ConeState state = pool.states.cone(k * ContactConstraint::rows);
        state.mode != ConeState::Mode::open && pool.items[k].restitution > 0)
      turns_.push_back({.contact = k, .state = state});
  after_step_ = u_saved_, end_of_step_ = problem.position;
  problem.position = mean_place_;
  std::copy(x_.begin(), x_.end(), u_saved_.begin());
  bool is_solved = false;
  std::optional<double> kinetic =
      take_turn(problem, wanted, problem.kinetic_energy([&](std::size_t i) { return x_[i]; }));
  for (int round = 0; round < most_rounds && kinetic; ++round) {
    bool any = false;
    for (Turn& turn : turns_) {
      ContactConstraint& c = pool.items[turn.contact];
      const double approach = -rate_in_the_middle(c, problem.velocity);
      turn.acts = round == 0 ? c.leaves : approach > least;
      if (!turn.acts) continue;
      any = turn.has_acted = true;
      c.rebound = c.restitution * std::max(0.0, approach);
      if (round == 0) least = std::max(least, little * approach);
    }
    if (!any) break;
    std::copy(problem.velocity.begin(), problem.velocity.end(), u_saved_.begin());
    kinetic = take_turn(problem, wanted, *kinetic);
    is_solved = is_solved || kinetic.has_value();
  }
  for (const Turn& turn : turns_) {
    ContactConstraint& c = pool.items[turn.contact];
    ActiveSet::set_cone(pool, turn.contact, turn.state);
    if (!is_solved) continue;  // all act at once
    c.rebound = turn.has_acted ? std::max(0.0, rate_in_the_middle(c, problem.velocity)) : 0;
    c.leaves = c.rebound > 0;
  }
  u_saved_ = after_step_, problem.position = end_of_step_;
}

// Leaves the velocities as they are if there is no solution.
std::optional<double> Newton::take_turn(Problem& problem, const Wanted& wanted, double kinetic) {
  constexpr int most_openings = 8;
  auto& pool = problem.pool_of<ContactConstraint>();
  for (const Turn& turn : turns_)
    ActiveSet::set_cone(pool, turn.contact,
                        turn.acts ? ConeState{ConeState::Mode::slips, 1} : ConeState{ConeState::Mode::open});
  std::optional<double> after;
  for (int opening = 0; opening < most_openings; ++opening) {
    std::copy(u_saved_.begin(), u_saved_.end(), problem.velocity.begin());
    after = project_onto_sides(problem, wanted, kinetic);
    bool pulls = false;
    for (Turn& turn : turns_)
      if (turn.acts && impulses_[pool.slots[turn.contact].unknown] > 0)
        ActiveSet::set_cone(pool, turn.contact, {ConeState::Mode::open}), turn.acts = false, pulls = true;
    if (!after || !pulls) break;
  }
  return after;
}

}  // namespace iota::solver
