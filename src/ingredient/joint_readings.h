// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ingredient/loads.h"
#include "ingredient/model.h"

#include <cstdint>
#include <span>
#include <utility>

namespace iota::ingredient {

/// Updates the model's coordinates of a joint from the present places.
void refresh_coordinates(model::Model&, std::uint32_t joint);

/// After bodies of these joints were set to other places: counts as many turns of their angles that screws and couplings are
/// met, if any number does that, and seeks places on the whole of their paths. Places tell angles but for turns; a wheel and its
/// rack that were set back together agree about them.
void count_turns(model::Model&, std::span<const std::uint32_t> joints);

/// Finds the state from which the rows of a new joint start: the nearest points of its two surfaces.
void start_rows(model::Model&, std::uint32_t joint);

/// Force and torque of a joint (a coupling: of its first joint) on its side a in the last step, about `position`.
struct Reaction {
  Vec3 position, force, torque;
};
Reaction calc_reaction(const model::Model&, std::uint32_t joint);

/// Force of a joint, and of couplings of its coordinates, on one of its places in the last step, N.
Vec3 calc_force_at(const LastStep&, std::uint32_t joint, int place);

/// The largest violation of a joint, without limits, at the present places: absolute (m; rad for directions), and
/// relative to the reference length of its row.
struct Violation {
  double absolute = 0, relative = 0;
};
Violation calc_violation(const model::Model&, std::uint32_t joint);

/// The multiplier of the friction along a joint's line by its friction coefficient, N; 0 without one.
double friction_of_line(const Constraint&);

/// Energy of a joint's compliance at the present places, J.
double calc_energy_of_holds(const model::Model&, std::uint32_t joint);

/// False if its bodies are too thin for a coordinate of its kind.
bool has_coordinate_row(const model::Model&, std::uint32_t joint, JointCoordinate);

/// Value and speed of a coordinate at the present places; the angle is unwrapped near the last one.
std::pair<double, double> calc_coordinate(const model::Model&, std::uint32_t joint, JointCoordinate);

}  // namespace iota::ingredient
