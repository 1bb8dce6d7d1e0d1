// SPDX-License-Identifier: Apache-2.0
#include "edit/combine.h"

#include "edit/checks.h"
#include "edit/settle.h"

namespace iota::edit {

namespace {

/// Makes two bodies one, in place. Within a batch their velocities are made to fit at its end, once for all.
template <class Combine>
RestructureReport make_rigid(Editor& e, std::uint32_t a, std::uint32_t b, const Vec3& middle, Combine combine) {
  RestructureReport report;
  // But the spin of a rod, which its points know nothing of, goes over to the whole at once.
  const bool later = e.batch.has_value() && !e.model.spins.has(a) && !e.model.spins.has(b);
  Restructuring change(e, std::array{a, b}, later ? Restructuring::Kind::gentle : Restructuring::Kind::moving, report);
  const model::Edit owed = combine(report);
  if (e.model.bodies[a].kind != BodyKind::dynamic) e.model.spins.erase(a);  // of a rod that has become static
  change.finish(owed, {ViewEvent::Kind::join, middle});
  if (later && report.changed) e.mark_velocity_dirty(e.model.bodies[a].first);  // somebody may step before
  return report;
}

}  // namespace

RestructureReport apply(Editor& e, const CombineParticles& c) {
  model::Model& model = e.model;
  const std::uint32_t p = e.require(c.p), q = e.require(c.q);
  require_not_negative("over", c.over);
  const std::uint32_t body_p = model.particles[p].body, body_q = model.particles[q].body;
  RestructureReport report;
  const bool unrelated = body_p != body_q && model.particles[p].ring != model.particles[q].ring;
  const double distance = c.over > 0 && unrelated ? norm(model.position(q) - model.position(p)) : 0;
  if (distance > 1e-9) {
    require_can_meet(model, p, q);
    if (ingredient::Closings::between(model, p, q) != model::none)
      throw std::invalid_argument(text("particles ", p, " and ", q, " are already on their way to each other"));
    Restructuring change(e, std::array{body_p, body_q}, Restructuring::Kind::transient, report);
    (void)ingredient::Closings::add(model, {{p, q}, distance, c.over, 0, 0});
    model.join_articulates(model.bodies[body_p].articulate, model.bodies[body_q].articulate);
    report.changed = true;
    change.finish({});
    return report;
  }
  const model::Ring& ring_p = model.rings[model.particles[p].ring];
  const model::Ring& ring_q = model.rings[model.particles[q].ring];
  const bool gentle = unrelated && ring_p.position == ring_q.position && ring_p.velocity == ring_q.velocity &&
                      !(ring_p.nailed && ring_q.nailed);
  const Vec3 middle = 0.5 * (ring_p.position + ring_q.position);
  if (body_p != body_q && !unrelated)
    return make_rigid(e, body_p, body_q, middle,
                      [&](RestructureReport& made) { return combine_particles(model, p, q, made); });
  Restructuring change(e, std::array{body_p, body_q},
                       gentle ? Restructuring::Kind::gentle : Restructuring::Kind::moving, report);
  change.finish(combine_particles(model, p, q, report), {ViewEvent::Kind::join, middle});
  return report;
}

RestructureReport apply(Editor& e, const CombineBodies& c) {
  model::Model& model = e.model;
  const std::uint32_t a = e.require(c.a), b = e.require(c.b);
  for (const std::uint32_t body : {a, b})
    if (model.bodies[body].count == 0) throw std::invalid_argument(text("combine: body ", body, " has no particles"));
  Vec3 middle;  // only viewers ask for it
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
