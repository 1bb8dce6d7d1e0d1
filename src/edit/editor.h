// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/parallel.h"
#include "base/serialize.h"
#include "edit/history.h"
#include "held/held_forces.h"
#include "ingredient/model.h"
#include "island/islands.h"
#include "read/orientations.h"

#include <array>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace iota {

template <>
struct LastEnumerator<IntegrationMode> : std::integral_constant<IntegrationMode, IntegrationMode::accurate> {};
template <>
struct LastEnumerator<Touches> : std::integral_constant<Touches, Touches::sensor> {};
template <>
struct LastEnumerator<BodyKind> : std::integral_constant<BodyKind, BodyKind::resting> {};
template <>
struct LastEnumerator<ConstraintKind>
    : std::integral_constant<ConstraintKind, static_cast<ConstraintKind>(ingredient::constraint_kinds.size() - 1)> {};
template <>
struct LastEnumerator<JointCoordinate> : std::integral_constant<JointCoordinate, JointCoordinate::second_angle> {};
template <>
struct LastEnumerator<CurveKind> : std::integral_constant<CurveKind, CurveKind::polyline> {};

}  // namespace iota

/// Everything that changes a system is a command: a struct of serializable fields, and a function `apply` that checks
/// the fields, throws before any change, or changes the model. Commands are queued during a step, recorded and replayed
/// (door.h). A new command is declared and defined in the files of its noun, and added to commands.h, or it is an
/// ingredient's own.
namespace iota::edit {

using ingredient::Destroy;
using model::require;

/// The state on which commands act.
struct Editor {
  Editor(model::Model& model, island::Islands& islands, held::HeldForces& held, read::Orientations& orientations,
         const Parallel& parallel)
      : model(model), islands(islands), held(held), orientations(orientations), parallel(parallel) {}

  model::Model& model;
  island::Islands& islands;
  held::HeldForces& held;
  read::Orientations& orientations;
  const Parallel& parallel;

  std::optional<Batch> batch;  ///< the open batch
  History undo, redo;
  /// Set while a replay may restore destroyed objects: their functions are then kept.
  bool keeps_functions = false;

  /// Slot of a living thing. Throws StaleIdError, which says what became of it.
  template <class IdType>
  std::uint32_t require(IdType id) const {
    return edit::require(model, id);
  }
  void structure_changed() { ++model.structure_version; }
  /// Marks that velocities of a particle were assigned or may violate constraints: they are projected before the next
  /// step. Wakes resting bodies.
  void mark_velocity_dirty(std::uint32_t particle);

  /// Drops a function whose user was destroyed, unless a restore or a replay may restore the user.
  template <class Function>
  void drop_function(std::map<std::uint64_t, Function>& functions, std::uint64_t key) {
    if (!keeps_functions && key >= keys_saved_below_) functions.erase(key);
  }

  enum class Origin : std::uint8_t { anywhere, own };
  /// A system that is restored from it builds its islands from saved data. So that this one continues to the same bits
  /// as another one, it does that, too; not for a snapshot of its own, to which it returns itself.
  Snapshot snapshot(Origin = Origin::anywhere);
  /// The tables as a snapshot, and nothing else. With their schema, so that later versions can read it, unless it is for
  /// this program itself.
  Snapshot pack(Origin = Origin::anywhere);
  /// A state of undo that another version may have written, as this one writes it. schema: of its tables. Throws as `restore`.
  static Snapshot own_state(const Snapshot&, std::string_view schema);
  /// The tables of a snapshot. Throws as `restore`.
  static model::Model unpack(const Snapshot&, Origin);
  /// Throws std::invalid_argument for bytes that are not a snapshot, before any change. Bytes from outside are checked,
  /// in O(n).
  void restore(const Snapshot&, Origin = Origin::anywhere);
  void forget_history() { batch.reset(), undo.clear(), redo.clear(); }

 private:
  std::uint64_t keys_saved_below_ = 0;  // of functions in the latest snapshot
  std::size_t size_of_tables_ = 0;      // of the latest snapshot, in bytes
};

}  // namespace iota::edit
