// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "model/structure.h"

#include <cstdint>

namespace iota::ingredient {

/// The last step of a model as the solver took it.
class LastStep {
 public:
  explicit LastStep(const model::Model& model);

  const model::Model& model;
  double h;  ///< s

  /// Where the scheme took forces: at the end of the step, or half way, at (x0 + x1) / 2 = x1 - h (v0 + v1) / 4.
  Vec3 place(std::uint32_t particle) const {
    const model::Ring& r = ring(particle);
    return r.position - back_ * mean_velocity(particle);
  }
  /// Displacement over h: v1, or (v0 + v1) / 2.
  Vec3 mean_velocity(std::uint32_t particle) const {
    const model::Ring& r = ring(particle);
    return r.velocity - back_ * r.acceleration;
  }
  const Vec3& acceleration(std::uint32_t particle) const { return ring(particle).acceleration; }
  /// What damping did to a body's particle, as a deceleration: after the scheme's step velocities fell by exp(-c h).
  Vec3 damping(std::uint32_t particle) const;

 private:
  const model::Ring& ring(std::uint32_t particle) const {
    return structure_.rings[structure_.particles[particle].ring];
  }
  const model::Structure& structure_;
  double back_;
};

/// A force that one of a body's particles felt in the last step.
struct Load {
  enum class Kind : std::uint8_t {
    outside,  ///< by something that is not the body
    within,   ///< between points of the body
    inertia,  ///< minus mass times acceleration
  };
  std::uint32_t particle = model::none;
  Vec3 force;  ///< N
  Kind kind = Kind::outside;
  /// Acts on the basis points that carry the particle, also where the particle is an unknown of its own.
  bool through_basis = false;
  BodyId part;  ///< of the body, that it counts for; null: it acts between parts
};

/// Receives the loads on a body. Readings, not steps, come through here, so that a virtual call does no harm.
class LoadReader {
 public:
  virtual void take(const Load&) = 0;

 protected:
  ~LoadReader() = default;
};

/// All loads on a body in the last step, but those of its hinges and nails: a fold over the ingredients.
void read_loads(const LastStep&, std::uint32_t body, LoadReader&);
using ReadLoads = void (*)(const LastStep&, std::uint32_t body, LoadReader&);

/// Force in the last step on the body of a particle by all that shares or nails the particle's place, N: what the hinge
/// carries. It is what the equation of motion of the body's point lacks. Those of one hinge add up to zero (with its nail);
/// a force that was applied to the shared particle counts as held by all its bodies alike.
Vec3 calc_hinge_force(const model::Model&, std::uint32_t particle, ReadLoads = read_loads);

/// Force, N, and torque about the center of mass, N m.
struct Wrench {
  Vec3 force, torque;
};
/// What acted from outside on a body in the last step, or on one part of it where that is not null: gravity, damping,
/// applied forces, bonds, hinges, nails, joints, grips.
Wrench calc_outside_load(const model::Model&, std::uint32_t body, BodyId part, ReadLoads = read_loads);
/// How the momenta of a body, or of one part, changed in the last step: by the load from outside and, for a part, by what
/// the other parts do to it.
Wrench calc_net_load(const model::Model&, std::uint32_t body, BodyId part, ReadLoads = read_loads);

}  // namespace iota::ingredient
