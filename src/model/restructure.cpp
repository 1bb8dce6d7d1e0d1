// SPDX-License-Identifier: Apache-2.0
#include "model/restructure.h"
#include "model/solid.h"

#include <algorithm>
#include <stdexcept>
#include <string>
#include <utility>

namespace iota::model {

namespace {

/// Merging two rings would put two particles of one body in one place, which no rigid body can.
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

/// All particles of `from` join `into`; position and velocity become the mass-weighted means, unless a nail or a body that
/// does not give way decides.
Edit merge_rings(Structure& model, std::uint32_t into, std::uint32_t from) {
  Ring& r = model.rings[into];
  const Ring s = model.rings[from];
  const double m_r = model.ring_mass(into), m_s = model.ring_mass(from),
               share = m_r + m_s > 0 ? m_s / (m_r + m_s) : 0.5;
  Edit edit{r.position != s.position, r.velocity != s.velocity || r.nailed || s.nailed};
  const bool stays = r.nailed || is_fixed(model, into);  // the first one's nail wins
  const bool replaces = !stays && (s.nailed || is_fixed(model, from));
  if (replaces)
    r.nailed = s.nailed, r.position = s.position;
  else if (!stays)
    r.position += share * (s.position - r.position);
  r.velocity += share * (s.velocity - r.velocity);
  model.ring_merged(into, from, replaces);
  for (std::uint32_t left = s.count; left > 0; --left) {  // the last one takes the ring `from` with it
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
  model.twins.for_each([&](std::uint32_t, Twin& t) {
    if (t.particle == q) t.particle = p;
  });
  const ParticleId retired = model.particles.id(q), survivor = model.particles.id(p);
  model.record_survivor(retired, survivor);
  report.absorbed_particles.push_back({retired, survivor});
  model.remove_particle(q);
}

/// All particles of body b become body a's; where both have one in the same ring, one absorbs the other.
void absorb_body(Structure& model, std::uint32_t a, std::uint32_t b, RestructureReport& report) {
  const BodyKind kind = model.bodies[a].kind;
  if (is_endless(model, b) && kind != BodyKind::static_ && kind != BodyKind::scripted)
    throw std::invalid_argument("combine: body " + std::to_string(b) + " is a half-space, which has no mass, so body " +
                                std::to_string(a) + " could not move with it; name body " + std::to_string(b) +
                                " first, or make body " + std::to_string(a) + " static");
  // Inertia pairs move with their particles, so take the list away before the particles leave.
  const std::uint32_t pairs = model.bodies[b].first_inertia;
  model.bodies[b].first_inertia = none;
  for (std::uint32_t last = pairs; last != none; last = model.inertia_pairs[last].next) {
    model.inertia_pairs[last].body = a;
    if (model.inertia_pairs[last].next != none) continue;
    model.inertia_pairs[last].next = model.bodies[a].first_inertia;
    model.bodies[a].first_inertia = pairs;
    break;
  }
  std::uint32_t* last_solid = &model.bodies[a].first_solid;  // a's first one goes on giving the frame
  while (*last_solid != none) last_solid = &model.solids[*last_solid].next;
  *last_solid = std::exchange(model.bodies[b].first_solid, none);
  model.for_each_solid_of(a, [&](std::uint32_t s) { model.solids[s].body = a; });
  const auto twin_in = [&](std::uint32_t body, std::uint32_t particle) {
    std::uint32_t twin = none;
    model.for_each_in_ring(model.particles[particle].ring, [&](std::uint32_t other) {
      if (model.particles[other].body == body) twin = other;
    });
    return twin;
  };
  while (model.bodies[b].first != none) {
    const std::uint32_t moved = model.bodies[b].first;
    const std::uint32_t twin = twin_in(a, moved);
    model.take_from_body(moved);
    model.add_to_body(moved, a);
    model.acting_changed(moved);
    if (twin == none) continue;
    model.for_each_inertia_of(a, [&](std::uint32_t i) {
      InertiaPair& pair = model.inertia_pairs[i];
      if (pair.p == moved) pair.p = twin;
      if (pair.q == moved) pair.q = twin;
    });
    model.for_each_solid_of(a, [&](std::uint32_t s) {
      std::replace(model.solids[s].points.begin(), model.solids[s].points.end(), moved, twin);
    });
    const Twin absorbed{twin, 0, model.particles[moved].part, model.particles[moved].mass};
    absorb_particle(model, twin, moved, report);
    model.twins.create(absorbed);
  }
  model.join_articulates(model.bodies[a].articulate, model.bodies[b].articulate);
  const BodyId retired = model.bodies.id(b), survivor = model.bodies.id(a);
  model.record_survivor(retired, survivor);
  report.absorbed_bodies.push_back({retired, survivor});
  model.remove_body(b);
  model.rebuild_basis(a);
  model.touch_body(a);
}

std::uint32_t massive_count(const Structure& model, std::uint32_t body) {
  std::uint32_t count = 0;
  model.for_each_particle_of(body, [&](std::uint32_t p) { count += !model.particles[p].is_marker(); });
  return count;
}

/// q can leave the body of p only with mass of its own, and must leave some behind.
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

/// The bodies at the other members of a particle's ring.
std::vector<std::uint32_t> ring_neighbors(const Structure& model, std::uint32_t particle) {
  std::vector<std::uint32_t> bodies;
  model.for_each_in_ring(model.particles[particle].ring, [&](std::uint32_t other) {
    if (other != particle) bodies.push_back(model.particles[other].body);
  });
  return bodies;
}

/// The markers of a body that its massive particles do not reach any more.
std::vector<ParticleId> stray_markers(const Structure& model, std::uint32_t body) {
  std::vector<ParticleId> strays;
  model.for_each_particle_of(body, [&](std::uint32_t p) {
    if (model.particles[p].is_marker() && !model.spans(body, model.position(p)))
      strays.push_back(model.particles.id(p));
  });
  return strays;
}

/// Call it after everything else is hinged again: it splits articulates as they are.
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
  const std::uint32_t body = model.particles[p].body;  // of one body, q leaves the ring that is brought to p
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
      model.rings[ring_p].nailed = 1;
      model.ring_merged(ring_p, ring_q, true);
      edit.moved = true;
    }
    absorb_particle(model, p, q, report);
    model.rebuild_basis(body_p);
    const std::vector<ParticleId> strays = stray_markers(model, body_p);  // by its shape before anything is moved
    if (q_was_hinged && ring_p != ring_q) edit = merge_rings(model, ring_p, ring_q);
    model.touch_body(body_p);
    destroy_strays(model, body_p, strays, report.notes);
    return edit;
  }

  if (ring_p == ring_q) {  // a hinge: made rigid
    absorb_body(model, body_p, body_q, report);
    return {false, true};
  }

  require_no_shared_body(model, ring_p, ring_q, none);
  require_can_meet(model, p, q);
  model.touch_ring(ring_q);
  const Edit edit = merge_rings(model, ring_p, ring_q);
  model.join_articulates(model.bodies[body_p].articulate, model.bodies[body_q].articulate);
  model.touch_ring(ring_p);
  return edit;
}

Edit combine_bodies(Structure& model, std::uint32_t a, std::uint32_t b, RestructureReport& report) {
  if (a == b) return {};
  report.changed = true;
  absorb_body(model, a, b, report);
  return {false, true};
}

Edit separate_particles(Structure& model, std::uint32_t p, std::uint32_t q, RestructureReport& report) {
  const std::uint32_t body = model.particles[p].body;
  if (p == q) {  // one particle: a second one at the same place
    model.particles[p].mass /= 2;
    const std::uint32_t twin = model.make_particle(body, model.position(p), model.particles[p].mass, model.velocity(p));
    model.particles[twin].inactive = model.particles[p].inactive;
    model.rebuild_basis(body);
    model.touch_body(body);
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
    const std::uint32_t own = model.make_body(model.bodies[body].kind, model.bodies[body].damping);
    model.particles[q].part = model.bodies.id(own);
    Ring ring;
    ring.position = position, ring.velocity = velocity;
    model.add_to_ring(q, model.rings.create(ring).slot);
    model.add_to_body(q, own);
    model.rebuild_basis(own);
    const Edit edit = merge_rings(model, model.particles[p].ring, model.particles[q].ring);
    model.join_articulates(model.bodies[body].articulate, model.bodies[own].articulate);
    model.touch_body(body);
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
    model.touch_ring(ring);
    model.take_from_ring(q);
    model.add_to_ring(q, model.rings.create(own).slot);
    model.touch_ring(model.particles[q].ring, ring);
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
  model.touch_body(body);
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
