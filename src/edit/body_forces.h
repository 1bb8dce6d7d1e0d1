// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "edit/editor.h"

#include <string>
#include <utility>
#include <vector>

/// Commands for the name and mass of a body, and for forces on it as a whole.
namespace iota::edit {

struct SetBodyName {
  BodyId body;
  std::string value;
};
struct SetBodyMass {
  BodyId body;
  double value;
};
struct ApplyBodyForce {
  static constexpr bool moves_nothing = true;
  BodyId body;
  Vec3 force;
  bool at_center;
  Vec3 at;  ///< unless at the center of mass
};
struct ApplyBodyTorque {
  static constexpr bool moves_nothing = true;
  BodyId body;
  Vec3 value;
};

void apply(Editor&, const SetBodyName&);
void check(const Editor&, const SetBodyMass&);
void apply(Editor&, const SetBodyMass&);
void apply(Editor&, const ApplyBodyForce&);
void apply(Editor&, const ApplyBodyTorque&);

/// Adds the shares of a force at the center of mass to `forces`: in proportion to mass, so that there is no load within.
void spread(const model::Model&, std::uint32_t body, const Vec3& force,
            std::vector<std::pair<ParticleId, Vec3>>& forces);

}  // namespace iota::edit
