// SPDX-License-Identifier: Apache-2.0
// Readings of mode accurate.
#include "scenes/chain.h"

#include <gtest/gtest.h>

namespace iota {
namespace {

TEST(Accurate, loads_from_outside_are_mass_times_acceleration_whatever_the_sub_steps) {
  System system({.mode = IntegrationMode::accurate, .damping = 0.3, .tolerance = 1e-8});
  const auto chain = scenes::make_chain(system, {.links = 6, .direction = {1, 0, 0}});
  const BodyId anchor = system.bodies().create();
  const ParticleId fixed = system.particles().create(anchor, {0, 3, 0}, 1);
  system.particles().nail(fixed);
  system.bonds().create(chain.lower[5], fixed, SpringLaw{.stiffness = 20, .damping = 2});
  int substeps = 0;
  for (int i = 0; i < 60; ++i) {
    substeps = std::max(substeps, system.step(1.0 / 60).substeps_max);
    for (const BodyId body : chain.links) {
      const Vec3 net = system.bodies().net_force(body), outside = system.bodies().outside_force(body, {});
      ASSERT_LT(norm(net - outside), 1e-8 * (1 + norm(net))) << "step " << i;
    }
  }
  EXPECT_GT(substeps, 1) << "or the scene is no test";
}

TEST(Accurate, the_force_on_a_nail_is_the_one_at_the_end_of_the_step) {
  System system({.mode = IntegrationMode::accurate});
  const BodyId rod = system.bodies().create();
  const ParticleId top = system.particles().create(rod, {0, 0, 0}, 1),
                   bob = system.particles().create(rod, {1, 0, 0}, 1);
  system.particles().nail(top);
  for (int i = 0; i < 30; ++i) {
    (void)system.step(1.0 / 60);
    const Vec3 x = system.particles().position(bob), v = system.particles().velocity(bob);
    const double tension = dot(v, v) - 9.81 * x.y;  // m v^2 / r + m g cos(angle)
    EXPECT_LT(norm(system.particles().hinge_force(top) - (-tension * x + Vec3{0, 9.81, 0})), 1e-9)
        << "and half of the rod's weight hangs on the nail itself";
  }
}

}  // namespace
}  // namespace iota
