// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace iota {

inline constexpr double g = 9.81;  ///< of the earth and of a system unless told otherwise, m/s2

}  // namespace iota
