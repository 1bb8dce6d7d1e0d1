// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "edit/editor.h"
#include "ingredient/outcome.h"

namespace iota::step {

/// Makes the edits to which a step has led, and writes them and the stops into its report.
void make_edits(edit::Editor&, const ingredient::Outcome&, StepReport&);

}  // namespace iota::step
