// SPDX-License-Identifier: Apache-2.0
// Forces that attract more the nearer two bodies are.
#include "tests/cpp/modes.h"

#include <iota/system.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <array>

namespace iota {
namespace {

TEST(AttractingPoles, do_not_catch_the_bodies_of_a_figure_of_eight) {
  for (const IntegrationMode mode : all_modes) {
    System system({.gravity = {}});
    system.set_mode(mode);
    const Vec3 x{0.97000436, -0.24308753, 0}, v{-0.93240737, -0.86473146, 0};
    std::array<ParticleId, 3> bodies;
    const std::array places{x, -x, Vec3{}}, velocities{-0.5 * v, -0.5 * v, v};
    for (std::size_t i = 0; i < 3; ++i)
      bodies[i] = system.particles().create(system.bodies().create(), places[i], 1, velocities[i]);
    const SharedLaw gravity{system.laws().find("gravity"), {{"strength", 1}, {"softening", 0}}, true};
    for (std::size_t i = 0; i < 3; ++i) system.bonds().create(bodies[i], bodies[(i + 1) % 3], gravity);
    double nearest = 1;
    for (int i = 0; i < 360; ++i) {
      const StepReport report = system.step(1.0 / 60);
      EXPECT_EQ(report.unconverged, 0) << "mode " << int(mode) << ", step " << i;
      EXPECT_LT(report.energy.lost, 1.3) << "of 1.3 J";
      for (std::size_t k = 0; k < 3; ++k)
        nearest = std::min(
            nearest, norm(system.particles().position(bodies[k]) - system.particles().position(bodies[(k + 1) % 3])));
    }
    EXPECT_GT(nearest, 0.1) << "mode " << int(mode);
  }
}

}  // namespace
}  // namespace iota
