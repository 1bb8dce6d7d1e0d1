// SPDX-License-Identifier: Apache-2.0
// Tables 4.2 and 4.3 and Figures 4.10-4.13 of the thesis, to the letter.
#include <iota/system.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

namespace iota {
namespace {

#define EXPECT_WHOLE(system) EXPECT_EQ((system).validate(), std::vector<std::string>{})

double relative(const Vec3& change, const Vec3& whole) { return norm(change) / (1e-3 + norm(whole)); }

void expect_momenta_kept(const RestructureReport& report, const System& system) {
  EXPECT_LT(relative(report.momentum_change, system.momentum()), 1e-12);
  EXPECT_LT(relative(report.angular_momentum_change, system.angular_momentum()), 1e-12);
}

/// The scene of Figures 4.8-4.12: A={P1,P2,P3}, B={P3..P7}, C={P7,P8}, D={P9,P10}, E={P11}, hinged at P3 (A,B) and
/// P7 (B,C), bonds P8-P9 and P10-P11. Everything moves, so that momenta mean something.
struct WorkedExample : ::testing::Test {
  System system{SystemOptions{.gravity = {0, 0, 0}}};
  BodyId a, b, c, d, e;
  ParticleId a1, a2, a3, b3, b4, b5, b6, b7, c7, c8, d9, d10, e11;
  BondId b8_9, b10_11;

  WorkedExample() {
    a = system.bodies().create(), b = system.bodies().create(), c = system.bodies().create(),
    d = system.bodies().create(), e = system.bodies().create();
    a1 = system.particles().create(a, {0, 0, 0}, 1), a2 = system.particles().create(a, {1, 1, 0}, 2);
    a3 = system.particles().create(a, {2, 0, 0.3}, 1.5);
    b3 = system.particles().create(b, {2, 0, 0.3}, 0.5), b4 = system.particles().create(b, {3, 0.5, 0}, 1);
    b5 = system.particles().create(b, {3, -1, 1}, 1), b6 = system.particles().create(b, {4, 0.5, -0.4}, 1.2);
    b7 = system.particles().create(b, {5, 0, 0}, 0.7);
    c7 = system.particles().create(c, {5, 0, 0}, 1), c8 = system.particles().create(c, {6, 1, 0}, 1);
    d9 = system.particles().create(d, {8, 1, 0}, 1, {0, 0.4, 0}),
    d10 = system.particles().create(d, {9, 1, 1}, 2, {0, 0.4, 0});
    e11 = system.particles().create(e, {11, 0, 0}, 3, {0.1, 0.2, 0.3});
    (void)system.edits().combine(a3, b3);
    (void)system.edits().combine(b7, c7);
    b8_9 = system.bonds().create(c8, d9, SpringLaw{5, 0.1});
    b10_11 = system.bonds().create(d10, e11, SpringLaw{5, 0.1});
    system.particles().set_velocity(a1, {0.3, -0.2, 0.5});
    system.particles().set_velocity(c8, {-0.3, 0.6, 0.1});
    for (int i = 0; i < 30; ++i) (void)system.step(1.0 / 120);
  }
  void expect_runs() {
    EXPECT_WHOLE(system);
    for (int i = 0; i < 120; ++i) {
      const StepReport report = system.step(1.0 / 120);
      EXPECT_EQ(report.unconverged, 0);
      ASSERT_LT(report.worst_gap, 1e-9);
    }
    EXPECT_WHOLE(system);
  }
};

TEST_F(WorkedExample, figure_4_9_has_three_articulates) {
  EXPECT_EQ(system.bodies().articulate_count(), 3u);
  EXPECT_EQ(system.bodies().articulate(a), system.bodies().articulate(c));
  EXPECT_NE(system.bodies().articulate(a), system.bodies().articulate(d));
  EXPECT_NE(system.bodies().articulate(d), system.bodies().articulate(e));
  EXPECT_EQ(system.particles().ring(a3).size(), 2u);
  EXPECT_DOUBLE_EQ(system.particles().mass(a3) + system.particles().mass(b3), 2.0);
  expect_runs();
}

TEST_F(WorkedExample, figure_4_11a_combine_in_one_body_removes_the_latter) {
  const RestructureReport report = system.edits().combine(b6, b5);
  EXPECT_TRUE(report.changed);
  ASSERT_EQ(report.absorbed_particles.size(), 1u);
  EXPECT_EQ(report.absorbed_particles[0].retired, b5);
  EXPECT_EQ(report.absorbed_particles[0].survivor, b6);
  EXPECT_FALSE(system.particles().contains(b5));
  EXPECT_EQ(system.particles().survivor_of(b5), b6);
  EXPECT_EQ(system.bodies().particles(b), (std::vector{b3, b4, b6, b7}));
  EXPECT_DOUBLE_EQ(system.particles().mass(b6), 2.2);
  EXPECT_EQ(system.bodies().articulate_count(), 3u);
  expect_momenta_kept(report, system);
  expect_runs();
}

TEST_F(WorkedExample, figure_4_11b_combine_at_a_hinge_makes_one_rigid_body) {
  (void)system.edits().combine(b6, b5);
  const RestructureReport report = system.edits().combine(b7, c7);
  EXPECT_FALSE(system.particles().contains(c7));
  EXPECT_FALSE(system.bodies().contains(c));
  EXPECT_EQ(system.bodies().survivor_of(c), b);
  EXPECT_EQ(system.particles().body(c8), b);
  EXPECT_EQ(system.bodies().particles(b), (std::vector{b3, b4, b6, b7, c8}));
  EXPECT_DOUBLE_EQ(system.particles().mass(b7), 1.7);
  EXPECT_EQ(system.bodies().articulate_count(), 3u);
  EXPECT_LE(report.energy_change, 1e-12);
  expect_momenta_kept(report, system);
  expect_runs();
}

TEST_F(WorkedExample, figures_4_11c_and_4_12_hinge_separate_and_detach) {
  (void)system.edits().combine(b6, b5);
  (void)system.edits().combine(b7, c7);
  // 4.11(c): different bodies, apart: a hinge, and one articulate less.
  const RestructureReport hinged = system.edits().combine(d9, c8);
  EXPECT_GT(hinged.closed_distance, 1.0);
  EXPECT_LT(hinged.remaining_gap, 1e-9);
  EXPECT_EQ(system.particles().position(d9), system.particles().position(c8));
  EXPECT_EQ(system.particles().ring(d9), (std::vector{d9, c8}));
  EXPECT_EQ(system.bodies().articulate(d), system.bodies().articulate(a));
  EXPECT_EQ(system.bodies().articulate_count(), 2u);
  EXPECT_TRUE(system.bonds().contains(b8_9)) << "it sleeps while its particles are one, and acts again after a cut";
  expect_momenta_kept(hinged, system);
  EXPECT_WHOLE(system);

  // 4.12(a): separate in one body: P10 becomes a one-particle body hinged to P9.
  const RestructureReport pulled = system.edits().separate(d9, d10);
  ASSERT_EQ(pulled.created_bodies.size(), 1u);
  EXPECT_EQ(system.particles().body(d10), pulled.created_bodies[0]);
  EXPECT_EQ(system.bodies().particles(d), std::vector{d9});
  EXPECT_EQ(system.particles().ring(d9).size(), 3u);
  EXPECT_EQ(system.bodies().articulate(pulled.created_bodies[0]), system.bodies().articulate(d));
  EXPECT_EQ(system.bodies().articulate_count(), 2u);
  EXPECT_TRUE(system.bonds().contains(b10_11));
  expect_momenta_kept(pulled, system);
  EXPECT_WHOLE(system);

  // 4.12(b): separate at a hinge: A gets an articulate of its own.
  const RestructureReport cut = system.edits().separate(b3, a3);
  EXPECT_EQ(cut.articulates_before, 2u);
  EXPECT_EQ(cut.articulates_after, 3u);
  EXPECT_NE(system.bodies().articulate(a), system.bodies().articulate(b));
  EXPECT_EQ(system.particles().position(a3), system.particles().position(b3)) << "cut, but still at the same place";
  EXPECT_DOUBLE_EQ(system.particles().mass(a3), 1.5);
  expect_momenta_kept(cut, system);
  expect_runs();
}

TEST(Combine, of_one_particle_with_itself_does_nothing) {
  System system;
  const BodyId body = system.bodies().create();
  const ParticleId p = system.particles().create(body, {});
  const auto version = system.structure_version();
  EXPECT_FALSE(system.edits().combine(p, p).changed);
  EXPECT_EQ(system.structure_version(), version);
}

TEST(Separate, of_unrelated_particles_does_nothing) {
  System system;
  const ParticleId p = system.particles().create(system.bodies().create(), {}),
                   q = system.particles().create(system.bodies().create(), {});
  EXPECT_FALSE(system.edits().separate(p, q).changed);
}

TEST(Separate, of_one_particle_makes_a_twin_with_half_the_mass_and_goes_on_to_a_free_body) {
  // Figure 4.10 from left to right: single point, same body, hinged, unrelated.
  System system{SystemOptions{.gravity = {}}};
  const BodyId body = system.bodies().create();
  const ParticleId p = system.particles().create(body, {1, 2, 3}, 4, {1, 0, 0});
  const RestructureReport single = system.edits().separate(p, p);
  ASSERT_EQ(single.created_particles.size(), 1u);
  const ParticleId q = single.created_particles[0];
  EXPECT_EQ(system.particles().body(q), body);
  EXPECT_DOUBLE_EQ(system.particles().mass(p), 2);
  EXPECT_DOUBLE_EQ(system.particles().mass(q), 2);
  EXPECT_WHOLE(system);
  (void)system.step(0.01);

  EXPECT_TRUE(system.edits().separate(p, q).changed);
  EXPECT_NE(system.particles().body(q), body);
  EXPECT_EQ(system.particles().ring(p), (std::vector{p, q}));
  EXPECT_EQ(system.bodies().articulate_count(), 1u);

  EXPECT_TRUE(system.edits().separate(p, q).changed);
  EXPECT_EQ(system.particles().ring(p), std::vector{p});
  EXPECT_EQ(system.bodies().articulate_count(), 2u);
  EXPECT_FALSE(system.edits().separate(p, q).changed);
  EXPECT_NEAR(norm(system.momentum() - Vec3{4, 0, 0}), 0, 1e-12);

  // and back again
  EXPECT_TRUE(system.edits().combine(p, q).changed);
  EXPECT_TRUE(system.edits().combine(p, q).changed);
  EXPECT_FALSE(system.particles().contains(q));
  EXPECT_DOUBLE_EQ(system.particles().mass(p), 4);
  EXPECT_EQ(system.bodies().articulate_count(), 1u);
  EXPECT_WHOLE(system);
}

/// Figure 4.13: does a cut of one hinge make two articulates? Not in a cycle.
struct FourBar : ::testing::Test {
  System system;
  std::vector<BodyId> bars;
  std::vector<ParticleId> starts, ends;
  FourBar() {
    const Vec3 corners[4] = {{0, 0, 0}, {1, 0, 0}, {1, -1, 0}, {0, -1, 0}};
    for (int i = 0; i < 4; ++i) {
      bars.push_back(system.bodies().create());
      starts.push_back(system.particles().create(bars[i], corners[i]));
      ends.push_back(system.particles().create(bars[i], corners[(i + 1) % 4]));
    }
    for (int i = 0; i < 4; ++i) (void)system.edits().combine(ends[i], starts[(i + 1) % 4]);
  }
};

TEST_F(FourBar, a_cycle_stays_one_articulate_after_the_first_cut_and_splits_after_the_second) {
  EXPECT_EQ(system.bodies().articulate_count(), 1u);
  EXPECT_WHOLE(system);
  const RestructureReport first = system.edits().separate(ends[0], starts[1]);
  EXPECT_TRUE(first.changed);
  EXPECT_EQ(first.articulates_after, 1u);
  const RestructureReport second = system.edits().separate(ends[2], starts[3]);
  EXPECT_EQ(second.articulates_after, 2u);
  EXPECT_EQ(system.bodies().articulate(bars[0]), system.bodies().articulate(bars[3]));
  EXPECT_EQ(system.bodies().articulate(bars[1]), system.bodies().articulate(bars[2]));
  EXPECT_WHOLE(system);
  (void)system.edits().combine(ends[2], starts[3]);
  (void)system.edits().combine(ends[0], starts[1]);
  EXPECT_EQ(system.bodies().articulate_count(), 1u);
  EXPECT_WHOLE(system);
}

TEST_F(FourBar, a_swinging_cycle_keeps_its_hinges_and_its_energy) {
  system.particles().nail(starts[0]);
  const double start = system.energy().total();
  for (int i = 0; i < 600; ++i) {
    const StepReport report = system.step(1.0 / 120);
    ASSERT_EQ(report.unconverged, 0);
    ASSERT_LT(report.worst_gap, 1e-9);
    ASSERT_LT(report.energy.total(), start + 1e-6);
  }
}

TEST(Combine, brings_distant_ends_together_without_a_shot_of_energy) {
  System system{SystemOptions{.gravity = {}}};
  const BodyId a = system.bodies().create(), b = system.bodies().create();
  system.particles().create(a, {0, 0, 0});
  const ParticleId p = system.particles().create(a, {1, 0, 0});
  const ParticleId q = system.particles().create(b, {1.5, 0.4, 0});
  system.particles().create(b, {2.5, 0.4, 0.3});
  const RestructureReport report = system.edits().combine(p, q);
  EXPECT_NEAR(report.closed_distance, std::hypot(0.5, 0.4), 1e-12);
  EXPECT_LT(report.remaining_gap, 1e-9);
  EXPECT_NEAR(system.energy().kinetic, 0, 1e-20) << "the closing displacement must not become velocity";
  EXPECT_LT(system.worst_gap(), 1e-9);
  (void)system.step(1.0 / 60);
  EXPECT_NEAR(system.energy().kinetic, 0, 1e-16);
}

/// Signed volume of the first four particles of a body over its first value: -1 for a mirror image.
struct Handedness {
  const System& system;
  BodyId body;
  double volume() const {
    const std::vector<ParticleId> p = system.bodies().particles(body);
    const Vec3 origin = system.particles().position(p[0]);
    const auto edge = [&](int i) { return system.particles().position(p[i]) - origin; };
    return dot(edge(1), cross(edge(2), edge(3)));
  }
  double first = volume();
  double now() const { return volume() / first; }
};

/// A solid of four points, about `size` large, its corner `first` at a place.
BodyId make_corner(System& system, double size, const Vec3& at) {
  const BodyId body = system.bodies().create();
  for (const Vec3& x : {Vec3{}, Vec3{1, 0.1, 0}, Vec3{0.2, 0.9, 0.1}, Vec3{0, 0.3, 1.2}})
    (void)system.particles().create(body, at + size * x, 0.7);
  return body;
}

TEST(Combine, of_distant_points_does_not_mirror_solids) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (const double size : {1e-3, 1.0, 1e3})
    for (int scene = 0; scene < 40; ++scene) {
      System system{SystemOptions{.gravity = {0, 0, 0}}};
      std::vector<BodyId> bodies;
      for (int i = 0; i < 3; ++i)
        bodies.push_back(make_corner(system, size, 4 * size * Vec3{uniform(random), uniform(random), uniform(random)}));
      std::vector<Handedness> hands;
      for (const BodyId body : bodies) hands.push_back({system, body});
      const auto corner = [&](int body, int i) { return system.bodies().particles(bodies[body])[i]; };
      // Free ones, then a ring of three: the last solids are held at one and two points.
      for (int i = 0; i < 3; ++i) {
        (void)system.edits().combine(corner(i, scene % 4), corner((i + 1) % 3, (scene + 1 + scene / 4 % 3) % 4));
        for (const Handedness& hand : hands) EXPECT_NEAR(hand.now(), 1, 1e-6) << "size " << size << " scene " << scene;
      }
      EXPECT_WHOLE(system);
    }
}

TEST(Combine, over_a_time_closes_smoothly_and_then_makes_one_ring) {
  System system{SystemOptions{.gravity = {}}};
  const ParticleId p = system.particles().create(system.bodies().create(), {0, 0, 0}),
                   q = system.particles().create(system.bodies().create(), {1, 0, 0}, 3);
  EXPECT_TRUE(system.edits().combine(p, q, 0.5).changed);
  EXPECT_EQ(system.edits().closing_count(), 1u);
  EXPECT_EQ(system.bodies().articulate_count(), 1u);
  double distance = 1;
  for (int i = 0; i < 59; ++i) {
    (void)system.step(1.0 / 120);
    const double now = norm(system.particles().position(q) - system.particles().position(p));
    EXPECT_LE(now, distance + 1e-12);
    EXPECT_NEAR(norm(system.momentum()), 0, 1e-9);
    distance = now;
  }
  for (int i = 0; i < 3; ++i) (void)system.step(1.0 / 120);
  EXPECT_EQ(system.edits().closing_count(), 0u);
  EXPECT_EQ(system.particles().ring(p).size(), 2u);
  EXPECT_NEAR(system.particles().position(p).x, 0.75, 1e-6) << "they meet at their common center of mass";
  EXPECT_WHOLE(system);
}

TEST(Combine, over_a_time_is_no_change_of_structure_until_the_particles_meet) {
  System system;
  const BodyId body = system.bodies().create();
  const ParticleId p = system.particles().create(body, {0, 0, 0}),
                   q = system.particles().create(system.bodies().create(), {1, 0, 0});
  system.particles().create(body, {0, 1, 0});
  (void)system.viewer().take_scene_changes();
  const std::uint32_t version = system.structure_version();
  const RestructureReport begun = system.edits().combine(p, q, 0.05);
  EXPECT_TRUE(begun.changed);
  EXPECT_EQ(begun.structure_version, version);
  (void)system.step(0.01);
  const GripId grip = system.grips().create(body, {}, {0, 0, 0});
  (void)system.step(0.01);
  system.grips().destroy(grip);
  (void)system.step(0.01);
  EXPECT_TRUE(system.edits().separate(p, q).changed) << "called off";
  (void)system.edits().combine(p, q, 0.05);
  EXPECT_EQ(system.structure_version(), version);
  const SceneChanges seen = system.viewer().take_scene_changes();
  EXPECT_TRUE(seen.bodies.set.empty() && seen.events.empty());
  for (int i = 0; i < 6; ++i) (void)system.step(0.01);
  EXPECT_GT(system.structure_version(), version) << "they have met";
}

TEST(Combine, that_is_called_off_leaves_two_articulates) {
  System system;
  const ParticleId p = system.particles().create(system.bodies().create(), {0, 0, 0}),
                   q = system.particles().create(system.bodies().create(), {1, 0, 0});
  (void)system.edits().combine(p, q, 5);
  (void)system.step(0.01);
  EXPECT_TRUE(system.edits().separate(p, q).changed);
  EXPECT_EQ(system.edits().closing_count(), 0u);
  EXPECT_EQ(system.bodies().articulate_count(), 2u);
  EXPECT_WHOLE(system);
}

TEST(Combine, over_a_time_is_called_off_when_both_become_one_rigid_body_or_one_ring) {
  System system{SystemOptions{.gravity = {}}};
  const BodyId a = system.bodies().create(), b = system.bodies().create();
  const ParticleId a1 = system.particles().create(a, {0, 0, 0}), a2 = system.particles().create(a, {1, 0, 0});
  const ParticleId b1 = system.particles().create(b, {0, 1, 0});
  system.particles().create(b, {1, 1, 0});
  (void)system.edits().combine(a1, b1, 1);
  (void)system.step(0.01);
  const RestructureReport report = system.edits().combine(a, b);
  EXPECT_EQ(system.edits().closing_count(), 0u);
  EXPECT_FALSE(report.notes.empty());
  EXPECT_WHOLE(system);

  const ParticleId p = system.particles().create(system.bodies().create(), {3, 0, 0}),
                   q = system.particles().create(system.bodies().create(), {4, 0, 0});
  (void)system.edits().combine(p, q, 1);
  (void)system.edits().combine(a2, p);
  (void)system.edits().combine(a2, q);
  EXPECT_EQ(system.edits().closing_count(), 0u);
  EXPECT_EQ(system.particles().ring(a2).size(), 3u);
  EXPECT_WHOLE(system);
  (void)system.step(0.01);
}

TEST(Combine, of_two_bodies_makes_one_rigid_body_that_keeps_momenta) {
  System system{SystemOptions{.gravity = {}}};
  const BodyId a = system.bodies().create(), b = system.bodies().create();
  system.particles().create(a, {0, 0, 0}, 1, {0, 1, 0}), system.particles().create(a, {1, 0, 0}, 1, {0, 1, 0});
  system.particles().create(b, {0, 0, 1}, 2), system.particles().create(b, {1, 1, 1}, 2);
  (void)system.step(0.01);
  const RestructureReport report = system.edits().combine(a, b);
  EXPECT_EQ(system.bodies().survivor_of(b), a);
  EXPECT_EQ(system.bodies().particles(a).size(), 4u);
  EXPECT_LT(report.energy_change, 0) << "an inelastic join";
  expect_momenta_kept(report, system);
  EXPECT_WHOLE(system);
  for (int i = 0; i < 100; ++i) ASSERT_LT(system.step(1.0 / 120).worst_gap, 1e-9);
}

TEST(Combine, refuses_to_put_two_particles_of_one_body_in_one_place) {
  System system;
  const BodyId rod = system.bodies().create(), other = system.bodies().create();
  const ParticleId p = system.particles().create(rod, {0, 0, 0}), q = system.particles().create(rod, {1, 0, 0});
  const ParticleId r = system.particles().create(other, {0, 0, 0});
  (void)system.edits().combine(p, r);
  const auto hash = system.state_hash();
  EXPECT_THROW((void)system.edits().combine(r, q), std::invalid_argument);
  EXPECT_EQ(system.state_hash(), hash) << "nothing may change";
  EXPECT_WHOLE(system);
}

TEST(Combine, in_one_body_keeps_the_nail_of_the_particle_that_is_removed) {
  System system;
  const BodyId body = system.bodies().create();
  const ParticleId p = system.particles().create(body, {1, 0, 0}), q = system.particles().create(body, {0, 0, 0});
  system.particles().create(body, {1, -1, 0});
  const Vec3 hook{0, 0.25, 0};
  system.particles().nail(q, hook);
  (void)system.step(1.0 / 60);
  (void)system.edits().combine(p, q);
  EXPECT_FALSE(system.particles().contains(q));
  ASSERT_TRUE(system.particles().is_nailed(p));
  for (int i = 0; i < 30; ++i) (void)system.step(1.0 / 60);
  EXPECT_LT(norm(system.particles().position(p) - hook), 1e-9) << "the nail stays where it is, the body comes to it";
  EXPECT_WHOLE(system);
}

// Nails do not yield, so no row of the bar is left that could report it.
TEST(Combine, of_a_nailed_bar_with_a_nail_out_of_its_reach_says_what_remains) {
  for (const double over : {0.0, 0.1}) {
    System system;
    const BodyId bar = system.bodies().create(), stone = system.bodies().create();
    const ParticleId held = system.particles().create(bar, {0, 0, 0}), end = system.particles().create(bar, {1, 0, 0});
    const ParticleId far = system.particles().create(stone, {1.5, 0, 0});
    system.particles().nail(held), system.particles().nail(far);
    const RestructureReport report = system.edits().combine(end, far, over);
    if (over == 0) {
      EXPECT_NEAR(report.remaining_gap, 0.5, 1e-6);
      EXPECT_FALSE(report.notes.empty());
    }
    for (int i = 0; i < 30; ++i) EXPECT_GT(system.step(1.0 / 120).unconverged, 0) << over << ' ' << i;
  }
}

TEST(Combine, reports_the_impulse_of_a_nail) {
  System system{SystemOptions{.gravity = {}}};
  const ParticleId nailed = system.particles().create(system.bodies().create(), {0, 0, 0}),
                   flying = system.particles().create(system.bodies().create(), {0.1, 0, 0}, 2, {3, 0, 0});
  system.particles().nail(nailed);
  const RestructureReport report = system.edits().combine(nailed, flying);
  EXPECT_NEAR(norm(report.momentum_change - Vec3{-6, 0, 0}), 0, 1e-12);
  EXPECT_NEAR(report.energy_change, -9, 1e-12);
}

TEST(Destroying, a_body_in_the_middle_of_a_chain_leaves_two_articulates) {
  System system;
  std::vector<BodyId> bodies;
  std::vector<ParticleId> ends;
  for (int i = 0; i < 5; ++i) {
    bodies.push_back(system.bodies().create());
    const ParticleId start = system.particles().create(bodies[i], {double(i), 0, 0});
    if (i > 0) (void)system.edits().combine(ends.back(), start);
    ends.push_back(system.particles().create(bodies[i], {double(i + 1), 0, 0}));
  }
  system.bodies().destroy(bodies[2]);
  EXPECT_EQ(system.bodies().articulate_count(), 2u);
  EXPECT_THROW((void)system.bodies().mass(bodies[2]), StaleIdError);
  EXPECT_THROW((void)system.particles().position(ends[2]), StaleIdError);
  EXPECT_WHOLE(system);
  (void)system.step(0.01);
}

}  // namespace
}  // namespace iota
