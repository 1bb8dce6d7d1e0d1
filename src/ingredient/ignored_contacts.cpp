// SPDX-License-Identifier: Apache-2.0
#include "ingredient/ignored_contacts.h"

#include "ingredient/contacts.h"
#include "ingredient/model.h"

#include <algorithm>
#include <optional>
#include <stdexcept>
#include <utility>

namespace iota::ingredient {

namespace {

IgnoredPair in_order(const ContactParty& a, const ContactParty& b) {
  return a <= b ? IgnoredPair{a, b} : IgnoredPair{b, a};
}

void require_party(const Model& model, const ContactParty& party) {
  if (party.body && party.group)
    throw std::invalid_argument("a party of contacts is a body or a group, not both; give each its own exception");
  if (party.group)
    (void)model::require(model, party.group);
  else
    (void)model::require(model, party.body);
}

void insert(std::vector<IgnoredPair>& pairs, const IgnoredPair& pair) {
  const auto place = std::lower_bound(pairs.begin(), pairs.end(), pair);
  if (place == pairs.end() || *place != pair) pairs.insert(place, pair);
}

/// A body begins anew to look for contacts.
void look_anew(Model& model, std::uint32_t slot) {
  const model::Body& body = model.bodies[slot];
  Contacts::end(model, slot);
  if (model::is_free(body.kind)) model.wake(body.articulate);
}

/// The same for the bodies of a party. Static ones do not look: the other party does.
void look_anew(Model& model, const ContactParty& party) {
  model.bodies.for_each([&](std::uint32_t slot, const model::Body& body) {
    if (body.kind != BodyKind::static_ && belongs(model, slot, party)) look_anew(model, slot);
  });
}

/// Sets the party to what became of it. False if it was destroyed.
bool survives(const Model& model, ContactParty& party) {
  if (party.group) return model.groups.contains(party.group);
  const std::optional<BodyId> body = model.survivor_of(party.body);
  if (body) party.body = *body;
  return body.has_value();
}

}  // namespace

bool belongs(const Model& model, std::uint32_t slot, const ContactParty& party) {
  if (!party.group) return model.bodies.id(slot) == party.body;
  if (!model.groups.contains(party.group)) return false;
  const std::uint32_t bit = 1u << party.group.slot;
  for (std::uint32_t p = model.bodies[slot].first; p != none; p = model.particles[p].next_in_body)
    if (model.particles[p].groups & bit) return true;
  return false;
}

// Pairs with a group come first in their order, since a group has the null body; of two bodies one is searched for.
bool IgnoredContacts::include(const Model& model, std::uint32_t body, std::uint32_t other) {
  const std::vector<IgnoredPair>& pairs = model.ignored_contacts;
  if (pairs.empty()) return false;
  auto pair = pairs.begin();
  for (; pair != pairs.end() && pair->a.group; ++pair)
    if ((belongs(model, body, pair->a) && belongs(model, other, pair->b)) ||
        (belongs(model, other, pair->a) && belongs(model, body, pair->b)))
      return true;
  return std::binary_search(pair, pairs.end(), in_order({model.bodies.id(body), {}}, {model.bodies.id(other), {}}));
}

void IgnoredContacts::apply(Model& model, const IgnoreContacts& c) {
  require_party(model, c.a), require_party(model, c.b);
  if (c.a.body && c.a == c.b) throw std::invalid_argument("a body does not touch itself; ignore takes two");
  const IgnoredPair pair = in_order(c.a, c.b);
  if (c.ignores)
    insert(model.ignored_contacts, pair);
  else
    std::erase(model.ignored_contacts, pair);
  look_anew(model, c.a), look_anew(model, c.b);
}

IgnoredContacts::Memory IgnoredContacts::remember(const Model& model, std::span<const std::uint32_t> bodies) {
  Memory memory;
  if (model.ignored_contacts.empty()) return memory;
  for (const std::uint32_t body : bodies) {
    Kept& kept = memory.emplace_back(Kept{model.bodies.id(body), {}});
    model.for_each_particle_of(body, [&](std::uint32_t p) { kept.particles.push_back(model.particles.id(p)); });
  }
  return memory;
}

void IgnoredContacts::reattach(Model& model, const Memory& memory) {
  if (memory.empty()) return;
  const std::vector<IgnoredPair> before = std::exchange(model.ignored_contacts, {});
  const auto keep = [&](IgnoredPair pair) {
    if (!survives(model, pair.a) || !survives(model, pair.b)) return;
    if (!(pair.a.body && pair.a == pair.b)) insert(model.ignored_contacts, in_order(pair.a, pair.b));
  };
  for (const IgnoredPair& pair : before) {
    keep(pair);
    for (const Kept& kept : memory)
      for (const ParticleId particle : kept.particles) {
        if (!model.particles.contains(particle)) continue;
        const ContactParty piece{model.bodies.id(model.particles[particle.slot].body), {}};
        if (pair.a.body == kept.body && piece.body != pair.a.body) keep({piece, pair.b});
        if (pair.b.body == kept.body && piece.body != pair.b.body) keep({pair.a, piece});
      }
  }
}

void IgnoredContacts::change_member(Model& model, std::uint32_t body, GroupId group) {
  const bool looks = model.bodies[body].kind != BodyKind::static_;
  for (const IgnoredPair& pair : model.ignored_contacts)
    for (const auto& [own, other] : {std::pair(pair.a, pair.b), std::pair(pair.b, pair.a)})
      if (own.group == group) looks ? look_anew(model, body) : look_anew(model, other);
}

void IgnoredContacts::forget_group(Model& model, GroupId group) {
  std::erase_if(model.ignored_contacts, [&](const IgnoredPair& pair) {
    const bool names = pair.a.group == group || pair.b.group == group;
    if (names) look_anew(model, pair.a), look_anew(model, pair.b);
    return names;
  });
}

void IgnoredContacts::validate(const Model& model, model::Audit& audit) {
  const std::vector<IgnoredPair>& pairs = model.ignored_contacts;
  audit.require(std::is_sorted(pairs.begin(), pairs.end()), "the exceptions from contact are not sorted");
  for (const IgnoredPair& pair : pairs)
    for (const ContactParty& party : {pair.a, pair.b})
      audit.require(party.group ? !party.body && model.groups.contains(party.group) : bool{party.body},
                    "an exception from contact names neither a body nor a group");
}

}  // namespace iota::ingredient
