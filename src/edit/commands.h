// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/serialize.h"
#include "edit/attributes.h"
#include "edit/batches.h"
#include "edit/bodies.h"
#include "edit/body_forces.h"
#include "edit/bonds.h"
#include "edit/combine.h"
#include "edit/constraints.h"
#include "edit/emitters.h"
#include "edit/fields.h"
#include "edit/grips.h"
#include "edit/joint_pose.h"
#include "edit/laws.h"
#include "edit/many.h"
#include "edit/nails.h"
#include "edit/particles.h"
#include "edit/separate.h"
#include "edit/settings.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

namespace iota::edit {

/// A step is a command too, since recordings contain it; src/step applies it.
struct Step {
  double dt;
};
/// A snapshot was taken for others: what it does to the islands has to be repeated by a replay.
struct TakeSnapshot {
  static constexpr bool keeps_energy = true;
};
inline void apply(Editor& e, const TakeSnapshot&) { e.islands.renew(e.model); }

// One per line, to avoid merge conflicts.
// clang-format off
using OfNouns = std::tuple<
    Step,
    SetGravity,
    SetMode,
    SetSolver,
    SetDamping,
    SetRest,
    CreateBody,
    CreateSolid,
    CreateAttachment,
    SetRod,
    SetKind,
    SetBodyDamping,
    SetPose,
    SetBodyVelocity,
    SetAngularVelocity,
    Destroy<BodyId>,
    CreateParticle,
    SetPosition,
    SetVelocity,
    SetMass,
    ApplyForce,
    SetParticleActive,
    SetParticleBreakForce,
    Destroy<ParticleId>,
    SetAttributes,
    SetOrientation,
    SetSpin,
    ApplyTorque,
    SetMoment,
    SetSpinDamping,
    Align,
    CreateEmitter,
    SetEmitterActive,
    SetRate,
    MoveEmitter,
    Destroy<EmitterId>,
    CombineParticles,
    CombineBodies,
    Separate,
    SeparatePart,
    CreateCosmeticBond,
    Destroy<CosmeticBondId>,
    Nail,
    Release,
    CreateGrip,
    MoveGrip,
    Destroy<GripId>,
    CreateJoint,
    CreateDistance,
    CreatePath,
    CreateSurface,
    CreateSurfacePair,
    SetConstraintActive,
    SetCoordinate,
    SetLength,
    SetBreakLimits,
    Destroy<ConstraintId>,
    CreateLaw,
    Destroy<LawId>,
    CreateBond,
    SetBondParameter,
    SetBondActive,
    SetBondBreakForce,
    Destroy<BondId>,
    CreateGroup,
    SetMember,
    Destroy<GroupId>,
    CreateField,
    SetFieldParameter,
    SetFieldActive,
    Destroy<FieldId>,
    CreatePairs,
    SetPairsParameter,
    SetPairsActive,
    Destroy<PairsId>,
    BeginEdit,
    EndEdit,
    CancelEdit,
    Undo,
    Redo,
    SetBodyName,
    SetBodyMass,
    ApplyBodyForce,
    ApplyBodyTorque,
    SetCoordinateValue,
    CreatePoints,
    CreateRods,
    CreateBonds,
    CombineMany,
    AssignParticles,
    AssignBodies,
    AssignBonds,
    CreateSpan,
    CreateCoupling,
    CreateTackle,
    SetCompliance,
    SetTolerance,
    SetBudget,
    SetRadius,
    SetUsualRadius,
    SetMaterial,
    SetUsualMaterial,
    CreateObstacle,
    TakeSnapshot,
    SetColor,
    SetMassProperties>;
// clang-format on

namespace detail {
template <class OfNouns, class Ingredients>
struct Joined;
template <class... C, class... I>
struct Joined<std::tuple<C...>, std::tuple<I...>> {
  template <class... Own>
  static std::tuple<C..., Own...> join(std::tuple<Own...>*);
  using type = decltype(join(static_cast<decltype(std::tuple_cat(std::declval<typename I::Commands>()...))*>(nullptr)));
};
}  // namespace detail

/// The types of all commands: those above, then those of the ingredients. Recordings name a command by its index in a list that they
/// contain (command_list.h).
using AllCommands = detail::Joined<OfNouns, ingredient::Ingredients>::type;

/// An ingredient's own command.
template <class C>
  requires(ingredient::is_own_command<C>)
auto apply(Editor& e, const C& c) {
  return ingredient::OwnerOf<C>::apply(e.model, c);
}

/// The index of a command in that list.
template <class C, class Commands = AllCommands>
inline constexpr std::uint8_t index_of = 0;
template <class C, class... Commands>
inline constexpr std::uint8_t index_of<C, std::tuple<Commands...>> = [] {
  std::uint8_t index = 0;
  static_cast<void>(((std::is_same_v<C, Commands> || (++index, false)) || ...));
  return index;
}();

/// Appends a command as recordings have it.
template <class C>
void write(std::vector<std::byte>& bytes, const C& command) {
  Writer writer(bytes);
  writer.value(index_of<C>);
  serialize(writer, command);
}

namespace detail {

template <class C, class Visit>
void read_one(Reader& reader, Visit& visit) {
  C command{};
  serialize(reader, command);
  if (reader.ok()) visit(std::as_const(command));
}

template <class>
struct Each;
template <class... C>
struct Each<std::tuple<C...>> {
  template <class Visit>
  static void visit(Visit& visit) {
    (visit.template operator()<C>(), ...);
  }
  /// By index.
  template <class Visit>
  static constexpr std::array<void (*)(Reader&, Visit&), sizeof...(C)> readers = {&read_one<C, Visit>...};
};

}  // namespace detail

/// Calls visit.operator()<C>() for each type of command, in order.
template <class Visit>
void for_each_command_type(Visit visit) {
  detail::Each<AllCommands>::visit(visit);
}

/// Reads what `write` appended and calls visit(command). The reader fails, and nothing is called, at an index that no command has
/// and at values that it cannot have. Not a variant that is visited: with a hundred alternatives each use took seconds to compile.
template <class Visit>
void read_command(Reader& reader, Visit visit) {
  constexpr auto& readers = detail::Each<AllCommands>::readers<Visit>;
  std::uint8_t index = 0;
  reader.value(index);
  if (index >= readers.size()) reader.fail();
  if (reader.ok()) readers[index](reader, visit);
}

/// Whether a command may be requested during a step; it is then applied right after it. Such a command has its name for
/// users (`queued_as`).
template <class C>
inline constexpr bool is_queueable = requires { C::queued_as; };

/// Whether a command does not change the energy of the system, so that no energy has to be summed up: grips do work
/// only in steps.
template <class C>
inline constexpr bool keeps_energy = requires { C::keeps_energy; };
template <>
inline constexpr bool keeps_energy<Destroy<GripId>> = true;

/// Whether a command leaves everything where it is until the next step: forces, which scripts apply in each step.
template <class C>
inline constexpr bool moves_nothing = requires { C::moves_nothing; };

/// Whether all bodies whose energy a command changes are awake after it, so that those of others need not be summed up.
template <class C>
inline constexpr bool wakes_what_it_changes = moves_nothing<C> || requires { C::wakes_what_it_changes; };

/// The users' names of the queueable commands, each once: "combine, separate, ...".
std::string queued_edits();

}  // namespace iota::edit
