// SPDX-License-Identifier: Apache-2.0
#include "ingredient/strides.h"

#include "ingredient/model.h"

#include <iota/system.h>

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

namespace iota {
namespace {

using ingredient::Strides;
using ingredient::Track;

struct OneParticle : testing::Test {
  model::Model model;
  std::uint32_t body = 0, ring = 0;
  void SetUp() override {
    body = model.make_body(BodyKind::dynamic, 0);
    ring = model.particles[model.make_particle(body, {1, 2, 3}, 1, {4, 5, 6})].ring;
  }
};

TEST_F(OneParticle, a_track_begins_and_ends_at_its_states_and_is_a_parabola_for_constant_acceleration) {
  const Vec3 from{1, 2, 3}, velocity{1, -2, 0.5}, acceleration{0, -9.81, 3};
  const double h = 0.01, whole = 8 * h;
  Track& track = model.tracks.make(ring);
  track.from = from, track.velocity_from = velocity, track.h = h, track.length = 8, track.points = 1;
  track.to = from + whole * velocity + 0.5 * whole * whole * acceleration;
  track.velocity_to = velocity + whole * acceleration;
  for (std::uint32_t steps = 0; steps <= 8; ++steps) {
    const double t = steps * h;
    Strides::show(model, ring, steps);
    EXPECT_LT(norm(model.rings[ring].position - (from + t * velocity + 0.5 * t * t * acceleration)), 1e-14);
    EXPECT_LT(norm(model.rings[ring].velocity - (velocity + t * acceleration)), 1e-13);
  }
}

TEST_F(OneParticle, a_stride_ends_at_a_beat_and_is_shorter_for_what_turns_fast) {
  const std::uint32_t bodies[] = {body};
  std::uint32_t ends = 0;
  for (model.step = 0; model.step < 64; model.step += Strides::length(model, 8, bodies, 0.01)) ++ends;
  EXPECT_LE(ends, 9u);
  EXPECT_EQ(model.step % 8, (64 + Strides::length(model, 8, bodies, 0.01)) % 8);
}

TEST(Strides, refuse_other_numbers_and_what_is_gone) {
  System system;
  const BodyId box = system.bodies().create(Box{{1, 1, 1}});
  for (const int steps : {-1, 17, 1000}) EXPECT_THROW(system.bodies().set_stride(box, steps), std::invalid_argument);
  for (const int steps : {0, 1, 2, 16}) {
    system.bodies().set_stride(box, steps);
    EXPECT_EQ(system.bodies().stride(box), steps);
  }
  system.bodies().destroy(box);
  EXPECT_THROW(system.bodies().set_stride(box, 2), StaleIdError);
  EXPECT_THROW((void)system.bodies().stride(box), StaleIdError);
  EXPECT_TRUE(system.validate().empty());
}

TEST(Strides, of_a_body_that_was_made_before_them_in_the_same_step_stay) {
  System system;
  const BodyId box = system.bodies().create(Box{{1, 1, 1}});
  system.bodies().set_stride(box, 4);
  for (int i = 0; i < 3; ++i) (void)system.step(0.01);
  EXPECT_EQ(system.bodies().stride(box), 4);
  system.bodies().set_velocity(box, {1, 0, 0});
  (void)system.step(0.01);
  EXPECT_EQ(system.bodies().stride(box), 1);
}

}  // namespace
}  // namespace iota
