// SPDX-License-Identifier: Apache-2.0
// Adjacency lists: every bond, closing, cosmetic bond and constraint is linked at each of its particles.
#include "model/model.h"

#include <algorithm>
#include <cmath>

namespace iota::model {

namespace {

/// Puts one end of an item at the front of its particle's list.
template <class Table>
void link(Table& items, std::uint32_t& first, std::uint32_t slot, std::uint32_t end) {
  Ends& item = items[slot];
  item.next[end] = first, item.previous[end] = none;
  if (first != none) items[first / 2].previous[first % 2] = 2 * slot + end;
  first = 2 * slot + end;
}

template <class Table>
void unlink(Table& items, std::uint32_t& first, std::uint32_t slot, std::uint32_t end) {
  const Ends& item = items[slot];
  const std::uint32_t before = item.previous[end], after = item.next[end];
  (before == none ? first : items[before / 2].next[before % 2]) = after;
  if (after != none) items[after / 2].previous[after % 2] = before;
}

std::uint32_t particle_at(const Ends& item, std::uint32_t end) { return end == 0 ? item.p : item.q; }

}  // namespace

std::uint32_t Model::add_bond(const Bond& bond) {
  const std::uint32_t slot = bonds.create(bond).slot;
  ++laws[bond.law].uses, ++bonds_revision;
  for (const std::uint32_t end : {0u, 1u}) {
    const std::uint32_t particle = particle_at(bond, end);
    link(bonds, references.make(particle).first_bond, slot, end);
    ++particles[particle].uses;
    touch_particle(particle);
  }
  bonds[slot].muted = !acts(bond.p) || !acts(bond.q);
  return slot;
}

std::uint32_t Model::add_closing(const Closing& closing) {
  const std::uint32_t slot = closings.create(closing).slot;
  for (const std::uint32_t end : {0u, 1u}) {
    const std::uint32_t particle = particle_at(closing, end);
    link(closings, references.make(particle).first_closing, slot, end);
    ++particles[particle].uses;
    touch_locally(particles[particle].body);
  }
  return slot;
}

std::uint32_t Model::add_cosmetic_bond(const CosmeticBond& bond) {
  const std::uint32_t slot = cosmetic_bonds.create(bond).slot;
  for (const std::uint32_t end : {0u, 1u})
    link(cosmetic_bonds, references.make(particle_at(bond, end)).first_cosmetic_bond, slot, end);
  scene.bodies.note(particles[bond.p].body);
  return slot;
}

void Model::remove_bond(std::uint32_t slot) {
  --laws[bonds[slot].law].uses, ++bonds_revision;
  for (const std::uint32_t end : {0u, 1u}) {
    const std::uint32_t particle = particle_at(bonds[slot], end);
    unlink(bonds, references.at(particle).first_bond, slot, end);
    --particles[particle].uses;
    touch_particle(particle);
  }
  bonds.destroy(slot);
  scene.bonds.note(slot);
}

void Model::remove_closing(std::uint32_t slot) {
  for (const std::uint32_t end : {0u, 1u}) {
    const std::uint32_t particle = particle_at(closings[slot], end);
    unlink(closings, references.at(particle).first_closing, slot, end);
    --particles[particle].uses;
    touch_locally(particles[particle].body);
  }
  closings.destroy(slot);
}

void Model::remove_cosmetic_bond(std::uint32_t slot) {
  scene.bodies.note(particles[cosmetic_bonds[slot].p].body);
  for (const std::uint32_t end : {0u, 1u})
    unlink(cosmetic_bonds, references.at(particle_at(cosmetic_bonds[slot], end)).first_cosmetic_bond, slot, end);
  cosmetic_bonds.destroy(slot);
}

std::uint32_t Model::add_constraint(const Constraint& constraint) {
  const std::uint32_t slot = constraints.create(constraint).slot;
  for (std::uint32_t place = 0; place < place_count; ++place)
    if (constraint.particles[place] != none) link_place(slot, place);
  if (geometries_.size() <= slot) geometries_.resize(slot + 1);
  geometries_[slot] = make_geometry(*this, constraint);
  return slot;
}

void Model::set_fuse(std::uint32_t particle, double force) {
  if (std::isinf(force))
    fuses.erase(particle);
  else
    fuses.make(particle) = force;
}

void Model::make_geometries() {
  geometries_.assign(constraints.slot_count(), {});
  constraints.for_each([&](std::uint32_t slot, const Constraint& c) { geometries_[slot] = make_geometry(*this, c); });
}

void Model::remove_constraint(std::uint32_t slot) {
  for (std::uint32_t place = 0; place < place_count; ++place)
    if (constraints[slot].particles[place] != none) unlink_place(slot, place);
  const CurveData curve = constraints[slot].curve;
  geometries_[slot] = {};
  constraints.destroy(slot);
  scene.constraints.note(slot);
  if (curve.count == 0) return;
  const auto first = curve_points.begin() + curve.first;
  curve_points.erase(first, first + curve.count);
  constraints.for_each([&](std::uint32_t, Constraint& c) {
    if (c.curve.first > curve.first) c.curve.first -= curve.count;
  });
}

void Model::link_place(std::uint32_t slot, std::uint32_t place) {
  Constraint& c = constraints[slot];
  std::uint32_t& first = references.make(c.particles[place]).first_constraint;
  c.next[place] = first, c.previous[place] = none;
  if (first != none) constraints[first / place_count].previous[first % place_count] = place_count * slot + place;
  first = place_count * slot + place;
  touch_particle(c.particles[place]);
}

void Model::unlink_place(std::uint32_t slot, std::uint32_t place) {
  const Constraint& c = constraints[slot];
  const std::uint32_t before = c.previous[place], after = c.next[place];
  (before == none ? references.at(c.particles[place]).first_constraint
                  : constraints[before / place_count].next[before % place_count]) = after;
  if (after != none) constraints[after / place_count].previous[after % place_count] = before;
  touch_particle(c.particles[place]);
}

void Model::set_bond_active(std::uint32_t slot, bool active) {
  Bond& bond = bonds[slot];
  if (bond.active == static_cast<std::uint8_t>(active)) return;
  bond.active = active;
  bond.broken = 0;
  ++bonds_revision, ++structure_version;
  for (const std::uint32_t end : {bond.p, bond.q}) touch_particle(end);
}

void Model::mute_bonds_of(std::uint32_t particle) {
  ++members_revision;
  for_each_bond_of(particle, [&](std::uint32_t b) {
    bonds[b].muted = !acts(bonds[b].p) || !acts(bonds[b].q);
    ++bonds_revision;
  });
}

void Model::redirect_uses(std::uint32_t q, std::uint32_t p) {
  const auto redirect = [&](auto& items, std::uint32_t References::* first, auto remove) {
    while (references[q].*first != none) {
      const std::uint32_t slot = references[q].*first / 2, end = references[q].*first % 2;
      if (particle_at(items[slot], 1 - end) == p) {
        remove(slot);
        continue;
      }
      unlink(items, references.at(q).*first, slot, end);
      (end == 0 ? items[slot].p : items[slot].q) = p;
      link(items, references.make(p).*first, slot, end);
    }
  };
  while (references[q].first_constraint != none) {
    const std::uint32_t slot = references[q].first_constraint / place_count;
    const std::uint32_t place = references[q].first_constraint % place_count;
    Constraint& c = constraints[slot];
    if (std::find(c.particles.begin(), c.particles.end(), p) != c.particles.end()) {  // two of its places in one
      for (std::uint32_t i = 0; i < place_count; ++i)                                 // both stay
        if (c.particles[i] == p || c.particles[i] == q) c.owned &= static_cast<std::uint8_t>(~(1u << i));
      destroy_constraint(*this, slot);
      continue;
    }
    unlink_place(slot, place);
    c.particles[place] = p;
    c.owned &= static_cast<std::uint8_t>(~(1u << place));
    link_place(slot, place);
  }
  if (const double* const force = fuses.find(q))  // the weaker one counts
    set_fuse(p, fuses.has(p) ? std::min(*force, fuses[p]) : *force);
  const std::uint32_t uses = particles[q].uses;
  ++bonds_revision;
  redirect(bonds, &References::first_bond, [&](std::uint32_t slot) { remove_bond(slot); });
  redirect(closings, &References::first_closing, [&](std::uint32_t slot) { remove_closing(slot); });
  redirect(cosmetic_bonds, &References::first_cosmetic_bond, [&](std::uint32_t slot) { remove_cosmetic_bond(slot); });
  mute_bonds_of(p);
  const std::uint32_t moved = particles[q].uses;  // the others were removed, and counted off
  particles[p].uses += moved, particles[q].uses = 0;
  if (uses > 0) touch_particle(p);
}

}  // namespace iota::model
