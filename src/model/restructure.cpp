// SPDX-License-Identifier: Apache-2.0
#include "model/restructure.h"
#include "model/solid.h"

#include <iota/reports.h>

#include <algorithm>
#include <stdexcept>
#include <string>
#include <utility>

namespace iota::model {

namespace {

/// Merging two rings would put two particles of one body at one place, which is impossible for a rigid body.
void require_no_shared_body(const Structure& model, std::uint32_t ring_a, std::uint32_t ring_b,
                            std::uint32_t except_body) {
  model.for_each_in_ring(ring_a, [&](std::uint32_t a) {
    model.for_each_in_ring(ring_b, [&](std::uint32_t b) {
      const std::uint32_t body = model.particles[a].body;
      if (body == model.particles[b].body && body != except_body)
        throw std::invalid_argument("combine: body " + std::to_string(body) + " has particles (" + std::to_string(a) +
                                    ", " + std::to_string(b) +
                                    ") in both rings, and a rigid body cannot have both in one place; combine or "
                                    "separate those two first");
    });
  });
}

bool is_fixed(const Structure& model, std::uint32_t ring, std::uint32_t except_body = none) {
  bool fixed = false;
  model.for_each_in_ring(ring, [&](std::uint32_t p) {
    const std::uint32_t body = model.particles[p].body;
    const BodyKind kind = model.bodies[body].kind;
    fixed = fixed || (body != except_body && (kind == BodyKind::static_ || kind == BodyKind::scripted));
  });
  return fixed;
}

/// All particles of `from` join `into`; position and velocity become the mass-weighted means, unless a nail or a fixed
/// body determines them.
Edit merge_rings(Structure& model, std::uint32_t into, std::uint32_t from) {
  Ring& r = model.rings[into];
  const Ring s = model.rings[from];
  double share = 0;  // weight of `from` in the means, if they differ
  if (r.position != s.position || r.velocity != s.velocity) {
    const double m_r = model.ring_mass(into), m_s = model.ring_mass(from);
    share = m_r + m_s > 0 ? m_s / (m_r + m_s) : 0.5;
  }
  Edit edit{r.position != s.position, r.velocity != s.velocity || r.nailed || s.nailed};
  const bool stays = r.nailed || is_fixed(model, into);  // the first one's nail wins
  const bool replaces = !stays && (s.nailed || is_fixed(model, from));
  if (replaces)
    r.nailed = s.nailed, r.position = s.position;
  else if (!stays)
    r.position += share * (s.position - r.position);
  r.velocity += share * (s.velocity - r.velocity);
  model.ring_merged(into, from, replaces);
  for (std::uint32_t left = s.count; left > 0; --left) {  // the ring `from` is destroyed with its last particle
    const std::uint32_t moved = model.rings[from].first;
    model.take_from_ring(moved);
    model.add_to_ring(moved, into);
  }
  return edit;
}

/// q, of the same body as p, becomes p: mass, bonds and inertia pairs. Both must be in one ring already or q alone in its.
void absorb_particle(Structure& model, std::uint32_t p, std::uint32_t q, RestructureReport& report) {
  if (model.particles[q].inactive != model.particles[p].inactive)
    model.particles[q].mass *= model.particles[p].inactive ? inactive_share : 1 / inactive_share;
  model.particles[p].mass += model.particles[q].mass;
  if (const double* const force = model.fuses.find(q))  // the weaker one counts
    model.set_fuse(p, model.fuses.has(p) ? std::min(*force, model.fuses[p]) : *force);
  model.absorb_uses(q, p);
  model.acting_changed(p);
  model.move_twins(q, p);
  const ParticleId retired = model.particles.id(q), survivor = model.particles.id(p);
  model.record_survivor(retired, survivor);
  report.absorbed_particles.push_back({retired, survivor});
  model.remove_particle(q);
}

/// The kind of the rigid union of two bodies, in either order: static or scripted if one of them is; inactive only if
/// both are inactive, and resting only if both are resting.
BodyKind kind_of_union(BodyKind a, BodyKind b) {
  for (const BodyKind kind : {BodyKind::static_, BodyKind::scripted, BodyKind::dynamic})
    if (a == kind || b == kind) return kind;
  return a == b ? a : BodyKind::dynamic;
}

/// Damping is averaged by mass.
double damping_of_union(const Structure& model, std::uint32_t a, std::uint32_t b) {
  const double of_a = model.body_damping[a], of_b = model.body_damping[b];
  if (of_a == of_b) return of_a;
  const double mass_a = model.body_mass(a), mass_b = model.body_mass(b);
  return (mass_a * of_a + mass_b * of_b) / (mass_a + mass_b);
}

const char* name_of(BodyKind kind) {
  switch (kind) {
    case BodyKind::dynamic: return "dynamic";
    case BodyKind::static_: return "static";
    case BodyKind::scripted: return "scripted";
    case BodyKind::inactive: return "inactive";
    case BodyKind::resting: return "resting";
  }
  return "";
}

/// Sets the kind of the body with all particles of the union. Notes if one of the two had another kind.
void unite_kinds(Structure& model, std::uint32_t body, BodyKind of_a, BodyKind of_b, RestructureReport& report) {
  if (of_a == of_b) return;
  const BodyKind kind = kind_of_union(of_a, of_b);
  const bool acted = model.bodies[body].kind != BodyKind::inactive;
  model.bodies[body].kind = kind;
  if (!acted) model.for_each_particle_of(body, [&](std::uint32_t p) { model.acting_changed(p); });
  if (is_free(of_a) && is_free(of_b)) return;
  const auto [first, second] = std::minmax(of_a, of_b);
  report.notes.push_back("body " + std::to_string(body) + " is " + name_of(kind) +
                         " now: one of the two bodies that it was "
                         "combined of was " +
                         name_of(first) + ", the other " + name_of(second));
}

/// Moves all particles of body b to body a; if both have one in the same ring, one absorbs the other. The cost is that
/// of b, unless a needs another basis.
Edit absorb_body(Structure& model, std::uint32_t a, std::uint32_t b, RestructureReport& report) {
  const BodyKind kind_a = model.bodies[a].kind, kind_b = model.bodies[b].kind;
  const BodyKind kind = kind_of_union(kind_a, kind_b);
  for (const std::uint32_t body : {a, b})
    if (lacks_volume(model, body) && kind != BodyKind::static_ && kind != BodyKind::scripted)
      throw std::invalid_argument(
          "combine: body " + std::to_string(body) +
          " is a half-space or an open mesh, which has no mass, so that what is combined with it cannot move; "
          "make it static or scripted first");
  const double damping = damping_of_union(model, a, b);
  // The material of what touches nothing is not taken by what touches by the usual one: that would fall through the floor.
  if (!model.materials.has(a) && model.materials.has(b) && (model.material(b) || !model.material(a))) {
    const Material material = model.materials.at(b);
    model.materials.make(a) = material;
  }
  const BodyKind kind_before = kind_of_union(model.bodies[a].kind_before, model.bodies[b].kind_before);
  // Inertia pairs and solids move with their particles, so the lists are detached before the particles leave.
  const std::uint32_t pairs = std::exchange(model.bodies[b].first_inertia, none);
  const std::uint32_t solids = std::exchange(model.bodies[b].first_solid, none);
  std::uint32_t* last_pair = nullptr;
  for (std::uint32_t i = pairs; i != none; i = model.inertia_pairs[i].next) {
    model.inertia_pairs[i].body = a;
    last_pair = &model.inertia_pairs[i].next;
  }
  for (std::uint32_t s = solids; s != none; s = model.solids[s].next) model.solids[s].body = a;
  std::vector<std::uint32_t> moved;
  const std::uint32_t count_before = model.bodies[a].count;
  while (model.bodies[b].first != none) {
    const std::uint32_t particle = model.bodies[b].first;
    std::uint32_t twin = none;
    model.for_each_in_ring(model.particles[particle].ring, [&](std::uint32_t other) {
      if (model.particles[other].body == a) twin = other;
    });
    if (twin == none) {
      model.take_from_body(particle);
      model.add_to_body(particle, a);
      model.acting_changed(particle);
      moved.push_back(particle);
      continue;
    }
    for (std::uint32_t i = pairs; i != none; i = model.inertia_pairs[i].next) {
      InertiaPair& pair = model.inertia_pairs[i];
      if (pair.p == particle) pair.p = twin;
      if (pair.q == particle) pair.q = twin;
    }
    for (std::uint32_t s = solids; s != none; s = model.solids[s].next)
      std::replace(model.solids[s].points.begin(), model.solids[s].points.end(), particle, twin);
    const Twin absorbed{
        .particle = twin, .part = model.particles[particle].part, .mass = model.particles[particle].mass};
    absorb_particle(model, twin, particle, report);
    model.add_twin(absorbed);
  }
  if (last_pair) *last_pair = std::exchange(model.bodies[a].first_inertia, pairs);
  if (solids != none) {
    std::uint32_t* last_solid = &model.bodies[a].first_solid;  // a's first one still defines the frame
    while (*last_solid != none) last_solid = &model.solids[*last_solid].next;
    *last_solid = solids;
  }
  model.join_articulates(model.bodies[a].articulate, model.bodies[b].articulate);
  const BodyId retired = model.bodies.id(b), survivor = model.bodies.id(a);
  model.record_survivor(retired, survivor);
  report.absorbed_bodies.push_back({retired, survivor});
  model.remove_body(b);
  model.set_damping(a, damping);
  model.bodies[a].kind_before = kind_before;
  unite_kinds(model, a, kind_a, kind_b, report);
  if (!carry_by_basis(model, a, count_before, moved)) model.rebuild_basis(a);
  model.mark_body(a);
  return {false, true};
}

std::uint32_t massive_count(const Structure& model, std::uint32_t body) {
  std::uint32_t count = 0;
  model.for_each_particle_of(body, [&](std::uint32_t p) { count += !model.particles[p].is_marker(); });
  return count;
}

/// q can leave the body of p only with its own mass, and some mass must remain.
void require_mass_on_its_own(const Structure& model, std::uint32_t p, std::uint32_t q) {
  if (model.particles[q].is_marker())
    throw std::invalid_argument("separate: particle " + std::to_string(q) +
                                " is massless and cannot leave the body that carries it; give it a mass first");
  if (model.particles[p].is_marker())
    throw std::invalid_argument("separate: particle " + std::to_string(p) +
                                " is massless, and what leaves a body is hinged to one of its massive particles");
  if (massive_count(model, model.particles[p].body) == 1)
    throw std::invalid_argument("separate: particle " + std::to_string(q) +
                                " is the only one with mass in its body; give another one a mass first");
}

/// The bodies of the other members of a particle's ring.
std::vector<std::uint32_t> ring_neighbors(const Structure& model, std::uint32_t particle) {
  std::vector<std::uint32_t> bodies;
  model.for_each_in_ring(model.particles[particle].ring, [&](std::uint32_t other) {
    if (other != particle) bodies.push_back(model.particles[other].body);
  });
  return bodies;
}

/// The markers of a body that are no longer in the span of its massive particles.
std::vector<ParticleId> stray_markers(const Structure& model, std::uint32_t body) {
  std::vector<ParticleId> strays;
  if (model.bodies[body].rank == 4) return strays;  // spans all places
  model.for_each_particle_of(body, [&](std::uint32_t p) {
    if (model.particles[p].is_marker() && !model.spans(body, model.position(p)))
      strays.push_back(model.particles.id(p));
  });
  return strays;
}

/// Call it after all hinges are restored, as it splits the present articulates.
void destroy_strays(Structure& model, std::uint32_t body, const std::vector<ParticleId>& strays,
                    std::vector<std::string>& notes) {
  for (const ParticleId id : strays)
    if (model.particles.contains(id)) destroy_particle(model, id.slot);
  if (!strays.empty())
    notes.push_back("body " + std::to_string(body) + " is too flat now to carry " + std::to_string(strays.size()) +
                    " massless particles: they are gone with what was joined to them");
}

}  // namespace

void destroy_stray_markers(Structure& model, std::uint32_t body, std::vector<std::string>& notes) {
  destroy_strays(model, body, stray_markers(model, body), notes);
}

void require_can_meet(const Structure& model, std::uint32_t p, std::uint32_t q) {
  const std::uint32_t a = model.particles[p].ring, b = model.particles[q].ring;
  const std::uint32_t body = model.particles[p].body;  // in one body, q leaves the ring that is moved to p
  const std::uint32_t leaving = body == model.particles[q].body ? body : none;
  const bool fixed = is_fixed(model, b, leaving), held = fixed || model.rings[b].nailed;
  const bool stuck = (is_fixed(model, a) && held) || (fixed && model.is_pinned(a));
  if (stuck && model.rings[a].position != model.rings[b].position)
    throw std::invalid_argument("combine: particles " + std::to_string(p) + " and " + std::to_string(q) +
                                " are apart, and static or scripted bodies and nails hold both; release or move one");
}

Edit combine_particles(Structure& model, std::uint32_t p, std::uint32_t q, RestructureReport& report) {
  if (p == q) return {};
  const std::uint32_t body_p = model.particles[p].body, body_q = model.particles[q].body;
  const std::uint32_t ring_p = model.particles[p].ring, ring_q = model.particles[q].ring;
  report.changed = true;
  report.closed_distance = norm(model.position(q) - model.position(p));

  if (body_p == body_q) {  // same body: the latter is removed
    if (ring_p != ring_q) require_no_shared_body(model, ring_p, ring_q, body_p);
    if (model.rings[ring_q].count > 1) require_can_meet(model, p, q);
    // The body keeps its shape without q; bodies that were hinged to q are moved to p.
    const bool q_was_hinged = model.rings[ring_q].count > 1;
    const Vec3 momentum = model.particles[p].mass * model.velocity(p) + model.particles[q].mass * model.velocity(q);
    const double mass = model.particles[p].mass + model.particles[q].mass;
    Edit edit{false, true};
    const Vec3 velocity = mass > 0 ? (1 / mass) * momentum : model.velocity(p);
    const Ring left_behind = model.rings[ring_q];
    if (model.rings[ring_p].count == 1) model.rings[ring_p].velocity = velocity;
    if (!q_was_hinged && left_behind.nailed && !model.rings[ring_p].nailed) {
      model.rings[ring_p].nailed = left_behind.nailed;
      model.ring_merged(ring_p, ring_q, true);
      edit.moved = true;
    }
    absorb_particle(model, p, q, report);
    model.rebuild_basis(body_p);
    const std::vector<ParticleId> strays = stray_markers(model, body_p);  // by its shape before any move
    if (q_was_hinged && ring_p != ring_q) edit = merge_rings(model, ring_p, ring_q);
    model.mark_body(body_p);
    destroy_strays(model, body_p, strays, report.notes);
    return edit;
  }

  if (ring_p == ring_q) {  // a hinge: made rigid
    return absorb_body(model, body_p, body_q, report);
  }

  require_no_shared_body(model, ring_p, ring_q, none);
  require_can_meet(model, p, q);
  model.mark_ring(ring_q);
  const Edit edit = merge_rings(model, ring_p, ring_q);
  model.join_articulates(model.bodies[body_p].articulate, model.bodies[body_q].articulate);
  model.mark_ring(ring_p);
  return edit;
}

Edit combine_bodies(Structure& model, std::uint32_t a, std::uint32_t b, RestructureReport& report) {
  if (a == b) return {};
  report.changed = true;
  return absorb_body(model, a, b, report);
}

Edit separate_particles(Structure& model, std::uint32_t p, std::uint32_t q, RestructureReport& report) {
  const std::uint32_t body = model.particles[p].body;
  if (p == q) {  // one particle: a second one at the same place
    model.particles[p].mass /= 2;
    const std::uint32_t twin = model.make_particle(body, model.position(p), model.particles[p].mass, model.velocity(p));
    model.particles[twin].inactive = model.particles[p].inactive;
    model.rebuild_basis(body);
    model.mark_body(body);
    report.changed = true;
    report.created_particles.push_back(model.particles.id(twin));
    return {};
  }

  if (body == model.particles[q].body) {  // one body: q leaves it and is hinged to p
    require_mass_on_its_own(model, p, q);
    report.changed = true;
    report.closed_distance = norm(model.position(q) - model.position(p));
    std::vector<std::uint32_t> neighbors = ring_neighbors(model, q);
    neighbors.push_back(body);
    const Vec3 position = model.position(q), velocity = model.velocity(q);
    model.take_from_ring(q);
    model.take_from_body(q);
    model.rebuild_basis(body);
    const std::vector<ParticleId> strays = stray_markers(model, body);
    const std::uint32_t own = model.make_body(model.bodies[body].kind, model.body_damping[body]);
    model.radii.copy(body, own), model.materials.copy(body, own), model.colors.copy(body, own);
    model.particles[q].part = model.bodies.id(own);
    Ring ring;
    ring.position = position, ring.velocity = velocity;
    model.add_to_ring(q, model.rings.create(ring).slot);
    model.add_to_body(q, own);
    model.rebuild_basis(own);
    const Edit edit = merge_rings(model, model.particles[p].ring, model.particles[q].ring);
    model.join_articulates(model.bodies[body].articulate, model.bodies[own].articulate);
    model.mark_body(body);
    split_where_apart(model, neighbors);
    destroy_strays(model, body, strays, report.notes);
    report.created_bodies.push_back(model.bodies.id(own));
    return {edit.moved, true};
  }

  const std::uint32_t ring = model.particles[p].ring;
  if (ring == model.particles[q].ring) {  // hinged: q leaves the ring
    report.changed = true;
    Ring own;
    own.position = model.rings[ring].position, own.velocity = model.rings[ring].velocity;
    model.mark_ring(ring);
    model.take_from_ring(q);
    model.add_to_ring(q, model.rings.create(own).slot);
    model.mark_ring(model.particles[q].ring, ring);
    split_where_apart(model, std::array{body, model.particles[q].body});
    return {};
  }

  report.changed = model.call_off(p, q);  // not met yet
  return {};
}

void split_where_apart(Structure& model, std::span<const std::uint32_t> bodies) {
  for (std::size_t i = 0; i < bodies.size(); ++i)
    for (std::size_t j = i + 1; j < bodies.size(); ++j)
      if (model.bodies[bodies[i]].articulate == model.bodies[bodies[j]].articulate)
        model.split_articulate(bodies[i], bodies[j]);
}

void destroy_particle(Structure& model, std::uint32_t particle) {
  const std::uint32_t body = model.particles[particle].body;
  const bool massive = !model.particles[particle].is_marker();
  if (massive && massive_count(model, body) == 1) return destroy_body(model, body);
  model.drop_uses(particle);
  std::vector<std::uint32_t> apart = ring_neighbors(model, particle);
  model.remove_particle(particle);
  model.mark_body(body);
  apart.push_back(body);
  split_where_apart(model, apart);
  if (!massive) return;
  model.rebuild_basis(body);
  destroy_stray_markers(model, body, model.notes);
}

void destroy_body(Structure& model, std::uint32_t body) {
  while (model.bodies[body].first != none) {
    const std::uint32_t particle = model.bodies[body].first;
    model.drop_uses(particle);
    std::vector<std::uint32_t> apart = ring_neighbors(model, particle);
    model.remove_particle(particle);
    apart.push_back(body);
    split_where_apart(model, apart);
  }
  model.remove_body(body);
}

}  // namespace iota::model
