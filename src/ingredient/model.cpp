// SPDX-License-Identifier: Apache-2.0
// A model calls all of its ingredients; none of them is named here.
#include "ingredient/model.h"

#include "base/text.h"

#include <algorithm>

namespace iota::model {

namespace {

/// visit.operator()<I>() for each ingredient.
template <class Visit>
void for_each_ingredient(Visit visit) {
  ingredient::for_each_type<ingredient::Ingredients>(visit);
}

template <class Test>
bool any_ingredient(Test test) {
  bool any = false;
  for_each_ingredient([&]<class I>() { any = any || test.template operator()<I>(); });
  return any;
}

}  // namespace

Vec3 Model::acting_gravity() const {
  return any_ingredient([&]<class I>() { return I::replaces_gravity(*this); }) ? Vec3{} : gravity;
}

void Model::visit_tied(std::uint32_t particle, Ties ties, Visit visit) const {
  for_each_ingredient([&]<class I>() {
    const bool counts = ties == Ties::all || (ties == Ties::but_contacts && !I::ties_by_contact);
    if (counts || I::ties_rigidly) I::visit_tied(*this, particle, visit);
  });
}

std::vector<std::uint32_t> Model::tied_bodies(std::span<const std::uint32_t> start, Ties ties) const {
  std::vector<std::uint32_t> reached;
  std::vector<std::uint8_t> is_reached(articulates.slot_count(), 0);
  const auto reach = [&](std::uint32_t body) {
    const std::uint32_t a = bodies[body].articulate;
    if (is_reached[a]) return;
    is_reached[a] = 1;
    for_each_body_of(a, [&](std::uint32_t b) { reached.push_back(b); });
  };
  for (const std::uint32_t body : start) reach(body);
  for (std::size_t next = 0; next < reached.size(); ++next)
    for_each_particle_of(reached[next], [&](std::uint32_t p) { visit_tied(p, ties, reach); });
  return reached;
}

bool Model::has_ties() const {
  return any_ingredient([&]<class I>() { return I::ties_any(*this); });
}

bool Model::is_tied_to_world(std::uint32_t body) const {
  return any_ingredient([&]<class I>() { return I::ties_to_world(*this, body); });
}

void Model::watch_scene() {
  scene.bodies.is_on = scene.memberships.is_on = true;
  scene.bodies.clear(), scene.memberships.clear(), scene.events.clear();
  scene.is_whole = false;
  for_each_ingredient([&]<class I>() {
    if (ChangedSlots* const log = I::scene_log(*this)) log->is_on = true, log->clear();
  });
}

void Model::stop_watching_scene() {
  scene = {};
  for_each_ingredient([&]<class I>() {
    if (ChangedSlots* const log = I::scene_log(*this)) *log = {};
  });
}

void Model::take_over(Model& before) {
  for_each_ingredient([&]<class I>() { I::take_over(*this, before); });
  if (!before.scene.is_on()) return;
  watch_scene();
  scene.is_whole = true;
}

void Model::absorb_uses(std::uint32_t q, std::uint32_t p) {
  for_each_ingredient([&]<class I>() { I::absorb(*this, q, p); });
}
void Model::drop_uses(std::uint32_t particle) {
  for_each_ingredient([&]<class I>() { I::drop(*this, particle); });
}
void Model::forget_particle(std::uint32_t particle) {
  for_each_ingredient([&]<class I>() { I::forget_particle(*this, particle); });
}
void Model::forget_body(std::uint32_t body) {
  for_each_ingredient([&]<class I>() { I::forget_body(*this, body); });
}
void Model::ring_changed(std::uint32_t ring) {
  for_each_ingredient([&]<class I>() { I::ring_changed(*this, ring); });
}
void Model::ring_merged(std::uint32_t into, std::uint32_t from, bool replaces) {
  for_each_ingredient([&]<class I>() { I::ring_merged(*this, into, from, replaces); });
}
void Model::inertia_changed(std::uint32_t body) {
  for_each_ingredient([&]<class I>() { I::inertia_changed(*this, body); });
}
void Model::acting_changed(std::uint32_t particle) {
  ++members_revision;
  for_each_ingredient([&]<class I>() { I::acting_changed(*this, particle); });
}
bool Model::call_off(std::uint32_t p, std::uint32_t q) {
  return any_ingredient([&]<class I>() { return I::call_off(*this, p, q); });
}
bool Model::is_used(std::uint32_t particle) const {
  return any_ingredient([&]<class I>() { return I::uses(*this, particle); });
}
bool Model::is_frozen(std::uint32_t body) const { return ingredient::Strides::is_frozen(*this, body); }
Vec3 Model::inner_momentum(std::uint32_t body) const {
  Vec3 sum;
  for_each_ingredient([&]<class I>() { sum += I::inner_momentum(*this, body); });
  return sum;
}
void Model::visit_joined(std::uint32_t particle, Visit visit) const {
  for_each_ingredient([&]<class I>() { I::visit_joined(*this, particle, visit); });
}
void Model::visit_companions(std::uint32_t particle, Visit visit) const {
  for_each_ingredient([&]<class I>() { I::visit_companions(*this, particle, visit); });
}

void Model::visit_lines(std::uint32_t body, VisitLine visit) const {
  for_each_ingredient([&]<class I>() { I::visit_lines(*this, body, visit); });
}
double Model::ball_radius(std::uint32_t particle) const {
  const std::uint32_t slot = particles[particle].attributes;
  if (slot == none) return 0;
  double radius = 0;
  for_each_ingredient([&]<class I>() { radius = std::max(radius, I::ball_radius(*this, particle)); });
  return radius > 0 ? radius : attributes[slot].radius;
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

// Three chains, which a processor finds side by side: each value of one chain waits for the value before it.
std::uint64_t Model::quick_hash() const {
  WordHasher a, b, c;
  const auto add = [&](const auto& x, const auto& y, const auto& z) { a.value(x), b.value(y), c.value(z); };
  add(step, time, structure_version);
  rings.for_each([&](std::uint32_t slot, const Ring& r) {
    add(slot, r.first, r.count);
    add(r.position.x, r.position.y, r.position.z);
    add(r.velocity.x, r.velocity.y, r.velocity.z);
  });
  particles.for_each(
      [&](std::uint32_t slot, const Particle& p) { add(std::uint64_t{slot} << 32 | p.body, p.ring, p.mass); });
  bodies.for_each([&](std::uint32_t slot, const Body& body) { add(slot, body.articulate, body.count); });
  a.value(b.result()), a.value(c.result());
  return a.result();
}

void refuse_null(std::string_view kind) {
  throw StaleIdError(text("this ", kind, " id is null: it never named a ", kind));
}

void refuse_stale(std::string_view kind, std::uint32_t slot, std::optional<std::uint32_t> survivor) {
  if (survivor) throw StaleIdError(text(kind, " ", slot, " is gone: it was absorbed by ", kind, " ", *survivor));
  throw StaleIdError(text(kind, " ", slot, " is gone: it was destroyed"));
}

}  // namespace iota::model
