// SPDX-License-Identifier: Apache-2.0
#include "model/model.h"

#include <algorithm>
#include <limits>
#include <type_traits>

namespace iota::model {

namespace {

/// Appends to a doubly linked list whose links are members of the items.
template <class Table, class Owner>
void append(Table& items, Owner& owner, std::uint32_t item, auto next, auto previous) {
  items[item].*previous = owner.last;
  items[item].*next = none;
  (owner.last == none ? owner.first : items[owner.last].*next) = item;
  owner.last = item;
  ++owner.count;
}

template <class Table, class Owner>
void unlink(Table& items, Owner& owner, std::uint32_t item, auto next, auto previous) {
  const std::uint32_t before = items[item].*previous, after = items[item].*next;
  (before == none ? owner.first : items[before].*next) = after;
  (after == none ? owner.last : items[after].*previous) = before;
  items[item].*next = items[item].*previous = none;
  --owner.count;
}

}  // namespace

std::uint32_t Model::make_particle(std::uint32_t body, const Vec3& position, double mass, const Vec3& velocity) {
  Particle p;
  p.mass = mass, p.part = bodies.id(body);
  const std::uint32_t particle = particles.create(p).slot;
  Ring r;
  r.position = position, r.velocity = velocity;
  add_to_ring(particle, rings.create(r).slot);
  add_to_body(particle, body);
  return particle;
}

std::uint32_t Model::make_body(BodyKind kind, double body_damping) {
  Body b;
  b.kind = kind, b.damping = body_damping;
  const std::uint32_t body = bodies.create(b).slot;
  scene.bodies.note(body, true);
  add_to_articulate(body, articulates.create({}).slot);
  return body;
}

void Model::remove_particle(std::uint32_t particle) {
  set_fuse(particle, std::numeric_limits<double>::infinity());
  if (twins.size() > 0)
    for (std::uint32_t t = 0; t < twins.slot_count(); ++t)
      if (twins.is_alive(t) && twins[t].particle == particle) twins.destroy(t);
  if (const std::uint32_t slot = particles[particle].attributes; slot != none) {
    if (const std::uint32_t emitter = attributes[slot].emitter; emitter != none) --emitters[emitter].alive;
    attributes.destroy(slot);
  }
  take_from_body(particle);
  take_from_ring(particle);
  ties.erase(particle), references.erase(particle);
  particles.destroy(particle);
}

void Model::add_to_body(std::uint32_t particle, std::uint32_t body) {
  particles[particle].body = body;
  append(particles, bodies[body], particle, &Particle::next_in_body, &Particle::previous_in_body);
}

void Model::take_from_body(std::uint32_t particle) {
  remove_inertia_of(particles[particle].body, particle);
  remove_solids_of(particles[particle].body, particle);
  unlink(particles, bodies[particles[particle].body], particle, &Particle::next_in_body, &Particle::previous_in_body);
  particles[particle].body = none;
}

void Model::add_to_ring(std::uint32_t particle, std::uint32_t ring) {
  particles[particle].ring = ring;
  append(particles, rings[ring], particle, &Particle::next_in_ring, &Particle::previous_in_ring);
}

void Model::take_from_ring(std::uint32_t particle) {
  const std::uint32_t ring = particles[particle].ring;
  unlink(particles, rings[ring], particle, &Particle::next_in_ring, &Particle::previous_in_ring);
  particles[particle].ring = none;
  scene.rings.note(ring);  // its nail is drawn at its first particle
  if (rings[ring].count > 0) return;
  nails.erase(ring), pushes.erase(ring);
  rings.destroy(ring);
}

void Model::enter_articulate(std::uint32_t body, std::uint32_t articulate) {
  bodies[body].articulate = articulate;
  scene.memberships.note(body);
  append(bodies, articulates[articulate], body, &Body::next_in_articulate, &Body::previous_in_articulate);
}

void Model::leave_articulate(std::uint32_t body) {
  const std::uint32_t articulate = bodies[body].articulate;
  unlink(bodies, articulates[articulate], body, &Body::next_in_articulate, &Body::previous_in_articulate);
  if (articulates[articulate].count == 0) articulates.destroy(articulate);
}

void Model::add_to_articulate(std::uint32_t body, std::uint32_t articulate) {
  enter_articulate(body, articulate);
  touch(articulate);
}

void Model::take_from_articulate(std::uint32_t body) {
  touch_body(body);
  leave_articulate(body);
}

void Model::remove_body(std::uint32_t body) {
  remove_inertia_of(body, none);
  remove_solids_of(body, none);
  take_from_articulate(body);
  more_rows.erase(body), spins.erase(body);
  bodies.destroy(body);
}

void Model::remove_inertia_of(std::uint32_t body, std::uint32_t particle) {
  std::uint32_t* link = &bodies[body].first_inertia;
  while (*link != none) {
    const std::uint32_t pair = *link;
    InertiaPair& i = inertia_pairs[pair];
    if (particle == none || i.p == particle || i.q == particle) {
      *link = i.next;
      inertia_pairs.destroy(pair);
    } else {
      link = &i.next;
    }
  }
}

void Model::remove_solids_of(std::uint32_t body, std::uint32_t particle) {
  std::uint32_t* link = &bodies[body].first_solid;
  while (*link != none) {
    const std::uint32_t solid = *link;
    const auto& points = solids[solid].points;
    if (particle == none || std::find(points.begin(), points.end(), particle) != points.end()) {
      *link = solids[solid].next;
      solids.destroy(solid);
    } else {
      link = &solids[solid].next;
    }
  }
}

bool Model::is_pinned(std::uint32_t ring) const {
  if (rings[ring].nailed) return true;
  bool pinned = false;
  for_each_in_ring(ring, [&](std::uint32_t p) {
    const BodyKind kind = bodies[particles[p].body].kind;
    pinned = pinned || kind == BodyKind::static_ || kind == BodyKind::scripted;
  });
  return pinned;
}

double Model::body_mass(std::uint32_t body) const {
  double mass = 0;
  for_each_particle_of(body, [&](std::uint32_t p) { mass += particles[p].mass; });
  return mass;
}

double Model::ring_mass(std::uint32_t ring) const {
  double mass = 0;
  for_each_in_ring(ring, [&](std::uint32_t p) { mass += particles[p].mass; });
  return mass;
}

Vec3 Model::center_of_mass(std::uint32_t body) const {
  double mass = 0;
  Vec3 sum;
  for_each_particle_of(body, [&](std::uint32_t p) {
    mass += particles[p].mass;
    sum += particles[p].mass * position(p);
  });
  return mass > 0 ? (1 / mass) * sum : sum;
}

void Model::record_survivor(ParticleId retired, ParticleId survivor) { particle_survivors_.record(retired, survivor); }
void Model::record_survivor(BodyId retired, BodyId survivor) { body_survivors_.record(retired, survivor); }

std::optional<ParticleId> Model::survivor_of(ParticleId id) const {
  for (std::optional<ParticleId> next = id; next; next = particle_survivors_.find(*next))
    if (particles.contains(*next)) return next;
  return std::nullopt;
}

std::optional<BodyId> Model::survivor_of(BodyId id) const {
  for (std::optional<BodyId> next = id; next; next = body_survivors_.find(*next))
    if (bodies.contains(*next)) return next;
  return std::nullopt;
}

bool Model::is_spark(std::uint32_t particle) const {
  const Particle& p = particles[particle];
  if (p.attributes == none || attributes[p.attributes].emitter == none) return false;
  const References& r = references[particle];
  const Ring& ring = rings[p.ring];
  return bodies[p.body].count == 1 && ring.count == 1 && !ring.nailed && r.first_bond == none &&
         r.first_closing == none && r.first_constraint == none;
}

std::uint64_t Model::hash() const {
  Hasher h;
  h.value(step), h.value(time), h.value(structure_version);
  const auto add = [&](const Vec3& v) { h.value(v.x), h.value(v.y), h.value(v.z); };
  rings.for_each([&](std::uint32_t slot, const Ring& r) {
    h.value(slot), h.value(r.first), h.value(r.count);
    add(r.position), add(r.velocity);
  });
  particles.for_each(
      [&](std::uint32_t slot, const Particle& p) { h.value(slot), h.value(p.body), h.value(p.ring), h.value(p.mass); });
  bodies.for_each([&](std::uint32_t slot, const Body& b) { h.value(slot), h.value(b.articulate), h.value(b.count); });
  return h.result();
}

}  // namespace iota::model
