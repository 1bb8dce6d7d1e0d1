// SPDX-License-Identifier: Apache-2.0
#include "edit/separate.h"

#include "edit/combine.h"
#include "edit/settle.h"
#include "math/checks.h"

#include <iota/reports.h>

namespace iota::edit {

namespace {

RestructureReport separate_points(Editor& e, std::uint32_t p, std::uint32_t q) {
  model::Model& model = e.model;
  const std::uint32_t body_p = model.particles[p].body, body_q = model.particles[q].body;
  bool gentle = p == q ? model.bodies[body_p].first_inertia == model::none  // half the mass at one end changes the rod
                       : body_p != body_q && model.particles[p].ring == model.particles[q].ring;
  model.for_each_in_ring(model.particles[q].ring, [&](std::uint32_t r) { gentle = gentle && model.follows_basis(r); });
  const Vec3 place = model.position(q);
  RestructureReport report;
  Restructuring change(e, std::array{body_p, body_q},
                       gentle ? Restructuring::Kind::gentle : Restructuring::Kind::moving, report);
  model::Edit owed = separate_particles(model, p, q, report);
  owed.velocity_dirty = !gentle;
  change.finish(owed, {ViewEvent::Kind::break_, place});
  return report;
}

}  // namespace

RestructureReport apply(Editor& e, const Separate& c) {
  const std::uint32_t p = e.require(c.p), q = e.require(c.q);
  if (const std::uint32_t closing = ingredient::Closings::between(e.model, p, q); closing != model::none)
    return call_off(e, closing);
  return separate_points(e, p, q);
}

RestructureReport apply(Editor& e, const SeparatePart& c) {
  const std::uint32_t body = e.require(c.body);
  RestructureReport report;
  // Positions and velocities do not change. Only a split inertia pair has to be compensated.
  const bool gentle = e.model.bodies[body].first_inertia == model::none;
  Restructuring change(e, {{body}}, gentle ? Restructuring::Kind::gentle : Restructuring::Kind::moving, report);
  change.finish(separate_part(e.model, body, c.part, report));
  if (gentle && report.changed) e.mark_velocity_dirty(e.model.bodies[body].first);
  for (const BodyId created : report.created_bodies)
    e.model.scene.note(ViewEvent::Kind::break_, e.model.center_of_mass(created.slot));
  return report;
}

CosmeticBondId apply(Editor& e, const CreateCosmeticBond& c) {
  model::Model& model = e.model;
  const std::uint32_t p = e.require(c.p), q = e.require(c.q);
  if (p == q) throw std::invalid_argument(text("a cosmetic bond needs two particles, got particle ", p, " twice"));
  if (model.particles[p].body != model.particles[q].body)
    throw std::invalid_argument(text("a cosmetic bond joins particles of one body; particle ", p, " is of body ",
                                     model.particles[p].body, ", particle ", q, " of body ", model.particles[q].body));
  e.structure_changed();
  return model.cosmetic_bonds.id(ingredient::CosmeticBonds::add(model, {{p, q}}));
}

RestructureReport apply(Editor& e, const Destroy<CosmeticBondId>& c) {
  model::Model& model = e.model;
  const std::uint32_t bond = e.require(c.id);
  const auto [p, q] = std::pair(model.cosmetic_bonds[bond].p, model.cosmetic_bonds[bond].q);
  const Vec3 middle = 0.5 * (model.position(p) + model.position(q));
  RestructureReport report;
  Restructuring change(e, {{model.particles[p].body}}, Restructuring::Kind::moving, report);
  change.finish(ingredient::CosmeticBonds::break_(model, bond, report));
  if (!report.created_bodies.empty()) model.scene.note(ViewEvent::Kind::break_, middle);
  return report;
}

}  // namespace iota::edit
