// SPDX-License-Identifier: Apache-2.0
#include "edit/command_log.h"

#include <gtest/gtest.h>
#include <iota/system.h>

#include <atomic>
#include <thread>
#include <vector>

namespace iota {
namespace {

constexpr double each_step = 1e-9;  // s of real time, so that each step ends a piece

/// A pendulum, whose log is cut after each step.
struct CutLog {
  CutLog() {
    const ParticleId nail = system.particles().create(body, {0, 0, 0});
    end = system.particles().create(body, {1, 0, 0});
    system.particles().nail(nail);
    log.start(each_step);
    start = log.snapshot();
    (void)log.take();
  }
  void step() { (void)system.step(1.0 / 120); }
  System system;
  BodyId body = system.bodies().create();
  ParticleId end;
  Log log = system.log();
  Snapshot start;
};

TEST(CommandLog, is_cut_after_steps_and_its_pieces_lead_to_the_same_bits) {
  CutLog scene;
  System other;
  other.restore(scene.start);
  for (int piece = 0; piece < 4; ++piece) {
    for (int i = 0; i < piece; ++i) scene.step();
    const LogPiece cut = scene.log.take_cut();
    EXPECT_EQ(cut.commands.empty(), piece == 0);
    other.log().repeat(cut.commands);
    EXPECT_EQ(other.state_hash(), scene.system.state_hash()) << piece;
    EXPECT_EQ(cut.hash, piece == 0 ? 0 : other.log().hash()) << piece;
    EXPECT_EQ(cut.time, piece == 0 ? 0 : other.time()) << piece;
  }
}

TEST(CommandLog, gives_what_was_cut_to_one_who_takes_all) {
  CutLog scene;
  scene.step();
  scene.system.particles().set_velocity(scene.end, {0, 1, 0});
  System other;
  other.restore(scene.start);
  other.log().repeat(scene.log.take().commands);
  EXPECT_EQ(other.state_hash(), scene.system.state_hash());
  EXPECT_TRUE(scene.log.take_cut().commands.empty());
}

TEST(CommandLog, is_not_cut_in_a_batch_after_a_change_of_the_structure_nor_when_held) {
  CutLog scene;
  scene.system.edits().begin();
  scene.step();
  EXPECT_TRUE(scene.log.take_cut().commands.empty()) << "a state in the midst of a batch";
  (void)scene.system.edits().end();
  scene.step();
  EXPECT_FALSE(scene.log.take_cut().commands.empty());

  scene.system.particles().create(scene.body, {2, 0, 0});
  scene.step(), scene.step();
  EXPECT_TRUE(scene.log.take_cut().commands.empty()) << "other functions may be in use";
  EXPECT_FALSE(scene.log.take().commands.empty());
  scene.step();
  EXPECT_FALSE(scene.log.take_cut().commands.empty());

  scene.log.hold_cuts();
  scene.step();
  EXPECT_TRUE(scene.log.take_cut().commands.empty());
  (void)scene.log.take();
  scene.step();
  EXPECT_FALSE(scene.log.take_cut().commands.empty());
}

TEST(CommandLog, leaves_out_what_a_state_from_elsewhere_has_replaced) {
  CutLog scene;
  scene.step();
  scene.system.restore(scene.start);
  scene.step();
  const LogPiece taken = scene.log.take();
  EXPECT_TRUE(taken.is_broken);
  EXPECT_TRUE(taken.commands.empty());
  scene.step();
  EXPECT_FALSE(scene.log.take_cut().commands.empty());
  scene.log.stop();
  scene.step();
  EXPECT_TRUE(scene.log.take_cut().commands.empty());
}

TEST(CommandLog, is_read_by_another_thread_while_the_system_steps) {
  CutLog scene;
  System other;
  other.restore(scene.start);
  std::vector<std::byte> all;
  std::atomic<bool> ends = false;
  std::thread reader([&] {
    for (bool last = false; !last;) {
      last = ends;
      const LogPiece cut = scene.log.take_cut();
      all.insert(all.end(), cut.commands.begin(), cut.commands.end());
    }
  });
  for (int i = 0; i < 300; ++i) scene.step();
  ends = true;
  reader.join();
  other.log().repeat(all);
  EXPECT_EQ(other.state_hash(), scene.system.state_hash());
}

}  // namespace
}  // namespace iota
