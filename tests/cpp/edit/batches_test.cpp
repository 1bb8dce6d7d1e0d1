// SPDX-License-Identifier: Apache-2.0
#include "scenes/chain.h"

#include <iota/system.h>

#include <gtest/gtest.h>

namespace iota {
namespace {

TEST(EditBatch, has_one_report_for_all) {
  System system;
  const auto chain = scenes::make_chain(system, {.links = 6});
  (void)system.step(0.01);
  const double energy = system.energy().edits;
  system.edits().begin();
  const BodyId ball = system.bodies().create(Sphere{0.1}, {.attachments = {{0, 0, 0}}});
  (void)system.edits().separate(chain.lower[1], chain.upper[2]);
  system.edits().begin();  // part of the batch
  (void)system.edits().separate(chain.lower[3], chain.upper[4]);
  system.bodies().destroy(chain.links[5]);
  EXPECT_FALSE(system.edits().end().changed);
  (void)system.edits().combine(chain.links[2], chain.links[3]);
  const RestructureReport report = system.edits().end();
  EXPECT_TRUE(report.changed);
  EXPECT_EQ(report.created_bodies, std::vector<BodyId>{ball});
  EXPECT_EQ(report.created_particles.size(), 5u);
  EXPECT_EQ(report.destroyed_bodies, std::vector<BodyId>{chain.links[5]});
  EXPECT_EQ(report.destroyed_particles, (std::vector<ParticleId>{chain.upper[5], chain.lower[5]}));
  ASSERT_EQ(report.absorbed_bodies.size(), 1u);
  EXPECT_EQ(report.absorbed_bodies[0].retired, chain.links[3]);
  EXPECT_EQ(report.articulates_before, 1u);
  EXPECT_EQ(report.articulates_after, 4u);
  EXPECT_NE(report.energy_change, 0);
  EXPECT_NEAR(report.energy_change, system.energy().edits - energy, 1e-14);  // a difference of sums
  EXPECT_THROW((void)system.edits().end(), std::logic_error);
}

// The halves of a long chain stay in one island for some steps after a cut, unless it is built anew.
TEST(EditBatch, leaves_the_islands_that_follow_cuts_as_they_are) {
  System system{{.mode = IntegrationMode::robust}};
  const auto chain = scenes::make_chain(system, {.links = 200});
  (void)system.step(0.01);
  (void)system.edits().separate(chain.lower[99], chain.upper[100]);
  (void)system.step(0.01);
  ASSERT_EQ(system.islands().size(), 1u);
  system.edits().begin();
  system.bodies().set_damping(chain.links[50], 0.1);
  (void)system.edits().end();
  (void)system.step(0.01);
  EXPECT_EQ(system.islands().size(), 1u);
  (void)system.snapshot();  // others continue from it to the same bits
  (void)system.step(0.01);
  EXPECT_EQ(system.islands().size(), 2u);
}

TEST(EditBatch, angles_are_counted_on_from_its_begin_and_not_from_places_between_its_edits) {
  for (int k = -6; k <= 6; ++k) {
    System system({.gravity = {}});
    const BodyId a = system.bodies().create(Capsule{0.1, 0.3}, {.mass = 1});
    const BodyId b = system.bodies().create(Capsule{0.1, 0.3}, {.mass = 1, .position = {0.5, 0, 0}});
    const ConstraintId hinge = system.joints().create(
        JointSpec{.kind = ConstraintKind::revolute, .a = b, .b = a, .at = {0.25, 0, 0}, .axis = {0, 1, 0}});
    system.joints().set_value(hinge, JointCoordinate::angle, -2);
    system.bodies().set_angular_velocity(a, {0, 0.5 * k, 0}), system.bodies().set_angular_velocity(b, {0, 0.5 * k, 0});
    for (int i = 0; i < 60; ++i) (void)system.step(1.0 / 60);  // both turn by k / 2
    system.edits().begin();
    system.bodies().set_pose(a, {}, {}), system.bodies().set_pose(b, {0.5, 0, 0}, {});
    (void)system.edits().end();
    EXPECT_NEAR(system.joints().state(hinge).coordinate[0], 0, 1e-9) << k;
    system.edits().begin();
    system.bodies().set_pose(a, {}, {}), system.joints().set_value(hinge, JointCoordinate::angle, 7);
    (void)system.edits().end();
    EXPECT_NEAR(system.joints().state(hinge).coordinate[0], 7, 1e-9) << k;
  }
}

TEST(EditBatch, undo_and_redo_give_the_same_hash) {
  System system;
  const auto chain = scenes::make_chain(system, {.links = 6});
  for (int i = 0; i < 10; ++i) (void)system.step(0.01);
  const std::uint64_t before = system.state_hash();
  system.edits().begin();
  (void)system.edits().separate(chain.lower[1], chain.upper[2]);
  system.bodies().destroy(chain.links[5]);
  (void)system.edits().end();
  for (int i = 0; i < 5; ++i) (void)system.step(0.01);
  const std::uint64_t after = system.state_hash();
  EXPECT_TRUE(system.edits().undo());
  EXPECT_EQ(system.state_hash(), before);
  EXPECT_TRUE(system.bodies().contains(chain.links[5]));
  EXPECT_TRUE(system.validate().empty());
  EXPECT_FALSE(system.edits().undo());
  EXPECT_TRUE(system.edits().redo());
  EXPECT_EQ(system.state_hash(), after);
  EXPECT_FALSE(system.edits().redo());
  EXPECT_TRUE(system.edits().undo());
  system.edits().begin();  // an empty one is no edit
  system.edits().begin();
  (void)system.edits().end();
  (void)system.edits().end();
  EXPECT_EQ(system.edits().redo_count(), 1u);
  EXPECT_EQ(system.edits().undo_count(), 0u);
  system.edits().begin();  // a new edit ends the way forward
  (void)system.bodies().create();
  (void)system.edits().end();
  EXPECT_EQ(system.edits().redo_count(), 0u);
  EXPECT_EQ(system.edits().undo_count(), 1u);
  for (int i = 0; i < 5; ++i) EXPECT_EQ(system.step(0.01).unconverged, 0);
}

TEST(EditBatch, a_canceled_one_never_was) {
  System system;
  const auto chain = scenes::make_chain(system, {.links = 3});
  const std::uint64_t before = system.state_hash();
  system.edits().begin();
  system.bodies().destroy(chain.links[1]);
  EXPECT_THROW((void)system.edits().undo(), std::logic_error);
  system.edits().cancel();
  EXPECT_EQ(system.state_hash(), before);
  EXPECT_EQ(system.edits().undo_count(), 0u);
}

TEST(EditBatch, that_is_not_undoable_is_no_step_of_an_undo) {
  System system;
  const std::uint64_t before = system.state_hash();
  system.edits().begin();
  const BodyId first = system.bodies().create();
  (void)system.edits().end();
  system.edits().begin(false);
  const BodyId second = system.bodies().create();
  system.edits().begin();  // within it
  (void)system.bodies().create();
  (void)system.edits().end();
  (void)system.edits().end();
  EXPECT_EQ(system.edits().undo_count(), 1u);
  EXPECT_TRUE(system.edits().undo());
  EXPECT_EQ(system.state_hash(), before);
  EXPECT_FALSE(system.bodies().contains(first) || system.bodies().contains(second));
  system.edits().begin(false);
  (void)system.bodies().create();
  (void)system.edits().end();
  EXPECT_EQ(system.edits().redo_count(), 1u);
  EXPECT_TRUE(system.edits().redo());
  EXPECT_TRUE(system.bodies().contains(first) && system.bodies().contains(second));
  system.edits().begin(false);
  system.bodies().destroy(first);
  system.edits().cancel();
  EXPECT_TRUE(system.bodies().contains(first));
}

TEST(EditBatch, keeps_so_many_and_forgets_the_oldest) {
  System system;
  for (int i = 0; i < 100; ++i) {
    system.edits().begin();
    (void)system.bodies().create(Box{});
    (void)system.edits().end();
  }
  EXPECT_EQ(system.edits().undo_count(), 64u);
  while (system.edits().undo()) {
  }
  EXPECT_EQ(system.bodies().ids().size(), 36u);
}

TEST(EditBatch, edits_asked_for_during_a_step_are_reported_as_one) {
  System system;
  const auto chain = scenes::make_chain(system, {.links = 4});
  const BodyId ball = system.bodies().create();
  const ParticleId p = system.particles().create(ball, {0, 1, 0});
  bool asked = false;
  (void)system.bonds().create(p, chain.lower[3], ScriptedLaw{[&](const BondState&) {
                                if (!asked) {
                                  (void)system.edits().separate(chain.lower[0], chain.upper[1]);
                                  (void)system.edits().combine(chain.links[1], chain.links[2]);
                                  asked = true;
                                }
                                return Vec3{};
                              }});
  const StepReport report = system.step(0.01);
  ASSERT_TRUE(report.edits.has_value());
  EXPECT_TRUE(report.edits->changed);
  EXPECT_EQ(report.edits->absorbed_bodies.size(), 1u);
  EXPECT_EQ(report.edits->articulates_after, report.edits->articulates_before + 1);
  EXPECT_FALSE(system.step(0.01).edits.has_value());
}

TEST(EditBatch, batches_and_undo_are_recorded_and_replayed) {
  System system;
  const auto chain = scenes::make_chain(system, {.links = 4});
  system.record().start();
  (void)system.step(0.01);
  system.edits().begin();
  (void)system.edits().separate(chain.lower[1], chain.upper[2]);
  (void)system.edits().end();
  for (int i = 0; i < 3; ++i) (void)system.step(0.01);
  (void)system.edits().undo();
  for (int i = 0; i < 3; ++i) (void)system.step(0.01);
  (void)system.edits().redo();
  (void)system.step(0.01);
  EXPECT_EQ(system.record().replay(system.record().stop()), std::nullopt);
}

}  // namespace
}  // namespace iota
