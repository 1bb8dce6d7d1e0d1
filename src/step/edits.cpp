// SPDX-License-Identifier: Apache-2.0
// What each command does, and the physics that a structural edit owes.
#include "ingredient/followers.h"
#include "ingredient/joint_readings.h"
#include "ingredient/quantities.h"
#include "math/mat3.h"
#include "model/solid.h"
#include "step/checks.h"
#include "step/implementation.h"

#include <iota/solver.h>

#include <algorithm>
#include <cmath>

namespace iota {

using model::none;
using namespace step;

namespace {

void sort_unique(std::vector<std::uint32_t>& list) {
  std::sort(list.begin(), list.end());
  list.erase(std::unique(list.begin(), list.end()), list.end());
}

}  // namespace

std::uint32_t System::Implementation::require(BodyId id) const {
  if (!model.bodies.contains(id)) throw_stale("body", id, model.survivor_of(id));
  return id.slot;
}
std::uint32_t System::Implementation::require(ParticleId id) const {
  if (!model.particles.contains(id)) throw_stale("particle", id, model.survivor_of(id));
  return id.slot;
}
std::uint32_t System::Implementation::require(BondId id) const {
  if (!model.bonds.contains(id)) throw_stale("bond", id, std::optional<BondId>{});
  return id.slot;
}
std::uint32_t System::Implementation::require(GripId id) const {
  if (!model.grips.contains(id)) throw_stale("grip", id, std::optional<GripId>{});
  return id.slot;
}

void System::Implementation::jolt(std::uint32_t particle) {
  model::Articulate& a = model.articulates[model.bodies[model.particles[particle].body].articulate];
  a.jolted = a.disturbed = 1;
}

// --- settings ---------------------------------------------------------------------------------------------------------

void System::Implementation::apply(const step::SetGravity& c) {
  require_finite("gravity", c.value);
  model.gravity = c.value;
  model.articulates.for_each([](std::uint32_t, model::Articulate& a) { a.disturbed = 1; });
}
void System::Implementation::apply(const step::SetMode& c) { model.mode = c.mode; }
void System::Implementation::apply(const step::SetSolver& c) {
  if (c.name.back() != 0) throw std::invalid_argument("set_solver: the name does not end");
  try {
    if (c.name[0] != 0) (void)make_solver(c.name.data());
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument(text(error.what(), "; or \"direct\", the system's own"));
  }
  model.solver = c.name;
}
void System::Implementation::apply(const step::SetSystemDamping& c) {
  require_not_negative("damping", c.per_second);
  model.damping = c.per_second;
}

// --- making -----------------------------------------------------------------------------------------------------------

BodyId System::Implementation::apply(const step::CreateBody& c) {
  require_not_negative("damping", c.options.damping);
  const std::uint32_t body = model.make_body(c.options.kind, c.options.damping);
  structure_changed();
  return model.bodies.id(body);
}

ParticleId System::Implementation::apply(const step::CreateParticle& c) {
  const std::uint32_t body = require(c.body);
  require_finite("position", c.position);
  require_finite("velocity", c.velocity);
  if (c.mass == 0) return make_marker(body, c.position);
  require_mass("mass", c.mass);
  const std::uint32_t particle = model.make_particle(body, c.position, c.mass, c.velocity);
  model.rebuild_basis(body);
  model.touch_body(body);
  jolt(particle);
  structure_changed();
  return model.particles.id(particle);
}

ParticleId System::Implementation::make_marker(std::uint32_t body, const Vec3& position) {
  if (!model.spans(body, position))
    throw std::invalid_argument(text("a massless particle is carried by the massive ones of its body; those of body ",
                                     body, model.bodies[body].rank == 0 ? " are yet to be made" : " do not reach ",
                                     model.bodies[body].rank == 0 ? "" : text_of(position)));
  const std::uint32_t marker = model.make_marker(body, position);
  model.particles[marker].part = model.part_at(body, position);
  structure_changed();
  return model.particles.id(marker);
}

void System::Implementation::apply(const step::SetRod& c) {
  const std::uint32_t body = require(c.body);
  require_mass("mass", c.mass);
  if (!(c.radius > 0 && c.radius <= 1e9))
    throw std::invalid_argument(text("radius must be above 0 and at most 1e9 m, got ", c.radius));
  std::vector<std::uint32_t> massive;
  model.for_each_particle_of(body, [&](std::uint32_t p) {
    if (!model.particles[p].is_marker()) massive.push_back(p);
  });
  if (massive.size() != 2)
    throw std::invalid_argument(
        text("set_rod needs a body of exactly two massive particles, body ", body, " has ", massive.size()));
  const std::uint32_t p = massive[0], q = massive[1];
  const double length = norm(model.position(q) - model.position(p));
  require_positive("the distance of the rod's two particles", length);
  // Mass [A B; B A] as two point masses A+B = m/2 and a pair -B |v_p - v_q|^2 / 2, where A-B = 2 It/L^2.
  const double transverse = c.mass * (3 * c.radius * c.radius + length * length) / 12;
  const double sum = c.mass / 2, difference = 2 * transverse / (length * length);
  model.remove_inertia_of(body, none);
  for (const std::uint32_t end : {p, q}) model.particles[end].mass = sum;
  model::InertiaPair pair{body, none, p, q, -(sum - difference) / 2};
  model.bodies[body].first_inertia = model.inertia_pairs.create(pair).slot;
  model.touch_body(body);
}

CosmeticBondId System::Implementation::apply(const step::CreateCosmeticBond& c) {
  const std::uint32_t p = require(c.p), q = require(c.q);
  if (p == q) throw std::invalid_argument(text("a cosmetic bond needs two particles, got particle ", p, " twice"));
  if (model.particles[p].body != model.particles[q].body)
    throw std::invalid_argument(text("a cosmetic bond joins particles of one body; particle ", p, " is of body ",
                                     model.particles[p].body, ", particle ", q, " of body ", model.particles[q].body));
  structure_changed();
  return model.cosmetic_bonds.id(model.add_cosmetic_bond({{p, q}}));
}

GripId System::Implementation::apply(const step::CreateGrip& c) {
  const std::uint32_t body = require(c.body);
  require_finite("local_point", c.local_point);
  require_finite("target", c.target);
  require_positive("frequency", c.options.frequency);
  require_positive("max_acceleration", c.options.max_acceleration);
  if (model.bodies[body].count == 0) throw std::invalid_argument(text("body ", body, " has no particles to hold"));
  refresh_orientations();
  model::Grip grip;
  grip.body = body;
  grip.client = c.options.client, grip.hold = c.options.hold;
  grip.frequency = c.options.frequency, grip.max_acceleration = c.options.max_acceleration;
  grip.target = c.target;
  const Vec3 place = model.center_of_mass(body) + rotate(model.bodies[body].orientation, c.local_point);
  ingredient::Grips::anchor(model, grip, place);
  model.touch_locally(body);
  return model.grips.create(grip);
}

void System::Implementation::apply(const step::MoveGrip& c) {
  require_finite("target", c.target);
  model.grips[require(c.grip)].target = c.target;
}

// --- assigning --------------------------------------------------------------------------------------------------------

void System::Implementation::apply(const step::SetBodyDamping& c) {
  require_not_negative("damping", c.per_second);
  const std::uint32_t body = require(c.body);
  model.bodies[body].damping = c.per_second;
  model.touch_locally(body);
}

void System::Implementation::refresh_coordinates(std::uint32_t body) {
  if (model.constraints.size() == 0) return;
  model.for_each_particle_of(body, [&](std::uint32_t p) {
    model.for_each_constraint_of(p, [&](std::uint32_t c, int) { ingredient::refresh_coordinates(model, c); });
  });
}

void System::Implementation::apply(const step::SetPosition& c) {
  const std::uint32_t particle = require(c.particle);
  require_finite("position", c.value);
  if (model.bodies[model.particles[particle].body].kind == BodyKind::scripted)
    return apply(step::Nail{c.particle, false, c.value});  // carried there during the next step
  const std::uint32_t ring = model.particles[particle].ring;
  model.for_each_in_ring(ring, [&](std::uint32_t p) {
    if (model.particles[p].is_marker() && !model.spans(model.particles[p].body, c.value))
      throw std::invalid_argument(text("particle ", p, " is massless, and the massive ones of its body do not reach ",
                                       text_of(c.value), "; move those"));
  });
  model::Ring& r = model.rings[ring];
  r.position = c.value;
  if (r.nailed) model.nails.at(ring).position = model.nails.at(ring).position_before = c.value;
  model.for_each_in_ring(ring, [&](std::uint32_t moved) {
    const std::uint32_t body = model.particles[moved].body;
    model.for_each_particle_of(body, [&](std::uint32_t p) {  // markers go where the basis takes them
      if (!model.particles[p].is_marker() || p == moved || model.is_unknown(model.particles[p])) return;
      model.rings[model.particles[p].ring].position = model.carried(p).first;
    });
    if (!model.particles[moved].is_marker()) model.remove_solids_of(body, moved);  // no longer that shape
    model.rebuild_basis(body);
    model.touch_body(body);
  });
  model.for_each_in_ring(ring, [&](std::uint32_t p) { refresh_coordinates(model.particles[p].body); });
  jolt(particle);
}

void System::Implementation::apply(const step::SetVelocity& c) {
  const std::uint32_t particle = require(c.particle);
  require_finite("velocity", c.value);
  model.rings[model.particles[particle].ring].velocity = c.value;
  jolt(particle);
}

void System::Implementation::apply(const step::SetMass& c) {
  const std::uint32_t particle = require(c.particle);
  require_mass("mass", c.value);
  const std::uint32_t body = model.particles[particle].body;
  model.particles[particle].mass = model.particles[particle].inactive ? c.value * model::inactive_share : c.value;
  model.keep_inertia_positive(body);
  model.touch_body(body);
}

void System::Implementation::apply(const step::ApplyForce& c) {
  const std::uint32_t particle = require(c.particle);
  require_finite("force", c.value);
  model.pushes.make(model.particles[particle].ring).force += c.value;
}

// --- structural edits -------------------------------------------------------------------------------------------------

template <class EditFunction>
RestructureReport System::Implementation::restructure(std::span<const std::uint32_t> edited, bool gentle,
                                                      EditFunction edit) {
  RestructureReport report;
  report.articulates_before = model.articulates.size();
  const ingredient::Followers followers(model, edited);
  // Nothing beyond what bonds tie to the edited bodies can move or change its velocity.
  std::vector<std::uint32_t> affected;
  if (!gentle) affected = model.tied_bodies(edited);
  const Conserved before = conserved(affected);

  const model::Edit owed = edit(report);
  if (report.changed) {
    if (model.closings.size() > 0) end_settled_closings(model, report.notes);
    if (model.constraints.size() > 0) {
      std::vector<std::uint32_t> bodies(edited.begin(), edited.end());
      for (const BodyId body : report.created_bodies) bodies.push_back(body.slot);
      end_settled_constraints(model, bodies, report.notes);
    }
    followers.follow(model);
    structure_changed();
  }
  report.articulates_after = model.articulates.size();
  report.structure_version = model.structure_version;
  if (gentle || !report.changed) return report;

  bool pinned = false;
  for (const BodyId body : report.created_bodies) affected.push_back(body.slot);
  std::erase_if(affected, [&](std::uint32_t body) { return !model.bodies.is_alive(body); });
  if (owed.moved || owed.jolted) {
    std::vector<std::uint32_t> touched(edited.begin(), edited.end());
    for (const BodyId body : report.created_bodies) touched.push_back(body.slot);
    std::erase_if(touched, [&](std::uint32_t body) { return !model.bodies.is_alive(body); });
    settle(touched, owed.moved, report);
    pinned = !give_back_momenta(touched, affected, before);
  }
  const Conserved after = conserved(affected);
  report.energy_change = after.kinetic + after.potential - before.kinetic - before.potential;
  report.momentum_change = after.momentum - before.momentum;
  report.angular_momentum_change = after.angular_momentum - before.angular_momentum;
  const double spin_change = norm(report.angular_momentum_change);
  if (!pinned && spin_change > 1e-9 * (norm(before.angular_momentum) + 1e-3 * spin_change))
    report.notes.push_back(
        "what is left (a point, a rod, or bodies almost in one place) cannot carry all of the angular "
        "momentum; angular_momentum_change tells the rest");
  return report;
}

System::Implementation::Conserved System::Implementation::conserved(std::span<const std::uint32_t> bodies) const {
  const ingredient::Energies energies = ingredient::calc_energies(model, bodies);
  const ingredient::Momenta momenta = ingredient::calc_momenta(model, bodies);
  return {energies.kinetic, energies.potential, momenta.linear, momenta.angular};
}

void System::Implementation::settle(std::span<const std::uint32_t> bodies, bool positions, RestructureReport& report) {
  islands.update(model, parallel);
  std::vector<step::Island*> settled;
  for (const std::uint32_t body : bodies) {
    step::Island* island = islands.of_articulate(model.bodies[body].articulate);
    if (!island) continue;  // a free particle has nothing to settle
    if (std::find(settled.begin(), settled.end(), island) != settled.end()) continue;
    settled.push_back(island);
    if (island->project(model, positions)) continue;
    report.remaining_gap = ingredient::worst_gap(model);
    report.notes.push_back(text("no position of the bodies lets the combined particles meet exactly; ",
                                report.remaining_gap, " m remain, shared by the constraints"));
  }
}

bool System::Implementation::give_back_momenta(std::span<const std::uint32_t> bodies,
                                               std::span<const std::uint32_t> affected, const Conserved& before) {
  std::vector<std::uint32_t> members = model.tied_bodies(bodies, model::Model::Ties::constraints), rings;
  std::erase_if(members, [&](std::uint32_t b) { return model.bodies[b].kind == BodyKind::inactive; });
  for (const std::uint32_t b : members) {
    bool pinned = model.is_tied_to_world(b);
    model.for_each_particle_of(b,
                               [&](std::uint32_t p) { pinned = pinned || model.is_pinned(model.particles[p].ring); });
    if (pinned) return false;
  }
  double mass = 0;
  Vec3 first_moment;
  for (const std::uint32_t b : members)
    model.for_each_particle_of(b, [&](std::uint32_t p) {
      rings.push_back(model.particles[p].ring);
      mass += model.particles[p].mass;
      first_moment += model.particles[p].mass * model.position(p);
    });
  if (!(mass > 0)) return false;
  sort_unique(rings);

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
  const bool is_a_point = !(trace > 1e-24 * mass * dot(center, center));  // what there is of it is round-off
  for (int pass = 0; pass < 2; ++pass) {  // the second takes away the round-off of the first
    const Conserved now = conserved(affected);
    const Vec3 lost = before.momentum - now.momentum;
    const Vec3 lost_spin = before.angular_momentum - now.angular_momentum - cross(center, lost);
    Vec3 turn = solve_semidefinite(inertia, lost_spin);
    // Bodies that were pulled together to almost a point would have to spin absurdly to keep their angular momentum.
    if (is_a_point || 0.5 * dot(turn, lost_spin) > 3 * (before.kinetic + 1e-12)) turn = {};
    for (const std::uint32_t ring : rings)
      model.rings[ring].velocity += (1 / mass) * lost + cross(turn, model.rings[ring].position - center);
  }
  return true;
}

void System::Implementation::apply(const SetKind& c) {
  const std::uint32_t slot = require(c.body);
  const BodyKind before = model.bodies[slot].kind;
  if (before == c.kind) return;
  if (model::is_free(c.kind) && is_endless(model, slot))
    throw std::invalid_argument(
        text("body ", slot, " is a half-space, which has no mass: it can only be static or scripted"));
  if (c.kind == BodyKind::resting) {
    if (before != BodyKind::dynamic)
      throw std::invalid_argument(text("only dynamic bodies can rest; body ", slot, " is none: make it dynamic first"));
    return put_to_rest(slot);
  }
  if (before == BodyKind::resting) {
    for (const std::uint32_t b : model.tied_bodies(std::array{slot})) {
      if (model.bodies[b].kind == BodyKind::resting) model.bodies[b].kind = BodyKind::dynamic;
      model.articulates[model.bodies[b].articulate].disturbed = 1;
    }
    if (c.kind == BodyKind::dynamic) return;
  }
  const auto change = [&] {
    model::Body& body = model.bodies[slot];
    if (c.kind == BodyKind::inactive) body.kind_before = body.kind;
    body.kind = c.kind;
    if (c.kind != BodyKind::dynamic) model.spins.erase(slot);
    if (c.kind == BodyKind::dynamic && before != BodyKind::inactive) model.rebuild_basis(slot);  // rigid as it was put
    model.for_each_particle_of(slot, [&](std::uint32_t p) {
      model.mute_bonds_of(p);
      model::Ring& ring = model.rings[model.particles[p].ring];
      if (c.kind != BodyKind::dynamic && (c.kind != BodyKind::inactive || ring.count == 1))
        ring.velocity = ring.acceleration = {};
    });
    model.touch_body(slot);
    model.articulates[body.articulate].jolted = 1;
  };
  if (before == BodyKind::inactive) {  // what it is hinged to may have gone elsewhere meanwhile
    (void)restructure(std::array{slot}, false, [&](RestructureReport& report) {
      change();
      report.changed = true;
      return model::Edit{true, true};
    });
    return;
  }
  change();
  structure_changed();
}

/// Lets viewers know of an edit that has changed something.
RestructureReport System::Implementation::seen(ViewEvent::Kind kind, const Vec3& place, RestructureReport report) {
  if (report.changed) model.scene.note(kind, place);
  return report;
}

RestructureReport System::Implementation::apply(const step::CombineParticles& c) {
  const std::uint32_t p = require(c.p), q = require(c.q);
  require_not_negative("over", c.over);
  const std::uint32_t body_p = model.particles[p].body, body_q = model.particles[q].body;
  const double distance = norm(model.position(q) - model.position(p));
  const bool unrelated = body_p != body_q && model.particles[p].ring != model.particles[q].ring;
  if (c.over > 0 && unrelated && distance > 1e-9) {
    require_can_meet(model, p, q);
    return restructure(std::array{body_p, body_q}, false, [&](RestructureReport& report) {
      if (closing_between(model, p, q) != none)
        throw std::invalid_argument(text("particles ", p, " and ", q, " are already on their way to each other"));
      report.changed = true;
      (void)model.add_closing({{p, q}, distance, c.over, 0, 0});
      model.join_articulates(model.bodies[body_p].articulate, model.bodies[body_q].articulate);
      return model::Edit{false, true};
    });
  }
  const model::Ring& ring_p = model.rings[model.particles[p].ring];
  const model::Ring& ring_q = model.rings[model.particles[q].ring];
  const bool gentle = unrelated && ring_p.position == ring_q.position && ring_p.velocity == ring_q.velocity &&
                      !(ring_p.nailed && ring_q.nailed);
  const Vec3 place = 0.5 * (ring_p.position + ring_q.position);
  return seen(ViewEvent::Kind::join, place,
              restructure(std::array{body_p, body_q}, gentle,
                          [&](RestructureReport& report) { return combine_particles(model, p, q, report); }));
}

RestructureReport System::Implementation::apply(const step::CombineBodies& c) {
  const std::uint32_t a = require(c.a), b = require(c.b);
  for (const std::uint32_t body : {a, b})
    if (model.bodies[body].count == 0) throw std::invalid_argument(text("combine: body ", body, " has no particles"));
  const Vec3 place = 0.5 * (model.center_of_mass(a) + model.center_of_mass(b));
  return seen(ViewEvent::Kind::join, place, restructure(std::array{a, b}, false, [&](RestructureReport& report) {
                return combine_bodies(model, a, b, report);
              }));
}

RestructureReport System::Implementation::apply(const step::Separate& c) {
  const std::uint32_t p = require(c.p), q = require(c.q);
  const std::uint32_t body_p = model.particles[p].body, body_q = model.particles[q].body;
  bool gentle = p == q ? model.bodies[body_p].first_inertia == none  // a rod with less mass at its end is no rod
                       : body_p != body_q && model.particles[p].ring == model.particles[q].ring;
  model.for_each_in_ring(model.particles[q].ring, [&](std::uint32_t r) { gentle = gentle && model.follows_basis(r); });
  const Vec3 place = model.position(q);
  return seen(ViewEvent::Kind::break_, place,
              restructure(std::array{body_p, body_q}, gentle, [&](RestructureReport& report) {
                model::Edit edit = separate_particles(model, p, q, report);
                edit.jolted = !gentle;
                return edit;
              }));
}

RestructureReport System::Implementation::call_off(std::uint32_t closing) {
  const std::vector<std::uint32_t> bodies{model.particles[model.closings[closing].p].body,
                                          model.particles[model.closings[closing].q].body};
  return restructure(bodies, false, [&](RestructureReport& report) {
    report.changed = true;
    model::call_off(model, closing);
    return model::Edit{false, true};
  });
}

void System::Implementation::apply(const step::Nail& c) {
  const std::uint32_t particle = require(c.particle);
  const Vec3 position = c.in_place ? model.position(particle) : c.position;
  require_finite("position", position);
  const std::uint32_t slot = model.particles[particle].ring;
  model::Ring& ring = model.rings[slot];
  model.for_each_in_ring(slot, [&](std::uint32_t p) {
    if (model.bodies[model.particles[p].body].kind == BodyKind::static_ && position != ring.position)
      throw std::invalid_argument(text("nail: static body ", model.particles[p].body, " holds particle ", particle,
                                       "; make it dynamic or scripted to move it"));
  });
  if (ring.nailed) {
    model.nails.at(slot).position = position;  // moves there during the next step
    return;
  }
  (void)restructure(std::array{model.particles[particle].body}, false, [&](RestructureReport& report) {
    report.changed = true;
    const bool moved = ring.position != position;
    ring.nailed = 1, ring.position = position, ring.velocity = {};
    model.nails.make(slot) = {position, position, {}};
    model.touch_ring(slot);
    model.scene.note(ViewEvent::Kind::join, position);
    return model::Edit{moved, true};
  });
}

void System::Implementation::apply(const step::Release& c) {
  const std::uint32_t particle = require(c.particle);
  const std::uint32_t ring = model.particles[particle].ring;
  if (!model.rings[ring].nailed) return;
  model.rings[ring].nailed = 0;
  model.scene.note(ViewEvent::Kind::break_, model.rings[ring].position);
  model.nails.at(ring).multiplier = {};
  model.touch_ring(ring);
  structure_changed();
}

// Destroying takes what there was: mass, momentum and energy go with it.
void System::Implementation::apply(const step::Destroy<BodyId>& c) {
  const ingredient::Followers followers(model, std::array{require(c.id)});
  destroy_body(model, c.id.slot);
  followers.follow(model);
  structure_changed();
}
void System::Implementation::apply(const step::Destroy<ParticleId>& c) {
  const std::uint32_t particle = require(c.id);
  const ingredient::Followers followers(model, std::array{model.particles[particle].body});
  destroy_particle(model, particle);
  followers.follow(model);
  structure_changed();
}
RestructureReport System::Implementation::apply(const step::Destroy<CosmeticBondId>& c) {
  if (!model.cosmetic_bonds.contains(c.id)) throw_stale("cosmetic bond", c.id, std::optional<CosmeticBondId>{});
  const model::CosmeticBond& bond = model.cosmetic_bonds[c.id.slot];
  const Vec3 place = 0.5 * (model.position(bond.p) + model.position(bond.q));
  RestructureReport report =
      restructure({{model.particles[bond.p].body}}, false,
                  [&](RestructureReport& report) { return break_cosmetic_bond(model, c.id.slot, report); });
  if (!report.created_bodies.empty()) model.scene.note(ViewEvent::Kind::break_, place);
  return report;
}
RestructureReport System::Implementation::apply(const step::SeparatePart& c) {
  const std::uint32_t body = require(c.body);
  RestructureReport report = restructure(
      {{body}}, false, [&](RestructureReport& report) { return separate_part(model, body, c.part, report); });
  for (const BodyId created : report.created_bodies)
    model.scene.note(ViewEvent::Kind::break_, model.center_of_mass(created.slot));
  return report;
}
void System::Implementation::apply(const step::Destroy<GripId>& c) {
  const std::uint32_t grip = require(c.id);
  model.touch_locally(model.grips[grip].body);
  model.grips.destroy(grip);
}

}  // namespace iota
