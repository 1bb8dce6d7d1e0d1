// SPDX-License-Identifier: Apache-2.0
#include "edit/grips.h"

#include "scenes/chain.h"

#include <iota/system.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <stdexcept>
#include <vector>

namespace iota {
namespace {

TEST(Grip, holds_the_place_of_a_turned_body_that_it_was_given_in_that_bodys_frame) {
  System system{SystemOptions{.gravity = {}}};
  const double half = 0.4;
  const BodyId box = system.bodies().create(
      Box{{0.2, 0.4, 0.6}}, {.position = {1, 2, 3}, .orientation = {0, 0, std::sin(half), std::cos(half)}});
  (void)system.grips().create(box, {0.1, 0, 0.3}, {5, 5, 5}, {.client = 7, .hold = 2});
  const PoseSnapshot poses = system.viewer().poses();
  ASSERT_EQ(poses.holds.size(), 1u);
  const HoldPose& hold = poses.holds[0];
  EXPECT_EQ(hold.client, 7u);
  EXPECT_EQ(hold.hold, 2u);
  EXPECT_EQ(hold.body, box.slot);
  EXPECT_NEAR(hold.point[0], 1 + 0.1 * std::cos(2 * half), 1e-6);
  EXPECT_NEAR(hold.point[1], 2 + 0.1 * std::sin(2 * half), 1e-6);
  EXPECT_NEAR(hold.point[2], 3.3, 1e-6);
  EXPECT_EQ(hold.target[0], 5);
}

/// A page looks at frames all the time; who replays what it did does not, and went on with other bits.
TEST(Grip, of_a_rod_does_not_depend_on_who_has_looked_at_its_frame) {
  System looked_at, other;
  std::vector<BodyId> rods;
  for (System* const system : {&looked_at, &other}) {
    const scenes::Chain chain = scenes::make_chain(*system, {.links = 5});
    rods = chain.links;
    system->particles().set_velocity(chain.lower.back(), {0, 0, 3});
    for (int i = 0; i < 30; ++i) {
      (void)system->step(1.0 / 120);
      if (system == &looked_at) (void)system->viewer().poses();
    }
    (void)system->grips().create(rods[3], {0.02, 0.01, -0.005}, {1, 1, 1});
    (void)system->step(1.0 / 120, 5);
  }
  EXPECT_EQ(looked_at.state_hash(), other.state_hash());
}

TEST(Grip, with_numbers_that_no_hand_has_is_refused_and_changes_nothing) {
  System system;
  const BodyId empty = system.bodies().create(), body = system.bodies().create(Sphere{0.1});
  const std::uint64_t before = system.state_hash();
  EXPECT_THROW(system.grips().create(empty, {}, {}), std::invalid_argument);
  EXPECT_THROW(system.grips().create(body, {}, {}, {.frequency = 0}), std::invalid_argument);
  EXPECT_THROW(system.grips().create(body, {}, {}, {.max_acceleration = -1}), std::invalid_argument);
  EXPECT_THROW(system.grips().create(body, {}, {std::nan(""), 0, 0}), std::invalid_argument);
  EXPECT_EQ(system.state_hash(), before);
  const GripId grip = system.grips().create(body, {}, {});
  EXPECT_THROW(system.grips().move(grip, {std::nan(""), 0, 0}), std::invalid_argument);
  system.grips().destroy(grip);
  EXPECT_THROW(system.grips().move(grip, {}), StaleIdError);
}

// A body at rest gets h f/m in a short step, by the law of a spring near the target, and by the largest acceleration from afar.
TEST(Grip, pulls_with_its_largest_acceleration_from_afar_and_as_a_spring_from_near) {
  constexpr double frequency = 2, largest = 7, h = 1e-5;
  const double omega = 2 * std::numbers::pi * frequency;
  for (const double mass : {0.1, 40.0}) {
    for (const double distance : {0.001, 0.04, 0.05, 1.0, 1e3, 1e6}) {
      System system{SystemOptions{.gravity = {}}};
      const BodyId ball = system.bodies().create(Sphere{0.1}, {.mass = mass});
      (void)system.grips().create(ball, {}, {distance, 0, 0}, {.frequency = frequency, .max_acceleration = largest});
      (void)system.step(h);
      const double wanted = std::min(omega * omega * distance, largest);
      EXPECT_NEAR(system.bodies().velocity(ball).x / h, wanted, 1e-3 * wanted) << mass << " kg, " << distance << " m";
    }
  }
}

// A hand lifts half of what hangs at a body by its hinges; what stands fixed does not hang.
TEST(Grip, of_a_body_on_a_hinge_does_not_lift_what_stands_fixed) {
  const auto speed = [](double mass, BodyKind kind) {
    System system{SystemOptions{.gravity = {}}};
    const BodyId post = system.bodies().create(), rod = system.bodies().create();
    (void)system.particles().create(post, {-1, 0, 0}, mass);
    const ParticleId top = system.particles().create(post, {}, mass), start = system.particles().create(rod, {}, 1);
    (void)system.particles().create(rod, {1, 0, 0}, 1);
    (void)system.edits().combine(top, start);
    system.bodies().set_kind(post, kind);
    (void)system.grips().create(rod, {1, 0, 0}, {1, 1e-3, 0});
    (void)system.step(1e-4);
    return norm(system.bodies().velocity(rod));
  };
  EXPECT_NEAR(speed(1000, BodyKind::static_), speed(1, BodyKind::static_), 1e-9 * speed(1, BodyKind::static_));
  EXPECT_GT(speed(1000, BodyKind::dynamic), 2 * speed(1, BodyKind::dynamic)) << "what hangs counts";
}

// Islands are built in parallel: one took the grip of another into its own numbers, and read memory that is not its own.
TEST(Grip, before_the_first_step_of_many_islands_pulls_only_its_own) {
  constexpr int chains = 200, links = 4;
  for (int trial = 0; trial < 20; ++trial) {
    System system{SystemOptions{.gravity = {}}};
    std::vector<BodyId> rods;
    for (int chain = 0; chain < chains; ++chain) {
      ParticleId last;
      for (int link = 0; link < links; ++link) {
        const BodyId rod = rods.emplace_back(system.bodies().create());
        const ParticleId start = system.particles().create(rod, {1.0 * link, 0, 3.0 * chain}, 1);
        if (link > 0) (void)system.edits().combine(last, start);
        last = system.particles().create(rod, {1.0 * link + 1, 0, 3.0 * chain}, 1);
      }
    }
    const BodyId held = rods[(trial * 37 % chains) * links];
    const Vec3 place = system.bodies().center_of_mass(held);
    (void)system.grips().create(held, {}, place + Vec3{0, 1, 0});
    (void)system.step(1.0 / 120);
    for (std::size_t i = 0; i < rods.size(); ++i) {
      const bool is_beside = i / links == static_cast<std::size_t>(trial * 37 % chains);
      EXPECT_EQ(norm(system.bodies().velocity(rods[i])) > 0, is_beside) << "rod " << i;
    }
  }
}

}  // namespace
}  // namespace iota
