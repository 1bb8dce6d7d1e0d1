// SPDX-License-Identifier: Apache-2.0
// The radius of a body: its own, or the usual one, which depends on the structure alone.
#include "model/outline.h"

#include <gtest/gtest.h>
#include <iota/system.h>

#include <cmath>

namespace iota::model {
namespace {

BodyId add_rod(System& system, const Vec3& from, const Vec3& to) {
  const BodyId rod = system.bodies().create();
  (void)system.particles().create(rod, from);
  (void)system.particles().create(rod, to);
  return rod;
}
BodyId add_point(System& system, const Vec3& at) {
  const BodyId body = system.bodies().create();
  (void)system.particles().create(body, at);
  return body;
}

TEST(BodyRadius, the_usual_radius_is_of_the_median_rod_or_else_of_the_extent) {
  EXPECT_DOUBLE_EQ(usual_radius_of({}, 0), 0.03);
  EXPECT_DOUBLE_EQ(usual_radius_of({}, 2), 0.04);
  EXPECT_DOUBLE_EQ(usual_radius_of({3, 1, 100}, 2), 0.18);
  EXPECT_DOUBLE_EQ(usual_radius_of({0, 0, 0}, 2), 0.04);
  EXPECT_DOUBLE_EQ(usual_radius_of({std::nan(""), 1, std::nan("")}, std::nan("")), 0.06);
  EXPECT_DOUBLE_EQ(usual_radius_of({}, std::nan("")), 0.03);
  System system;
  EXPECT_DOUBLE_EQ(system.usual_radius(), 0.03);
  (void)add_point(system, {});
  (void)add_point(system, {3, 0, 4});
  EXPECT_DOUBLE_EQ(system.usual_radius(), 0.1);
  for (const double length : {0.5, 2.0, 1.0}) (void)add_rod(system, {}, {length, 0, 0});
  EXPECT_DOUBLE_EQ(system.usual_radius(), 0.06);
  (void)system.bodies().create(Box{}, {.position = {50, 0, 0}});
  EXPECT_DOUBLE_EQ(system.usual_radius(), 0.06);
}

TEST(BodyRadius, the_usual_radius_stays_after_the_first_step_that_finds_a_body) {
  System system({.gravity = {}});
  (void)system.emitters().create({.rate = 1000, .mass = 1});
  (void)system.step(0.1, 3);
  const BodyId rod = add_rod(system, {}, {1, 0, 0});
  EXPECT_DOUBLE_EQ(system.usual_radius(), 0.06) << "sparks are no bodies";
  (void)system.step(0.01);
  (void)add_rod(system, {0, 5, 0}, {9, 5, 0});
  (void)add_rod(system, {0, 6, 0}, {9, 6, 0});
  system.bodies().destroy(rod);
  EXPECT_DOUBLE_EQ(system.usual_radius(), 0.06);
  System again;
  again.restore(system.snapshot());
  EXPECT_EQ(again.usual_radius(), system.usual_radius());
  system.set_usual_radius(0.2);
  EXPECT_EQ(system.usual_radius(), 0.2);
}

TEST(BodyRadius, is_the_same_whoever_asks_and_in_a_replay) {
  const auto run = [](System& system, bool asks) {
    const auto ask = [&] {
      if (!asks) return;
      (void)system.usual_radius();
      (void)system.viewer().take_scene_changes();
      (void)system.places().nearest({});
    };
    ask();
    (void)add_rod(system, {}, {1, 0, 0});
    ask();
    (void)add_rod(system, {0, 0, 1}, {3, 0, 1});
    (void)system.step(0.01);
    ask();
    (void)add_rod(system, {0, 0, 2}, {7, 0, 2});
    (void)system.step(0.01);
  };
  System asked, alone, replayed;
  asked.record().start();
  run(asked, true), run(alone, false);
  EXPECT_EQ(asked.usual_radius(), alone.usual_radius());
  const Recording recording = asked.record().stop();
  EXPECT_FALSE(replayed.record().replay(recording));
  EXPECT_EQ(replayed.usual_radius(), asked.usual_radius());
  EXPECT_EQ(replayed.snapshot().bytes, asked.snapshot().bytes);
}

TEST(BodyRadius, the_radius_of_a_body_is_its_own_or_the_usual_one) {
  System system;
  system.set_usual_radius(0.1);
  const BodyId rod = add_rod(system, {}, {1, 0, 0}), point = add_point(system, {0, 3, 0}),
               ball = add_point(system, {0, 4, 0}), box = system.bodies().create(Box{});
  const ParticleId middle = system.bodies().particles(ball)[0];
  system.particles().set_attributes(middle, {.radius = 0.7});
  const auto radius = [&](BodyId body) { return system.bodies().radius(body); };
  EXPECT_EQ(radius(rod), 0.1);
  EXPECT_EQ(radius(point), 0.2);
  EXPECT_EQ(radius(ball), 0.7);
  EXPECT_EQ(radius(box), 0);
  for (const BodyId body : {rod, point, ball}) {
    system.bodies().set_radius(body, 0.5);
    EXPECT_EQ(radius(body), 0.5);
  }
  EXPECT_EQ(system.particles().attributes(middle).radius, 0.5) << "a particle has one radius";
  EXPECT_FALSE(system.particles().has_attributes(system.bodies().particles(point)[0]));
  EXPECT_THROW(system.bodies().set_radius(box, 0.5), std::invalid_argument);
  for (const double bad : {0.0, -1.0, std::nan(""), 2e9, std::numeric_limits<double>::infinity()}) {
    EXPECT_THROW(system.bodies().set_radius(rod, bad), std::invalid_argument);
    EXPECT_THROW(system.set_usual_radius(bad), std::invalid_argument);
  }
  system.bodies().destroy(rod);
  EXPECT_THROW((void)radius(rod), StaleIdError);
}

TEST(BodyRadius, the_radius_of_a_body_goes_to_its_pieces_is_undone_and_saved) {
  System system;
  const BodyId bar = add_rod(system, {}, {1, 0, 0});
  (void)system.particles().create(bar, {2, 0, 0});
  (void)system.particles().create(bar, {3, 0, 0});
  system.bodies().set_radius(bar, 0.3);
  const std::vector<ParticleId> points = system.bodies().particles(bar);
  std::vector<CosmeticBondId> bonds;
  for (int i = 1; i < 4; ++i) bonds.push_back(system.cosmetic_bonds().create(points[i - 1], points[i]));
  (void)system.edits().separate(points[2], points[3]);
  ASSERT_EQ(system.bodies().ids().size(), 2u);
  system.cosmetic_bonds().destroy(bonds[0]);
  ASSERT_EQ(system.bodies().ids().size(), 3u);
  for (const BodyId piece : system.bodies().ids()) EXPECT_EQ(system.bodies().radius(piece), 0.3);
  const Snapshot saved = system.snapshot();
  system.edits().begin();
  system.bodies().set_radius(bar, 0.4);
  (void)system.edits().end();
  EXPECT_EQ(system.bodies().radius(bar), 0.4);
  system.edits().undo();
  EXPECT_EQ(system.bodies().radius(bar), 0.3);
  System again;
  again.restore(saved);
  EXPECT_EQ(again.bodies().radius(bar), 0.3);
  system.bodies().destroy(bar);
  EXPECT_TRUE(system.validate().empty());
}

TEST(BodyRadius, a_body_that_absorbs_another_one_keeps_its_radius) {
  System system;
  const BodyId one = add_rod(system, {}, {1, 0, 0}), other = add_rod(system, {2, 0, 0}, {3, 0, 0});
  system.bodies().set_radius(one, 0.3), system.bodies().set_radius(other, 0.2);
  (void)system.edits().combine(one, other);
  const BodyId survivor = *system.bodies().survivor_of(other);
  EXPECT_EQ(system.bodies().radius(survivor), survivor == one ? 0.3 : 0.2);
  EXPECT_TRUE(system.validate().empty());
}

}  // namespace
}  // namespace iota::model
