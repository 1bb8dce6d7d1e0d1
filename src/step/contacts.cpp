// SPDX-License-Identifier: Apache-2.0
#include "step/contacts.h"

#include "ingredient/joint_readings.h"

namespace iota::step {

void tell_contacts(model::Model& model, StepReport& report) {
  model.constraints.for_each([&](std::uint32_t slot, const auto& seen) {
    if (seen.carries.bits == seen.told.bits) return;
    auto& constraint = model.constraints[slot];
    for (int bit = 0; bit <= static_cast<int>(joint_coordinates.size()); ++bit) {
      if (constraint.carries[bit] == constraint.told[bit]) continue;
      ContactEvent& event = report.contacts.emplace_back();
      event.kind = constraint.carries[bit] ? ContactEvent::Kind::met : ContactEvent::Kind::parted;
      event.constraint = model.constraints.id(slot);
      if (bit > 0) event.stop = joint_coordinates[static_cast<std::size_t>(bit - 1)];
      event.position = ingredient::calc_reaction(model, slot).position;
    }
    constraint.told = constraint.carries;
  });
}

}  // namespace iota::step
