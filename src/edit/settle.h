// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "edit/editor.h"
#include "ingredient/attachments.h"
#include "ingredient/scope.h"
#include "model/restructure.h"

#include <iota/reports.h>

#include <array>
#include <span>
#include <vector>

/// The motion after a change of structure. The model changes first; then positions are projected so that combined
/// points meet, velocities so that they satisfy the joints, and the change of momentum and angular momentum by moved
/// mass is compensated.
namespace iota::edit {

/// Energy and momentum of some bodies, or their changes.
struct Conserved {
  ingredient::Energies energies;
  ingredient::Momenta momenta;

  Conserved& add(const Conserved& other, double sign = 1);
};

/// A general body, with four basis points, as it was before a change.
struct BodyBefore {
  std::uint32_t body;
  std::array<std::uint32_t, 4> basis;
  std::array<Vec3, 4> places;
};

/// Projects velocities once for all bodies that a batch has made rigid, and adds the changes to its report.
void settle_batch(Editor&, RestructureReport&);

/// One change of structure: measures before it, settles and measures after it, and makes the report.
///
///     RestructureReport report;
///     Restructuring change(editor, bodies, Restructuring::Kind::moving, report);
///     change.finish(model::combine_bodies(editor.model, a, b, report));
///     return report;
class Restructuring {
 public:
  /// A gentle change moves neither points nor mass: it needs no measurement or projection, and costs what it touches. A
  /// transient one (closings) also does not raise `structure_version` and is not sent to viewers.
  enum class Kind : std::uint8_t { transient, gentle, moving };
  /// One body or two. The change writes into the report what it made, and whether it changed anything.
  Restructuring(Editor&, std::span<const std::uint32_t> bodies, Kind, RestructureReport&);

  /// Call it after the change, with the required projections.
  void finish(const model::Edit& owed);
  /// Also sends viewers the event, if anything has changed.
  void finish(const model::Edit& owed, const ViewEvent& event) {
    finish(owed);
    if (report_.changed) editor_.model.scene.note(event.kind, event.position);
  }

 private:
  void settle_and_measure(const model::Edit& owed);
  /// The living ones among some bodies and the bodies that the change has created.
  std::vector<std::uint32_t> with_created(std::span<const std::uint32_t> bodies) const;
  std::span<const std::uint32_t> edited() const { return {bodies_.data(), body_count_}; }

  Editor& editor_;
  RestructureReport& report_;
  std::array<std::uint32_t, 2> bodies_{};  // most edits cost less than a vector for them would
  std::size_t body_count_;
  Kind kind_;
  ingredient::Attachments attachments_;
  // The bodies whose energy and momentum the edit itself may change; changes by projections further away are added.
  std::vector<std::uint32_t> around_;
  Conserved before_;
  std::vector<BodyBefore> bodies_before_;  ///< the general ones of them
};

}  // namespace iota::edit
