// SPDX-License-Identifier: Apache-2.0
#include "step/closings.h"

#include "edit/combine.h"
#include "ingredient/quantities.h"

namespace iota::step {

void finish_closings(edit::Editor& editor, StepReport& report) {
  model::Model& model = editor.model;
  std::vector<std::pair<Id<"closing">, edit::CombineParticles>> due;
  model.closings.for_each([&](std::uint32_t slot, ingredient::Closing& c) {
    c.elapsed += report.dt;
    if (c.elapsed >= c.duration)
      due.push_back({model.closings.id(slot), {model.particles.id(c.p), model.particles.id(c.q), 0}});
  });
  for (const auto& [closing, combine] : due) {
    if (!model.closings.contains(closing)) continue;  // destroyed by an earlier one
    ingredient::begin_edits(model);
    try {
      const RestructureReport combined = apply(editor, combine);
      report.unconverged += combined.remaining_gap > 0;
      for (const std::string& note : combined.notes) report.warnings.push_back(note);
    } catch (const std::exception& error) {  // impossible: gives up instead of trying again at every step
      if (model.closings.contains(closing)) (void)call_off(editor, closing.slot);
      report.warnings.push_back(error.what());
    }
  }
}

}  // namespace iota::step
