// SPDX-License-Identifier: Apache-2.0
#include "ingredient/nails.h"

#include <iota/system.h>

#include <gtest/gtest.h>

#include <cmath>

namespace iota {
namespace {

/// A pendulum of two rods; its nail is the world's only hold.
struct Pendulum {
  System system;
  BodyId upper = system.bodies().create(), lower = system.bodies().create();
  ParticleId top, middle, below, end;

  explicit Pendulum(IntegrationMode mode) : system(SystemOptions{.mode = mode}) {
    top = system.particles().create(upper, {0, 0, 0}, 2);
    middle = system.particles().create(upper, {0.6, -0.8, 0}, 3);
    below = system.particles().create(lower, {0.6, -0.8, 0}, 1);
    end = system.particles().create(lower, {1.6, -0.8, 0}, 4);
    (void)system.edits().combine(middle, below);
    system.particles().nail(top);
  }
};

TEST(Nails, push_with_the_change_of_momentum_less_gravity) {
  for (const IntegrationMode mode : {IntegrationMode::robust, IntegrationMode::energy_keeping}) {
    Pendulum p(mode);
    constexpr double h = 1e-3;
    // An energy-keeping step ends with a projection of velocities, which is not part of the force.
    const double tolerance = mode == IntegrationMode::energy_keeping ? 1e-4 : 1e-9;
    for (int i = 0; i < 50; ++i) {
      const Vec3 before = p.system.momentum();
      (void)p.system.step(h);
      const Vec3 force = (1 / h) * (p.system.momentum() - before) - 10 * p.system.gravity();
      EXPECT_LT(norm(p.system.particles().nail_force(p.top) - force), tolerance * norm(force)) << i;
      EXPECT_LT(norm(p.system.particles().position(p.top)), 1e-12);
    }
  }
}

TEST(Nails, that_carry_something_do_the_work_that_the_book_counts) {
  Pendulum p(IntegrationMode::energy_keeping);
  for (int i = 1; i <= 100; ++i) {
    p.system.particles().nail(p.top, {0.1 * std::sin(0.05 * i), 0.002 * i, 0});
    (void)p.system.step(0.01);
  }
  EXPECT_GT(std::abs(p.system.energy().external_work), 1);
  EXPECT_NEAR(p.system.energy().balance(), 0, 1e-9 * std::abs(p.system.energy().external_work));
}

TEST(Nails, of_static_particles_do_not_creep_under_a_load_however_often_islands_are_built) {
  for (const IntegrationMode mode : {IntegrationMode::robust, IntegrationMode::energy_keeping}) {
    System system(SystemOptions{.mode = mode});
    const BodyId post = system.bodies().create(), load = system.bodies().create();
    const ParticleId hook = system.particles().create(post, {0, 1, 0}, 1);
    (void)system.edits().combine(hook, system.particles().create(load, {0, 1, 0}, 1e6));
    system.bodies().set_kind(post, BodyKind::static_);
    for (int i = 0; i < 2000; ++i) system.restore(system.snapshot()), (void)system.step(1.0 / 60);
    EXPECT_LT(norm(system.particles().position(hook) - Vec3{0, 1, 0}), 1e-14);
  }
}

TEST(Nails, of_static_bodies_are_where_the_smallest_moves_of_the_script_lead) {
  System system;
  const BodyId post = system.bodies().create(), load = system.bodies().create();
  const ParticleId hook = system.particles().create(post, {0, 1, 0}, 1);
  (void)system.particles().create(post, {1e3, 1, 0}, 1);  // a large body
  (void)system.edits().combine(hook, system.particles().create(load, {0, 1, 0}, 1));
  system.bodies().set_kind(post, BodyKind::static_);
  for (int i = 1; i <= 100; ++i) {
    system.particles().set_position(hook, {1e-6 * i, 1, 0});
    for (int k = 0; k < 3; ++k) (void)system.step(1.0 / 60);
    EXPECT_NEAR(system.particles().position(hook).x, 1e-6 * i, 1e-11) << i;
  }
}

TEST(Nails, stay_where_they_are_when_their_ring_absorbs_another) {
  Pendulum p(IntegrationMode::robust);
  const ParticleId loose = p.system.particles().create(p.system.bodies().create(), {0, 1, 0});
  (void)p.system.edits().combine(loose, p.top);  // the second one's nail holds both
  EXPECT_TRUE(p.system.particles().is_nailed(loose));
  EXPECT_LT(norm(p.system.particles().position(loose)), 1e-12);
  (void)p.system.edits().separate(loose, p.top);
  EXPECT_NE(p.system.particles().is_nailed(loose), p.system.particles().is_nailed(p.top)) << "one nail, one ring";
  EXPECT_EQ(p.system.validate(), std::vector<std::string>{});
}

}  // namespace
}  // namespace iota
