// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "edit/editor.h"

/// Commands for optional attributes of particles: lifetime, look, orientation.
namespace iota::edit {

struct SetAttributes {
  ParticleId particle;
  ParticleAttributes value;
};
struct SetOrientation {
  ParticleId particle;
  Quaternion value;
};
struct SetSpin {
  ParticleId particle;
  Vec3 value;
};
struct ApplyTorque {
  static constexpr bool moves_nothing = true;
  ParticleId particle;
  Vec3 value;
};
struct SetMoment {
  ParticleId particle;
  double value;
};
struct SetSpinDamping {
  ParticleId particle;
  double per_second;
};
struct Align {
  ParticleId particle;
  Vec3 direction;
  double stiffness, damping;
};

void apply(Editor&, const SetAttributes&);
void apply(Editor&, const SetOrientation&);
void apply(Editor&, const SetSpin&);
void apply(Editor&, const ApplyTorque&);
void apply(Editor&, const SetMoment&);
void apply(Editor&, const SetSpinDamping&);
void apply(Editor&, const Align&);

}  // namespace iota::edit
