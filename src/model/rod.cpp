// SPDX-License-Identifier: Apache-2.0
// Rods: two points with an inertia pair.
#include "model/structure.h"

#include <algorithm>

namespace iota::model {

// Mass [A B; B A] with A + B = m/2 and A - B = m/2 + 2J = 2 It/L^2, and of a cylinder It = m L^2/12 + Ia/2.
double Structure::axial_inertia(std::uint32_t slot) const {
  const Body& body = bodies[slot];
  if (body.rank != 2 || body.first_inertia == none || inertia_pairs[body.first_inertia].next != none) return 0;
  const InertiaPair& pair = inertia_pairs[body.first_inertia];
  const double mass = particles[pair.p].mass + particles[pair.q].mass, length = body.first_row.length;
  return std::max(0.0, (mass / 3 + 2 * pair.inertia) * length * length);
}

Vec3 Structure::rod_axis(std::uint32_t body) const {
  const InertiaPair& pair = inertia_pairs[bodies[body].first_inertia];
  const Vec3 along = position(pair.q) - position(pair.p);
  return (1 / norm(along)) * along;
}

}  // namespace iota::model
