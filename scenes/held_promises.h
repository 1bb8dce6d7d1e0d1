// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>

/// The promises of held forces and torques on random scenes, judged by places and velocities alone: the truth is integrated
/// here, by the Runge-Kutta rule of fourth order.
namespace iota::scenes {

std::optional<std::string> check_field(std::uint64_t seed);
std::optional<std::string> check_torque(std::uint64_t seed);

}  // namespace iota::scenes
