// SPDX-License-Identifier: Apache-2.0
#include "ingredient/contact_readings.h"
#include "system/core.h"

#include <stdexcept>

namespace iota {

std::vector<ContactPoint> Contacts::points() const { return ingredient::contact_points(core_.model); }

Vec3 Contacts::force(BodyId body, BodyId other) const {
  return ingredient::contact_force(core_.model, core_.slot(body), core_.slot(other));
}

void Contacts::ignore(const ContactParty& a, const ContactParty& b) {
  core_.execute(ingredient::IgnoreContacts{a, b, true});
}

void Contacts::allow(const ContactParty& a, const ContactParty& b) {
  core_.execute(ingredient::IgnoreContacts{a, b, false});
}

std::vector<std::pair<ContactParty, ContactParty>> Contacts::ignored() const {
  std::vector<std::pair<ContactParty, ContactParty>> pairs;
  for (const ingredient::IgnoredPair& pair : core_.model.ignored_contacts) pairs.emplace_back(pair.a, pair.b);
  return pairs;
}

std::uint32_t Contacts::watch(const ContactFilter& filter) {
  for (const auto* const side : {&filter.a, &filter.b})
    for (const ContactParty& party : *side)
      if (party.group)
        (void)core_.slot(party.group);
      else
        (void)core_.slot(party.body);
  if (core_.door.is_stepping()) edit::Door::refuse_in_step();
  return core_.watches.add(core_.model, core_.outlines, filter);
}

void Contacts::unwatch(std::uint32_t watch) {
  if (core_.door.is_stepping()) edit::Door::refuse_in_step();
  core_.watches.remove(watch);
}

}  // namespace iota
