// SPDX-License-Identifier: Apache-2.0
#include "edit/combine.h"

#include "edit/settle.h"
#include "math/checks.h"

#include <iota/reports.h>

namespace iota::edit {

namespace {

/// Makes two bodies one without moving them. In a batch their velocities are projected once at its end.
template <class Combine>
RestructureReport make_rigid(Editor& e, std::uint32_t a, std::uint32_t b, const Vec3& middle, Combine combine) {
  RestructureReport report;
  // But the spin of a rod, which its points do not have, is passed to the whole immediately.
  const bool later = e.batch.has_value() && !e.model.spins.has(a) && !e.model.spins.has(b);
  Restructuring change(e, std::array{a, b}, later ? Restructuring::Kind::gentle : Restructuring::Kind::moving, report);
  const model::Edit owed = combine(report);
  if (e.model.bodies[a].kind != BodyKind::dynamic) e.model.spins.erase(a);  // for a rod that has become static
  change.finish(owed, {ViewEvent::Kind::join, middle});
  if (later && report.changed) e.mark_velocity_dirty(e.model.bodies[a].first);  // a step may come before
  return report;
}

RestructureReport begin_closing(Editor& e, std::uint32_t p, std::uint32_t q, double distance, double over) {
  model::Model& model = e.model;
  const std::uint32_t body_p = model.particles[p].body, body_q = model.particles[q].body;
  require_can_meet(model, p, q);
  if (ingredient::Closings::between(model, p, q) != model::none)
    throw std::invalid_argument(text("particles ", p, " and ", q, " are already on their way to each other"));
  RestructureReport report;
  Restructuring change(e, std::array{body_p, body_q}, Restructuring::Kind::transient, report);
  (void)ingredient::Closings::add(model, {{p, q}, distance, over, 0, 0});
  model.join_articulates(model.bodies[body_p].articulate, model.bodies[body_q].articulate);
  report.changed = true;
  change.finish({});
  return report;
}

RestructureReport hinge(Editor& e, std::uint32_t p, std::uint32_t q) {
  model::Model& model = e.model;
  const model::Ring& ring_p = model.rings[model.particles[p].ring];
  const model::Ring& ring_q = model.rings[model.particles[q].ring];
  const std::uint32_t body_p = model.particles[p].body, body_q = model.particles[q].body;
  const bool gentle = body_p != body_q && ring_p.position == ring_q.position && ring_p.velocity == ring_q.velocity &&
                      !(ring_p.nailed && ring_q.nailed);
  const Vec3 middle = 0.5 * (ring_p.position + ring_q.position);
  RestructureReport report;
  Restructuring change(e, std::array{body_p, body_q},
                       gentle ? Restructuring::Kind::gentle : Restructuring::Kind::moving, report);
  change.finish(combine_particles(model, p, q, report), {ViewEvent::Kind::join, middle});
  return report;
}

}  // namespace

RestructureReport apply(Editor& e, const CombineParticles& c) {
  model::Model& model = e.model;
  const std::uint32_t p = e.require(c.p), q = e.require(c.q);
  require_not_negative("over", c.over);
  const std::uint32_t body_p = model.particles[p].body, body_q = model.particles[q].body;
  const bool share_ring = model.particles[p].ring == model.particles[q].ring;
  if (body_p != body_q && share_ring)
    return make_rigid(e, body_p, body_q, model.position(p),
                      [&](RestructureReport& made) { return combine_particles(model, p, q, made); });
  if (c.over > 0 && body_p != body_q) {
    const double distance = norm(model.position(q) - model.position(p));
    const double extent = std::max(model.extent(body_p), model.extent(body_q));
    // A step moves the ends by far more than a small gap, and a distance row from there to it does not converge.
    constexpr double small = 1e-4;  // of the bodies' extent
    if (distance > small * extent) return begin_closing(e, p, q, distance, c.over);
  }
  return hinge(e, p, q);
}

RestructureReport apply(Editor& e, const CombineBodies& c) {
  model::Model& model = e.model;
  const std::uint32_t a = e.require(c.a), b = e.require(c.b);
  for (const std::uint32_t body : {a, b})
    if (model.bodies[body].count == 0) throw std::invalid_argument(text("combine: body ", body, " has no particles"));
  Vec3 middle;  // only for viewers
  if (model.scene.is_on()) middle = 0.5 * (model.center_of_mass(a) + model.center_of_mass(b));
  return make_rigid(e, a, b, middle, [&](RestructureReport& made) { return combine_bodies(model, a, b, made); });
}

RestructureReport call_off(Editor& e, std::uint32_t closing) {
  model::Model& model = e.model;
  const ingredient::Closing& c = model.closings[closing];
  RestructureReport report;
  Restructuring change(e, std::array{model.particles[c.p].body, model.particles[c.q].body},
                       Restructuring::Kind::transient, report);
  ingredient::Closings::end(model, closing);
  report.changed = true;
  change.finish({});
  return report;
}

}  // namespace iota::edit
