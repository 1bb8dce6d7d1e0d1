// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ingredient/contacts.h"

#include <vector>

namespace iota::ingredient {

/// The two bodies of a contact in the order of reports: one that can move first; if both can, the one with the lower slot.
struct ContactPair {
  std::uint32_t body, other;
  friend auto operator<=>(const ContactPair&, const ContactPair&) = default;
};
ContactPair pair_of(const Model&, const Contact&);

/// The places where bodies touched in the last step, in the order of their pairs and of slots of contacts.
std::vector<ContactPoint> contact_points(const Model&);
/// The places where one body did.
std::vector<ContactPoint> contact_points(const Model&, std::uint32_t body);
/// Sum of the forces of contacts of the other one on a body, N.
Vec3 contact_force(const Model&, std::uint32_t body, std::uint32_t other);

}  // namespace iota::ingredient
