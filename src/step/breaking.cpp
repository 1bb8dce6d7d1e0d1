// SPDX-License-Identifier: Apache-2.0
#include "step/breaking.h"

#include "base/text.h"
#include "edit/bonds.h"
#include "edit/constraints.h"
#include "edit/nails.h"
#include "edit/separate.h"
#include "ingredient/joint_readings.h"
#include "ingredient/loads.h"
#include "ingredient/quantities.h"

#include <cmath>

namespace iota::step {

namespace {

void break_constraints(edit::Editor& editor, StepReport& report) {
  model::Model& model = editor.model;
  for (std::uint32_t slot = 0; slot < model.constraints.slot_count(); ++slot) {
    if (!model.constraints.is_alive(slot)) continue;
    const ingredient::Constraint& c = model.constraints[slot];
    if (!c.active || (std::isinf(c.breaks.force) && std::isinf(c.breaks.torque))) continue;
    const ingredient::Reaction reaction = ingredient::calc_reaction(model, slot);
    const double force = norm(reaction.force), torque = norm(reaction.torque);
    if (!(force > c.breaks.force || torque > c.breaks.torque)) continue;
    report.broken.push_back(
        {.constraint = model.constraints.id(slot), .position = reaction.position, .force = force, .torque = torque});
    ingredient::begin_edits(model);
    apply(editor, edit::SetConstraintActive{model.constraints.id(slot), false});
    model.constraints[slot].broken = 1;
    model.scene.note(ViewEvent::Kind::break_, reaction.position);
  }
}

void break_bonds(edit::Editor& editor, StepReport& report) {
  model::Model& model = editor.model;
  for (const std::uint32_t slot : editor.held.breakable_bonds()) {
    ingredient::Bond& bond = model.bonds[slot];
    const double force = norm(editor.held.force(slot));
    if (!(force > bond.break_force)) continue;
    const Vec3 middle = 0.5 * (model.position(bond.p) + model.position(bond.q));
    report.broken.push_back({.bond = model.bonds.id(slot), .position = middle, .force = force});
    ingredient::begin_edits(model);
    apply(editor, edit::SetBondActive{model.bonds.id(slot), false});
    bond.broken = 1;
    model.scene.note(ViewEvent::Kind::break_, middle);
  }
}

void break_hinges_and_nails(edit::Editor& editor, StepReport& report) {
  model::Model& model = editor.model;
  std::vector<Broken> overloaded;
  model.fuses.for_each([&](std::uint32_t particle, double most) {
    const double force = norm(ingredient::calc_hinge_force(model, particle));
    if (force > most)
      overloaded.push_back(
          {.particle = model.particles.id(particle), .position = model.position(particle), .force = force});
  });
  if (!overloaded.empty()) ingredient::begin_edits(model);
  for (const Broken& broken : overloaded) {
    const model::Ring& ring = model.rings[model.particles[broken.particle.slot].ring];
    const std::uint32_t other = ring.first == broken.particle.slot ? ring.last : ring.first;
    if (ring.count > 1)
      (void)apply(editor, edit::Separate{model.particles.id(other), broken.particle});
    else if (ring.nailed)
      apply(editor, edit::Release{broken.particle});
    else
      continue;
    report.broken.push_back(broken);
  }
}

}  // namespace

void break_overloaded(edit::Editor& editor, StepReport& report) {
  break_constraints(editor, report);
  break_bonds(editor, report);
  break_hinges_and_nails(editor, report);
}

void switch_off_failed_surfaces(edit::Editor& editor, StepReport& report) {
  model::Model& model = editor.model;
  for (std::uint32_t slot = 0; slot < model.constraints.slot_count(); ++slot) {
    if (!model.constraints.is_alive(slot) || !model.constraints[slot].active) continue;
    for (const auto& surface : model.geometry(slot).surfaces) {
      if (!surface || surface->failure().empty()) continue;
      report.switched_off_constraints.push_back(model.constraints.id(slot));
      report.warnings.push_back(text("constraint ", slot, " (", ingredient::info(model.constraints[slot].kind).name,
                                     "): the function of its surface ", surface->failure(),
                                     "; the constraint is switched off"));
      apply(editor, edit::SetConstraintActive{model.constraints.id(slot), false});
      break;
    }
  }
}

}  // namespace iota::step
