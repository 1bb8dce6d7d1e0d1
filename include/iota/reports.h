// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iota/ids.h>
#include <iota/kinds.h>
#include <iota/materials.h>
#include <iota/vec3.h>
#include <iota/view_event.h>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace iota {

/// Energy balance, J. Each gain and loss is counted where it occurs; `balance()` is constant up to
/// round-off.
struct Energy {
  double kinetic = 0;
  double potential = 0;   ///< gravity, springs, and all bonds, fields and pairs whose law has an energy
  double dissipated = 0;  ///< since the start, work of damping, dashpots, friction, laws and impacts
  double lost = 0;        ///< since the start, by the integration scheme; may decrease within its tolerance
  double made = 0;        ///< since the start, by the integration scheme: a defect, see StepReport::warnings
  double external_work =
      0;  ///< since the start, by grips, scripted bonds, moved nails, applied forces, and errors of held forces
  double edits = 0;  ///< since the start, gained (+) or lost (-) by edits
  double total() const { return kinetic + potential; }
  double balance() const { return kinetic + potential + dissipated + lost - made - external_work - edits; }
};

/// A constraint, bond, hinge or nail that broke at the end of a step because of its load.
struct Broken {
  ConstraintId constraint;  ///< now inactive; else null
  BondId bond;              ///< now inactive; else null
  ParticleId particle;      ///< that left its ring or lost its nail; else null
  Vec3 position;            ///< m
  double force = 0;         ///< N
  double torque = 0;        ///< N m
};

/// A one-sided constraint began or ceased to carry a load: surfaces met or parted, a rope became taut or slack, a
/// coordinate reached or left a stop.
struct StopEvent {
  enum class Kind : std::uint8_t { met, parted };
  Kind kind = Kind::met;
  ConstraintId constraint;
  std::optional<JointCoordinate> coordinate;  ///< whose stop; unset: the constraint itself
  Vec3 position;                              ///< where it acts on a, m
};

/// The result of one structural edit.
struct RestructureReport {
  bool queued = false;   ///< requested during a step: applied right after it
  bool changed = false;  ///< false if there was nothing to do (e.g. separating unrelated particles)
  std::uint32_t structure_version = 0;
  std::vector<BodyId> created_bodies;
  std::vector<ParticleId> created_particles;
  std::vector<BodyId> destroyed_bodies;  ///< of batches (begin_edit); absorbed ones are below
  std::vector<ParticleId> destroyed_particles;
  struct AbsorbedParticle {
    ParticleId retired, survivor;
  };
  struct AbsorbedBody {
    BodyId retired, survivor;
  };
  std::vector<AbsorbedParticle> absorbed_particles;
  std::vector<AbsorbedBody> absorbed_bodies;
  std::uint32_t articulates_before = 0, articulates_after = 0;  ///< of the whole system
  double closed_distance = 0;                                   ///< former distance of the combined particles, m
  double remaining_gap = 0;                                     ///< gap that could not be closed, m
  double energy_change = 0;                                     ///< J
  Vec3 momentum_change;                                         ///< kg m/s, not conserved because of nails
  Vec3 angular_momentum_change;                                 ///< about the origin, kg m^2/s
  std::vector<std::string> notes;                               ///< plain sentences
};

/// The result of one `step`. Non-convergence is a result, never an exception.
struct [[nodiscard]] StepReport {
  std::uint64_t step = 0;      ///< number of the step just finished, from 1
  double time = 0;             ///< simulated time at its end, s
  double dt = 0;               ///< s
  double iterations_mean = 0;  ///< Newton iterations per articulate and (sub-)step
  int iterations_max = 0;
  int substeps_max = 1;  ///< largest number of sub-steps of an articulate
  int fallbacks = 0;     ///< (sub-)steps that the robust scheme took in place of the energy-keeping one
  int unconverged = 0;   ///< articulates left with a least violation instead of a solution
  int cut_short = 0;     ///< islands whose budget ended before their solution: see StepBudget, System::islands
  int approximate = 0;   ///< islands whose contacts were solved one by one: see StepBudget::contacts
  double error = 0;      ///< largest estimate of an island, see IslandReport::error; only of mode accurate
  double worst_gap = 0;  ///< largest hinge separation or rigidity error, m
  Energy energy;
  std::uint32_t articulates = 0;
  std::uint32_t resting = 0;  ///< bodies asleep
  std::uint32_t structure_version = 0;
  std::vector<BondId> switched_off;                    ///< bonds whose force was not finite, or whose function threw
  std::vector<ConstraintId> switched_off_constraints;  ///< the same of the functions of their surfaces
  std::vector<Broken> broken;
  std::vector<StopEvent> stops;
  Impact impact;
  std::vector<ContactEvent> contacts;      ///< for the watches of System::contacts
  std::vector<ParticleId> born, died;      ///< of emitters, and of those with a lifetime
  std::optional<RestructureReport> edits;  ///< requested during the step and made right after it, as one
  std::vector<std::string> warnings;       ///< plain sentences: a quarantined bond, a conflict ...
};

/// Cost and quality of the last step of one island: bodies that were solved together.
struct IslandReport {
  std::vector<BodyId> bodies;  ///< that still exist
  std::uint32_t points = 0;    ///< unknown ones
  bool resting = false;        ///< asleep: nothing was solved
  int iterations = 0;          ///< of Newton's method, each with one linear solve; in mode accurate linear solves
  int substeps = 0;
  int fallbacks = 0;         ///< see StepReport
  bool converged = true;     ///< false: left with a least violation instead of a solution
  bool cut_short = false;    ///< the budget ended before the solution
  bool approximate = false;  ///< contacts were solved one by one: see StepBudget::contacts
  double gap = 0;            ///< largest violation of a constraint at the end, m
  /// Estimated local error of positions, in mean lengths of links per second: the sum over the sub-steps, divided by dt,
  /// without what the motion makes of earlier ones. Only of mode accurate. Infinite, that is unknown, if a part of the step has no
  /// estimate: contacts were solved approximately, or sub-steps became too short or fell back to the robust scheme.
  double error = 0;
  double lost = 0, made = 0;  ///< energy, by the integration scheme, J
};

/// Combines the reports of consecutive steps: last values of time and energy, sums of counts, maxima of largest values,
/// and all events.
void add_step(StepReport& sum, const StepReport& next);

/// Analysis of conflicting and redundant constraints of an island, by singular value decomposition of their Jacobian at
/// the present positions (the thesis, C.3). Rows are scaled to length 1, unknowns by masses, so that figures do not
/// depend on units. Bonds and the stiffness of stretched links are left out.
struct Diagnosis {
  std::uint32_t unknowns = 0;            ///< coordinates of points
  std::uint32_t rows = 0;                ///< of active constraints: without open stops and slack ropes
  std::uint32_t rank = 0;                ///< singular values above 1e-8 of the largest
  std::uint32_t redundancy = 0;          ///< rows - rank
  std::uint32_t degrees_of_freedom = 0;  ///< unknowns - rank
  std::vector<double> singular_values;   ///< falling
  double condition = 1;                  ///< largest singular value over the smallest one in the rank
  double kkt_condition = 1;              ///< of the matrix that a step solves
  std::vector<std::string> findings;     ///< plain sentences that name bodies, particles and constraints
};

}  // namespace iota
