// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "contact/outlines.h"
#include "edit/door.h"
#include "step/stepper.h"

#include <iota/system.h>

namespace iota {

/// The parts of a system. Each uses those above it in this list.
struct Core {
  model::Model model;
  Parallel parallel;
  island::Islands islands;
  held::HeldForces held{model, parallel};
  read::Orientations orientations;
  edit::Editor editor{model, islands, held, orientations, parallel};
  edit::Door door{editor};
  contact::Outlines outlines{model};
  step::ContactWatches watches;
  step::Stepper stepper{editor, door, outlines, watches};

  /// All changes go through it.
  template <class C>
  auto execute(const C& command) {
    if constexpr (std::is_same_v<C, edit::Step>) {
      if (door.is_stepping()) edit::Door::refuse_in_step();
      StepReport report = stepper.step(command.dt);
      door.record_step(command);
      return report;
    } else {
      return door.execute(command);
    }
  }

  /// The command that the reader reads next.
  void execute_next(Reader&);

  /// Slot of an existing object. Throws StaleIdError, which says what became of it.
  template <class IdType>
  std::uint32_t slot(IdType id) const {
    return edit::require(model, id);
  }
};

}  // namespace iota
