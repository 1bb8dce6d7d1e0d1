// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ingredient/model.h"

namespace iota::step {

/// Reports the one-sided constraints and stops that began or ceased to carry a load since the last call.
void tell_contacts(model::Model&, StepReport&);

}  // namespace iota::step
