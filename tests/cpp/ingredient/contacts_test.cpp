// SPDX-License-Identifier: Apache-2.0
// Contacts through edits: of the obstacle, of the body, of the materials.
#include "ingredient/contacts.h"

#include <iota/system.h>

#include <gtest/gtest.h>

#include <random>
#include <stdexcept>
#include <vector>

namespace iota {
namespace {

void run_steps(System& system, int steps) {
  for (int i = 0; i < steps; ++i) (void)system.step(1.0 / 120);
}

struct Lying : testing::Test {
  System system;
  BodyId ground, box;

  void SetUp() override {
    ground = system.bodies().create_obstacle(HalfSpace{{0, 1, 0}});
    system.bodies().set_material(ground, Material{});
    box = system.bodies().create(Box{{0.4, 0.2, 0.4}}, {.position = {0, 0.1, 0}});
    system.bodies().set_material(box, Material{});
    run_steps(system, 20);
    EXPECT_EQ(system.bodies().contacts(box).size(), 4u);
  }
  double height() const { return system.bodies().center_of_mass(box).y; }
  void TearDown() override { EXPECT_EQ(system.validate(), std::vector<std::string>{}); }
};

TEST_F(Lying, bodies_fall_when_the_obstacle_is_destroyed) {
  system.bodies().destroy(ground);
  run_steps(system, 60);
  EXPECT_LT(height(), -0.5);
}

TEST_F(Lying, bodies_fall_when_it_or_they_lose_their_material) {
  for (const BodyId body : {ground, box}) {
    const double before = height();
    system.bodies().set_material(body, std::nullopt);
    run_steps(system, 30);
    EXPECT_LT(height(), before - 0.1);
    system.bodies().set_material(body, Material{});
  }
}

TEST_F(Lying, bodies_follow_an_obstacle_that_is_lowered) {
  system.bodies().set_pose(ground, {0, -0.3, 0}, {});
  run_steps(system, 120);
  EXPECT_NEAR(height(), -0.2, 1e-6);
}

TEST_F(Lying, bodies_that_do_not_move_have_no_contacts) {
  for (const BodyKind kind : {BodyKind::static_, BodyKind::scripted, BodyKind::inactive}) {
    system.bodies().set_kind(box, kind);
    run_steps(system, 2);
    EXPECT_TRUE(system.bodies().contacts(box).empty());
    system.bodies().set_kind(box, BodyKind::dynamic);
    run_steps(system, 2);
    EXPECT_EQ(system.bodies().contacts(box).size(), 4u);
  }
}

TEST_F(Lying, bodies_lie_on_after_they_are_joined_and_parted) {
  const BodyId other = system.bodies().create(Box{{0.4, 0.2, 0.4}}, {.position = {0.4, 0.1, 0}});
  (void)system.edits().combine(box, other);
  run_steps(system, 60);
  EXPECT_NEAR(height(), 0.1, 1e-6);
  (void)system.edits().separate(box, system.bodies().parts(box).back());
  run_steps(system, 60);
  EXPECT_NEAR(height(), 0.1, 1e-6);
  for (const BodyId body : system.bodies().ids())
    EXPECT_TRUE(system.bodies().material(body).has_value()) << "a piece keeps it";
}

TEST_F(Lying, bodies_sleep_and_wake_as_others_do) {
  system.set_rest({.after = 0.2, .speed = 0.01});
  run_steps(system, 60);
  EXPECT_EQ(system.bodies().kind(box), BodyKind::resting);
  EXPECT_EQ(system.bodies().contacts(box).size(), 4u);
  system.bodies().set_velocity(box, {1, 0, 0});
  run_steps(system, 200);
  EXPECT_NEAR(system.bodies().center_of_mass(box).x, 1 / (2 * 0.5 * 9.81), 0.02);
  EXPECT_EQ(system.bodies().kind(box), BodyKind::resting);
}

TEST(Contacts, pass_the_audit_after_random_edits_of_what_lies) {
  std::mt19937 random(4);
  const auto number = [&](double a, double b) { return std::uniform_real_distribution<double>(a, b)(random); };
  System system;
  system.bodies().set_material(system.bodies().create_obstacle(HalfSpace{{0, 1, 0}}), Material{});
  system.set_usual_material(Material{0.4});
  for (int i = 0; i < 12; ++i)
    (void)system.bodies().create(Box{{0.3, 0.2, 0.4}}, {.position = {0.6 * i, number(0.1, 0.6), number(-1, 1)}});
  for (int i = 0; i < 300; ++i) {
    const std::vector<BodyId> ids = system.bodies().ids();
    const BodyId a = ids[random() % ids.size()], b = ids[random() % ids.size()];
    try {
      switch (random() % 8) {
        case 0:
          if (a != b && ids.size() > 6) (void)system.edits().combine(a, b);
          break;
        case 1:
          if (ids.size() > 6) system.bodies().destroy(a);
          break;
        case 2: system.bodies().set_kind(a, random() % 2 ? BodyKind::dynamic : BodyKind::inactive); break;
        case 3: system.bodies().set_velocity(a, {number(-1, 1), number(0, 3), number(-1, 1)}); break;
        case 4:
          if (a != b) {  // a hinge, which may be a point of another basis
            const Vec3 place = 0.5 * (system.bodies().center_of_mass(a) + system.bodies().center_of_mass(b));
            (void)system.edits().combine(system.particles().create(a, place, 0.1),
                                         system.particles().create(b, place, 0.1));
          }
          break;
        case 5: {
          const std::vector<ParticleId> points = system.bodies().particles(a);
          if (points.size() > 1) (void)system.edits().separate(points[0], points.back());
          break;
        }
        case 6: (void)system.bodies().create(Sphere{0.1}, {.position = {number(0, 5), 0.3, number(-1, 1)}}); break;
        default: (void)system.particles().create(a, system.bodies().center_of_mass(a) + Vec3{0, 0.1, 0}, 0.1);
      }
    } catch (const std::invalid_argument&) {  // it does not fit these bodies
    }
    (void)system.step(1.0 / 120);
    ASSERT_EQ(system.validate(), std::vector<std::string>{}) << i;
  }
}

/// Boxes that fall on the ground while they spin fast. contacts: of StepBudget.
struct SpinningBoxes {
  System system;

  SpinningBoxes(unsigned seed, const Material& material, double contacts = StepBudget{}.contacts) {
    std::mt19937 random(seed);
    std::normal_distribution<double> any;
    StepBudget budget = system.budget();
    budget.contacts = contacts;
    system.set_budget(budget);
    system.set_usual_material(material);
    system.bodies().create_obstacle(HalfSpace{{0, 1, 0}});
    for (int i = 0; i < 4; ++i) {
      const Quaternion turned = normalized(Quaternion{any(random), any(random), any(random), any(random)});
      const BodyId box = system.bodies().create(
          Box{{0.3, 0.2, 0.4}},
          {.mass = 5, .position = {0.6 * i, 0.6, 0}, .orientation = turned, .velocity = {3, -4, 1}});
      system.bodies().set_angular_velocity(box, {1, 30, 8});
    }
  }
  double energy() const { return system.energy().kinetic + system.energy().potential; }
};

TEST(Contacts, that_blows_begin_and_end_have_all_their_strain_in_one_account) {
  for (unsigned seed = 0; seed < 10; ++seed) {
    SpinningBoxes boxes(seed, Material{0.8});
    const double before = boxes.system.energy().kinetic;
    for (int i = 0; i < 30; ++i) (void)boxes.system.step(1.0 / 60);
    EXPECT_NEAR(boxes.system.energy().balance(), 0, 1e-9 * before) << seed;
  }
}

TEST(Contacts, of_bodies_that_have_swung_into_each_other_lift_nothing_for_free) {
  const struct {
    Material material;
    double contacts;
    double of_round_off;
  } cases[] = {{{0.8}, StepBudget{}.contacts, 1e-9},
               {{0}, StepBudget{}.contacts, 1e-9},
               {{.friction = 0, .restitution = 1}, 1, 1e-5},  // by sweeps
               {{.friction = 0.5}, 1, 1e-5}};
  for (const auto& [material, contacts, of_round_off] : cases)
    for (unsigned seed = 0; seed < 6; ++seed) {
      SpinningBoxes boxes(seed, material, contacts);
      const double before = boxes.energy();
      double last = before;
      for (int i = 0; i < 40; ++i) {
        (void)boxes.system.step(1.0 / 30);
        EXPECT_LT(boxes.energy(), last + of_round_off * before)
            << seed << ", step " << i << ", friction " << material.friction << ", by sweeps " << (contacts == 1);
        last = boxes.energy();
      }
    }
}

}  // namespace
}  // namespace iota
