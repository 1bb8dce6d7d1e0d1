// SPDX-License-Identifier: Apache-2.0
// The sum of the energy book, which is zero at all times.
#pragma once

#include <iota/system.h>

namespace iota {

inline double book(const Energy& energy) { return energy.balance(); }
inline double book(const System& system) { return book(system.energy()); }

}  // namespace iota
