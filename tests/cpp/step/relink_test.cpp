// SPDX-License-Identifier: Apache-2.0
// Large islands follow cuts and hinges in place; what comes out is what a new analysis gives.
#include "scenes/chain.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

namespace iota {
namespace {

/// A long chain that is cut and rejoined at random places, now and then to a piece that was elsewhere.
struct BusyChain {
  System system;
  scenes::Chain chain;
  std::mt19937 random{5};
  std::vector<std::size_t> cuts;  ///< hinges above these links are open

  explicit BusyChain(bool rods) : system({.mode = IntegrationMode::robust, .damping = 0.5}) {
    chain = scenes::make_chain(system, {.links = 500, .rods = rods, .direction = {0, -1, 0}});
    (void)system.step(1.0 / 240);
  }
  void edit() {
    if (cuts.size() < 3 && random() % 2) {
      const std::size_t link = 2 + random() % 497;
      if (system.ring(chain.upper[link]).size() < 2) return;
      (void)system.separate(chain.lower[link - 1], chain.upper[link]);
      cuts.push_back(link);
    } else if (!cuts.empty()) {
      const std::size_t which = random() % cuts.size();
      (void)system.combine(chain.lower[cuts[which] - 1], chain.upper[cuts[which]]);
      cuts.erase(cuts.begin() + static_cast<std::ptrdiff_t>(which));
    }
  }
};

TEST(Relinking, gives_what_a_new_analysis_gives) {
  for (const bool rods : {false, true}) {
    BusyChain followed(rods), renewed(rods);
    for (int step = 0; step < 60; ++step) {
      followed.edit(), renewed.edit();
      (void)renewed.system.snapshot();  // builds all islands anew
      (void)followed.system.step(1.0 / 240), (void)renewed.system.step(1.0 / 240);
      ASSERT_EQ(followed.system.validate(), std::vector<std::string>{});
      double farthest = 0;
      for (const ParticleId p : followed.chain.lower)
        farthest = std::max(farthest, norm(followed.system.position(p) - renewed.system.position(p)));
      ASSERT_LT(farthest, 1e-7) << "step " << step;
      ASSERT_LT(followed.system.worst_gap(), 1e-8) << "step " << step;
    }
  }
}

TEST(Relinking, replays_to_the_same_bits_from_a_snapshot_amid_the_cuts) {
  BusyChain world(true);
  for (int i = 0; i < 5; ++i) world.edit(), (void)world.system.step(1.0 / 240);
  world.system.start_recording();
  for (int i = 0; i < 30; ++i) world.edit(), (void)world.system.step(1.0 / 240);
  const Recording recording = world.system.stop_recording();
  System other;
  EXPECT_EQ(other.replay(recording), std::nullopt);
}

TEST(Relinking, ends_with_an_island_for_each_piece) {
  BusyChain world(true);
  (void)world.system.separate(world.chain.lower[249], world.chain.upper[250]);
  for (int i = 0; i < 130; ++i) (void)world.system.step(1.0 / 240);  // a fall of the free half is exact only by itself
  const Vec3 v = world.system.velocity(world.chain.lower[499]);
  EXPECT_LT(v.y, -1) << "the cut-off half falls";
  EXPECT_EQ(world.system.articulate_count(), 2u);
}

}  // namespace
}  // namespace iota
