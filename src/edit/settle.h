// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "edit/editor.h"
#include "ingredient/followers.h"
#include "ingredient/scope.h"
#include "model/restructure.h"

#include <span>
#include <vector>

/// The physics that a change of structure owes. The model changes first, at once; then positions are projected so that
/// combined points meet, velocities so that they respect the joints, and momentum and angular momentum that moved mass has
/// cost are given back.
namespace iota::edit {

/// Energy and momentum of some bodies.
struct Conserved {
  ingredient::Energies energies;
  ingredient::Momenta momenta;
};

/// One change of structure: measures before it, settles and measures after it, and makes the report.
///
///     Restructuring change(editor, bodies, Restructuring::Kind::moving);
///     return change.finish(model::combine_bodies(editor.model, a, b, change.report));
class Restructuring {
 public:
  /// A gentle change moves nothing and no mass: there is nothing to measure or to settle, and it costs what it touches.
  enum class Kind : bool { gentle, moving };
  Restructuring(Editor&, std::span<const std::uint32_t> bodies, Kind);

  RestructureReport report;  ///< the change says here what it made, and whether it did anything

  /// After the change, which says what it owes.
  RestructureReport finish(const model::Edit& owed);
  /// Also shows viewers the event, if anything has changed.
  RestructureReport finish(const model::Edit& owed, const ViewEvent& event);

 private:
  Editor& editor_;
  std::vector<std::uint32_t> bodies_;
  Kind kind_;
  ingredient::Followers followers_;
  // Nothing beyond the bodies that bonds and constraints tie to the edited ones can move or change its velocity.
  std::vector<std::uint32_t> affected_;
  Conserved before_;
};

}  // namespace iota::edit
