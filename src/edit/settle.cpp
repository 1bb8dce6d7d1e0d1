// SPDX-License-Identifier: Apache-2.0
#include "edit/settle.h"

#include "base/sort_unique.h"
#include "base/text.h"
#include "ingredient/quantities.h"
#include "math/mat3.h"
#include "model/solid.h"

#include <iota/reports.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

namespace iota::edit {

namespace {

/// Each slot once, in order. `slots`: how many there are.
void sort_unique(std::vector<std::uint32_t>& list, std::size_t slots) {
  constexpr std::size_t many = 64;  // of the slots one in so many: marking all of them is then quicker than sorting
  if (list.size() * many < slots) return iota::sort_unique(list);
  std::vector<std::uint8_t> is_in(slots, 0);
  for (const std::uint32_t slot : list) is_in[slot] = 1;
  list.clear();
  for (std::uint32_t slot = 0; slot < slots; ++slot)
    if (is_in[slot]) list.push_back(slot);
}

/// Energy and momenta of these bodies and the springs between them; destroyed bodies are skipped.
Conserved conserved(const model::Model& model, std::span<const std::uint32_t> bodies) {
  return {ingredient::calc_energies(model, bodies), ingredient::calc_momenta(model, bodies)};
}

/// Adds the bodies tied by bonds and constraints: if one of these moves, the energies of the others change.
void add_tied(const model::Model& model, std::vector<std::uint32_t>& bodies) {
  sort_unique(bodies, model.bodies.slot_count());
  if (!model.has_ties()) return;
  for (std::size_t i = 0, count = bodies.size(); i < count; ++i)
    model.for_each_particle_of(bodies[i], [&](std::uint32_t p) {
      model.visit_tied(p, model::Model::Ties::all, [&](std::uint32_t tied) { bodies.push_back(tied); });
    });
  sort_unique(bodies, model.bodies.slot_count());
}

/// Some bodies, those at their points, and those that are tied to these.
std::vector<std::uint32_t> bodies_around(const model::Model& model, std::span<const std::uint32_t> bodies) {
  std::vector<std::uint32_t> found;
  for (const std::uint32_t body : bodies)
    model.for_each_particle_of(body, [&](std::uint32_t p) {
      model.for_each_in_ring(model.particles[p].ring,
                             [&](std::uint32_t q) { found.push_back(model.particles[q].body); });
    });
  add_tied(model, found);
  return found;
}

/// The changes by moving some rings.
Conserved calc_change(model::Model& model, island::MovedRings& moved) {
  std::vector<std::uint32_t> bodies;
  for (const auto& state : moved.before)
    model.for_each_in_ring(state.ring, [&](std::uint32_t p) { bodies.push_back(model.particles[p].body); });
  add_tied(model, bodies);
  Conserved change = conserved(model, bodies);
  moved.exchange(model);
  change.add(conserved(model, bodies), -1);
  moved.exchange(model);
  return change;
}

/// Whether all islands of the bodies have positions that satisfy their rows.
bool project(Editor& e, std::span<const std::uint32_t> bodies, bool positions, island::MovedRings& moved) {
  bool met = true;
  std::vector<std::uint32_t> articulates;
  for (const std::uint32_t body : bodies) articulates.push_back(e.model.bodies[body].articulate);
  e.islands.for_each_of(e.model, articulates,
                        [&](island::Island& island) { met = island.settle(e.model, bodies, positions, moved) && met; });
  return met;
}

/// Signed, times six.
double calc_volume(const std::array<Vec3, 4>& x) { return dot(x[1] - x[0], cross(x[2] - x[0], x[3] - x[0])); }

bool is_mirrored(const model::Model& model, const BodyBefore& before) {
  std::array<Vec3, 4> now;
  for (int i = 0; i < 4; ++i) {
    if (!model.particles.is_alive(before.basis[i])) return false;
    now[i] = model.position(before.basis[i]);
  }
  return calc_volume(now) * calc_volume(before.places) < 0;
}

/// Puts a body's free points where the unmirrored body is nearest to its points, first of all to those that it shares
/// or that are pinned.
void fit(model::Model& model, const BodyBefore& earlier, island::MovedRings& moved) {
  const model::Body& body = model.bodies[earlier.body];
  if (body.basis != earlier.basis) return;  // absorbed meanwhile
  struct Point {
    std::uint32_t ring;
    Vec3 before, now;
    double weight;
  };
  std::vector<Point> points;
  Vec3 before, now;
  double weights = 0;
  model.for_each_particle_of(earlier.body, [&](std::uint32_t p) {
    Point point{model.particles[p].ring, {}, model.position(p), 1};
    const std::array<double, 4> shares = model.weights(p);
    for (int i = 0; i < 4; ++i) point.before += shares[i] * earlier.places[i];
    if (model.rings[point.ring].count == 1 && !model.is_pinned(point.ring)) point.weight = 1e-3;
    before += point.weight * point.before, now += point.weight * point.now, weights += point.weight;
    points.push_back(point);
  });
  before = (1 / weights) * before, now = (1 / weights) * now;
  Mat3 products;
  for (const Point& p : points) products += p.weight * Mat3::outer(p.now - now, p.before - before);
  const Mat3 turn = nearest_rotation(products);
  for (const Point& p : points)
    if (p.weight < 1) moved.put(model, p.ring, now + turn * (p.before - before), model.rings[p.ring].velocity);
}

/// Projects positions and velocities of the islands of the bodies. Returns the changes.
///
/// A projection finds the nearest positions with the right distances, which a mirror image has too: with one point of a
/// solid taken far away, every second solid became its own. Those are fitted to their points, and projected again.
Conserved settle(Editor& e, std::span<const std::uint32_t> edited, bool positions, std::span<const BodyBefore> general,
                 RestructureReport& report) {
  constexpr int most_attempts = 4;  // a solid that is fitted may mirror its neighbor
  island::MovedRings moved;
  e.islands.update(e.model, e.parallel, moved);
  std::vector<std::uint32_t> bodies(edited.begin(), edited.end());
  for (int attempt = 1;; ++attempt) {
    island::MovedRings projected;
    const bool met = project(e, bodies, positions, projected);
    std::vector<const BodyBefore*> mirrored;
    if (positions && attempt < most_attempts)
      for (const BodyBefore& body : general)
        if (is_mirrored(e.model, body)) mirrored.push_back(&body);
    if (mirrored.empty()) {
      moved.before.insert(moved.before.end(), projected.before.begin(), projected.before.end());
      if (!met) {
        report.remaining_gap = ingredient::worst_gap(e.model);
        report.notes.push_back(text("no position of the bodies lets the combined particles meet exactly; ",
                                    report.remaining_gap, " m remain, shared by the constraints"));
      }
      return calc_change(e.model, moved);
    }
    projected.exchange(e.model);
    for (const BodyBefore* before : mirrored) fit(e.model, *before, moved), bodies.push_back(before->body);
  }
}

/// Displacements and moved masses change momenta; a rigid motion of all bodies connected to these compensates that
/// without violating any constraint, and is added to `change`. Returns the former values; nothing if something is
/// pinned, as the world takes momenta then.
std::optional<Conserved> give_back_momenta(Editor& e, std::span<const std::uint32_t> bodies, Conserved& change) {
  model::Model& model = e.model;
  for (const std::uint32_t body : bodies) {  // usually known immediately for large articulates
    const std::uint32_t articulate = model.bodies[body].articulate;
    const island::Island* const island = e.islands.of_articulate(articulate);
    if (island && island->is_pinned(model, articulate)) return std::nullopt;
  }
  std::vector<std::uint32_t> members = model.tied_bodies(bodies, model::Model::Ties::constraints), rings;
  std::erase_if(members, [&](std::uint32_t b) { return model.bodies[b].kind == BodyKind::inactive; });
  for (const std::uint32_t b : members) {
    bool pinned = model.is_tied_to_world(b);
    model.for_each_particle_of(b,
                               [&](std::uint32_t p) { pinned = pinned || model.is_pinned(model.particles[p].ring); });
    if (pinned) return std::nullopt;
  }
  const std::vector<std::uint32_t> affected = model.tied_bodies(bodies);
  const Conserved settled = conserved(model, affected);
  const Conserved before = Conserved(settled).add(change, -1);
  double mass = 0;
  Vec3 first_moment;
  for (const std::uint32_t b : members)
    model.for_each_particle_of(b, [&](std::uint32_t p) {
      rings.push_back(model.particles[p].ring);
      mass += model.particles[p].mass;
      first_moment += model.particles[p].mass * model.position(p);
    });
  if (!(mass > 0)) return std::nullopt;
  sort_unique(rings, model.rings.slot_count());

  const Vec3 center = (1 / mass) * first_moment;
  Mat3 inertia;
  for (const std::uint32_t b : members) {
    model.for_each_particle_of(
        b, [&](std::uint32_t p) { inertia += point_inertia(model.particles[p].mass, model.position(p) - center); });
    model.for_each_inertia_of(b, [&](std::uint32_t i) {
      const model::InertiaPair& pair = model.inertia_pairs[i];
      inertia += point_inertia(pair.inertia, model.position(pair.p) - model.position(pair.q));
    });
  }
  const double trace = inertia.m[0][0] + inertia.m[1][1] + inertia.m[2][2];
  const bool is_a_point = !(trace > 1e-24 * mass * dot(center, center));  // only round-off
  for (int pass = 0; pass < 2; ++pass) {  // the second removes the round-off of the first
    const Conserved now = conserved(model, affected);
    const Vec3 lost = before.momenta.linear - now.momenta.linear;
    const Vec3 lost_spin = before.momenta.angular - now.momenta.angular - cross(center, lost);
    Vec3 turn = solve_semidefinite(inertia, lost_spin);
    // Bodies that were contracted nearly to a point would need an extreme spin to keep their angular momentum.
    if (is_a_point || 0.5 * dot(turn, lost_spin) > 3 * before.energies.kinetic) turn = {};
    for (const std::uint32_t ring : rings)
      model.rings[ring].velocity += (1 / mass) * lost + cross(turn, model.rings[ring].position - center);
  }
  change.add(conserved(model, affected)).add(settled, -1);
  return before;
}

}  // namespace

Conserved& Conserved::add(const Conserved& other, double sign) {
  energies.kinetic += sign * other.energies.kinetic, energies.potential += sign * other.energies.potential;
  momenta.linear += sign * other.momenta.linear, momenta.angular += sign * other.momenta.angular;
  return *this;
}

Restructuring::Restructuring(Editor& editor, std::span<const std::uint32_t> bodies, Kind kind,
                             RestructureReport& report)
    : editor_(editor),
      report_(report),
      bodies_{bodies.front(), bodies.back()},
      body_count_(bodies.size()),
      kind_(kind),
      attachments_(editor.model, bodies) {
  report.articulates_before = editor.model.articulate_count();
  if (kind != Kind::moving) return;
  around_ = bodies_around(editor.model, bodies);
  before_ = conserved(editor.model, around_);
  for (const std::uint32_t b : around_) {
    const model::Body& body = editor.model.bodies[b];
    if (body.rank < 4 || !model::is_free(body.kind)) continue;
    BodyBefore& before = bodies_before_.emplace_back(BodyBefore{b, body.basis, {}});
    for (int i = 0; i < 4; ++i) before.places[i] = editor.model.position(body.basis[i]);
  }
}

void Restructuring::finish(const model::Edit& owed) {
  model::Model& model = editor_.model;
  if (report_.changed) {
    std::array<std::uint32_t, 2> left{};  // an array, since a vector would cost more than most edits
    const auto end = std::copy_if(bodies_.begin(), bodies_.begin() + static_cast<std::ptrdiff_t>(body_count_),
                                  left.begin(), [&](std::uint32_t body) { return model.bodies.is_alive(body); });
    if (report_.created_bodies.empty())
      ingredient::clean_up(model, {left.begin(), end}, report_.notes);
    else
      ingredient::clean_up(model, with_created(edited()), report_.notes);
    attachments_.reattach(model);
    if (kind_ != Kind::transient) editor_.structure_changed();
  }
  report_.articulates_after = model.articulate_count();
  report_.structure_version = model.structure_version;
  if (kind_ == Kind::moving && report_.changed) settle_and_measure(owed);
}

void settle_batch(Editor& e, RestructureReport& report) {
  model::Model& model = e.model;
  std::vector<std::uint32_t> bodies;
  for (const auto& absorbed : report.absorbed_bodies)
    if (const auto body = model.survivor_of(absorbed.survivor)) bodies.push_back(body->slot);
  sort_unique(bodies, model.bodies.slot_count());
  if (bodies.empty()) return;
  const Conserved change = settle(e, bodies, false, {}, report);
  report.energy_change += change.energies.total();
  report.momentum_change += change.momenta.linear;
  report.angular_momentum_change += change.momenta.angular;
}

std::vector<std::uint32_t> Restructuring::with_created(std::span<const std::uint32_t> known) const {
  std::vector<std::uint32_t> bodies(known.begin(), known.end());
  for (const BodyId body : report_.created_bodies) bodies.push_back(body.slot);
  std::erase_if(bodies, [&](std::uint32_t body) { return !editor_.model.bodies.is_alive(body); });
  return bodies;
}

void Restructuring::settle_and_measure(const model::Edit& owed) {
  Conserved change = conserved(editor_.model, with_created(around_));
  change.add(before_, -1);
  std::optional<Conserved> before = before_;  // of everything that may have changed; nothing if something is pinned
  if (owed.moved || owed.velocity_dirty) {
    const std::vector<std::uint32_t> changed = with_created(edited());
    change.add(settle(editor_, changed, owed.moved, bodies_before_, report_));
    before = give_back_momenta(editor_, changed, change);
  }
  report_.energy_change = change.energies.total();
  report_.momentum_change = change.momenta.linear;
  report_.angular_momentum_change = change.momenta.angular;
  const double spin_change = norm(report_.angular_momentum_change);
  if (before && spin_change > 1e-9 * (norm(before->momenta.angular) + 1e-3 * spin_change))
    report_.notes.push_back(
        "the bodies that are left (a point, a rod, or bodies almost in one place) cannot carry all of the angular "
        "momentum; angular_momentum_change tells the rest");
}

}  // namespace iota::edit
