// SPDX-License-Identifier: Apache-2.0
// Groups, fields and pairwise forces.
#include "scenes/chain.h"
#include "tests/cpp/scattered.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace iota {
namespace {

TEST(Field, uniform_is_gravity_and_can_replace_it) {
  System plain, replaced(SystemOptions{.gravity = {0, 50, 0}});
  FieldOptions options;
  options.parameters = {{"acceleration_y", -9.81}};
  options.replaces_gravity = true;
  const FieldId field = replaced.fields().create("uniform", options);
  for (System* const s : {&plain, &replaced}) {
    (void)scatter(*s, 3, 5);
    scenes::make_chain(*s, {.links = 5});
    for (int i = 0; i < 100; ++i) (void)s->step(0.01);
  }
  const auto a = positions(plain), b = positions(replaced);
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_NEAR(a[i], b[i], 1e-7);
  replaced.fields().set_active(field, false);
  const double before = replaced.particles().velocity(replaced.particles().ids()[0]).y;
  (void)replaced.step(0.01);
  EXPECT_NEAR(replaced.particles().velocity(replaced.particles().ids()[0]).y - before, 0.5, 1e-9) << "gravity is back";
}

TEST(Field, acts_on_its_group_only) {
  System system(SystemOptions{.gravity = {}});
  const auto particles = scatter(system, 4, 6, 1, 0);
  const GroupId group = system.groups().create("leaves");
  system.groups().add(group, particles[1]);
  system.groups().add(group, particles[2]);
  FieldOptions options;
  options.group = group;
  options.parameters = {{"velocity_x", 5}, {"drag", 1e9}};
  const FieldId wind = system.fields().create("wind", options);
  (void)system.step(0.01);
  EXPECT_EQ(system.particles().velocity(particles[0]), Vec3{});
  EXPECT_NEAR(system.particles().velocity(particles[1]).x, 5, 1e-9) << "as fast as the wind, no faster";
  system.groups().remove(group, particles[1]);
  system.fields().set_parameter(wind, "velocity_x", 7);
  (void)system.step(0.01);
  EXPECT_NEAR(system.particles().velocity(particles[1]).x, 5, 1e-9);
  EXPECT_NEAR(system.particles().velocity(particles[2]).x, 7, 1e-9);
  EXPECT_EQ(system.groups().particles(group), std::vector<ParticleId>{particles[2]});
  EXPECT_THROW(system.groups().destroy(group), std::invalid_argument);
  system.fields().destroy(wind);
  system.groups().destroy(group);
  EXPECT_FALSE(system.groups().contains(group));
  EXPECT_EQ(system.validate(), std::vector<std::string>{});
}

TEST(Field, of_a_well_keeps_an_orbit_closed) {
  for (const std::string text : {"well", "written"}) {
    System system(SystemOptions{.gravity = {}});
    const ParticleId p = system.particles().create(system.bodies().create(), {1, 0, 0}, 3, {0, 1, 0});
    if (text == "well")
      system.fields().create("well", {"", {{"strength", 1}, {"softening", 0}}, {}, false});
    else
      system.fields().create("r = sqrt(x^2 + y^2 + z^2); fx = -m*x/r^3; fy = -m*y/r^3; fz = -m*z/r^3");
    const double turn = 2 * 3.14159265358979323846;
    for (int i = 0; i < 20 * 500; ++i) (void)system.step(turn / 500);
    EXPECT_NEAR(norm(system.particles().position(p)), 1, 1e-4) << "twenty turns";
    EXPECT_NEAR(system.particles().position(p).x, 1, 5e-3) << "twenty turns";
  }
}

TEST(Field, a_function_sees_all_its_particles_and_is_switched_off_when_it_throws) {
  System system(SystemOptions{.gravity = {}});
  const auto particles = scatter(system, 3, 8, 1, 0);
  bool angry = false;
  std::size_t seen = 0;
  const FieldId field = system.fields().create(FieldFunction([&](const ParticleBatch& b) {
                                                 if (angry) throw std::runtime_error("enough");
                                                 seen = b.count;
                                                 for (std::size_t i = 0; i < 3 * b.count; ++i)
                                                   b.force[i] = b.mass[i / 3];
                                               }),
                                               {"push", {}, {}, false});
  (void)system.step(0.5);
  EXPECT_EQ(seen, 3u);
  EXPECT_NEAR(norm(system.particles().velocity(particles[1]) - Vec3{0.5, 0.5, 0.5}), 0, 1e-12);
  angry = true;
  const StepReport report = system.step(0.5);
  EXPECT_EQ(report.warnings, std::vector<std::string>{"field 0 (push) raised: enough; the field is switched off"});
  EXPECT_FALSE(system.fields().is_active(field));
  EXPECT_TRUE(system.step(0.5).warnings.empty());
}

TEST(Field, without_a_finite_force_says_where) {
  System system(SystemOptions{.gravity = {}});
  const ParticleId good = system.particles().create(system.bodies().create(), {1, 0, 0});
  const ParticleId bad = system.particles().create(system.bodies().create(), {0, 0, 0});
  system.fields().create("fx = 1/x", {"pole", {}, {}, false});
  const StepReport report = system.step(0.1);
  EXPECT_EQ(report.warnings,
            std::vector<std::string>{"field 0 (pole) gives no finite force on particle 1; there it gives none"});
  EXPECT_NEAR(system.particles().velocity(good).x, 0.1, 1e-12);
  EXPECT_EQ(system.particles().velocity(bad), Vec3{});
}

TEST(Pairs, a_lennard_jones_fluid_keeps_its_energy) {
  System system(SystemOptions{.gravity = {}});
  std::mt19937 random(9);
  for (int i = 0; i < 216; ++i) {
    const Vec3 place{1.15 * (i % 6), 1.15 * (i / 6 % 6), 1.15 * (i / 36)};
    const auto number = [&] { return std::uniform_real_distribution(-0.5, 0.5)(random); };
    system.particles().create(system.bodies().create(), place, 1, {number(), number(), number()});
  }
  const PairsId pairs = system.pairs().create({system.laws().find("lennard_jones"), {}, {}}, {.cutoff = 6});
  const Vec3 momentum = system.momentum();
  const double start = system.energy().total();
  EXPECT_DOUBLE_EQ(system.energy().potential, system.pairs().energy(pairs));
  double drift = 0;
  for (int i = 0; i < 400; ++i) {
    const StepReport report = system.step(0.004);
    ASSERT_TRUE(report.warnings.empty());
    drift = std::max(drift, std::abs(report.energy.total() - start));
  }
  EXPECT_LT(drift, 1e-3 * std::abs(start));
  EXPECT_LT(norm(system.momentum() - momentum), 1e-11);
}

TEST(Pairs, are_the_same_written_restored_and_replayed) {
  std::vector<std::vector<double>> ends;
  for (const bool written : {false, true}) {
    System system(SystemOptions{.gravity = {}});
    (void)scatter(system, 200, 10, 1, 0.2);
    const LawId law =
        written ? system.laws().create("energy = 0.5*k*where(r < d, r - d, 0)^2", {"", {{"k", 30}, {"d", 0.4}}})
                : system.laws().find("soft_repulsion");
    SharedLaw shared{law, {}, {}};
    if (!written) shared.parameters = {{"stiffness", 30}, {"length", 0.4}};
    system.record().start();
    system.pairs().create(shared, {.cutoff = 0.4});
    for (int i = 0; i < 50; ++i) (void)system.step(0.01);
    const Snapshot middle = system.snapshot();
    for (int i = 0; i < 50; ++i) (void)system.step(0.01);
    ends.push_back(positions(system));
    const std::uint64_t hash = system.state_hash();
    const Recording recording = system.record().stop();
    System other;
    other.restore(middle);
    for (int i = 0; i < 50; ++i) (void)other.step(0.01);
    EXPECT_EQ(other.state_hash(), hash) << "the list of neighbors is no hidden state";
    EXPECT_EQ(other.record().replay(recording), std::nullopt);
  }
  for (std::size_t i = 0; i < ends[0].size(); ++i) EXPECT_NEAR(ends[0][i], ends[1][i], 1e-10);
}

TEST(Pairs, leave_out_points_of_one_body_and_push_nothing_static) {
  System system(SystemOptions{.gravity = {}});
  const BodyId rod = system.bodies().create(), wall = system.bodies().create({.kind = BodyKind::static_});
  const ParticleId a = system.particles().create(rod, {0, 0, 0}), b = system.particles().create(rod, {0.1, 0, 0});
  const ParticleId post = system.particles().create(wall, {0.3, 0, 0});
  SharedLaw law{system.laws().find("coulomb"), {{"strength", 1}}, {}};
  system.pairs().create(law, {.cutoff = 1});
  (void)system.step(0.01);
  EXPECT_NEAR(system.momentum().x, -0.01 * (1 / 0.09 + 1 / 0.04), 1e-9);
  EXPECT_EQ(system.particles().position(post).x, 0.3);
  EXPECT_NEAR(norm(system.particles().position(b) - system.particles().position(a)), 0.1, 1e-12);
}

TEST(Groups, and_forces_refuse_bad_input) {
  System system;
  const ParticleId p = system.particles().create(system.bodies().create(), {});
  const std::uint64_t hash = system.state_hash();
  const auto refuses = [](auto call, const std::string& words) {
    try {
      call();
      ADD_FAILURE() << "not refused: " << words;
    } catch (const std::invalid_argument& error) {
      EXPECT_NE(std::string(error.what()).find(words), std::string::npos) << error.what();
    }
  };
  refuses([&] { system.groups().create(""); }, "needs a name");
  refuses([&] { system.groups().create(std::string(40, 'x')); }, "shorter than 32");
  refuses([&] { system.fields().create("wnd"); }, "no field is called 'wnd'");
  refuses([&] { system.fields().create("fx = q"); }, "unknown name 'q'");
  refuses([&] { system.fields().create("gx = 1"); }, "defines 'energy' (J), or 'fx', 'fy' or 'fz'");
  refuses([&] { system.fields().create("wind", {"", {{"drag", -1}}, {}, false}); }, "drag must be zero or more");
  refuses([&] { system.fields().create("wind", {"", {{"drga", 1}}, {}, false}); }, "did you mean 'drag'");
  refuses([&] { system.fields().create("wind", {"", {{"drag", NAN}}, {}, false}); }, "drag");
  refuses([&] { system.fields().create(FieldFunction{}); }, "needs a function");
  const SharedLaw morse{system.laws().find("morse"), {}, {}};
  refuses([&] { system.pairs().create(morse, {.cutoff = 1}); }, "need a value for length");
  refuses([&] { system.pairs().create({system.laws().find("coulomb"), {}, {}}, {.cutoff = 0}); },
          "cutoff must be positive");
  refuses([&] { system.pairs().create({system.laws().find("coulomb"), {}, {}}, {.cutoff = NAN}); }, "cutoff");
  EXPECT_EQ(system.state_hash(), hash);
  const GroupId group = system.groups().create("a");
  refuses([&] { system.groups().create("a"); }, "already");
  for (int i = 1; i < 32; ++i) system.groups().create("g" + std::to_string(i));
  refuses([&] { system.groups().create("one more"); }, "at most 32");
  system.groups().destroy(group);
  EXPECT_THROW(system.groups().add(group, p), StaleIdError);
}

/// A box in a wind that blows upwards, and another one that falls on it.
struct Blown {
  System system{{.gravity = {}}};
  BodyId box, falling;
  Blown() {
    system.set_usual_material(Material{0.5});
    box = system.bodies().create(Box{{0.2, 0.2, 0.2}}, {});
    falling = system.bodies().create(Sphere{0.1}, {.position = {0, 0.3, 0}});
    for (const ParticleId p : system.bodies().particles(falling)) system.particles().set_velocity(p, {0, -1, 0});
    const GroupId group = system.groups().create("blown");
    for (const ParticleId p : system.bodies().particles(box)) system.groups().add(group, p);
    system.fields().create("wind", {.parameters = {{"velocity_y", 3}, {"drag", 0.5}}, .group = group});
    (void)system.step(0.01);
  }
};

TEST(Field, acts_in_the_very_step_in_which_something_touches_what_is_frozen) {
  Blown made;
  System& system = made.system;
  for (const ParticleId p : system.bodies().particles(made.box)) system.particles().set_velocity(p, {});
  (void)system.step(0.01);
  system.bodies().set_stride(made.box, 0);
  (void)system.step(0.01);
  const Vec3 held = system.bodies().center_of_mass(made.box);
  Vec3 before = system.momentum();
  int frozen = 0;
  for (; frozen < 100 && system.bodies().stride(made.box) == 0; ++frozen) {
    EXPECT_EQ(system.bodies().center_of_mass(made.box), held);
    before = system.momentum();
    (void)system.step(0.01);
  }
  ASSERT_GT(frozen, 2);
  ASSERT_LT(frozen, 100);
  // The wind's impulse on 6 to 8 particles of 0.5 N s/m each, at about 3 m/s.
  EXPECT_GT(system.momentum().y - before.y, 0.05);
}

TEST(Field, has_the_same_bits_with_all_bodies_within_strides_from_a_snapshot) {
  Blown made;
  made.system.bodies().set_stride(made.box, 4);
  for (int i = 0; i < 3; ++i) (void)made.system.step(0.01);
  System other;
  other.restore(made.system.snapshot());
  for (int i = 0; i < 40; ++i) (void)made.system.step(0.01), (void)other.step(0.01);
  EXPECT_EQ(made.system.snapshot(), other.snapshot());
}

}  // namespace
}  // namespace iota
