// SPDX-License-Identifier: Apache-2.0
#include "edit/settle.h"

#include "base/text.h"
#include "ingredient/quantities.h"
#include "math/mat3.h"
#include "model/solid.h"

#include <algorithm>
#include <cmath>

namespace iota::edit {

namespace {

void sort_unique(std::vector<std::uint32_t>& list) {
  std::sort(list.begin(), list.end());
  list.erase(std::unique(list.begin(), list.end()), list.end());
}

/// Of these bodies and the springs between them; a body that is no longer alive has nothing.
Conserved conserved(const model::Model& model, std::span<const std::uint32_t> bodies) {
  return {ingredient::calc_energies(model, bodies), ingredient::calc_momenta(model, bodies)};
}

/// Projects positions and velocities of the islands that the bodies are in.
void settle(Editor& e, std::span<const std::uint32_t> bodies, bool positions, RestructureReport& report) {
  e.islands.update(e.model, e.parallel);
  std::vector<island::Island*> settled;
  for (const std::uint32_t body : bodies) {
    island::Island* const island = e.islands.of_articulate(e.model.bodies[body].articulate);
    if (!island) continue;  // a free particle has nothing to settle
    if (std::find(settled.begin(), settled.end(), island) != settled.end()) continue;
    settled.push_back(island);
    if (island->project(e.model, positions)) continue;
    report.remaining_gap = ingredient::worst_gap(e.model);
    report.notes.push_back(text("no position of the bodies lets the combined particles meet exactly; ",
                                report.remaining_gap, " m remain, shared by the constraints"));
  }
}

/// Displacements and moved masses change momenta; a rigid motion of all that hangs together with the bodies gives them
/// back without disturbing any constraint. `before` is of `affected`. False where something is pinned: the rest of the
/// world has taken them.
bool give_back_momenta(model::Model& model, std::span<const std::uint32_t> bodies,
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
  const bool is_a_point = !(trace > 1e-24 * mass * dot(center, center));  // only round-off
  for (int pass = 0; pass < 2; ++pass) {  // the second takes away the round-off of the first
    const Conserved now = conserved(model, affected);
    const Vec3 lost = before.momenta.linear - now.momenta.linear;
    const Vec3 lost_spin = before.momenta.angular - now.momenta.angular - cross(center, lost);
    Vec3 turn = solve_semidefinite(inertia, lost_spin);
    // Bodies that were pulled together to almost a point would have to spin absurdly to keep their angular momentum.
    if (is_a_point || 0.5 * dot(turn, lost_spin) > 3 * (before.energies.kinetic + 1e-12)) turn = {};
    for (const std::uint32_t ring : rings)
      model.rings[ring].velocity += (1 / mass) * lost + cross(turn, model.rings[ring].position - center);
  }
  return true;
}

}  // namespace

Restructuring::Restructuring(Editor& editor, std::span<const std::uint32_t> bodies, Kind kind,
                             RestructureReport& report)
    : editor_(editor), report_(report), body_count_(bodies.size()), kind_(kind), followers_(editor.model, bodies) {
  std::copy(bodies.begin(), bodies.end(), bodies_.begin());
  report.articulates_before = editor.model.articulates.size();
  if (kind != Kind::moving) return;
  affected_ = editor.model.tied_bodies(bodies);
  before_ = conserved(editor.model, affected_);
}

void Restructuring::finish(const model::Edit& owed) {
  model::Model& model = editor_.model;
  if (report_.changed) {
    ingredient::settle(model, with_created(edited()), report_.notes);
    followers_.follow(model);
    if (kind_ != Kind::transient) editor_.structure_changed();
  }
  report_.articulates_after = model.articulates.size();
  report_.structure_version = model.structure_version;
  if (kind_ == Kind::moving && report_.changed) settle_and_measure(owed);
}

void settle_batch(Editor& e, RestructureReport& report) {
  model::Model& model = e.model;
  std::vector<std::uint32_t> bodies;
  for (const auto& absorbed : report.absorbed_bodies)
    if (const auto body = model.survivor_of(absorbed.survivor)) bodies.push_back(body->slot);
  sort_unique(bodies);
  if (bodies.empty()) return;
  const std::vector<std::uint32_t> affected = model.tied_bodies(bodies);
  const Conserved before = conserved(model, affected);
  settle(e, bodies, false, report);
  const Conserved after = conserved(model, affected);
  report.energy_change += after.energies.total() - before.energies.total();
  report.momentum_change += after.momenta.linear - before.momenta.linear;
  report.angular_momentum_change += after.momenta.angular - before.momenta.angular;
}

std::vector<std::uint32_t> Restructuring::with_created(std::span<const std::uint32_t> known) const {
  std::vector<std::uint32_t> bodies(known.begin(), known.end());
  for (const BodyId body : report_.created_bodies) bodies.push_back(body.slot);
  std::erase_if(bodies, [&](std::uint32_t body) { return !editor_.model.bodies.is_alive(body); });
  return bodies;
}

void Restructuring::settle_and_measure(const model::Edit& owed) {
  model::Model& model = editor_.model;
  const std::vector<std::uint32_t> affected = with_created(affected_);
  bool pinned = false;
  if (owed.moved || owed.velocity_dirty) {
    const std::vector<std::uint32_t> touched = with_created(edited());
    settle(editor_, touched, owed.moved, report_);
    pinned = !give_back_momenta(model, touched, affected, before_);
  }
  const Conserved after = conserved(model, affected);
  report_.energy_change =
      after.energies.kinetic + after.energies.potential - before_.energies.kinetic - before_.energies.potential;
  report_.momentum_change = after.momenta.linear - before_.momenta.linear;
  report_.angular_momentum_change = after.momenta.angular - before_.momenta.angular;
  const double spin_change = norm(report_.angular_momentum_change);
  if (!pinned && spin_change > 1e-9 * (norm(before_.momenta.angular) + 1e-3 * spin_change))
    report_.notes.push_back(
        "the bodies that are left (a point, a rod, or bodies almost in one place) cannot carry all of the angular "
        "momentum; angular_momentum_change tells the rest");
}

}  // namespace iota::edit
