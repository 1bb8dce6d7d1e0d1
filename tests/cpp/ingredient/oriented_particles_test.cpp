// SPDX-License-Identifier: Apache-2.0
#include "ingredient/oriented_particles.h"
#include "ingredient/quantities.h"
#include "tests/cpp/model/small_model.h"

#include <gtest/gtest.h>

namespace iota::ingredient {
namespace {

TEST(OrientedParticles, have_the_energy_and_momentum_of_a_ball_that_turns) {
  model::SmallModel m;
  m.model.gravity = {};
  const std::uint32_t body = m.body({{1, 2, 3}}), p = m.particle(body, 0);
  model::Attributes ball;
  ball.particle = p, ball.oriented = 1, ball.moment = 0.5, ball.spin = {0, 0, 4};
  m.model.particles[p].attributes = m.model.attributes.create(ball).slot;
  for (const Scope& scope : {Scope(m.model), Scope(m.model, body)}) {
    EXPECT_EQ(calc_energies(scope).kinetic, 4);
    EXPECT_EQ(calc_momenta(scope).angular, (Vec3{0, 0, 2}));
  }
  m.model.bodies[body].kind = BodyKind::inactive;
  EXPECT_EQ(calc_energies(m.model).kinetic, 0);
}

}  // namespace
}  // namespace iota::ingredient
