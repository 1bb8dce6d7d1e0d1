// SPDX-License-Identifier: Apache-2.0
// Bonds by law: all ways of writing one, implicit and held.
#include "scenes/chain.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace iota {
namespace {

double compiled_spring(double r, double, double, const double* p) { return -p[0] * (r - p[1]); }

BatchFunction batch_spring() {
  return [](const BondBatch& b) {
    for (std::size_t i = 0; i < b.count; ++i) {
      double d[3], r2 = 0;
      for (int k = 0; k < 3; ++k) d[k] = b.position_q[3 * i + k] - b.position_p[3 * i + k], r2 += d[k] * d[k];
      const double r = std::sqrt(r2), pull = b.parameters[2 * i] * (r - b.parameters[2 * i + 1]) / r;
      for (int k = 0; k < 3; ++k) b.force[3 * i + k] = pull * d[k];
    }
  };
}

/// A lattice of bonded particles, stretched a little, that rings without chaos.
struct BondMesh {
  System system;
  std::vector<ParticleId> particles;
  std::vector<BondId> bonds;

  template <class Bond>
  BondMesh(IntegrationMode mode, Bond bond) : system(SystemOptions{.gravity = {0, -1, 0}, .mode = mode}) {
    constexpr int n = 4;
    for (int y = 0; y < n; ++y)
      for (int x = 0; x < n; ++x)
        particles.push_back(system.particles().create(system.bodies().create(),
                                                      {0.11 * x, 0.11 * y, 0.01 * ((x + y) % 2)}, 0.1 + 0.01 * x));
    for (int x = 0; x < n; ++x) system.particles().nail(particles[(n - 1) * n + x]);
    for (int y = 0; y < n; ++y)
      for (int x = 0; x < n; ++x) {
        if (x + 1 < n) bonds.push_back(bond(system, particles[y * n + x], particles[y * n + x + 1]));
        if (y + 1 < n) bonds.push_back(bond(system, particles[y * n + x], particles[(y + 1) * n + x]));
      }
  }
};

TEST(Law, is_the_same_force_on_all_ways_of_writing_it) {
  const std::vector<LawParameter> parameters{{"k", 20}, {"r0", 0.1}};
  const std::vector<std::function<LawId(System&)>> ways{
      [](System& s) { return s.laws().find("spring"); },
      [&](System& s) { return s.laws().create("energy = 0.5*k*(r - r0)^2", {"written", parameters}); },
      [&](System& s) { return s.laws().create("force = -k*(r - r0)", {"pushed", parameters}); },
      [&](System& s) { return s.laws().create(&compiled_spring, {"compiled", parameters}); },
      [&](System& s) { return s.laws().create(batch_spring(), {"batch", parameters}); },
  };
  for (const IntegrationMode mode : {IntegrationMode::energy_keeping, IntegrationMode::robust}) {
    std::vector<std::vector<double>> ends;
    for (std::size_t way = 0; way <= ways.size(); ++way) {
      std::optional<LawId> law;
      BondMesh mesh(mode, [&](System& s, ParticleId p, ParticleId q) {
        if (way == ways.size())
          return s.bonds().create(p, q,
                                  ScriptedLaw{[](const BondState& b) {
                                                const Vec3 d = b.position_q - b.position_p;
                                                return (20 * (norm(d) - 0.1) / norm(d)) * d;
                                              },
                                              "scripted"});
        if (!law) law = ways[way](s);
        SharedLaw shared{*law, {}, false};
        if (way == 0) shared.parameters = {{"stiffness", 20}, {"length", 0.1}};
        return s.bonds().create(p, q, shared);
      });
      for (int i = 0; i < 100; ++i) ASSERT_TRUE(mesh.system.step(1.0 / 240).switched_off.empty());
      ends.emplace_back(3 * mesh.particles.size());
      mesh.system.particles().read_positions(ends.back());
    }
    double moved = 0;
    for (std::size_t way = 1; way < ends.size(); ++way)
      for (std::size_t i = 0; i < ends[0].size(); ++i) {
        EXPECT_NEAR(ends[way][i], ends[0][i], 1e-12) << "way " << way;
        moved = std::max(moved, std::abs(ends[0][i] - 0.11 * static_cast<double>(i / 3 % 4)));
      }
    EXPECT_GT(moved, 0.02);
  }
}

TEST(Law, written_as_an_energy_is_solved_like_the_built_in_spring) {
  for (const IntegrationMode mode : {IntegrationMode::energy_keeping, IntegrationMode::robust}) {
    std::vector<std::vector<double>> ends;
    for (const bool written : {false, true}) {
      std::optional<LawId> law;
      BondMesh mesh(mode, [&](System& s, ParticleId p, ParticleId q) {
        if (!written) return s.bonds().create(p, q, SpringLaw{300, 0.5, 0.1});
        if (!law)
          law = s.laws().create("energy = 0.5*k*(r - r0)^2; force = -c*v", {"", {{"k", 300}, {"r0", 0.1}, {"c", 0.5}}});
        return s.bonds().create(p, q, SharedLaw{*law});
      });
      for (int i = 0; i < 100; ++i) ASSERT_EQ(mesh.system.step(1.0 / 120).unconverged, 0);
      ends.emplace_back(3 * mesh.particles.size());
      mesh.system.particles().read_positions(ends.back());
    }
    for (std::size_t i = 0; i < ends[0].size(); ++i) EXPECT_NEAR(ends[1][i], ends[0][i], 1e-8);
  }
}

TEST(Law, stiff_ones_are_solved_together_with_the_joints) {
  for (const std::string text : {"energy = 0.5*k*(r - 0.2)^2", "energy = k*(r - 0.2)^4", "force = -k*(r - 0.2)^3"}) {
    System system;
    const auto a = scenes::make_chain(system, {.links = 5});
    const auto b = scenes::make_chain(system, {.links = 5, .top = {0, -0.2, 0.1}});
    const LawId law = system.laws().create(text, {"", {{"k", 1e7}}});
    system.bonds().create(a.lower[4], b.lower[4], SharedLaw{law});
    for (int i = 0; i < 120; ++i) {
      const StepReport report = system.step(1.0 / 60);
      ASSERT_LT(report.worst_gap, 1e-8) << text;
      ASSERT_EQ(report.unconverged, 0) << text;
      const Energy e = report.energy;
      ASSERT_NEAR(e.balance(), system.energy().balance(), 1e-12);
    }
  }
}

TEST(Law, keeps_the_energy_of_an_oscillator_of_any_shape) {
  for (const std::string name : {"morse", "lennard_jones", "gravity"}) {
    System system{SystemOptions{.gravity = {}}};
    const ParticleId p = system.particles().create(system.bodies().create(), {0, 0, 0}, 1);
    const ParticleId q = system.particles().create(system.bodies().create(), {1.2, 0, 0}, 1, {0, 0.3, 0});
    SharedLaw law{system.laws().find(name)};
    if (name == "morse") law.parameters = {{"length", 1}, {"depth", 5}};
    system.bonds().create(p, q, law);
    const double start = system.energy().total();
    double largest = 0;
    int fallbacks = 0;
    for (int i = 0; i < 10000; ++i) {
      const StepReport report = system.step(0.01);
      largest = std::max(largest, std::abs(report.energy.total() - start));
      fallbacks += report.fallbacks;
    }
    EXPECT_LT(largest, 1e-6) << name;
    EXPECT_EQ(fallbacks, 0) << name;
  }
}

TEST(Law, two_bodies_under_gravity_follow_kepler) {
  System system{SystemOptions{.gravity = {}}};
  const double semi_major = 1, eccentricity = 0.4, total = 4;  // G = 1
  const double far = semi_major * (1 + eccentricity);
  const double speed = std::sqrt(total * (1 - eccentricity) / far);
  const ParticleId p = system.particles().create(system.bodies().create(), {0, 0, 0}, 3, {0, -speed / 4, 0});
  const ParticleId q = system.particles().create(system.bodies().create(), {far, 0, 0}, 1, {0, speed * 3 / 4, 0});
  system.bonds().create(p, q, SharedLaw{system.laws().find("gravity")});
  const double period = 2 * std::numbers::pi * std::sqrt(semi_major / total);
  const auto error_after_one_orbit = [&](int steps) {
    const Snapshot start = system.snapshot();
    for (int i = 0; i < steps; ++i) (void)system.step(period / steps);
    const Vec3 d = system.particles().position(q) - system.particles().position(p);
    system.restore(start);
    return norm(d - Vec3{far, 0, 0});
  };
  const double coarse = error_after_one_orbit(500), fine = error_after_one_orbit(1000);
  EXPECT_LT(fine, 2e-4);
  EXPECT_NEAR(coarse / fine, 4, 0.1) << "second order";
}

TEST(Law, that_is_held_neither_gains_nor_loses_energy_in_the_long_run) {
  System system{SystemOptions{.gravity = {}}};
  const ParticleId p = system.particles().create(system.bodies().create(), {0, 0, 0}, 1);
  const ParticleId q = system.particles().create(system.bodies().create(), {1.1, 0, 0}, 1);
  system.bonds().create(p, q, SharedLaw{system.laws().find("spring"), {{"stiffness", 200}, {"length", 1}}, false});
  double early = 0, late = 0;
  for (int i = 0; i < 12000; ++i) {
    const double kinetic = system.step(1.0 / 120).energy.kinetic;
    if (i < 120) early = std::max(early, kinetic);
    if (i > 11800) late = std::max(late, kinetic);
  }
  EXPECT_NEAR(late / early, 1, 0.01) << "3 Hz for 100 s";
}

TEST(Law, the_energy_book_counts_pushes_and_changes_with_time) {
  for (const std::string text :
       {"force = 3", "energy = 50*(r - 1 - 0.2*sin(5*t))^2", "force = -40*(r - 1) + 4*sin(7*t)", "force = 2*v"}) {
    System system;
    const auto chain = scenes::make_chain(system, {.links = 4});
    const ParticleId p = system.particles().create(system.bodies().create(), {0.3, 0.2, 0}, 0.5);
    system.bonds().create(chain.lower[3], p, SharedLaw{system.laws().create(text)});
    const double start = system.energy().balance();
    double dissipated = 0;
    for (int i = 0; i < 240; ++i) {
      const StepReport report = system.step(1.0 / 240);
      EXPECT_NEAR(report.energy.balance(), start, 1e-9) << text;
      EXPECT_EQ(report.unconverged, 0) << text;
      dissipated = report.energy.dissipated;
    }
    if (text == "force = 2*v")
      EXPECT_LT(dissipated, -0.1) << "an engine, not a brake: its work is negative dissipation";
    else
      EXPECT_NEAR(dissipated, 0, 1e-7) << text;
  }
}

TEST(Law, without_a_finite_force_switches_its_bond_off) {
  for (const bool implicit : {true, false}) {
    System system{SystemOptions{.gravity = {}}};
    const ParticleId p = system.particles().create(system.bodies().create(), {0, 0, 0}, 1, {1, 0, 0});
    const ParticleId q = system.particles().create(system.bodies().create(), {0, 0, 0}, 1, {1, 0, 0});
    const ParticleId far = system.particles().create(system.bodies().create(), {2, 0, 0}, 1, {1, 0, 0});
    const LawId law = system.laws().create("energy = 1/r", {"inverse"});
    const BondId bad = system.bonds().create(p, q, SharedLaw{law, {}, implicit});
    const BondId good = system.bonds().create(p, far, SharedLaw{law, {}, implicit});
    const StepReport report = system.step(0.01);
    ASSERT_EQ(report.switched_off, std::vector<BondId>{bad});
    EXPECT_NE(report.warnings.at(0).find("bond 0 (inverse): the force is not finite at r = 0 m"), std::string::npos)
        << report.warnings.at(0);
    EXPECT_FALSE(system.bonds().is_active(bad));
    EXPECT_TRUE(system.bonds().is_active(good));
    EXPECT_GT(system.particles().velocity(far).x, 1);
    EXPECT_TRUE(system.step(0.01).switched_off.empty());
    EXPECT_EQ(system.validate(), std::vector<std::string>{});
  }
}

TEST(Law, a_function_that_throws_switches_off_the_bonds_of_its_law) {
  System system{SystemOptions{.gravity = {}}};
  const ParticleId p = system.particles().create(system.bodies().create(), {0, 0, 0});
  const ParticleId q = system.particles().create(system.bodies().create(), {1, 0, 0});
  const LawId law = system.laws().create(
      BatchFunction([](const BondBatch&) { throw std::runtime_error("no wind today"); }), {"wind"});
  const BondId a = system.bonds().create(p, q, SharedLaw{law}), b = system.bonds().create(q, p, SharedLaw{law});
  const StepReport report = system.step(0.01);
  EXPECT_EQ(report.switched_off, (std::vector<BondId>{a, b}));
  EXPECT_EQ(report.warnings.at(0), "law wind raised: no wind today; its 2 bonds are switched off");
  EXPECT_EQ(report.step, 1u);
}

TEST(Law, parameters_change_while_it_runs) {
  System system{SystemOptions{.gravity = {}}};
  const ParticleId p = system.particles().create(system.bodies().create(), {0, 0, 0});
  const ParticleId q = system.particles().create(system.bodies().create(), {1.5, 0, 0}, 2);
  system.particles().nail(p);
  const LawId law = system.laws().create("energy = 0.5*k*(r - r0)^2; force = -c*v",
                                         {"", {{"k", 100}, {"r0", std::nan("")}, {"c", 5}}});
  const BondId bond = system.bonds().create(p, q, SharedLaw{law});
  EXPECT_EQ(system.bonds().parameters(bond).at(1).value, 1.5) << "NaN: the distance at creation";
  (void)system.step(0.01);
  EXPECT_EQ(system.particles().position(q).x, 1.5);
  const double before = system.energy().edits;
  system.bonds().set_parameter(bond, "r0", 1);
  EXPECT_NEAR(system.energy().edits - before, 12.5, 1e-12);
  for (int i = 0; i < 2000; ++i) (void)system.step(0.01);
  EXPECT_NEAR(system.particles().position(q).x, 1, 1e-6);
  EXPECT_THROW(system.bonds().set_parameter(bond, "kk", 1), std::invalid_argument);
  EXPECT_THROW(system.bonds().set_parameter(bond, "k", std::nan("")), std::invalid_argument);
}

TEST(Law, is_saved_recorded_and_replayed) {
  System system;
  const auto chain = scenes::make_chain(system, {.links = 4});
  const ParticleId p = system.particles().create(system.bodies().create(), {0.3, 0.2, 0}, 0.5);
  system.record().start();
  const LawId law =
      system.laws().create("s = r - r0; energy = 0.5*k*s^2 + 0.1*cos(3*r)", {"mine", {{"k", 100}, {"r0", 0.1}}});
  const BondId bond = system.bonds().create(chain.lower[3], p, SharedLaw{law, {{"k", 250}}});
  for (int i = 0; i < 20; ++i) (void)system.step(0.01);
  system.bonds().set_parameter(bond, "r0", 0.3);
  for (int i = 0; i < 20; ++i) (void)system.step(0.01);
  const Recording recording = system.record().stop();
  const std::uint64_t hash = system.state_hash();

  System other;
  EXPECT_EQ(other.record().replay(recording), std::nullopt);
  EXPECT_EQ(other.state_hash(), hash);
  System third;
  third.restore(system.snapshot());
  (void)third.step(0.01), (void)system.step(0.01);
  EXPECT_EQ(third.state_hash(), system.state_hash());
  EXPECT_EQ(third.laws().name(law), "mine");
  EXPECT_EQ(third.bonds().parameters(bond).at(0).value, 250);
}

TEST(Law, bad_ones_are_refused_before_anything_changes) {
  System system;
  const ParticleId p = system.particles().create(system.bodies().create(), {0, 0, 0});
  const ParticleId q = system.particles().create(system.bodies().create(), {1, 0, 0});
  const std::uint64_t hash = system.state_hash();
  const auto refuses = [](auto call, const std::string& words) {
    try {
      call();
      ADD_FAILURE() << "not refused: " << words;
    } catch (const std::invalid_argument& error) {
      EXPECT_NE(std::string(error.what()).find(words), std::string::npos) << error.what();
    }
  };
  refuses([&] { system.laws().create("energy = 0.5*k*(r - r0)^2", {"", {{"k", 1}}}); }, "unknown name 'r0'");
  refuses([&] { system.laws().create("energy = k", {"", {{"r", 1}}}); }, "it is a variable");
  refuses([&] { system.laws().create("energy = k", {"", {{"k", 1}, {"k", 2}}}); }, "given twice");
  refuses([&] { system.laws().create("energy = 1", {"", {{"a b", 1}}}); }, "cannot be a parameter's name");
  refuses([&] { system.laws().create("energy = k", {"", {{"k", INFINITY}}}); }, "must be finite");
  refuses([&] { system.laws().create(std::string(2000, 'r')); }, "shorter than 1000");
  refuses([&] { system.laws().create(RadialFunction{}); }, "needs a function");
  refuses([&] { system.laws().find("lenard_jones"); }, "did you mean 'lennard_jones'");
  const LawId morse = system.laws().find("morse");
  refuses([&] { system.bonds().create(p, q, SharedLaw{morse, {{"stiffness", 1}}}); }, "has no parameter 'stiffness'");
  refuses([&] { system.bonds().create(p, q, SharedLaw{morse, {{"width", -1}}}); }, "width must be positive");
  refuses([&] { system.bonds().create(p, q, SharedLaw{system.laws().find("spring"), {{"stiffness", -1}}}); },
          "zero or more");
  refuses([&] { system.laws().destroy(morse); }, "predefined");
  EXPECT_EQ(system.state_hash(), hash);

  const LawId code = system.laws().create(&compiled_spring, {"code", {{"k", 1}, {"r0", 1}}});
  refuses([&] { system.bonds().create(p, q, SharedLaw{code, {}, true}); }, "cannot be implicit");
  const BondId bond = system.bonds().create(p, q, SharedLaw{code});
  refuses([&] { system.laws().destroy(code); }, "1 bond or pairwise force has it");
  system.bonds().destroy(bond);
  system.laws().destroy(code);
  EXPECT_THROW(system.bonds().create(p, q, SharedLaw{code}), StaleIdError);
}

TEST(Bonds, report_their_force_in_every_form_of_writing) {
  const std::vector<LawParameter> parameters{{"k", 20}, {"r0", 0.5}};
  const double weight = 0.3 * 9.81;
  for (const int way : {0, 1, 2, 3, 4}) {
    System system(SystemOptions{.mode = IntegrationMode::robust, .damping = 2});
    const ParticleId p = system.particles().create(system.bodies().create(), {0, 0, 0}, 1);
    const ParticleId q = system.particles().create(system.bodies().create(), {0, -0.5 - weight / 20, 0}, 0.3);
    system.particles().nail(p);
    const BondLaw laws[] = {SpringLaw{20, 0.1, 0.5},
                            SharedLaw{system.laws().create("energy = 0.5*k*(r - r0)^2; drag = 0.1", {"", parameters})},
                            SharedLaw{system.laws().create(&compiled_spring, {"", parameters})},
                            SharedLaw{system.laws().create(batch_spring(), {"", parameters})},
                            ScriptedLaw{[](const BondState& b) {
                              const Vec3 d = b.position_q - b.position_p;
                              return 20 * (norm(d) - 0.5) / norm(d) * d;
                            }}};
    const BondId bond = system.bonds().create(p, q, laws[way]);
    for (int i = 0; i < 240; ++i) (void)system.step(1.0 / 120);
    EXPECT_NEAR(system.bonds().force(bond).y, -weight, 1e-6) << way;
    EXPECT_NEAR(norm(system.bonds().force(bond)), norm(system.particles().nail_force(p)) - 9.81, 1e-6)
        << way;  // and the weight of p
    system.bonds().set_active(bond, false);
    EXPECT_EQ(norm(system.bonds().force(bond)), 0);
  }
}

TEST(Bonds, break_beyond_their_force_and_are_mended) {
  System system(SystemOptions{.mode = IntegrationMode::robust, .damping = 2});
  const ParticleId p = system.particles().create(system.bodies().create(), {0, 0, 0}, 1);
  const ParticleId q = system.particles().create(system.bodies().create(), {0, -0.6, 0}, 0.3);
  system.particles().nail(p);
  const double weight = 0.3 * 9.81;
  const BondId bond = system.bonds().create(p, q, SpringLaw{weight / 0.1, 0, 0.5});
  system.bonds().set_break_force(bond, 1.5 * weight);
  for (int i = 0; i < 60; ++i) EXPECT_TRUE(system.step(1.0 / 120).broken.empty());
  const auto ticket = system.snapshot();
  for (const bool again : {false, true}) {  // limits are part of a snapshot
    if (again) system.restore(ticket);
    system.particles().apply_force(q, {0, -40 * weight, 0});
    int steps = 0;
    StepReport report = system.step(1.0 / 120);
    for (; report.broken.empty() && steps < 100; ++steps) report = system.step(1.0 / 120);
    ASSERT_EQ(report.broken.size(), 1u);
    EXPECT_EQ(report.broken[0].bond, bond);
    EXPECT_FALSE(report.broken[0].constraint);
    EXPECT_GT(report.broken[0].force, 1.5 * weight);
    EXPECT_TRUE(system.bonds().is_broken(bond));
    EXPECT_FALSE(system.bonds().is_active(bond));
    EXPECT_TRUE(system.validate().empty());
  }
  system.bonds().set_active(bond, true);
  EXPECT_FALSE(system.bonds().is_broken(bond));
  EXPECT_THROW(system.bonds().set_break_force(bond, -1), std::invalid_argument);
  EXPECT_THROW(system.bonds().set_break_force(bond, std::nan("")), std::invalid_argument);
}

TEST(Law, without_an_energy_pushes_as_much_in_every_mode) {
  for (const auto mode : {IntegrationMode::plausible, IntegrationMode::robust, IntegrationMode::energy_keeping,
                          IntegrationMode::accurate}) {
    System system({.gravity = {}, .mode = mode});
    const ParticleId a = system.particles().create(system.bodies().create(), {0, 0, 0});
    const ParticleId b = system.particles().create(system.bodies().create(), {1, 0, 0});
    system.particles().nail(a);
    system.bonds().create(a, b, SharedLaw{system.laws().create(std::string("force = 2"))});
    for (int i = 0; i < 60; ++i) (void)system.step(1.0 / 60);
    EXPECT_NEAR(system.particles().velocity(b).x, 2, 1e-9) << "1 kg, 1 s";
    EXPECT_NEAR(system.energy().external_work, 2, 0.05);
  }
}

}  // namespace
}  // namespace iota
