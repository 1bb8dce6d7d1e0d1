// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "edit/editor.h"

namespace iota::step {

/// Combines particles whose time to meet is over.
void finish_closings(edit::Editor&, StepReport&);

}  // namespace iota::step
