// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "edit/editor.h"

#include <iota/bodies.h>

/// Commands that make, move, switch and destroy bodies.
namespace iota::edit {

struct CreateBody {
  BodyOptions options;
};
struct CreateSolid {
  Shape shape;
  SolidOptions options;
};
struct CreateObstacle {
  Shape shape;
  Vec3 position;
  Quaternion orientation;
};
struct CreateAttachment {
  BodyId body;
  Vec3 position;
};
struct SetRod {
  BodyId body;
  double mass, radius;
};
/// inertia: about the center, world axes.
struct SetMassProperties {
  BodyId body;
  double mass;
  Vec3 center;
  Matrix3 inertia;
};
struct SetKind {
  static constexpr std::string_view queued_as = "set_kind";
  BodyId body;
  BodyKind kind;
};
struct SetBodyDamping {
  BodyId body;
  double per_second;
};
struct SetRadius {
  static constexpr std::string_view queued_as = "set_radius";
  static constexpr bool keeps_energy = true;
  BodyId body;
  double value;
};
/// Instead of the color of its material, in which it is drawn otherwise.
struct SetColor {
  static constexpr std::string_view queued_as = "set_color";
  static constexpr bool keeps_energy = true;
  BodyId body;
  bool has_one;
  std::uint32_t value;  ///< 0xRRGGBB
};
/// A body without one has the usual material.
struct SetMaterial {
  static constexpr std::string_view queued_as = "set_material";
  static constexpr bool keeps_energy = true;
  BodyId body;
  bool touches;
  Material value;
};
struct SetPose {
  static constexpr bool wakes_what_it_changes = true;
  BodyId body;
  Vec3 position;
  Quaternion orientation;
};
struct SetBodyVelocity {
  static constexpr bool wakes_what_it_changes = true;
  BodyId body;
  Vec3 value;
};
struct SetAngularVelocity {
  static constexpr bool wakes_what_it_changes = true;
  BodyId body;
  Vec3 value;
};

BodyId apply(Editor&, const CreateBody&);
BodyId apply(Editor&, const CreateSolid&);
BodyId apply(Editor&, const CreateObstacle&);
ParticleId apply(Editor&, const CreateAttachment&);
void apply(Editor&, const SetRod&);
void apply(Editor&, const SetMassProperties&);
void apply(Editor&, const SetKind&);
void apply(Editor&, const SetBodyDamping&);
void apply(Editor&, const SetRadius&);
void apply(Editor&, const SetColor&);
void apply(Editor&, const SetMaterial&);
void apply(Editor&, const SetPose&);
void apply(Editor&, const SetBodyVelocity&);
void apply(Editor&, const SetAngularVelocity&);
void apply(Editor&, const Destroy<BodyId>&);

/// Throws std::invalid_argument for a value other than 0: static and scripted bodies have the velocity with which their places
/// are set.
void require_own_motion(BodyKind, const char* what, const Vec3& value);
/// Throws std::invalid_argument for an obstacle. what: that cannot be done with it, as "have particles".
void refuse_obstacle(const model::Model&, std::uint32_t body, const char* what);
/// Throws if a body's points could not keep an angular velocity.
void require_can_spin(const model::Model&, std::uint32_t body, const Vec3& spin);
/// The spin of a rod in an angular velocity, which its points do not have; nothing for other bodies.
void set_axial_spin(model::Model&, std::uint32_t body, const Vec3& spin);

}  // namespace iota::edit
