// SPDX-License-Identifier: Apache-2.0
// All that an ingredient does by being in the list: it acts in steps, counts, is saved, and follows edits.
#include <iota/system.h>

#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <string>
#include <vector>

namespace iota {
namespace {

/// A rod of 2 kg along y, at rest without gravity, with 4 N at its lower end.
struct LiftedRod {
  System system{SystemOptions{.gravity = {}}};
  BodyId rod = system.bodies().create();
  ParticleId low = system.particles().create(rod, {}, 1), high = system.particles().create(rod, {0, 1, 0}, 1);
  BalloonId balloon = system.balloons().create(low, {0, 4, 0});

  double height() const { return system.particles().position(low).y; }
  void step(int count) {
    for (int i = 0; i < count; ++i) (void)system.step(0.01);
  }
};

TEST(Balloons, lift_a_body_and_count_in_energy_and_load) {
  LiftedRod lifted;
  const double before = lifted.system.energy().total();
  lifted.step(100);
  EXPECT_NEAR(lifted.height(), 0.5 * (4.0 / 2) * 1, 1e-9);  // F / m t^2 / 2
  EXPECT_NEAR(lifted.system.energy().total(), before, 1e-9);
}

TEST(Balloons, come_back_from_a_snapshot_and_follow_their_particle) {
  LiftedRod lifted;
  const Snapshot saved = lifted.system.snapshot();
  lifted.step(50);
  const double height = lifted.height();
  lifted.system.balloons().set_lift(lifted.balloon, {});
  lifted.system.restore(saved);
  EXPECT_EQ(lifted.height(), 0);
  lifted.step(50);
  EXPECT_EQ(lifted.height(), height);
  (void)lifted.system.edits().combine(lifted.high, lifted.low);
  EXPECT_TRUE(lifted.system.balloons().contains(lifted.balloon));
  EXPECT_EQ(lifted.system.validate(), std::vector<std::string>{});
  lifted.system.bodies().destroy(lifted.rod);
  EXPECT_FALSE(lifted.system.balloons().contains(lifted.balloon));
  EXPECT_THROW(lifted.system.balloons().destroy(lifted.balloon), StaleIdError);
}

/// Its commands are in the list of all: a recording has them, and they can be undone and asked for during a step.
TEST(Balloons, are_replayed_and_undone) {
  LiftedRod lifted;
  lifted.system.record().start();
  lifted.step(10);
  lifted.system.balloons().set_lift(lifted.balloon, {0, -4, 0});
  lifted.step(10);
  const Recording recording = lifted.system.record().stop();
  EXPECT_EQ(lifted.system.record().replay(recording), std::nullopt);
  lifted.system.edits().begin();
  lifted.system.balloons().destroy(lifted.balloon);
  (void)lifted.system.edits().end();
  EXPECT_TRUE(lifted.system.edits().undo());
  EXPECT_EQ(lifted.system.balloons().lift(lifted.balloon), (Vec3{0, -4, 0}));
  EXPECT_THROW(lifted.system.balloons().create(lifted.low, {0, std::nan(""), 0}), std::invalid_argument);
}

}  // namespace
}  // namespace iota
