// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "edit/editor.h"

namespace iota::step {

/// Combines particles whose closing has ended.
void finish_closings(edit::Editor&, StepReport&);

}  // namespace iota::step
