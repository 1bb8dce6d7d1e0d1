// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "model/structure.h"

#include <cstdint>

/// The outline of a body: with it the body touches, is drawn, and is found by queries.
///   - a body given by shape: its solids;
///   - a single particle: a ball;
///   - any other body: its lines (Structure::visit_lines) with the radius of the body, and a ball at each particle that
///     has a radius of its own (Attributes::radius).
/// A body without a radius of its own has the usual radius of the system. This is chosen once, at the begin of the first
/// step that finds a body, from the structure alone, and is saved with it. So a replay or a restored system has the same
/// number, whoever asks or looks on. Before that step the number that would be chosen now holds.
namespace iota::model {

/// Radius of the lines of bodies that have none of their own, m.
double usual_radius(Structure&);
/// Chooses it, unless it is chosen already or no body has a particle.
void choose_usual_radius(Structure&);
/// Radius of the lines of a body, or of the ball of its only particle, m; 0 for a body given by shape.
double radius_of(Structure&, std::uint32_t body);
/// The body's own from now on; that of its only particle, if this has one.
void set_radius(Structure&, std::uint32_t body, double radius);

/// Diagonal of the box around all particles, m; 0 without particles.
double scene_extent(const Structure&);

}  // namespace iota::model
