// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "edit/editor.h"

namespace iota::step {

/// Rotates oriented particles by the torques of the step.
void turn_particles(model::Model&, double h);

/// Ages particles, destroys them at the end of their lifetime, and creates those of emitters.
void update_lifetimes(edit::Editor&, StepReport&);

}  // namespace iota::step
