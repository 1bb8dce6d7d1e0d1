// SPDX-License-Identifier: Apache-2.0
// Reports of touches that begin and end. Impulses are compared with the change of momentum.
#include "step/contact_watches.h"

#include "gravity.h"

#include <iota/system.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <random>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace iota {
namespace {

/// Bodies of material 0.5 above a ground at height 0.
struct Watched {
  System system;
  BodyId ground;
  std::vector<ContactEvent> events;

  Watched() {
    system.set_usual_material(Material{0.5});
    ground = system.bodies().create_obstacle(HalfSpace{{0, 1, 0}});
    system.bodies().set_material(ground, Material{0.5});
  }
  void run(double seconds, double h = 1.0 / 120) {
    for (int i = 0; i < static_cast<int>(std::lround(seconds / h)); ++i) {
      const StepReport report = system.step(h);
      events.insert(events.end(), report.contacts.begin(), report.contacts.end());
    }
  }
  std::size_t count(bool began) const {
    return static_cast<std::size_t>(
        std::count_if(events.begin(), events.end(), [&](const ContactEvent& e) { return e.began == began; }));
  }
};

TEST(ContactWatches, tell_the_impulse_and_the_speed_of_a_fall_at_any_size_and_step) {
  for (const double size : {0.01, 0.3, 20.0})
    for (const double h : {1.0 / 240, 1.0 / 60, 1.0 / 97}) {
      SCOPED_TRACE(std::to_string(size) + " m, " + std::to_string(h) + " s");
      Watched world;
      (void)world.system.contacts().watch({});
      const double speed = 3 * std::sqrt(size);
      const BodyId ball = world.system.bodies().create(
          Sphere{size}, {.position = {0, size + speed * 2.4 * h, 0}, .velocity = {0, -speed, 0}});
      const double mass = world.system.bodies().mass(ball);
      double before = speed;
      while (world.events.empty() && world.system.step_count() < 9) {
        before = -world.system.bodies().velocity(ball).y;
        world.run(h, h);
      }
      ASSERT_EQ(world.events.size(), 1u);
      const ContactEvent& event = world.events[0];
      EXPECT_TRUE(event.began && event.body == ball && event.other == world.ground);
      EXPECT_NEAR(event.speed, before, 1e-9 * before);
      const double change = world.system.bodies().velocity(ball).y + before;
      EXPECT_NEAR(event.impulse, mass * (change + g * h), 1e-3 * event.impulse);
      EXPECT_LT(norm(event.position), 1e-3 * size);
      EXPECT_LT(norm(event.normal - Vec3{0, 1, 0}), 1e-9);
    }
}

TEST(ContactWatches, tell_of_a_box_that_rests_once_in_each_mode) {
  for (const IntegrationMode mode : {IntegrationMode::energy_keeping, IntegrationMode::robust})
    for (const double size : {0.02, 1.0}) {
      SCOPED_TRACE(size);
      Watched world;
      world.system.set_mode(mode);
      (void)world.system.contacts().watch({});
      (void)world.system.bodies().create(Box{{size, size, size}},
                                         {.position = {0, 0.7 * size, 0}, .orientation = {0, 0, 0.05, 0.99875}});
      world.run(4);
      EXPECT_EQ(world.count(true), 1u);
      EXPECT_EQ(world.count(false), 0u);
    }
}

TEST(ContactWatches, tell_the_end_when_a_body_is_lifted) {
  Watched world;
  const BodyId box = world.system.bodies().create(Box{{0.2, 0.2, 0.2}}, {.position = {0, 0.1, 0}});
  (void)world.system.contacts().watch({});
  world.run(0.5);
  ASSERT_EQ(world.events.size(), 1u);
  world.system.bodies().set_velocity(box, {0, 2, 0});
  world.run(0.1);
  ASSERT_EQ(world.events.size(), 2u);
  EXPECT_TRUE(!world.events[1].began && world.events[1].body == box && world.events[1].impulse == 0);
  EXPECT_LT(std::abs(world.events[1].position.y), 0.05) << "the last place";
  world.run(0.6);
  EXPECT_EQ(world.count(true), 2u);
}

TEST(ContactWatches, know_what_lay_there_before_they_began) {
  Watched world;
  const BodyId box = world.system.bodies().create(Box{{0.2, 0.2, 0.2}}, {.position = {0, 0.1, 0}});
  world.run(0.2);
  (void)world.system.contacts().watch({});
  world.run(0.2);
  world.system.bodies().set_velocity(box, {0, 2, 0});
  world.run(0.2);
  EXPECT_TRUE(world.events.empty()) << "an end without a begin";
}

TEST(ContactWatches, pass_only_what_their_filters_ask_for_in_the_order_that_these_name) {
  Watched world;
  System& system = world.system;
  const BodyId slow = system.bodies().create(Sphere{0.1}, {.position = {0, 0.11, 0}});
  const BodyId fast = system.bodies().create(Sphere{0.1}, {.position = {1, 0.9, 0}, .velocity = {0, -3, 0}});
  const GroupId group = system.groups().create("fast");
  system.groups().add(group, system.bodies().particles(fast)[0]);
  const auto party = [](BodyId body) { return std::vector{ContactParty{body, {}}}; };
  const auto watch = [&](const ContactFilter& filter) { return system.contacts().watch(filter); };
  const std::uint32_t all = watch({}), of_slow = watch({.a = party(world.ground), .b = party(slow)}),
                      of_group = watch({.a = {ContactParty{{}, group}}}),
                      among = watch({.a = party(slow), .b = party(fast)}), quick = watch({.min_speed = 2}),
                      hard = watch({.min_impulse = 6 * system.bodies().mass(fast)});
  world.run(0.6);
  std::map<std::uint32_t, std::vector<ContactEvent>> told;
  for (const ContactEvent& event : world.events) told[event.watch].push_back(event);
  EXPECT_EQ(told[all].size(), 2u);
  ASSERT_EQ(told[of_slow].size(), 1u);
  EXPECT_TRUE(told[of_slow][0].body == world.ground && told[of_slow][0].other == slow);
  EXPECT_NEAR(told[of_slow][0].normal.y, -1, 1e-9);
  ASSERT_EQ(told[of_group].size(), 1u);
  EXPECT_EQ(told[of_group][0].body, fast);
  EXPECT_EQ(told[among].size(), 0u);
  ASSERT_EQ(told[quick].size(), 1u);
  EXPECT_EQ(told[quick][0].body, fast);
  EXPECT_EQ(told[hard].size(), 0u) << "it falls with 5 m/s";
  system.contacts().unwatch(all), system.contacts().unwatch(all + 99);
  world.events.clear();
  system.bodies().set_velocity(fast, {0, 3, 0});
  world.run(1);
  for (const ContactEvent& event : world.events) EXPECT_NE(event.watch, all);
  EXPECT_EQ(world.events.size(), 4u) << "an end and a begin for two of them";
}

TEST(ContactWatches, wait_a_cooldown_for_the_same_two_bodies) {
  Watched world;
  const std::uint32_t patient = world.system.contacts().watch({.cooldown = 0.5});
  const BodyId ball = world.system.bodies().create(Sphere{0.1}, {.position = {0, 0.1, 0}});
  (void)world.system.bodies().create(Sphere{0.1}, {.position = {1, 0.1, 0}});
  for (int i = 0; i < 9; ++i) {
    world.system.bodies().set_velocity(ball, {0, 0.9, 0});
    world.run(0.2, 1.0 / 100);
  }
  std::vector<ContactEvent> begins;
  for (const ContactEvent& event : world.events)
    if (event.began && event.body == ball) begins.push_back(event);
  EXPECT_EQ(begins.size(), 3u) << "one of three bounces in 1.8 s";
  EXPECT_EQ(world.events.size(), begins.size() * 2 + 1) << patient << ": each begin has an end, the other ball none";
}

TEST(ContactWatches, follow_bodies_that_are_combined_and_tell_the_end_of_what_is_destroyed) {
  Watched world;
  System& system = world.system;
  (void)system.contacts().watch({});
  const BodyId a = system.bodies().create(Box{{0.2, 0.2, 0.2}}, {.position = {0, 0.1, 0}});
  const BodyId b = system.bodies().create(Box{{0.2, 0.2, 0.2}}, {.position = {0.3, 0.1, 0}});
  world.run(0.1);
  ASSERT_EQ(world.count(true), 2u);
  (void)system.edits().combine(b, a);  // the survivor is b
  world.run(0.1);
  EXPECT_EQ(world.events.size(), 3u);
  EXPECT_FALSE(world.events.back().began) << "two touches became one";
  system.bodies().destroy(b);
  world.run(0.1);
  EXPECT_EQ(world.events.size(), 4u);
  EXPECT_TRUE(!world.events.back().began && world.events.back().body == b);
}

TEST(ContactWatches, tell_nothing_of_a_restore_and_the_same_after_it) {
  Watched world;
  System& system = world.system;
  (void)system.contacts().watch({});
  (void)system.bodies().create(Sphere{0.1}, {.position = {0, 0.5, 0}});
  (void)system.bodies().create(Box{{0.2, 0.2, 0.2}}, {.position = {1, 0.1, 0}});
  world.run(0.1);
  const Snapshot start = system.snapshot();
  EXPECT_EQ(world.count(true), 1u);
  world.events.clear();
  world.run(0.6);
  const std::vector<ContactEvent> first = std::exchange(world.events, {});
  ASSERT_EQ(first.size(), 1u);
  system.restore(start);
  world.run(0.6);
  ASSERT_EQ(world.events.size(), 1u);
  EXPECT_EQ(world.events[0].impulse, first[0].impulse);
  EXPECT_EQ(world.events[0].position.x, first[0].position.x);
}

TEST(ContactWatches, let_begins_and_ends_take_turns_in_a_heap_with_edits_for_any_number_of_threads) {
  std::vector<std::vector<ContactEvent>> runs;
  for (const int threads : {1, 3}) {
    Watched world;
    System& system = world.system;
    system.set_threads(threads);
    std::mt19937 random(5);
    const auto number = [&](double a, double b) { return std::uniform_real_distribution<double>(a, b)(random); };
    for (int i = 0; i < 14; ++i) {
      const double a = number(0.05, 0.2);
      const std::vector<Shape> shapes{Sphere{a}, Box{{a, 2 * a, a}}, Capsule{a / 2, a}};
      (void)system.bodies().create(shapes[static_cast<std::size_t>(i) % 3],
                                   {.position = {number(-0.4, 0.4), 0.2 + 0.2 * i, number(-0.4, 0.4)},
                                    .spin = {number(-5, 5), number(-5, 5), number(-5, 5)}});
    }
    (void)system.contacts().watch({});
    std::map<std::pair<BodyId, BodyId>, bool> touching;
    for (int i = 0; i < 150; ++i) {
      const std::vector<BodyId> ids = system.bodies().ids();
      const BodyId some = ids[random() % ids.size()];
      if (i % 20 == 7) system.bodies().set_velocity(some, {number(-1, 1), 3, number(-1, 1)});
      if (i == 90) system.bodies().destroy(some);
      if (i == 120) system.bodies().set_kind(some, BodyKind::inactive);
      world.run(1.0 / 100, 1.0 / 100);
    }
    for (const ContactEvent& e : world.events) {
      bool& touches = touching[{e.body, e.other}];
      EXPECT_NE(touches, e.began);
      EXPECT_NEAR(norm(e.normal), 1, 1e-9);
      EXPECT_TRUE(std::isfinite(e.impulse) && e.impulse >= 0 && e.speed >= 0);
      touches = e.began;
    }
    // At the end those touch that the independent list of places has.
    std::set<std::pair<BodyId, BodyId>> now;
    for (const ContactPoint& point : system.contacts().points()) now.insert({point.body, point.other});
    for (const auto& pair : now) EXPECT_TRUE(touching[pair]) << pair.first.slot << " " << pair.second.slot;
    EXPECT_GT(world.events.size(), 40u);
    runs.push_back(world.events);
  }
  ASSERT_EQ(runs[0].size(), runs[1].size());
  for (std::size_t i = 0; i < runs[0].size(); ++i) {
    EXPECT_EQ(runs[0][i].body, runs[1][i].body);
    EXPECT_EQ(runs[0][i].impulse, runs[1][i].impulse);
  }
}

TEST(ContactWatches, tell_what_enters_and_leaves_a_sensor_which_feels_no_force) {
  const std::vector<Shape> zones{Box{{2, 1, 2}}, Sphere{0.5}, Cylinder{1, 1}, Capsule{0.4, 0.2}, Cone{1, 1}};
  const std::vector<Shape> falling{Sphere{0.1}, Box{{0.2, 0.2, 0.2}}, Capsule{0.05, 0.1}, Cylinder{0.1, 0.2}};
  for (const Shape& zone : zones)
    for (const Shape& shape : falling) {
      Watched world;
      System& system = world.system;
      const BodyId sensor = system.bodies().create_obstacle(zone, {0, 3, 0}, {std::sqrt(0.5), 0, 0, std::sqrt(0.5)});
      system.bodies().set_material(sensor, Material{.touches = Touches::sensor});
      const BodyId body = system.bodies().create(shape, {.position = {0, 5, 0}});
      (void)system.contacts().watch({.a = {ContactParty{sensor, {}}}});
      std::vector<double> heights;
      for (int i = 0; i < 110; ++i) {
        world.run(1.0 / 120);
        if (heights.size() < world.events.size()) heights.push_back(system.bodies().center_of_mass(body).y);
      }
      EXPECT_NEAR(system.bodies().velocity(body).y, -g * 110 / 120, 1e-9) << "it falls freely";
      ASSERT_EQ(world.events.size(), 2u) << zone.index() << " " << shape.index();
      EXPECT_TRUE(world.events[0].began && !world.events[1].began);
      EXPECT_TRUE(world.events[0].body == sensor && world.events[0].other == body);
      EXPECT_GT(world.events[0].speed, 3);
      EXPECT_EQ(world.events[0].impulse, 0);
      EXPECT_GT(heights[0], 3.1) << "at its upper side";
      EXPECT_LT(heights[1], 2.9) << "below its lower one";
      EXPECT_TRUE(system.contacts().points().empty());
    }
}

TEST(ContactWatches, tell_what_passes_a_sensor_between_two_steps) {
  for (const double speed : {3.0, 30.0, 300.0, 3000.0})
    for (const double phase : {0.0, 0.2, 0.4, 0.6, 0.8})
      for (const bool has_wall : {false, true}) {
        Watched world;
        System& system = world.system;
        system.set_gravity({});
        const BodyId gate = system.bodies().create_obstacle(Box{{0.02, 1, 1}}, {0, 5, 0});
        const BodyId beside = system.bodies().create_obstacle(Box{{0.02, 1, 1}}, {0, 6.06, 0});
        for (const BodyId sensor : {gate, beside})
          system.bodies().set_material(sensor, Material{.touches = Touches::sensor});
        if (has_wall) (void)system.bodies().create_obstacle(Box{{0.02, 4, 4}}, {-0.2, 5, 0});
        const double way = speed / 60;
        const BodyId ball = system.bodies().create(Sphere{0.05}, {.position = {-0.3 - phase * way, 5, 0}});
        system.bodies().set_velocity(ball, {speed, 0, 0});
        (void)system.contacts().watch({.a = {ContactParty{gate, {}}, ContactParty{beside, {}}}});
        for (int i = 0; i < 3 + static_cast<int>(0.5 / way); ++i) world.run(1.0 / 60, 1.0 / 60);
        if (has_wall) {
          EXPECT_TRUE(world.events.empty()) << "the wall has kept it out";
          continue;
        }
        ASSERT_EQ(world.events.size(), 2u) << speed << " " << phase;
        EXPECT_TRUE(world.events[0].began && !world.events[1].began && world.events[0].body == gate);
        EXPECT_NEAR(world.events[0].speed, speed, 1e-9 * speed);
        EXPECT_NEAR(system.bodies().velocity(ball).x, speed, 1e-9 * speed) << "it flies freely";
      }
}

// The velocity of a scripted body is that of its last step, which was none.
TEST(ContactWatches, tell_what_a_scripted_body_passes_in_the_step_in_which_it_starts) {
  for (const double way : {0.5, 5.0, 200.0})
    for (const bool is_gate : {false, true}) {
      Watched world;
      System& system = world.system;
      system.set_gravity({});
      const BodyId moved =
          system.bodies().create(Box{{0.02, 0.1, 0.1}}, {.position = {-0.1 * way, 5, 0}, .kind = BodyKind::scripted});
      std::vector<BodyId> sensors;
      for (const double share : {0.0, 0.3, 0.6})
        if (is_gate)
          sensors.push_back(system.bodies().create_obstacle(Box{{0.02, 1, 1}}, {share * way, 5, 0}));
        else
          (void)system.bodies().create(Sphere{0.01}, {.position = {share * way, 5, 0}});
      if (!is_gate) sensors.push_back(moved);
      for (const BodyId sensor : sensors) system.bodies().set_material(sensor, Material{.touches = Touches::sensor});
      (void)system.contacts().watch({.a = {ContactParty{moved, {}}}});
      system.bodies().set_pose(moved, {-0.1 * way, 5, 0}, {});
      world.run(2.0 / 60, 1.0 / 60);
      ASSERT_TRUE(world.events.empty());
      system.bodies().set_pose(moved, {0.9 * way, 5, 0}, {});
      world.run(2.0 / 60, 1.0 / 60);
      ASSERT_EQ(world.events.size(), 6u) << way << (is_gate ? " by gates" : " as a gate");
      for (std::size_t i = 0; i < 6; ++i) EXPECT_EQ(world.events[i].began, i < 3);
      EXPECT_NEAR(world.events[0].speed, 60 * way, 1e-6 * way);
    }
}

TEST(ContactWatches, forget_what_may_pass_a_sensor_when_nothing_touches_any_more) {
  System system;
  system.set_gravity({});
  const BodyId gate = system.bodies().create_obstacle(Box{{0.02, 1, 1}});
  system.bodies().set_material(gate, Material{.touches = Touches::sensor});
  const BodyId ball = system.bodies().create(Sphere{0.05}, {.position = {-1, 0, 0}});
  system.bodies().set_material(ball, Material{});
  system.bodies().set_velocity(ball, {100, 0, 0});
  (void)system.contacts().watch({});
  EXPECT_EQ(system.step(1.0 / 60).contacts.size(), 1u);
  system.bodies().destroy(ball), system.bodies().destroy(gate);
  (void)system.step(1.0 / 60);
  EXPECT_TRUE(system.step(1.0 / 60).contacts.empty());
}

TEST(ContactWatches, know_what_sleeps_in_a_sensor_and_sensors_that_move) {
  Watched world;
  System& system = world.system;
  system.set_rest({.after = 0.2, .speed = 0.01});
  const BodyId box = system.bodies().create(Box{{0.2, 0.2, 0.2}}, {.position = {0, 0.1, 0}});
  const BodyId zone = system.bodies().create(Box{{1, 1, 1}}, {.position = {0, 0.5, 0}, .kind = BodyKind::scripted});
  const BodyId other_zone = system.bodies().create_obstacle(Box{{1, 1, 1}});
  for (const BodyId body : {zone, other_zone}) system.bodies().set_material(body, Material{.touches = Touches::sensor});
  (void)system.contacts().watch({.a = {ContactParty{box, {}}}});
  world.run(1);
  ASSERT_EQ(system.bodies().kind(box), BodyKind::resting);
  std::set<BodyId> began;
  for (const ContactEvent& event : world.events) EXPECT_TRUE(event.began && began.insert(event.other).second);
  EXPECT_EQ(began, (std::set<BodyId>{world.ground, zone, other_zone}));
  world.events.clear();
  for (int i = 0; i < 60; ++i) {
    system.bodies().set_pose(zone, {0.05 * i, 0.5, 0}, {});
    world.run(1.0 / 120);
  }
  ASSERT_EQ(world.events.size(), 1u);
  EXPECT_TRUE(!world.events[0].began && world.events[0].other == zone);
}

TEST(ContactWatches, do_not_change_the_motion) {
  std::vector<std::uint64_t> hashes;
  for (const bool is_watched : {false, true}) {
    Watched world;
    if (is_watched) (void)world.system.contacts().watch({});
    for (int i = 0; i < 5; ++i)
      (void)world.system.bodies().create(Box{{0.2, 0.1, 0.2}}, {.position = {0.03 * i, 0.1 + 0.15 * i, 0}});
    world.run(0.5);
    hashes.push_back(world.system.state_hash());
  }
  EXPECT_EQ(hashes[0], hashes[1]);
}

TEST(ContactWatches, refuse_numbers_that_mean_nothing_and_bodies_that_are_gone) {
  Watched world;
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW((void)world.system.contacts().watch({.min_impulse = -1}), std::invalid_argument);
  EXPECT_THROW((void)world.system.contacts().watch({.min_speed = nan}), std::invalid_argument);
  EXPECT_THROW((void)world.system.contacts().watch({.cooldown = 1 / 0.0}), std::invalid_argument);
  const BodyId gone = world.system.bodies().create();
  world.system.bodies().destroy(gone);
  EXPECT_THROW((void)world.system.contacts().watch({.b = {ContactParty{gone, {}}}}), StaleIdError);
}

}  // namespace
}  // namespace iota
