// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "model/structure.h"
#include "solver/forces/force_arm.h"

#include <cstdint>

namespace iota::ingredient {

/// The last step of a model as the solver took it, from x0, v0 to x1, v1: x1 - x0 is h v1, or h (v0 + v1) / 2 by the mid-point
/// rule. Damping came after that and made v1 the velocity that the model has, v1 exp(-c h).
/// Exact where the step was taken as one: of a step in parts, multipliers are those of its last part. The mid-point rule
/// also leaves the mean of the last two multipliers, see docs/constraints.md.
class LastStep {
 public:
  explicit LastStep(const model::Model& model);

  const model::Model& model;
  const solver::ForceStage stage;  ///< how the solver's forces were taken

  double h() const { return stage.h; }
  Vec3 end(std::uint32_t particle) const { return ring(particle).position; }            ///< x1
  Vec3 start(std::uint32_t particle) const { return end(particle) - moved(particle); }  ///< x0
  /// Where forces act: x1, or (x0 + x1) / 2.
  Vec3 place(std::uint32_t particle) const {
    return stage.midpoint ? end(particle) - 0.5 * moved(particle) : end(particle);
  }
  /// Of the velocity that the model has, (v1 exp(-c h) - v0) / h.
  const Vec3& acceleration(std::uint32_t particle) const { return ring(particle).acceleration; }
  /// The share of damping in that, (v1 - v1 exp(-c h)) / h.
  Vec3 damping(std::uint32_t particle) const;

 private:
  Vec3 moved(std::uint32_t particle) const;
  const model::Ring& ring(std::uint32_t particle) const {
    return structure_.rings[structure_.particles[particle].ring];
  }
  const model::Structure& structure_;
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
