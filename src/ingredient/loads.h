// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "model/structure.h"
#include "solver/forces/force_arm.h"

#include <cstdint>

namespace iota::ingredient {

/// The solver's last step of a model, from x0, v0 to x1, v1: x1 - x0 is h v1, or h (v0 + v1) / 2 by the mid-point
/// rule. Then follow the correction that projects velocities on the constraints, and damping: the model has
/// (v1 + correction) exp(-c h).
/// Exact for a single step: for sub-steps, multipliers and corrections are those of the last one. After explicit steps (in
/// mode accurate) all are of the instant at the end.
class LastStep {
 public:
  /// The last step of the island that contains a particle.
  LastStep(const model::Model& model, std::uint32_t particle);

  const model::Model& model;
  const solver::ForceStage stage;  ///< time at which the solver's forces were evaluated

  double h() const { return stage.h; }
  Vec3 end(std::uint32_t particle) const { return ring(particle).position; }            ///< x1
  Vec3 start(std::uint32_t particle) const { return end(particle) - moved(particle); }  ///< x0
  /// Position for forces: x1, or (x0 + x1) / 2.
  Vec3 place(std::uint32_t particle) const {
    return stage.midpoint ? end(particle) - 0.5 * moved(particle) : end(particle);
  }
  /// By forces and damping, v1 - correction - v0, divided by h.
  const Vec3& acceleration(std::uint32_t particle) const { return ring(particle).acceleration; }
  /// By the correction after it, divided by h. Explicit steps have none: theirs is within.
  Vec3 correction(std::uint32_t particle) const {
    return h() > 0 ? (1 / h()) * structure_.corrections[structure_.particles[particle].ring] : Vec3{};
  }
  /// The share of damping in that: (1 - exp(-c h/2)) v0 and (exp(c h/2) - 1) v1, divided by h.
  Vec3 damping(std::uint32_t particle) const;

 private:
  /// Damping took this from a velocity before the solver's step and after it, m/s.
  struct Slowed {
    Vec3 at_start, at_end;
  };
  Slowed slowed(std::uint32_t particle) const;
  Vec3 moved(std::uint32_t particle) const;
  const model::Ring& ring(std::uint32_t particle) const {
    return structure_.rings[structure_.particles[particle].ring];
  }
  const model::Structure& structure_;
};

/// A force on one of a body's particles in the last step.
struct Load {
  enum class Kind : std::uint8_t {
    outside,  ///< from outside of the body
    within,   ///< between points of the body
    inertia,  ///< minus mass times acceleration
    jump,     ///< minus mass times the correction of velocities at the end of the step, by its length; acts at that end
  };
  std::uint32_t particle = model::none;
  Vec3 force;  ///< N
  Kind kind = Kind::outside;
  /// Acts on the basis points that carry the particle, also where the particle is an unknown of its own.
  bool through_basis = false;
  BodyId part;  ///< its part of the body; null: it acts between parts
};

/// Receives the loads on a body. Used by readings, not by steps, so a virtual call is acceptable.
class LoadReader {
 public:
  virtual void take(const Load&) = 0;

 protected:
  ~LoadReader() = default;
};

/// All loads on a body in the last step, except those of its hinges and nails: a fold over the ingredients.
void read_loads(const LastStep&, std::uint32_t body, LoadReader&);
using ReadLoads = void (*)(const LastStep&, std::uint32_t body, LoadReader&);

/// Force in the last step on the body of a particle by everything that shares or nails the particle's place, N: the
/// load of the hinge. It is the residual of the equation of motion of the body's point. Those of one hinge add up to
/// zero (with its nail); a force on the shared particle is distributed equally over its bodies.
Vec3 calc_hinge_force(const model::Model&, std::uint32_t particle, ReadLoads = read_loads);

/// Force, N, and torque about the center of mass, N m.
struct Wrench {
  Vec3 force, torque;
};
/// Load from outside on a body in the last step, or on a part of it if that is not null: gravity, damping,
/// applied forces, bonds, hinges, nails, joints, grips.
Wrench calc_outside_load(const model::Model&, std::uint32_t body, BodyId part, ReadLoads = read_loads);
/// Change of momenta of a body, or of one part, in the last step, by its length: by the load from outside and, for a part, by
/// the other parts. With what projections of velocities gave at the end of the step, as blows do, where contacts alone hold the
/// body: joints and hinges tell their forces without it.
Wrench calc_net_load(const model::Model&, std::uint32_t body, BodyId part, ReadLoads = read_loads);

}  // namespace iota::ingredient
