// SPDX-License-Identifier: Apache-2.0
// Random edits against brute force, and bits against bits.
#include "scenes/chain.h"
#include "tests/cpp/amount.h"

#include <gtest/gtest.h>

#include <cstring>
#include <random>

namespace iota {
namespace {

/// Random bodies of one to five particles, bonds, nails.
struct RandomWorld {
  std::mt19937_64 random;
  System system;
  double uniform(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random); }
  std::size_t index(std::size_t n) { return std::uniform_int_distribution<std::size_t>(0, n - 1)(random); }
  Vec3 point() { return {uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)}; }

  explicit RandomWorld(std::uint64_t seed, int bodies) : random(seed), system(SystemOptions{.damping = 0.1}) {
    for (int i = 0; i < bodies; ++i) add_body();
  }
  void add_body() {
    const BodyId body = system.bodies().create();
    const std::size_t count = 1 + index(5);
    for (std::size_t i = 0; i < count; ++i)
      system.particles().create(body, point(), std::pow(10, uniform(-2, 2)), point());
  }
  ParticleId any_particle() {
    const auto all = system.particles().ids();
    return all[index(all.size())];
  }

  void edit() {
    const auto total_mass = [&] {
      double sum = 0;
      for (const ParticleId p : system.particles().ids()) sum += system.particles().mass(p);
      return sum;
    };
    const ParticleId p = any_particle(), q = any_particle();
    const double mass = total_mass();
    RestructureReport report;
    try {
      switch (index(10)) {
        case 0:
        case 1:
        case 2: report = system.edits().combine(p, q); break;
        case 3:
        case 4:
        case 5: {
          const auto ring = system.particles().ring(p);
          report = system.edits().separate(p, ring[index(ring.size())]);
          break;
        }
        case 6: report = system.edits().separate(p, q); break;
        case 7: report = system.edits().combine(system.particles().body(p), system.particles().body(q)); break;
        case 8:
          if (system.particles().is_nailed(p))
            system.particles().release(p);
          else if (index(8) == 0)
            system.particles().nail(p);
          break;
        default: report = system.edits().combine(p, q, 0.05); break;
      }
    } catch (const std::invalid_argument&) {
      return;  // two particles of one body in one place, or already closing: refused, checked below by validate
    }
    ASSERT_NEAR(total_mass(), mass, 1e-9 * mass) << "edits keep mass";
    bool nailed = false;
    for (const ParticleId any : system.particles().ids()) nailed = nailed || system.particles().is_nailed(any);
    if (!nailed) {
      const double scale = 1e-9 + mass;  // positions and velocities are of order one
      ASSERT_LT(norm(report.momentum_change), 1e-10 * scale);
      if (report.remaining_gap == 0 && report.notes.empty()) {
        ASSERT_LT(norm(report.angular_momentum_change), 1e-8 * scale);
      }
    }
  }
};

TEST(RandomEdits, keep_the_structure_whole_and_finite) {
  for (std::uint64_t seed = 1; seed <= sampled(std::uint64_t{100}); ++seed) {
    RandomWorld world(seed, 12);
    for (int i = 0; i < 200; ++i) {
      world.edit();
      if (HasFatalFailure()) return;
      ASSERT_EQ(world.system.validate(), std::vector<std::string>{}) << "seed " << seed << " edit " << i;
      if (i % 8 == 0) {
        const Energy before = world.system.energy();
        const StepReport report = world.system.step(1.0 / 60);
        ASSERT_TRUE(std::isfinite(report.energy.total())) << "seed " << seed << " edit " << i;
        // Conflicts, closings and cuts of all kinds, and yet no step may make up energy on a grand scale.
        ASSERT_LT(report.energy.total(), before.total() + 20 * before.kinetic + 1e4)
            << "seed " << seed << " edit " << i;
      }
      if (world.system.bodies().ids().size() < 6) world.add_body();
    }
  }
}

void drive(System& system, std::uint64_t seed, int steps, std::vector<std::uint64_t>& hashes) {
  scenes::make_chain(system, {.links = 12, .link_length = 0.1});
  std::mt19937_64 random(seed);
  const auto bodies = system.bodies().ids();
  for (int i = 0; i < steps; ++i) {
    const auto particles = system.particles().ids();
    const ParticleId p = particles[random() % particles.size()];
    const auto ring = system.particles().ring(p);
    if (i % 20 == 5) (void)system.edits().separate(ring.front(), ring.back());
    if (i % 20 == 15) {
      const ParticleId q = particles[random() % particles.size()];
      try {
        (void)system.edits().combine(p, q, i % 40 < 20 ? 0 : 0.1);
      } catch (const std::invalid_argument&) {
      }
    }
    if (i == 30) (void)system.grips().create(bodies[5], {0.01, 0, 0}, {0.5, 0.5, 0.5});
    if (i == 10) system.particles().apply_force(p, {0, 3, 0});
    (void)system.step(1.0 / 120);
    hashes.push_back(system.state_hash());
  }
}

TEST(Determinism, repeated_runs_give_the_same_bits) {
  std::vector<std::uint64_t> first, second;
  System a, b;
  drive(a, 7, 200, first);
  drive(b, 7, 200, second);
  EXPECT_EQ(first, second);
  EXPECT_NE(first.front(), first.back());
}

TEST(Determinism, a_replay_gives_equal_hashes_and_a_changed_one_does_not) {
  System system;
  system.particles().create(system.bodies().create(), {3, 3, 3});
  system.record().start();
  std::vector<std::uint64_t> hashes;
  drive(system, 11, 200, hashes);
  Recording recording = system.record().stop();
  EXPECT_EQ(recording.hashes, hashes);
  const auto end = system.state_hash();
  EXPECT_EQ(system.record().replay(recording), std::nullopt);
  EXPECT_EQ(system.state_hash(), end);

  System other;  // another process would do the same
  EXPECT_EQ(other.record().replay(recording), std::nullopt);
  EXPECT_EQ(other.state_hash(), end);

  recording.hashes[50] ^= 1;
  EXPECT_EQ(other.record().replay(recording), 51u);
}

TEST(Determinism, a_recording_that_is_cut_short_is_refused_and_leaves_a_whole_system) {
  System system;
  system.record().start();
  std::vector<std::uint64_t> hashes;
  drive(system, 11, 40, hashes);
  const Recording recording = system.record().stop();
  for (const std::size_t missing : {std::size_t{1}, std::size_t{7}, recording.commands.size() / 2 + 3}) {
    Recording cut = recording;
    cut.commands.resize(recording.commands.size() - missing);
    System other;
    EXPECT_THROW((void)other.record().replay(cut), std::invalid_argument) << missing << " bytes are missing";
    EXPECT_EQ(other.validate(), std::vector<std::string>{});
  }
}

TEST(Determinism, a_restored_snapshot_goes_on_with_the_same_bits_and_the_same_ids) {
  System system;
  std::vector<std::uint64_t> hashes;
  drive(system, 13, 100, hashes);
  const Snapshot snapshot = system.snapshot();
  const ParticleId held = system.particles().ids()[3];
  const Vec3 position = system.particles().position(held);
  std::vector<std::uint64_t> first, second;
  for (int i = 0; i < 50; ++i) (void)system.step(1.0 / 120), first.push_back(system.state_hash());
  system.restore(snapshot);
  EXPECT_EQ(system.particles().position(held), position);
  for (int i = 0; i < 50; ++i) (void)system.step(1.0 / 120), second.push_back(system.state_hash());
  EXPECT_EQ(first, second);
}

TEST(Restore, refuses_damaged_bytes_and_changes_nothing) {
  System system;
  scenes::make_chain(system, {.links = 5});
  const Snapshot good = system.snapshot();
  const auto hash = system.state_hash();
  std::mt19937 random(1);
  for (int i = 0; i < 500; ++i) {
    Snapshot bad = good;
    if (i % 2)
      bad.bytes.resize(random() % bad.bytes.size());
    else
      bad.bytes[random() % bad.bytes.size()] ^= std::byte(1 + random() % 255);
    EXPECT_THROW(system.restore(bad), std::invalid_argument);
  }
  EXPECT_EQ(system.state_hash(), hash);
  EXPECT_NO_THROW(system.restore(good));
}

}  // namespace
}  // namespace iota
