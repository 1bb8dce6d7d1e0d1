// SPDX-License-Identifier: Apache-2.0
// Bodies that pass through each other on request, judged from places.
#include "ingredient/ignored_contacts.h"

#include <iota/system.h>

#include <gtest/gtest.h>

#include <stdexcept>
#include <string>
#include <vector>

namespace iota {
namespace {

struct Ignoring : testing::Test {
  System system;
  BodyId ground, box, other;

  void SetUp() override {
    system.set_usual_material(Material{0.5});
    ground = system.bodies().create_obstacle(HalfSpace{{0, 1, 0}});
    system.bodies().set_material(ground, Material{0.5});
    box = make(0), other = make(0.2);
    run_steps(10);
  }
  BodyId make(double y, double x = 0) {
    return system.bodies().create(Box{{0.2, 0.2, 0.2}}, {.position = {x, y + 0.1, 0}});
  }
  void run_steps(int steps) {
    for (int i = 0; i < steps; ++i) (void)system.step(1.0 / 120);
    EXPECT_EQ(system.validate(), std::vector<std::string>{});
  }
  double height(BodyId body) const { return system.bodies().center_of_mass(body).y; }
  static ContactParty party(BodyId body) { return {body, {}}; }
};

TEST_F(Ignoring, lets_two_bodies_pass_and_touch_again_when_it_ends) {
  EXPECT_NEAR(height(other), 0.3, 1e-6);
  system.contacts().ignore(party(other), party(box));
  EXPECT_EQ(system.contacts().ignored().size(), 1u);
  run_steps(90);
  EXPECT_NEAR(height(other), 0.1, 1e-6) << "inside of the other one, on the ground";
  EXPECT_NEAR(height(box), 0.1, 1e-6);
  system.bodies().set_pose(other, {0, 0.6, 0}, {});
  system.contacts().allow(party(box), party(other));
  run_steps(90);
  EXPECT_NEAR(height(other), 0.3, 1e-6);
  EXPECT_TRUE(system.contacts().ignored().empty());
}

TEST_F(Ignoring, wakes_what_rests_on_an_ignored_body) {
  system.set_rest({.after = 0.1, .speed = 0.01});
  run_steps(60);
  ASSERT_EQ(system.bodies().kind(other), BodyKind::resting);
  system.contacts().ignore(party(box), party(other));
  run_steps(60);
  EXPECT_LT(height(other), 0.2);
}

TEST_F(Ignoring, concerns_all_of_two_groups_and_the_ground) {
  const GroupId ghosts = system.groups().create("ghosts");
  const BodyId ghost = make(0.6);
  system.groups().add(ghosts, system.bodies().particles(ghost)[2]);
  system.groups().add(ghosts, system.bodies().particles(other)[0]);
  system.contacts().ignore({{}, ghosts}, {{}, ghosts});
  run_steps(90);
  EXPECT_NEAR(height(ghost), 0.3, 1e-6) << "through the other ghost, on the box";
  EXPECT_NEAR(height(other), 0.3, 1e-6);
  system.contacts().ignore({{}, ghosts}, party(ground));
  system.contacts().ignore(party(box), {{}, ghosts});
  run_steps(90);
  EXPECT_LT(height(ghost), -0.5);
  EXPECT_NEAR(height(box), 0.1, 1e-6);
  system.groups().destroy(ghosts);
  EXPECT_TRUE(system.contacts().ignored().empty());
}

TEST_F(Ignoring, stays_through_snapshots_and_edits) {
  system.contacts().ignore(party(other), party(box));
  const Snapshot before = system.snapshot();
  const BodyId third = make(0.5, 0.1);
  (void)system.edits().combine(third, other);  // the survivor takes it over
  ASSERT_TRUE(system.bodies().contains(third));
  ASSERT_EQ(system.contacts().ignored().size(), 1u);
  run_steps(90);
  EXPECT_LT(height(third), 0.35) << "a part of it is in the box";
  (void)system.edits().separate(third, system.bodies().parts(third).back());
  run_steps(1);
  EXPECT_EQ(system.contacts().ignored().size(), 2u) << "both pieces have it";
  system.bodies().destroy(box);
  EXPECT_TRUE(system.contacts().ignored().empty());
  system.restore(before);
  EXPECT_EQ(system.contacts().ignored().size(), 1u);
  run_steps(90);
  EXPECT_NEAR(height(other), 0.1, 1e-6);
}

TEST_F(Ignoring, refuses_what_is_no_pair) {
  EXPECT_THROW(system.contacts().ignore(party(box), party(box)), std::invalid_argument);
  EXPECT_THROW(system.contacts().ignore(party(box), {}), StaleIdError);
  const GroupId group = system.groups().create("group");
  EXPECT_THROW(system.contacts().ignore({box, group}, party(other)), std::invalid_argument);
  const BodyId gone = make(5);
  system.bodies().destroy(gone);
  EXPECT_THROW(system.contacts().allow(party(gone), party(other)), StaleIdError);
  EXPECT_TRUE(system.contacts().ignored().empty());
}

}  // namespace
}  // namespace iota
