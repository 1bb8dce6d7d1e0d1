// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "model/constraint.h"

#include "model/attributes.h"

#include <iota/system.h>

#include <array>
#include <cstddef>
#include <variant>

/// Everything that changes a system, as plain data: what is queued during a step, recorded and replayed. A new command is
/// a struct, a line in `Command` and an `apply` in system.cpp.
namespace iota::step {

struct SetGravity {
  Vec3 value;
};
struct SetMode {
  IntegrationMode mode;
};
struct SetSolver {
  std::array<char, 32> name;  ///< ended by zeros; empty: the built-in one
};
struct SetSystemDamping {
  double per_second;
};
struct CreateBody {
  BodyOptions options;
};
struct CreateParticle {
  BodyId body;
  Vec3 position, velocity;
  double mass;
};
struct SetRod {
  BodyId body;
  double mass, radius;
};
struct CreateSolid {
  BodyKind kind;
  double damping, mass;
  shape::Data shape;
  Vec3 center;
  Matrix3 mean_squares;
  Vec3 position, velocity, spin;
  Quaternion orientation;
};
struct CreateAttachment {
  BodyId body;
  Vec3 position;
};
struct SetPose {
  BodyId body;
  Vec3 position;
  Quaternion orientation;
};
struct SetBodyVelocity {
  BodyId body;
  Vec3 value;
};
struct SetAngularVelocity {
  BodyId body;
  Vec3 value;
};
struct CreateCosmeticBond {
  ParticleId p, q;
};
/// A piece of a record that is too long for one command; the next `CreateLaw` or `CreateField` uses all pieces.
struct Spell {
  std::array<std::byte, 64> piece;
};
struct CreateLaw {};
struct CreateGroup {
  std::array<char, 32> name;
};
struct SetMember {
  GroupId group;
  ParticleId particle;
  bool member;
};
struct CreateField {
  GroupId group;  ///< null: all particles
};
struct SetFieldParameter {
  FieldId field;
  std::uint32_t index;
  double value;
};
struct SetFieldActive {
  FieldId field;
  bool active;
};
struct CreatePairs {
  LawId law;
  GroupId group;  ///< null: all particles
  double cutoff;
  std::array<double, max_law_parameters> parameters;
};
struct SetPairsParameter {
  PairsId pairs;
  std::uint32_t index;
  double value;
};
struct SetPairsActive {
  PairsId pairs;
  bool active;
};
struct CreateBond {
  ParticleId p, q;
  LawId law;
  bool implicit;
  std::uint64_t script;
  std::array<double, max_law_parameters> parameters;  ///< NaN: the distance of the ends now
};
struct SetParameter {
  BondId bond;
  std::uint32_t index;
  double value;
};
struct CreateGrip {
  BodyId body;
  Vec3 local_point, target;
  GripOptions options;
};
struct MoveGrip {
  GripId grip;
  Vec3 target;
};
struct SetKind {
  BodyId body;
  BodyKind kind;
};
struct SetBodyDamping {
  BodyId body;
  double per_second;
};
struct SetPosition {
  ParticleId particle;
  Vec3 value;
};
struct SetVelocity {
  ParticleId particle;
  Vec3 value;
};
struct SetMass {
  ParticleId particle;
  double value;
};
struct ApplyForce {
  ParticleId particle;
  Vec3 value;
};
struct SetParticleActive {
  ParticleId particle;
  bool active;
};
struct SetRest {
  RestOptions options;
};
struct SetActive {
  BondId bond;
  bool active;
};
struct CreateJoint {
  JointSpec spec;
};
struct CreateDistance {
  DistanceSpec spec;
};
/// The points of a path travel ahead of it, a few at a time; the first lot starts a new list.
struct AddCurvePoints {
  std::array<Vec3, 16> points;
  std::uint32_t count;
  bool first;
};
struct CreatePath {
  model::PathData spec;
};
struct CreateSurface {
  model::SurfaceConstraintData spec;
};
struct CreateSurfacePair {
  model::SurfacePairData spec;
};
struct SetBreakForce {
  ParticleId particle;
  double force;
};
struct SetBondBreakForce {
  BondId bond;
  double force;
};
struct SetConstraintActive {
  ConstraintId constraint;
  bool active;
};
struct SetCoordinate {
  ConstraintId constraint;
  JointCoordinate coordinate;
  CoordinateOptions options;
};
struct SetLength {
  ConstraintId constraint;
  double value;
};
struct SetBreakLimits {
  ConstraintId constraint;
  BreakLimits limits;
};
struct CreateEmitter {
  model::Emitter emitter;
};
struct SetEmitter {
  EmitterId emitter;
  bool active;
  double rate;
  Vec3 position, velocity;
  Quaternion orientation;
};
struct SetAttributes {
  ParticleId particle;
  ParticleAttributes value;
};
struct SetTurn {
  enum class What : std::uint32_t { orientation, spin, torque, moment, damping, align } what;
  ParticleId particle;
  Vec3 vector;
  Quaternion quaternion;
  double number, second;
};
struct BeginEdit {};
struct EndEdit {};
struct CancelEdit {};
struct Undo {};
struct Redo {};
struct Step {
  double dt;
};

// Edits of the structure: queued when asked for during a step.
template <class IdType>
struct Destroy {
  IdType id;
};
struct CombineParticles {
  ParticleId p, q;
  double over;
};
struct CombineBodies {
  BodyId a, b;
};
struct Separate {
  ParticleId p, q;
};
struct SeparatePart {
  BodyId body, part;
};
struct Nail {
  ParticleId particle;
  bool in_place;
  Vec3 position;
};
struct Release {
  ParticleId particle;
};

// A line each, so that two who add one do not meet.
// clang-format off
using Command = std::variant<
    SetGravity,
    SetMode,
    SetSolver,
    SetSystemDamping,
    CreateBody,
    CreateParticle,
    SetRod,
    Spell,
    CreateGroup,
    SetMember,
    CreateField,
    SetFieldParameter,
    SetFieldActive,
    CreatePairs,
    SetPairsParameter,
    SetPairsActive,
    CreateLaw,
    CreateCosmeticBond,
    CreateBond,
    CreateGrip,
    MoveGrip,
    SetKind,
    SetBodyDamping,
    SetPosition,
    SetVelocity,
    SetMass,
    ApplyForce,
    SetActive,
    SetParticleActive,
    SetRest,
    SetParameter,
    CreateSolid,
    CreateAttachment,
    SetPose,
    SetBodyVelocity,
    SetAngularVelocity,
    CreateEmitter,
    SetEmitter,
    Destroy<EmitterId>,
    SetAttributes,
    SetTurn,
    BeginEdit,
    EndEdit,
    CancelEdit,
    Undo,
    Redo,
    Step,
    Destroy<BodyId>,
    Destroy<ParticleId>,
    Destroy<BondId>,
    Destroy<LawId>,
    Destroy<GroupId>,
    Destroy<FieldId>,
    Destroy<PairsId>,
    Destroy<CosmeticBondId>,
    Destroy<GripId>,
    CombineParticles,
    CombineBodies,
    Separate,
    SeparatePart,
    Nail,
    Release,
    CreateJoint,
    CreateDistance,
    AddCurvePoints,
    CreatePath,
    CreateSurface,
    CreateSurfacePair,
    SetConstraintActive,
    SetCoordinate,
    SetLength,
    SetBreakLimits, SetBreakForce, SetBondBreakForce, Destroy<ConstraintId>>;
// clang-format on

template <class C>
inline constexpr bool is_queueable = false;
template <class IdType>
inline constexpr bool is_queueable<Destroy<IdType>> = true;
template <>
inline constexpr bool is_queueable<SetKind> = true;
template <>
inline constexpr bool is_queueable<SetParticleActive> = true;
template <>
inline constexpr bool is_queueable<SetActive> = true;
template <>
inline constexpr bool is_queueable<CombineParticles> = true;
template <>
inline constexpr bool is_queueable<CombineBodies> = true;
template <>
inline constexpr bool is_queueable<Separate> = true;
template <>
inline constexpr bool is_queueable<SeparatePart> = true;
template <>
inline constexpr bool is_queueable<Nail> = true;
template <>
inline constexpr bool is_queueable<Release> = true;
template <>
inline constexpr bool is_queueable<SetConstraintActive> = true;
template <>
inline constexpr bool is_queueable<SetCoordinate> = true;
template <>
inline constexpr bool is_queueable<SetLength> = true;

}  // namespace iota::step
