// SPDX-License-Identifier: Apache-2.0
// Any number of threads gives the same bits, through edits of all kinds.
#include "scenes/chain.h"
#include "scenes/ragdoll.h"

#include <gtest/gtest.h>

#include <random>
#include <vector>

namespace iota {
namespace {

/// Many articulates of many sizes that are cut, joined, nailed, bonded and destroyed at random as they fall.
std::vector<std::uint64_t> hashes_of_a_busy_world(int threads, IntegrationMode mode) {
  System system({.mode = mode, .damping = 0.2, .threads = threads});
  std::mt19937_64 random(7);
  const auto index = [&](std::size_t n) { return static_cast<std::size_t>(random() % n); };
  for (int i = 0; i < 12; ++i) (void)scenes::make_ragdoll(system, {1.0 * i, 0, 0});
  for (int i = 0; i < 12; ++i)
    (void)scenes::make_chain(system, {.links = 4 + 5 * i, .rods = i % 2 == 0, .top = {0, 2.0 + i, 1}});
  std::vector<std::uint64_t> hashes;
  for (int step = 0; step < 12; ++step) {
    for (int edit = 0; edit < 6; ++edit) {
      const std::vector<ParticleId> particles = system.particles().ids();
      const ParticleId p = particles[index(particles.size())], q = particles[index(particles.size())];
      try {
        switch (index(8)) {
          case 0: (void)system.edits().combine(p, q, 0.1); break;
          case 1: (void)system.bonds().create(p, q, SpringLaw{.stiffness = 50}); break;
          case 2: (void)system.edits().combine(system.particles().body(p), system.particles().body(q)); break;
          case 3: system.particles().destroy(p); break;
          case 4:
            if (edit == 0) system.particles().nail(p);
            break;
          default: {
            const std::vector<ParticleId> ring = system.particles().ring(p);
            (void)system.edits().separate(p, ring[index(ring.size())]);
          }
        }
      } catch (const std::invalid_argument&) {  // what cannot be, cannot be for any number of threads
      }
    }
    (void)system.step(1.0 / 60);
    hashes.push_back(system.state_hash());
  }
  EXPECT_EQ(system.validate(), std::vector<std::string>{});
  return hashes;
}

TEST(Threads, of_any_number_give_the_same_bits_after_any_edits) {
  for (const IntegrationMode mode : {IntegrationMode::robust, IntegrationMode::energy_keeping}) {
    const std::vector<std::uint64_t> one = hashes_of_a_busy_world(1, mode);
    EXPECT_EQ(hashes_of_a_busy_world(2, mode), one);
    EXPECT_EQ(hashes_of_a_busy_world(4, mode), one);
  }
}

TEST(Threads, number_is_checked_and_readable) {
  EXPECT_THROW(System({.threads = -1}), std::invalid_argument);
  System system({.threads = 3});
  EXPECT_EQ(system.threads(), 3);
  system.set_threads(0);
  EXPECT_GE(system.threads(), 1);
}

}  // namespace
}  // namespace iota
