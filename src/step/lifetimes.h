// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "edit/editor.h"

namespace iota::step {

/// Oriented particles turn, particles age and die, emitters bear new ones.
void update_lifetimes(edit::Editor&, StepReport&);

}  // namespace iota::step
