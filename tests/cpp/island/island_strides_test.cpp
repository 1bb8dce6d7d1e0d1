// SPDX-License-Identifier: Apache-2.0
// Islands that take several steps at once, judged from places, velocities and energies.
#include "energy_book.h"
#include "scenes/chain.h"

#include <iota/system.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

namespace iota {
namespace {

constexpr double dt = 1.0 / 120;

/// Three chains that swing, each with a stride.
struct Swinging {
  System system;
  std::vector<scenes::Chain> chains;
  explicit Swinging(int stride, int threads = 1) : system({.threads = threads}) {
    for (int i = 0; i < 3; ++i)
      chains.push_back(scenes::make_chain(system, {.links = 5, .link_length = 0.3, .top = {0, 0, 2.0 * i}}));
    (void)system.step(dt);
    for (const scenes::Chain& chain : chains) system.bodies().set_articulate_stride(chain.links[1], stride);
  }
  void run(int steps) {
    for (int i = 0; i < steps; ++i) (void)system.step(dt);
  }
  std::vector<Vec3> ends() const {
    std::vector<Vec3> places;
    for (const scenes::Chain& chain : chains)
      for (const ParticleId p : chain.lower) places.push_back(system.particles().position(p));
    return places;
  }
  double worst_stretch() const {
    double worst = 0;
    for (const scenes::Chain& chain : chains)
      for (std::size_t i = 0; i < chain.links.size(); ++i)
        worst = std::max(worst, std::abs(norm(system.particles().position(chain.lower[i]) -
                                              system.particles().position(chain.upper[i])) -
                                         0.3));
    return worst;
  }
  int stride() const { return system.bodies().stride(chains[0].links[0]); }
};

double farthest(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  double worst = 0;
  for (std::size_t i = 0; i < a.size(); ++i) worst = std::max(worst, norm(a[i] - b[i]));
  return worst;
}

TEST(IslandStrides, show_the_motion_of_the_full_simulation_between_their_solutions) {
  for (const auto& [stride, bound] : {std::pair{2, 2e-3}, {4, 8e-3}, {8, 3e-2}}) {
    Swinging full(1), strided(stride);
    double error = 0, stretch = 0;
    for (int i = 0; i < 60; ++i) {
      full.run(1), strided.run(1);
      error = std::max(error, farthest(full.ends(), strided.ends()));
      stretch = std::max(stretch, strided.worst_stretch());
      ASSERT_EQ(strided.system.validate(), std::vector<std::string>{});
    }
    EXPECT_GT(error, 1e-7) << "it took every step";
    EXPECT_LT(error, bound) << stride;
    EXPECT_LT(stretch, 1e-3) << stride;
    EXPECT_EQ(strided.stride(), stride);
  }
}

TEST(IslandStrides, gain_no_energy_and_keep_the_books) {
  for (const int stride : {2, 4, 8, 16}) {
    Swinging s(stride);
    const double start = s.system.energy().total(), balance = book(s.system);
    for (int i = 0; i < 240; ++i) {
      s.run(1);
      ASSERT_LT(s.system.energy().total() - start, 3e-4) << stride << ", " << i << ": of 10 J in motion";
      ASSERT_NEAR(book(s.system), balance, 1e-9);
    }
  }
}

TEST(IslandStrides, a_flying_body_keeps_its_parabola_and_its_momentum) {
  System system;
  const BodyId box = system.bodies().create(Box{{0.2, 0.3, 0.4}}, {.velocity = {3, 4, 0}, .spin = {0.5, 1, 0}});
  const double mass = system.bodies().mass(box);
  (void)system.step(dt);
  const Vec3 start = system.bodies().center_of_mass(box), velocity = system.bodies().velocity(box);
  system.bodies().set_stride(box, 8);
  for (int i = 1; i <= 60; ++i) {
    (void)system.step(dt);
    const double t = i * dt;
    const Vec3 expected = start + t * velocity + Vec3{0, -0.5 * 9.81 * t * t, 0};
    ASSERT_LT(norm(system.bodies().center_of_mass(box) - expected), 1e-9) << i;
    ASSERT_LT(norm(system.momentum() - mass * (velocity + Vec3{0, -9.81 * t, 0})), 1e-7 * mass) << i;
  }
  EXPECT_EQ(system.bodies().stride(box), 8);
}

TEST(IslandStrides, a_frozen_island_stays_and_goes_on_as_it_would_have) {
  Swinging full(1), frozen(0);
  const std::vector<Vec3> places = frozen.ends();
  frozen.run(50);
  EXPECT_EQ(farthest(frozen.ends(), places), 0);
  for (const scenes::Chain& chain : frozen.chains) frozen.system.bodies().set_articulate_stride(chain.links[1], 1);
  full.run(40), frozen.run(40);
  EXPECT_LT(farthest(full.ends(), frozen.ends()), 1e-9);
}

TEST(IslandStrides, a_frozen_particle_stays_and_goes_on_as_it_would_have) {
  System system;
  const auto drop = [&](double x) {
    const BodyId body = system.bodies().create();
    return system.particles().create(body, {x, 1, 0}, 1, {0, 2, 0});
  };
  const ParticleId full = drop(0), frozen = drop(1);
  system.bodies().set_stride(system.particles().body(frozen), 0);
  system.particles().apply_force(frozen, {5, 0, 0});  // an edit frees it
  (void)system.step(0.01);
  EXPECT_GT(system.particles().velocity(frozen).x, 0.04);
  system.bodies().set_stride(system.particles().body(frozen), 0);
  const Vec3 place = system.particles().position(frozen), velocity = system.particles().velocity(frozen);
  for (int i = 0; i < 20; ++i) (void)system.step(0.01);
  EXPECT_EQ(system.particles().position(frozen), place);
  EXPECT_EQ(system.particles().velocity(frozen), velocity);
  EXPECT_LT(system.particles().position(full).y, 1.22);
  system.bodies().set_stride(system.particles().body(frozen), 1);
  for (int i = 0; i < 20; ++i) (void)system.step(0.01);
  EXPECT_NEAR(system.particles().velocity(frozen).y, velocity.y - 0.2 * 9.81, 1e-9);
}

TEST(IslandStrides, a_frozen_island_that_was_never_solved_reports_the_gap_of_its_places) {
  Swinging frozen(0);
  System other;
  other.restore(frozen.system.snapshot());
  (void)other.step(dt);
  const std::vector<IslandReport> reports = other.islands();
  ASSERT_EQ(reports.size(), 3u);
  for (const IslandReport& report : reports) EXPECT_LT(report.gap, 1e-9) << "the nail is that far from the origin";
}

TEST(IslandStrides, nailed_points_that_a_spring_connects_stay_frozen) {
  System system;
  std::vector<BodyId> bodies;
  for (int i = 0; i < 2; ++i) {
    bodies.push_back(system.bodies().create());
    const ParticleId p = system.particles().create(bodies[i], {1.0 * i, 0, 0});
    system.particles().nail(p);
    if (i > 0) (void)system.bonds().create(system.particles().ids()[0], p, SpringLaw{});
  }
  (void)system.step(dt);
  for (const int stride : {0, 4}) {
    for (const BodyId body : bodies) system.bodies().set_stride(body, stride);
    (void)system.step(dt);
    for (const BodyId body : bodies) EXPECT_EQ(system.bodies().stride(body), stride);
  }
}

TEST(IslandStrides, give_the_same_bits_for_any_number_of_threads) {
  Swinging one(4, 1), four(4, 4);
  one.run(50), four.run(50);
  EXPECT_EQ(one.system.state_hash(), four.system.state_hash());
}

TEST(IslandStrides, go_on_from_a_snapshot_taken_within_a_stride) {
  Swinging s(8), other(8);
  s.run(21);
  const Snapshot snapshot = s.system.snapshot();
  other.system.restore(snapshot);
  s.run(40), other.run(40);
  EXPECT_EQ(s.system.state_hash(), other.system.state_hash());
  EXPECT_EQ(other.stride(), 8);
}

TEST(IslandStrides, are_replayed_with_their_changes) {
  Swinging s(1), other(1);
  s.system.record().start();
  for (const int stride : {8, 1, 4, 0, 2}) {
    for (const scenes::Chain& chain : s.chains) s.system.bodies().set_articulate_stride(chain.links[1], stride);
    s.run(11);
  }
  s.system.bodies().set_velocity(s.chains[1].links[4], {0, 0, 1});
  s.run(11);
  const Recording recording = s.system.record().stop();
  EXPECT_EQ(other.system.record().replay(recording), std::nullopt);
  EXPECT_EQ(other.system.state_hash(), s.system.state_hash());
}

TEST(IslandStrides, end_at_once_where_an_edit_a_hand_or_a_force_touches) {
  for (int how = 0; how < 3; ++how) {
    Swinging s(8);
    s.run(21);
    const double before = s.system.energy().total();
    const BodyId link = s.chains[0].links[3];
    if (how == 0) s.system.bodies().set_velocity(link, s.system.bodies().velocity(link));
    if (how == 1) (void)s.system.grips().create(link, {}, s.system.bodies().center_of_mass(link), {});
    if (how == 2) s.system.bodies().apply_force(link, {0, 0, 1e-6});
    s.run(1);
    EXPECT_EQ(s.stride(), 1) << how;
    EXPECT_EQ(s.system.bodies().stride(s.chains[1].links[0]), 8) << how;
    for (std::size_t i = 0; i < 5; ++i)
      EXPECT_NEAR(norm(s.system.particles().position(s.chains[0].lower[i]) -
                       s.system.particles().position(s.chains[0].upper[i])),
                  0.3, 1e-9);
    if (how != 1) EXPECT_LT(s.system.energy().total() - before, 0.05 * s.system.energy().kinetic) << how;
    EXPECT_EQ(s.system.validate(), std::vector<std::string>{});
  }
}

TEST(IslandStrides, book_the_steps_that_were_taken_alone_when_they_end_early) {
  for (const bool is_destroyed : {true, false}) {
    System system({.damping = 0.5});
    const BodyId box = system.bodies().create(Box{{0.2, 0.3, 0.4}}, {.velocity = {0, -9, 0}});
    (void)system.step(dt);
    system.bodies().set_stride(box, 16);
    for (int i = 0; i < 20; ++i) (void)system.step(dt);
    const Energy within = system.energy();
    ASSERT_LT(within.lost, -0.02 * within.kinetic) << "no stride has just begun";
    if (is_destroyed)
      system.bodies().destroy(box);
    else
      system.bodies().set_velocity(box, system.bodies().velocity(box));
    (void)system.step(dt);
    const Energy after = system.energy();
    EXPECT_GT(after.lost, -2e-3 * within.kinetic) << is_destroyed;
    EXPECT_LT(after.dissipated, within.dissipated) << is_destroyed;
    EXPECT_NEAR(after.balance(), 0, 1e-9 * within.kinetic) << is_destroyed;
  }
}

TEST(IslandStrides, what_is_tied_together_takes_the_shortest_stride) {
  Swinging s(8);
  s.system.bodies().set_stride(s.chains[0].links[2], 2);
  s.run(1);
  EXPECT_EQ(s.stride(), 2);
  EXPECT_EQ(s.system.bodies().stride(s.chains[0].links[4]), 2);
}

struct Grounded : testing::Test {
  System system;
  void SetUp() override {
    system.set_usual_material(Material{0.5});
    system.bodies().set_material(system.bodies().create_obstacle(HalfSpace{{0, 1, 0}}), Material{0.5});
  }
  BodyId make(double y) { return system.bodies().create(Box{{0.2, 0.2, 0.2}}, {.position = {0, y, 0}}); }
};

TEST_F(Grounded, what_falls_with_a_stride_lands_as_it_should) {
  const BodyId box = make(2);
  (void)system.step(dt);
  system.bodies().set_stride(box, 8);
  for (int i = 0; i < 200; ++i) {
    (void)system.step(dt);
    ASSERT_GT(system.bodies().center_of_mass(box).y, 0.1 - 1e-6) << i;
  }
  EXPECT_NEAR(system.bodies().center_of_mass(box).y, 0.1, 1e-6);
}

TEST_F(Grounded, what_something_full_touches_is_full) {
  const BodyId box = make(0.1);
  for (int i = 0; i < 10; ++i) (void)system.step(dt);
  system.bodies().set_stride(box, 0);
  (void)system.step(dt);
  EXPECT_EQ(system.bodies().stride(box), 0);
  const BodyId falling = system.bodies().create(Sphere{0.1}, {.position = {0.12, 0.5, 0}});
  for (int i = 0; i < 60; ++i) (void)system.step(dt);
  EXPECT_EQ(system.bodies().stride(box), 1);
  EXPECT_GT(system.bodies().center_of_mass(falling).x, 0.15);
}

}  // namespace
}  // namespace iota
