// SPDX-License-Identifier: Apache-2.0
#include "ingredient/cosmetic_bonds.h"

#include "ingredient/model.h"
#include "math/mat3.h"

#include <iota/reports.h>
#include <iota/scene.h>

namespace iota::ingredient {

namespace {

DrawnLine line(const Vec3& from, const Vec3& to) {
  const double length = norm(to - from);
  return {0.5 * (from + to), length > 0 ? shortest_turn({1, 0, 0}, (1 / length) * (to - from)) : Quaternion{}, length};
}

/// A massless point that a joint made for itself: of its axis, say, which may be far from the body.
bool is_of_joint(const Model& model, std::uint32_t p) {
  if (!model.particles[p].is_marker()) return false;
  bool owned = false;
  model.for_each_constraint_of(
      p, [&](std::uint32_t slot, int place) { owned = owned || (model.constraints[slot].owned >> place & 1) != 0; });
  return owned;
}

/// Whether a cosmetic bond that begins at particle p is one of its body. A bond of which one end has gone with another body
/// lies in neither: the line would reach from the body to something that it is not hinged to, and touch it.
bool is_within(const Model& model, const CosmeticBond& bond, std::uint32_t p) {
  return bond.p == p && model.particles[bond.q].body == model.particles[p].body;
}

bool has_bonds(const Model& model, std::uint32_t body) {
  bool has = false;
  model.for_each_particle_of(body, [&](std::uint32_t p) {
    model.cosmetic_bonds.for_each_of(
        p, [&](std::uint32_t slot) { has = has || is_within(model, model.cosmetic_bonds[slot], p); });
  });
  return has;
}

}  // namespace

std::uint32_t CosmeticBonds::add(Model& model, const CosmeticBond& bond) {
  model.note_body(model.particles[bond.p].body);
  return model.cosmetic_bonds.create(bond);
}

void CosmeticBonds::remove(Model& model, std::uint32_t bond) {
  model.note_body(model.particles[model.cosmetic_bonds[bond].p].body);
  model.cosmetic_bonds.destroy(bond);
}

model::Edit CosmeticBonds::break_(Model& model, std::uint32_t bond, RestructureReport& report) {
  const std::uint32_t p = model.cosmetic_bonds[bond].p, q = model.cosmetic_bonds[bond].q;
  remove(model, bond);
  report.changed = true;
  if (model.particles[q].body != model.particles[p].body) return {};  // separated since
  return model::fall_apart(model, p, q, report);
}

void CosmeticBonds::visit_companions(const Model& model, std::uint32_t particle, Visit visit) {
  model.cosmetic_bonds.for_each_of(particle, [&](std::uint32_t slot) {
    const CosmeticBond& bond = model.cosmetic_bonds[slot];
    if (model.particles[bond.p].body == model.particles[bond.q].body) visit(bond.p == particle ? bond.q : bond.p);
  });
}

void CosmeticBonds::absorb(Model& model, std::uint32_t q, std::uint32_t p) {
  model.cosmetic_bonds.redirect(q, p, [](std::uint32_t) {}, [&](std::uint32_t bond) { remove(model, bond); });
}

void CosmeticBonds::drop(Model& model, std::uint32_t particle) {
  model.cosmetic_bonds.for_each_of(particle, [&](std::uint32_t bond) { remove(model, bond); });
}

void CosmeticBonds::check_links(const Model& model, model::Audit& audit) {
  audit.check_ends("cosmetic bond", model.cosmetic_bonds);
}

void CosmeticBonds::validate(const Model& model, model::Audit& audit) {
  model.cosmetic_bonds.for_each(
      [&](std::uint32_t slot, const CosmeticBond& bond) { audit.require_ends("cosmetic bond", slot, bond); });
  audit.require_listed("cosmetic bond", model.cosmetic_bonds);
}

// Without cosmetic bonds there is a line from each particle of a body to the next.
void CosmeticBonds::visit_lines(const Model& model, std::uint32_t body, Structure::VisitLine visit) {
  if (has_bonds(model, body)) {
    model.for_each_particle_of(body, [&](std::uint32_t p) {
      model.cosmetic_bonds.for_each_of(p, [&](std::uint32_t slot) {
        const CosmeticBond& bond = model.cosmetic_bonds[slot];
        if (is_within(model, bond, p)) visit(bond.p, bond.q);
      });
    });
    return;
  }
  std::uint32_t before = none;
  model.for_each_particle_of(body, [&](std::uint32_t p) {
    if (is_of_joint(model, p)) return;
    if (before != none) visit(before, p);
    before = p;
  });
}

void CosmeticBonds::draw(const SceneView& view, std::uint32_t body, DrawnBody& drawn) {
  const Model& model = view.model;
  if (model.bodies[body].count == 1) return;
  const Vec3 center = model.center_of_mass(body);
  const auto local = [&](std::uint32_t p) { return view.into_body(body, model.position(p) - center); };
  visit_lines(model, body, [&](std::uint32_t p, std::uint32_t q) { drawn.lines.push_back(line(local(p), local(q))); });
  if (has_bonds(model, body)) return;
  model.for_each_particle_of(body, [&](std::uint32_t p) { drawn.particles -= is_of_joint(model, p); });
}

}  // namespace iota::ingredient
