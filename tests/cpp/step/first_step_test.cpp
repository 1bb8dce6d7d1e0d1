// SPDX-License-Identifier: Apache-2.0
// What the first step of a scene costs: counted in calls of a function that each solve and each projection makes.
#include <iota/system.h>

#include <gtest/gtest.h>

#include <vector>

namespace iota {
namespace {

/// Calls of the surface's function during the first step of a row of particles on springs, the first on the surface.
int count_calls_in_first_step(int particles) {
  System system;
  std::vector<ParticleId> row;
  for (int i = 0; i < particles; ++i) {
    row.push_back(system.particles().create(system.bodies().create(), {0.1 * i, 0, 0}, 1e-3));
    if (i > 0) system.bonds().create(row[row.size() - 2], row.back(), SpringLaw{.stiffness = 1e3});
  }
  int calls = 0;
  const SurfaceFunction plane{[&](const Vec3& x) {
    ++calls;
    return x.y;
  }};
  system.joints().create(SurfaceSpec{.particle = row.front(), .surface = {plane, {}, {}}});
  calls = 0;
  (void)system.step(1.0 / 120);
  return calls;
}

TEST(FirstStep, projects_what_is_solved_together_once_however_many_bodies_it_has) {
  const int few = count_calls_in_first_step(4), many = count_calls_in_first_step(64);
  EXPECT_GT(few, 0);
  EXPECT_LE(many, 2 * few);
}

}  // namespace
}  // namespace iota
