// SPDX-License-Identifier: Apache-2.0
// Corrections of velocities at the end of a (sub-)step, and the energy that they take from the motion or return to it.
#include "solver/active_set.h"
#include "solver/integrator.h"

#include "solver/pieces.h"
#include "solver/rigid_modes.h"
#include "solver/row_masses.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

namespace iota::solver {

/// Whether a target moved in the (sub-)step that was solved. A motor at its largest torque is a force and drives nothing.
bool Integrator::has_driven_rows(const Problem& problem) {
  bool drives = false;
  problem.for_each_constraint_pool([&](const auto& pool) {
    for (const auto& c : pool.items) drives = drives || c.is_moving();
    for (std::size_t row = 0; row < pool.laws.size(); ++row)
      drives = drives || (pool.laws[row].rate != 0 && pool.states.is_equation(row));
  });
  return drives;
}

// The mid-point rule satisfies the rows by the mean velocity, not by the velocity at the end: the residual of a row
// there would change its sign in each step, as a rate of stretch of rigid links (up to 30 % of the kinetic energy of a
// whip) and as oscillating reactions. So velocities are projected, and the energy of that is returned to the motion.
// Not in an impact, when a bounded row has just become active: that is inelastic, and the projection takes its energy.
void Integrator::project_velocities_after_step(Problem& problem, const Stage& stage, AdvanceReport& report) {
  const bool met = met_ > 0, drives = drives_rows_ && has_driven_rows(problem);
  const std::optional<double> kinetic = newton_.project_velocities_after(
      problem, stage, {.kinetic = energy_.kinetic, .drives_rows = drives, .is_isolated = holds_.count == 0});
  has_corrected_ = kinetic.has_value();
  const double taken = kinetic ? note_projection(problem, *kinetic, drives, report) : 0;
  if (met)
    report.dissipated += taken;
  else
    energy_.missing += taken;
  if (!met && !drives && give_energy_back(problem, stage, taken, report)) has_corrected_ = true;
}

// Returns the kinetic energy that a projection of velocities has taken.
double Integrator::note_projection(Problem& problem, double kinetic, bool drives, AdvanceReport& report) {
  const double taken = energy_.kinetic - kinetic;
  energy_.kinetic -= taken, energy_.total -= taken;
  if (!drives) return taken;
  // Rows that move do work in it.
  const auto earlier = newton_.velocities_before();
  const double own = problem.kinetic_energy([&](std::size_t i) { return problem.velocity[i] - earlier[i]; });
  report.external_work += own - taken;
  return own;
}

// Newton's velocities before the correction become the correction.
void Integrator::keep_correction(const Problem& problem) {
  const auto changes = newton_.velocities_before();
  for (std::size_t i = 0; i < changes.size(); ++i) changes[i] = problem.velocity[i] - changes[i];
}

namespace {

/// The work of torques in a solved step of the end-point rule. It turns a body by less than its angular velocity says, so that
/// the forces of a torque do less than what the angular momentum of the step needs: a disk reached 53 % of it.
struct WorkOfTorques {
  double most = 0;     ///< bound of the work by the mean angular velocity, J
  double missing = 0;  ///< that work minus what the forces did, without the share of the angular velocity at the end

  WorkOfTorques(const Problem& problem, std::span<const Vec3> displacement, double h) {
    for (const BodyTorque& t : problem.torques) {
      const auto end = [&](std::uint32_t i) { return problem.position[i]; };
      const auto start = [&](std::uint32_t i) { return problem.position[i] - h * problem.velocity[i]; };
      const Vec3 before =
          t.turning(start, [&](std::uint32_t i) { return problem.velocity[i] - (1 / h) * displacement[i]; });
      const Vec3 after = t.turning(end, [&](std::uint32_t i) { return problem.velocity[i]; });
      const BodyTorque::Forces forces = t.forces(end);
      missing += 0.5 * h * dot(t.torque, before), most += h * norm(t.torque) * (norm(before) + norm(after));
      for (std::uint32_t i = 0; i < t.count; ++i) missing -= h * dot(forces[i], problem.velocity[t.nodes[i]]);
    }
  }
  static double of_end(const Problem& problem, double h) {
    double sum = 0;
    for (const BodyTorque& t : problem.torques)
      sum += 0.5 * h *
             dot(t.torque, t.turning([&](std::uint32_t i) { return problem.position[i]; },
                                     [&](std::uint32_t i) { return problem.velocity[i]; }));
    return sum;
  }
};

}  // namespace

// The end-point rule takes the work of a held force along the chord of a step. Forces that press on what turns, as two hands that
// push a rod from both ends, seem to take energy by that, and the rows that resist seem to make it: 12 J of 16 by hands that
// turn a ball about its joint. What moves a body is the part of a force that rows do not resist: its work is that of the whole.
// Up to what would be made otherwise. Springs of rows resist by where they are, not by what presses.
void Integrator::book_held_forces_that_press(Problem& problem, const Stage& stage, AdvanceReport& report) {
  const double made = -energy_.missing - energy_.slack;
  if (!(made > 0) || drives_rows_ || !problem.has_used_constraints()) return;
  const std::span<const GripForce> grips = problem.items_of<GripForce>();
  if (grips.empty() && problem.force.empty()) return;
  std::vector<Vec3> impulses(problem.size()), change(problem.size());
  for (std::size_t i = 0; i < problem.force.size(); ++i) impulses[i] = stage.h * problem.force[i];
  for (const GripForce& f : grips) {
    const Vec3 e1 = f.arm.value(problem.position.data()), e0 = e1 - stage.h * f.arm.rate(problem.velocity.data());
    const Vec3 impulse = stage.h * f.force(e0, e1, {.h = stage.h});
    for (std::uint32_t i = 0; i < f.arm.count; ++i) impulses[f.arm.nodes[i]] += f.arm.weights[i] * impulse;
  }
  ActiveSet::begin_impulses_after_step(problem);
  newton_.find_velocity_change(problem, impulses, {}, stage.fraction, change);
  double resisted = 0;
  for (std::size_t i = 0; i < problem.size(); ++i) resisted += dot(impulses[i], problem.velocity[i]);
  for_each_mass(problem, [&](double mass, std::uint32_t a, std::uint32_t b) {
    resisted -= mass * dot(change[a], problem.velocity[b]);
  });
  const double work = std::clamp(-resisted, 0.0, made);
  report.external_work += work, energy_.missing += work;
}

// Returns the angular momentum that the end-point rule has lost, with at most the energy that the step has lost and that
// torques have still to give. Dashpots act along the line at the start of the step and so slow the rotation: their energy may
// be returned, too. What rows dissipate may not: a motor that slips at 1e7 rad/s allowed any gain.
void Integrator::give_spin_back(Problem& problem, const Stage& stage, double damped, AdvanceReport& report) {
  std::copy(problem.velocity.begin(), problem.velocity.end(), newton_.velocities_before().begin());
  const double lost = std::max(0.0, energy_.missing);
  const WorkOfTorques torques(problem, newton_.displacement(), stage.h);
  has_corrected_ = spin().give_back(problem, newton_.displacement(), newton_.unbalanced_forces(), stage.h, holds_,
                                    lost + std::max(0.0, damped) + torques.most);
  if (!has_corrected_) return;
  if (!problem.torques.empty()) {
    const double work = torques.missing + WorkOfTorques::of_end(problem, stage.h);
    report.external_work += work, energy_.missing += work;
  }
  energy_.measure_kinetic(problem);
  const double refunded = std::clamp(-energy_.missing, 0.0, std::max(0.0, damped));
  energy_.missing += refunded, report.dissipated -= refunded;
  spin().turn_on(problem, newton_.velocities_before(), stage.h, [&] { track(problem, stage.fraction); });
}

// Also if dampers dissipate energy. Down to half of the slack, since round-off would exceed the whole.
void Integrator::remove_made_energy(Problem& problem, double energy_before) {
  double made = drives_rows_ || -energy_.missing <= energy_.slack ? 0 : -energy_.missing - 0.5 * energy_.slack;
  if (is_conservative_) made = std::max(made, energy_.total - energy_before);
  if (!(made > 0) || change_kinetic_energy(problem, made) || !problem.has_pushes()) return;
  // The bodies move as one. Forces from outside change their angular momentum, so that it need not be kept.
  const double rest = -energy_.missing - 0.5 * energy_.slack;
  if (!(rest > 0)) return;
  std::optional<RigidMotion> flight;
  if (holds_.are_none()) flight = rigid_motion_of(problem), flight->turning = {};
  (void)change_kinetic_energy(problem, rest, flight);
}

// The mid-point rule keeps the energy but for that of gaps that its solution leaves. In a stride of eight steps it is more than the
// slack: an acrobat made 1e-6 J of 15 J. What a taut net stores in its compliance is an artifact of the rows: returned to the motion,
// it threw a load of 100 kg up with 7 J in a step. So it stays lost.
void Integrator::remove_energy_of_gaps(Problem& problem, double recoil) {
  const double slack = std::max(0.0, energy_.slack - recoil);
  if (drives_rows_ || !(energy_.missing < -slack)) return;
  find_pieces_if_due(problem);
  if (pieces_.empty()) (void)change_kinetic_energy(problem, -energy_.missing - 0.5 * slack);
}

// Removes `excess` from the kinetic energy, or adds it if negative: scales all velocities, in an isolated problem
// relative to the rigid motion, so that momentum and angular momentum are kept. Velocities still satisfy the
// constraints afterwards. False if the motion has not so much energy beside the rigid one: all of that is removed.
bool Integrator::change_kinetic_energy(Problem& problem, double excess, const std::optional<RigidMotion>& found) {
  if (!scale_motion(problem, excess, found)) {
    energy_.measure_kinetic(problem);
    return false;
  }
  const double before = energy_.kinetic;
  energy_.kinetic -= excess, energy_.total -= excess, energy_.missing += before - energy_.kinetic;
  return true;
}

namespace {

/// By more than a point at rest.
bool is_held_otherwise(const Holds& holds) { return !holds.are_none() && !holds.pivot(); }

/// The part of each node: 0, or none of those that nails hold. Valid until the next call.
std::span<const std::uint32_t> part_without_nails(const Problem& problem) {
  thread_local std::vector<std::uint32_t> part_of;
  part_of.assign(problem.size(), 0);
  for (const AffineConstraint& c : problem.items_of<AffineConstraint>())
    if (c.is_nail()) part_of[c.nodes[0]] = Pieces::none;
  return part_of;
}

/// The rigid motion of the nodes that no nail holds, as if they were free: unlike rigid_motion_of without the masses that they are
/// coupled by with nailed ones.
RigidMotion motion_of_others(const Problem& problem, std::span<const std::uint32_t> part_of) {
  RigidMotion motion;
  Vec3 momentum;
  const auto for_each = [&](auto visit) {
    for_each_mass(problem, [&](double mass, std::uint32_t a, std::uint32_t b) {
      if (part_of[a] == 0 && part_of[b] == 0) visit(mass, a, b);
    });
  };
  for_each([&](double mass, std::uint32_t a, std::uint32_t b) {
    motion.mass += mass, motion.center += mass * problem.position[a], momentum += mass * problem.velocity[b];
  });
  if (!(motion.mass > 0)) return {};
  motion.center *= 1 / motion.mass, motion.velocity = (1 / motion.mass) * momentum;
  for_each([&](double mass, std::uint32_t a, std::uint32_t b) {
    const Vec3 ra = problem.position[a] - motion.center, rb = problem.position[b] - motion.center;
    motion.angular_momentum += mass * cross(ra, problem.velocity[b]);
    motion.inertia += coupled_inertia(mass, ra, rb);
  });
  return motion;
}

/// The part of the motion that neither rows within a problem nor those by which the world holds it notice, as the turning of what is
/// on an axle: nothing within changes its momentum. Nothing if there is none.
std::optional<RigidMotion> free_rigid_motion(const Problem& problem) {
  if (std::ranges::any_of(problem.items_of<AffineConstraint>(),
                          [](const AffineConstraint& c) { return c.is_nail() && c.is_moving(); }))
    return {};
  const std::span<const std::uint32_t> part_of = part_without_nails(problem);
  const RigidMotion all = motion_of_others(problem, part_of);
  if (!(all.mass > 0)) return {};
  const double extent = std::sqrt(0.5 * all.inertia.trace() / all.mass), length = extent > 0 ? extent : 1;
  RigidModes noticed{.center = all.center, .length = length};
  add_noticed_modes(problem, part_of, {&noticed, 1});
  if (noticed.are_all()) return {};
  RigidMotion motion = all;
  motion.velocity = motion.turning = {};
  RigidModes free;  // orthonormal in the norm of the masses
  while (!noticed.are_all()) {
    const RigidMode best = noticed.another();
    if (!(best.along(best) > 0)) return {};  // no numbers
    noticed.add(best, 0);
    RigidMode mode{best.velocity, (1 / length) * best.turning};
    const auto product = [&](const RigidMode& a, const RigidMode& b) {
      return all.mass * dot(a.velocity, b.velocity) + dot(a.turning, all.inertia * b.turning);
    };
    const double whole = product(mode, mode);
    for (std::size_t k = 0; k < free.count; ++k) mode.add(-product(mode, free.modes[k]), free.modes[k]);
    const double square = product(mode, mode);
    if (!(square > RigidModes::independent * whole)) continue;
    mode.velocity *= 1 / std::sqrt(square), mode.turning *= 1 / std::sqrt(square);
    const double speed = all.mass * dot(mode.velocity, all.velocity) + dot(mode.turning, all.angular_momentum);
    motion.velocity += speed * mode.velocity, motion.turning += speed * mode.turning;
    free.modes[free.count++] = mode;
  }
  motion.angular_momentum = motion.inertia * motion.turning;
  return motion;
}

}  // namespace

// The rigid motion whose momenta nothing within the problem changes; nothing if the world holds it altogether.
std::optional<RigidMotion> Integrator::rigid_motion(const Problem& problem) const {
  if (holds_.are_none()) return rigid_motion_of(problem);
  if (const auto pivot = holds_.pivot()) return rigid_motion_about(problem, *pivot);
  return free_rigid_motion(problem);
}

namespace {

/// Scales what a point's velocity has beside a rigid motion.
void scale_beside(const RigidMotion& rigid, double factor, Problem& problem, std::size_t node) {
  const Vec3 shared = rigid.velocity_at(problem.position[node]);
  problem.velocity[node] = shared + factor * (problem.velocity[node] - shared);
}

}  // namespace

// Returns whether the kinetic energy is reduced by the excess, to round-off.
bool Integrator::scale_motion(Problem& problem, double excess, const std::optional<RigidMotion>& found) {
  RigidMotion rigid;
  double rest = energy_.kinetic;
  constexpr double most_given = 1;  // of the kinetic energy of the motion
  if (found) {
    rigid = *found;
    rest -= rigid.kinetic_energy();
    // A pendulum on an axle has hardly another motion that the energy could come from or go to.
    if (is_held_otherwise(holds_) && !(std::abs(excess) <= most_given * rest)) rigid = {}, rest = energy_.kinetic;
  }
  if (!(rest > 0 && -excess <= most_given * rest)) return false;
  const double factor = std::sqrt(std::max(0.0, 1 - excess / rest));
  const bool has_nails = found && is_held_otherwise(holds_);
  const std::span<const std::uint32_t> part_of =
      has_nails ? part_without_nails(problem) : std::span<const std::uint32_t>{};
  for (std::size_t i = 0; i < problem.size(); ++i)
    if (!has_nails || part_of[i] == 0) scale_beside(rigid, factor, problem, i);
  return excess < rest;
}

/// The kinetic energy, about the center of mass of a problem that nothing holds, J.
double Integrator::kinetic_energy_of_motion(const Problem& problem) const {
  if (!holds_.are_none()) return energy_.kinetic;
  return energy_.kinetic - problem.flight_energy([&](std::size_t i) { return problem.velocity[i]; });
}

// Returns to the motion the energy that a projection of velocities has taken. Curves, surfaces and angles have no exact
// discrete gradient: the error of the mean of two gradients is returned as well, limited if the motion reverses and has
// little kinetic energy.
bool Integrator::give_energy_back(Problem& problem, const Stage& stage, double taken, AdvanceReport& report) {
  constexpr double most = 0.1;  // of the kinetic energy: limit of the returned error on curves
  double missing = taken;
  if (has_curved_rows_ && std::abs(energy_.missing) > energy_.slack) {
    const double limit = most * kinetic_energy_of_motion(problem);
    missing += std::clamp(energy_.missing - taken, -limit, limit);
  }
  if (missing == 0) return false;
  find_pieces_if_due(problem);
  if (!pieces_.empty()) {
    give_energy_back_by_piece(problem, stage, report);
    return true;
  }
  const std::optional<RigidMotion> rigid = rigid_motion(problem);
  if (rigid && !is_held_otherwise(holds_) && may_turn(problem) &&
      !(energy_.kinetic - rigid->kinetic_energy() > std::abs(missing))) {
    turn_body(problem, stage, missing, *rigid, FreeMotion::all, report);
    return true;
  }
  (void)change_kinetic_energy(problem, -missing, rigid);
  return true;
}

bool Integrator::may_turn(const Problem& problem) {
  return problem.items_of<GripForce>().empty() && problem.items_of<GyroscopicForce>().empty();
}

// A rigid body, or a piece, has no motion but the rigid one.
void Integrator::turn_body(Problem& problem, const Stage& stage, double missing, const RigidMotion& rigid,
                           std::uint32_t piece, AdvanceReport& report) {
  const bool is_all = piece == FreeMotion::all;
  std::copy(problem.position.begin(), problem.position.end(), newton_.room().begin());
  // By less than it turns in the step: a body at rest jumped by 1e-4 rad for the energy of its noise.
  turn_for_energy(problem, missing, step_length_ * norm(rigid.turning),
                  is_all ? holds_.pivot() : pieces_[piece].holds.pivot(),
                  is_all ? std::span<const std::uint32_t>{} : std::span<const std::uint32_t>(connected_.of), piece);
  double work = 0;
  for (std::size_t i = 0; i < problem.force.size(); ++i)
    work += dot(problem.force[i], problem.position[i] - newton_.room()[i]);
  report.external_work += work;
  energy_.measure_change(problem, stage.fraction, work);
}

void Integrator::find_pieces_if_due(const Problem& problem) {
  if (!std::exchange(may_be_in_pieces_, false)) return;
  const std::uint32_t count = find_pieces(problem, Connection::rows_and_forces, connected_, room_for_pieces_);
  pieces_.resize(count > 1 ? count : 0);
}

void Integrator::find_holds_of_pieces(const Problem& problem) {
  for (Piece& piece : pieces_) piece = {};
  add_holds(problem, Connection::rows_and_forces, connected_,
            [&](std::uint32_t piece) -> Holds& { return pieces_[piece].holds; });
}

// As that of a whole problem; none if it is held otherwise.
RigidMotion Integrator::rigid_motion_of_piece(const Problem& problem, std::uint32_t piece) const {
  const Holds& holds = pieces_[piece].holds;
  if (const auto pivot = holds.pivot()) return rigid_motion_about(problem, *pivot, connected_.of, piece);
  return holds.are_none() ? rigid_motion_of(problem, connected_.of, piece) : RigidMotion{};
}

// After an explicit sub-step. Its error is that of all pieces together, so all motions beside the rigid ones share it. Without
// such motions each piece turns for a share, as its energy is of the whole.
void Integrator::scale_motions_of_pieces(Problem& problem, double missing, AdvanceReport& report) {
  find_holds_of_pieces(problem);
  double turning = 0;
  for (std::uint32_t k = 0; k < pieces_.size(); ++k) turning += rigid_motion_of_piece(problem, k).kinetic_energy();
  const double rest = energy_.kinetic - turning;
  if (!(std::abs(missing) < rest)) {
    for (std::uint32_t k = 0; k < pieces_.size() && may_turn(problem); ++k) {
      const RigidMotion rigid = rigid_motion_of_piece(problem, k);
      if (const double own = rigid.kinetic_energy(); own > 0)
        turn_body(problem, Stage::projection(), missing * (own / turning), rigid, k, report);
    }
    return;
  }
  const double factor = std::sqrt(1 + missing / rest);
  for (std::uint32_t k = 0; k < pieces_.size(); ++k) {
    const RigidMotion rigid = rigid_motion_of_piece(problem, k);
    for (std::size_t i = 0; i < problem.size(); ++i)
      if (connected_.of[i] == k) scale_beside(rigid, factor, problem, i);
  }
  energy_.kinetic += missing, energy_.total += missing, energy_.missing -= missing;
}

// After a cut both halves stay in one problem for a while, but their energies are balanced separately.
void Integrator::give_energy_back_by_piece(Problem& problem, const Stage& stage, AdvanceReport& report) {
  const auto earlier = newton_.velocities_before();
  find_holds_of_pieces(problem);
  const auto add = [&](double mass, std::uint32_t a, std::uint32_t b) {
    Piece& piece = pieces_[connected_.of[a]];
    const double kinetic = 0.5 * mass * dot(problem.velocity[a], problem.velocity[b]);
    piece.kinetic += kinetic, piece.taken += 0.5 * mass * dot(earlier[a], earlier[b]) - kinetic;
  };
  for (std::uint32_t i = 0; i < problem.size(); ++i) add(problem.mass[i], i, i);
  for (const auto& c : problem.mass_couplings) add(2 * c.mass, c.a, c.b);
  for (std::uint32_t k = 0; k < pieces_.size(); ++k) {
    const Piece& piece = pieces_[k];
    if (!(piece.taken > 0)) continue;
    const RigidMotion rigid = rigid_motion_of_piece(problem, k);
    const double rest = piece.kinetic - rigid.kinetic_energy();
    if (!(piece.taken <= rest)) {
      if (may_turn(problem) && (piece.holds.are_none() || piece.holds.pivot()))
        turn_body(problem, stage, piece.taken, rigid, k, report);
      continue;
    }
    const double factor = std::sqrt(1 + piece.taken / rest);
    for (std::size_t i = 0; i < problem.size(); ++i)
      if (connected_.of[i] == k) scale_beside(rigid, factor, problem, i);
  }
  energy_.measure_kinetic(problem);
}

}  // namespace iota::solver
