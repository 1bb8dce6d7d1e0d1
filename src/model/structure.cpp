// SPDX-License-Identifier: Apache-2.0
#include "model/structure.h"

#include <algorithm>
#include <cmath>
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

std::uint32_t Structure::make_particle(std::uint32_t body, const Vec3& position, double mass, const Vec3& velocity) {
  Particle p;
  p.mass = mass, p.part = bodies.id(body);
  const std::uint32_t particle = particles.create(p).slot;
  Ring r;
  r.position = position, r.velocity = velocity;
  add_to_ring(particle, rings.create(r).slot);
  add_to_body(particle, body);
  return particle;
}

std::uint32_t Structure::make_body(BodyKind kind, double damping) {
  Body b;
  b.kind = kind;
  const BodyId id = bodies.create(b);
  const std::uint32_t body = id.slot;
  if (id.generation > 1) local_change_.reborn.push_back(body);
  set_damping(body, damping);
  note_body(body, true);
  add_to_articulate(body, articulates.create({}).slot);
  return body;
}

void Structure::remove_particle(std::uint32_t particle) {
  set_fuse(particle, std::numeric_limits<double>::infinity());
  while (const std::uint32_t* const first = first_twin.find(particle)) remove_twin(*first);
  forget_particle(particle);
  if (const std::uint32_t slot = particles[particle].attributes; slot != none) attributes.destroy(slot);
  take_from_body(particle);
  take_from_ring(particle);
  affine.erase(particle);
  particles.destroy(particle);
}

void Structure::add_twin(Twin twin) {
  const std::uint32_t* const first = first_twin.find(twin.particle);
  twin.next = first ? *first : none;
  first_twin.make(twin.particle) = twins.create(twin).slot;
}

void Structure::remove_twin(std::uint32_t twin) {
  const std::uint32_t particle = twins[twin].particle;
  std::uint32_t* link = first_twin.find(particle);
  while (*link != twin) link = &twins[*link].next;
  *link = twins[twin].next;
  if (first_twin.at(particle) == none) first_twin.erase(particle);
  twins.destroy(twin);
}

void Structure::move_twins(std::uint32_t from, std::uint32_t to) {
  while (const std::uint32_t* const first = first_twin.find(from)) {
    Twin twin = twins[*first];
    remove_twin(*first);
    twin.particle = to;
    add_twin(twin);
  }
}

void Structure::add_to_body(std::uint32_t particle, std::uint32_t body) {
  particles[particle].body = body;
  append(particles, bodies[body], particle, &Particle::next_in_body, &Particle::previous_in_body);
}

void Structure::take_from_body(std::uint32_t particle) {
  remove_inertia_of(particles[particle].body, particle);
  remove_solids_of(particles[particle].body, particle);
  unlink(particles, bodies[particles[particle].body], particle, &Particle::next_in_body, &Particle::previous_in_body);
  particles[particle].body = none;
}

void Structure::add_to_ring(std::uint32_t particle, std::uint32_t ring) {
  particles[particle].ring = ring;
  append(particles, rings[ring], particle, &Particle::next_in_ring, &Particle::previous_in_ring);
}

void Structure::take_from_ring(std::uint32_t particle) {
  const std::uint32_t ring = particles[particle].ring;
  unlink(particles, rings[ring], particle, &Particle::next_in_ring, &Particle::previous_in_ring);
  particles[particle].ring = none;
  ring_changed(ring);
  if (rings[ring].count > 0) return;
  corrections.set(ring, {});
  rings.destroy(ring);
}

void Structure::stop_ring(std::uint32_t ring) {
  rings[ring].velocity = rings[ring].acceleration = {};
  corrections.set(ring, {});
}

void Structure::enter_articulate(std::uint32_t body, std::uint32_t articulate) {
  bodies[body].articulate = articulate;
  scene.memberships.note(body);
  append(bodies, articulates[articulate], body, &Body::next_in_articulate, &Body::previous_in_articulate);
}

void Structure::leave_articulate(std::uint32_t body) {
  const std::uint32_t articulate = bodies[body].articulate;
  unlink(bodies, articulates[articulate], body, &Body::next_in_articulate, &Body::previous_in_articulate);
  if (articulates[articulate].count == 0) articulates.destroy(articulate);
}

void Structure::add_to_articulate(std::uint32_t body, std::uint32_t articulate) {
  enter_articulate(body, articulate);
  mark(articulate);
}

void Structure::take_from_articulate(std::uint32_t body) {
  mark_body(body);
  leave_articulate(body);
}

void Structure::remove_body(std::uint32_t body) {
  remove_inertia_of(body, none);
  remove_solids_of(body, none);
  take_from_articulate(body);
  forget_body(body);
  more_rows.erase(body), body_damping.erase(body), radii.erase(body), obstacles.erase(body), materials.erase(body),
      colors.erase(body), stands.erase(body);
  bodies.destroy(body);
}

void Structure::remove_inertia_of(std::uint32_t body, std::uint32_t particle) {
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

void Structure::remove_solids_of(std::uint32_t body, std::uint32_t particle) {
  std::uint32_t* link = &bodies[body].first_solid;
  while (*link != none) {
    const std::uint32_t solid = *link;
    const auto& points = solids[solid].points;
    if (particle == none || std::find(points.begin(), points.end(), particle) != points.end()) {
      *link = solids[solid].next;
      meshes.remove_use(solids[solid].shape.key);
      solids.destroy(solid);
    } else {
      link = &solids[solid].next;
    }
  }
}

bool Structure::is_pinned(std::uint32_t ring) const {
  if (rings[ring].nailed) return true;
  bool pinned = false;
  for_each_in_ring(ring, [&](std::uint32_t p) {
    const BodyKind kind = bodies[particles[p].body].kind;
    pinned = pinned || kind == BodyKind::static_ || kind == BodyKind::scripted;
  });
  return pinned;
}

double Structure::body_mass(std::uint32_t body) const {
  double mass = 0;
  for_each_particle_of(body, [&](std::uint32_t p) { mass += particles[p].mass; });
  return mass;
}

double Structure::ring_mass(std::uint32_t ring) const {
  double mass = 0;
  for_each_in_ring(ring, [&](std::uint32_t p) { mass += particles[p].mass; });
  return mass;
}

Vec3 Structure::center_of_mass(std::uint32_t body) const {
  if (const Obstacle* const obstacle = obstacles.find(body)) return obstacle->position;
  double mass = 0;
  Vec3 sum;
  for_each_particle_of(body, [&](std::uint32_t p) {
    mass += particles[p].mass;
    sum += particles[p].mass * position(p);
  });
  return mass > 0 ? (1 / mass) * sum : sum;
}

void Structure::record_survivor(ParticleId retired, ParticleId survivor) {
  particle_survivors_.record(retired, survivor);
}
void Structure::record_survivor(BodyId retired, BodyId survivor) { body_survivors_.record(retired, survivor); }

std::optional<ParticleId> Structure::survivor_of(ParticleId id) const {
  for (std::optional<ParticleId> next = id; next; next = particle_survivors_.find(*next))
    if (particles.contains(*next)) return next;
  return std::nullopt;
}

std::optional<BodyId> Structure::survivor_of(BodyId id) const {
  for (std::optional<BodyId> next = id; next; next = body_survivors_.find(*next))
    if (bodies.contains(*next)) return next;
  return std::nullopt;
}

bool Structure::is_spark(std::uint32_t particle) const {
  const Particle& p = particles[particle];
  if (p.attributes == none || attributes[p.attributes].emitter == none) return false;
  const Ring& ring = rings[p.ring];
  return bodies[p.body].count == 1 && ring.count == 1 && !ring.nailed && !is_used(particle);
}

void Structure::set_fuse(std::uint32_t particle, double force) {
  if (std::isinf(force))
    fuses.erase(particle);
  else
    fuses.make(particle) = force;
}

void Structure::set_damping(std::uint32_t body, double per_second) {
  if (per_second == 0)
    body_damping.erase(body);
  else
    body_damping.make(body) = per_second;
}

}  // namespace iota::model
