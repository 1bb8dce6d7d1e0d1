// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "edit/editor.h"

/// Commands that make, move, switch and destroy particles.
namespace iota::edit {

struct CreateParticle {
  BodyId body;
  Vec3 position, velocity;
  double mass;
};
struct SetPosition {
  static constexpr bool wakes_what_it_changes = true;
  ParticleId particle;
  Vec3 value;
};
struct SetVelocity {
  static constexpr bool wakes_what_it_changes = true;
  ParticleId particle;
  Vec3 value;
};
struct SetMass {
  ParticleId particle;
  double value;
};
struct ApplyForce {
  static constexpr bool moves_nothing = true;
  ParticleId particle;
  Vec3 value;
};
struct SetParticleActive {
  static constexpr std::string_view queued_as = "set_active";
  ParticleId particle;
  bool active;
};
struct SetParticleBreakForce {
  ParticleId particle;
  double force;
};

ParticleId apply(Editor&, const CreateParticle&);
void apply(Editor&, const SetPosition&);
void apply(Editor&, const SetVelocity&);
void apply(Editor&, const SetMass&);
void apply(Editor&, const ApplyForce&);
void apply(Editor&, const SetParticleActive&);
void apply(Editor&, const SetParticleBreakForce&);
void apply(Editor&, const Destroy<ParticleId>&);

}  // namespace iota::edit
