// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "edit/editor.h"

namespace iota::step {

/// Breaks constraints, bonds, hinges and nails whose load in the step was above their limits.
void break_overloaded(edit::Editor&, StepReport&);

/// Switches off constraints on surfaces whose function has failed.
void switch_off_failed_surfaces(edit::Editor&, StepReport&);

}  // namespace iota::step
