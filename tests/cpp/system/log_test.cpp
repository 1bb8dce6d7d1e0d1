// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <iota/system.h>

#include <stdexcept>
#include <utility>
#include <vector>

namespace iota {
namespace {

/// A pendulum of three rods on a nail, and a ball that a spring holds.
struct LogScene {
  LogScene() {
    ParticleId last;
    for (int link = 0; link < 3; ++link) {
      const BodyId body = system.bodies().create();
      const ParticleId p = system.particles().create(body, {1.0 * link, 2, 0});
      const ParticleId q = system.particles().create(body, {1.0 * (link + 1), 2, 0.1 * link});
      if (link == 0)
        system.particles().nail(p);
      else
        (void)system.edits().combine(last, p);
      last = q;
      bodies.push_back(body);
    }
    end = last;
  }
  System system;
  std::vector<BodyId> bodies;
  ParticleId end;

  void steps(int count) {
    for (int i = 0; i < count; ++i) (void)system.step(1.0 / 120);
  }
  /// Edits of several kinds between steps, one of them undone.
  void live() {
    steps(5);
    system.particles().set_velocity(end, {1, 3, 0});
    const GripId grip = system.grips().create(bodies[1], {0, 0, 0}, {1, 1, 1});
    steps(7);
    system.edits().begin();
    system.bodies().destroy(bodies[2]);
    (void)system.edits().end();
    steps(3);
    EXPECT_TRUE(system.edits().undo());
    system.grips().destroy(grip);
    system.set_gravity({0, -3, 0});
    steps(4);
  }
};

TEST(Log, repeats_in_another_system_what_was_done_to_the_last_bit) {
  LogScene scene;
  scene.steps(10);
  Log log = scene.system.log();
  log.start();
  const Snapshot start = log.snapshot();
  (void)log.take();
  System other;
  other.restore(start);
  for (int piece = 0; piece < 3; ++piece) {
    if (piece == 1)
      scene.live();
    else
      scene.steps(6);
    const LogPiece taken = log.take();
    EXPECT_FALSE(taken.is_broken);
    other.log().repeat(taken.commands);
    EXPECT_EQ(other.state_hash(), scene.system.state_hash()) << piece;
    EXPECT_EQ(other.log().hash(), taken.hash) << piece;
    EXPECT_EQ(other.time(), taken.time) << piece;
  }
  EXPECT_TRUE(other.edits().redo()) << "undo reaches what was done before";
  EXPECT_FALSE(other.bodies().contains(scene.bodies[2]));
}

TEST(Log, is_kept_beside_a_recording_and_ends_when_it_is_stopped) {
  LogScene scene;
  scene.system.log().start();
  scene.system.record().start();
  EXPECT_TRUE(scene.system.log().take().is_broken) << "a recording forgets the states of undo";
  scene.steps(2);
  EXPECT_EQ(scene.system.log().take().commands, scene.system.record().stop().commands);
  scene.system.log().stop();
  scene.steps(1);
  EXPECT_TRUE(scene.system.log().take().commands.empty());
}

TEST(Log, is_broken_by_a_state_from_elsewhere) {
  LogScene scene;
  const Snapshot start = scene.system.snapshot();
  scene.system.log().start();
  scene.steps(3);
  scene.system.restore(start);
  scene.steps(1);
  const LogPiece taken = scene.system.log().take();
  EXPECT_TRUE(taken.is_broken);
  EXPECT_TRUE(taken.commands.empty());
  scene.steps(1);
  EXPECT_FALSE(scene.system.log().take().is_broken);
}

TEST(Log, refuses_damaged_commands_before_any_change) {
  LogScene scene;
  scene.system.log().start();
  const Snapshot start = scene.system.log().snapshot();
  scene.live();
  std::vector<std::byte> commands = scene.system.log().take().commands;
  System other;
  other.restore(start);
  const std::uint64_t before = other.state_hash();
  commands.pop_back();
  EXPECT_THROW(other.log().repeat(commands), std::invalid_argument);
  EXPECT_EQ(other.state_hash(), before);
}

TEST(Log, carries_the_states_of_undo_to_another_system) {
  LogScene scene;
  const auto bytes = [](const auto& states) {
    std::vector<Snapshot> all;
    for (const auto& state : states) all.push_back({{state.begin(), state.end()}});
    return all;
  };
  scene.system.edits().begin();
  scene.system.bodies().destroy(scene.bodies[2]);
  (void)scene.system.edits().end();
  Log log = scene.system.log();
  ASSERT_EQ(log.undo_states().size(), 1u);
  System other;
  other.restore(log.quick_snapshot());
  other.log().set_history(bytes(log.undo_states()), bytes(log.redo_states()));
  EXPECT_FALSE(other.bodies().contains(scene.bodies[2]));
  EXPECT_TRUE(other.edits().undo());
  EXPECT_TRUE(other.bodies().contains(scene.bodies[2]));
  std::vector<Snapshot> damaged = bytes(log.undo_states());
  damaged.front().bytes[100] ^= std::byte{1};
  EXPECT_THROW(other.log().set_history(std::move(damaged), {}), std::invalid_argument);
}

TEST(Log, tells_which_functions_are_missing_and_takes_them_by_key) {
  LogScene scene;
  const ParticleId free = scene.system.particles().create(scene.system.bodies().create(), {0, 5, 0});
  const ScriptedLaw pull{[](const BondState&) { return Vec3{0, 2, 0}; }, "pull"};
  (void)scene.system.bonds().create(scene.end, free, pull);
  Log log = scene.system.log();
  log.start();
  const Snapshot start = log.snapshot();
  (void)log.take();
  scene.steps(5);
  System other;
  other.restore(start);
  std::vector<FunctionUse> uses = other.log().functions();
  ASSERT_EQ(uses.size(), 1u);
  EXPECT_FALSE(uses[0].is_there);
  other.log().give_function(uses[0].key, pull);
  EXPECT_EQ(other.log().functions()[0].name, "pull");
  other.log().repeat(log.take().commands);
  EXPECT_EQ(other.state_hash(), scene.system.state_hash());

  System third;
  third.restore(start);
  third.log().start();
  (void)third.bonds().create(scene.end, free, ScriptedLaw{pull.force, "push"});
  uses = third.log().functions();
  ASSERT_EQ(uses.size(), 2u);
  EXPECT_EQ(uses[0].name, "") << "the new function has a key of its own";
  EXPECT_EQ(uses[1].name, "push");
}

}  // namespace
}  // namespace iota
