// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "edit/editor.h"
#include "ingredient/followers.h"
#include "ingredient/scope.h"
#include "model/restructure.h"

#include <array>
#include <span>
#include <vector>

/// The physics that a change of structure owes. The model changes first, at once; then positions are projected so that
/// combined points meet, velocities so that they respect the joints, and momentum and angular momentum that moved mass has
/// cost are given back.
namespace iota::edit {

/// Energy and momentum of some bodies, or by how much they have changed.
struct Conserved {
  ingredient::Energies energies;
  ingredient::Momenta momenta;

  Conserved& add(const Conserved& other, double sign = 1);
};

/// Makes velocities fit what a batch has made rigid, once for all of it, and adds to its report what that changes.
void settle_batch(Editor&, RestructureReport&);

/// One change of structure: measures before it, settles and measures after it, and makes the report.
///
///     RestructureReport report;
///     Restructuring change(editor, bodies, Restructuring::Kind::moving, report);
///     change.finish(model::combine_bodies(editor.model, a, b, report));
///     return report;
class Restructuring {
 public:
  /// A gentle change moves nothing and no mass: there is nothing to measure or to settle, and it costs what it touches. A
  /// transient one, besides, neither raises `structure_version` nor is shown to viewers: closings.
  enum class Kind : std::uint8_t { transient, gentle, moving };
  /// One body or two. The change says in the report what it made, and whether it did anything.
  Restructuring(Editor&, std::span<const std::uint32_t> bodies, Kind, RestructureReport&);

  /// After the change, which says what it owes.
  void finish(const model::Edit& owed);
  /// Also shows viewers the event, if anything has changed.
  void finish(const model::Edit& owed, const ViewEvent& event) {
    finish(owed);
    if (report_.changed) editor_.model.scene.note(event.kind, event.position);
  }

 private:
  void settle_and_measure(const model::Edit& owed);
  /// Of some bodies and those that the change has created, the ones that are alive.
  std::vector<std::uint32_t> with_created(std::span<const std::uint32_t> bodies) const;
  std::span<const std::uint32_t> edited() const { return {bodies_.data(), body_count_}; }

  Editor& editor_;
  RestructureReport& report_;
  std::array<std::uint32_t, 2> bodies_{};  // most edits cost less than a vector for them would
  std::size_t body_count_;
  Kind kind_;
  ingredient::Followers followers_;
  // The bodies whose energy and momentum the edit itself may change; what settling changes further away is added to that.
  std::vector<std::uint32_t> around_;
  Conserved before_;
};

}  // namespace iota::edit
