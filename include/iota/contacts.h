// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iota/materials.h>
#include <iota/view.h>

#include <cstdint>
#include <utility>
#include <vector>

namespace iota {

/// The contacts of all bodies, exceptions from contact, and reports of touches that begin and end. See docs/contact.md.
class Contacts : public View {
 public:
  explicit Contacts(Core& core) : View(core) {}

  /// All places where bodies touched in the last step, in an order that does not depend on the history. `body` can move;
  /// if both can, it is the one with the lower slot.
  std::vector<ContactPoint> points() const;
  /// Sum of the forces of contacts of `other` on `body` in the last step, N.
  Vec3 force(BodyId body, BodyId other) const;

  /// @name Exceptions
  /// Kept by snapshots. A survivor of `combine` takes over those of what it absorbs; pieces have those of the whole.
  ///@{
  /// The two, or each of one group and each of the other, pass through each other. Both parties may be one group.
  void ignore(const ContactParty&, const ContactParty&);
  void allow(const ContactParty&, const ContactParty&);  ///< ends it; nothing without it
  std::vector<std::pair<ContactParty, ContactParty>> ignored() const;
  ///@}

  /// @name Watches
  /// Not a part of the state: a snapshot has none, and a restore or an undo keeps those that there are.
  ///@{
  /// Each StepReport then has the touches that begin and end, in the order of their bodies. Touches of now have begun
  /// already. A touch ends when the bodies are further apart than 1e-4 of the smaller one, so that round-off ends none. Returns the
  /// number of the watch. Throws std::invalid_argument for numbers that are negative or not finite.
  std::uint32_t watch(const ContactFilter&);
  void unwatch(std::uint32_t watch);  ///< nothing for an unknown one
  ///@}
};

}  // namespace iota
