// SPDX-License-Identifier: Apache-2.0
#include "step/edits.h"

#include "edit/bonds.h"
#include "edit/combine.h"
#include "edit/constraints.h"
#include "edit/nails.h"
#include "edit/particles.h"
#include "edit/separate.h"
#include "ingredient/quantities.h"

#include <algorithm>

namespace iota::step {

namespace {

void switch_off(edit::Editor& editor, ConstraintId constraint, StepReport& report) {
  report.switched_off_constraints.push_back(constraint);
  apply(editor, edit::SetConstraintActive{constraint, false});
}

void end_particle(edit::Editor& editor, ParticleId particle, StepReport& report) {
  model::Model& model = editor.model;
  if (!model.particles.contains(particle)) return;  // destroyed with another one
  const std::uint32_t before = model.structure_version, is_spark = model.is_spark(particle.slot);
  apply(editor, edit::Destroy<ParticleId>{particle});
  if (is_spark) model.spark_changes += model.structure_version - before;
  report.died.push_back(particle);
}

/// False if an edit before has already ended it.
bool break_constraint(edit::Editor& editor, ConstraintId constraint) {
  model::Model& model = editor.model;
  if (!model.constraints.contains(constraint) || !model.constraints[constraint.slot].active) return false;
  apply(editor, edit::SetConstraintActive{constraint, false});
  model.constraints[constraint.slot].broken = 1;
  return true;
}

bool break_bond(edit::Editor& editor, BondId bond) {
  model::Model& model = editor.model;
  if (!model.bonds.contains(bond)) return false;
  apply(editor, edit::SetBondActive{bond, false});
  model.bonds[bond.slot].broken = 1;
  return true;
}

bool break_hinge_or_nail(edit::Editor& editor, ParticleId particle) {
  model::Model& model = editor.model;
  if (!model.particles.contains(particle)) return false;
  const model::Ring& ring = model.rings[model.particles[particle.slot].ring];
  const std::uint32_t other = ring.first == particle.slot ? ring.last : ring.first;
  if (ring.count > 1)
    (void)apply(editor, edit::Separate{model.particles.id(other), particle});
  else if (ring.nailed)
    apply(editor, edit::Release{particle});
  else
    return false;
  return true;
}

void break_one(edit::Editor& editor, const Broken& broken, StepReport& report) {
  if (broken.constraint ? !break_constraint(editor, broken.constraint)
      : broken.bond     ? !break_bond(editor, broken.bond)
                        : !break_hinge_or_nail(editor, broken.particle))
    return;
  report.broken.push_back(broken);
  // A separation and a release note their events themselves.
  if (!broken.particle) editor.model.scene.note(ViewEvent::Kind::break_, broken.position);
}

void combine(edit::Editor& editor, Id<"closing"> closing, StepReport& report) {
  model::Model& model = editor.model;
  if (!model.closings.contains(closing)) return;  // destroyed by an earlier edit
  const ingredient::Closing& c = model.closings[closing.slot];
  try {
    const RestructureReport combined =
        apply(editor, edit::CombineParticles{model.particles.id(c.p), model.particles.id(c.q), 0});
    report.unconverged += combined.remaining_gap > 0;
    for (const std::string& note : combined.notes) report.warnings.push_back(note);
  } catch (const std::exception& error) {  // impossible: gives up instead of trying again at every step
    if (model.closings.contains(closing)) (void)call_off(editor, closing.slot);
    report.warnings.push_back(error.what());
  }
}

void edit_all(edit::Editor& editor, const ingredient::Outcome& told, StepReport& report) {
  model::Model& model = editor.model;
  ingredient::begin_edits(model);
  for (const ConstraintId constraint : told.failed) switch_off(editor, constraint, report);
  for (const ParticleId particle : told.ended) end_particle(editor, particle, report);
  for (const EmitterId emitter : told.due) ingredient::Emitters::bear(model, emitter.slot, report.dt, report.born);
  const auto break_all = [&](auto kind) {
    for (const Broken& broken : told.overloaded)
      if (broken.*kind) break_one(editor, broken, report);
  };
  break_all(&Broken::constraint), break_all(&Broken::bond);
  break_all(&Broken::particle);  // a hinge is separated without the joints and bonds that break in the same step
  for (const Id<"closing"> closing : told.met) combine(editor, closing, report);
}

}  // namespace

void make_edits(edit::Editor& editor, const ingredient::Outcome& told, StepReport& report) {
  report.warnings.insert(report.warnings.end(), told.warnings.begin(), told.warnings.end());
  if (told.has_edits()) edit_all(editor, told, report);
  for (const StopEvent& event : told.stops)
    if (editor.model.constraints.contains(event.constraint)) report.stops.push_back(event);
}

}  // namespace iota::step
