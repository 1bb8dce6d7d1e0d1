// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>

/// The promises of motion, on random scenes (`MeasuredScene`), in all modes. All is measured from outside.
namespace iota::scenes {

enum class Promise : std::uint8_t {
  energy,      ///< is not made, and what is lost is reported
  velocities,  ///< are those of rigid bodies (modes that keep energy)
  momenta,     ///< of what nothing holds stay
  force,       ///< changes momentum and angular momentum, in every mode
  conflict,    ///< is shared, held and reported
  order,       ///< of arguments means nothing
  turns,       ///< are those of the bodies: shafts, gears and screws at 0.01 to 10 turns a step
  bounds,      ///< motors at their largest torque and friction do the work torque times angle
  rescue,      ///< momenta of what nothing holds stay in steps that are not solved, too
  field,       ///< moves a particle or a pendulum as the equation of motion says, to the order of the mode
  torque,      ///< times its time is the angular momentum that a free body gets
  count
};
const char* name_of(Promise);

/// Returns how a random scene breaks a promise, in a sentence.
std::optional<std::string> break_promise(Promise, std::uint64_t seed);

}  // namespace iota::scenes
