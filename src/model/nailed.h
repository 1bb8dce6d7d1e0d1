// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace iota::model {

/// Values of `Ring::nailed` but 0. A nail is the user's; a carried ring is held where the script moved a scripted body, for
/// as long as that is scripted.
inline constexpr std::uint16_t by_nail = 1, carried = 2;

}  // namespace iota::model
