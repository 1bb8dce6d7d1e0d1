// SPDX-License-Identifier: Apache-2.0
// Large islands follow edits in place; what comes out is what islands give that are built anew.
#include "scenes/chain.h"
#include "scenes/loose_bodies.h"
#include "tests/cpp/amount.h"

#include <gtest/gtest.h>

#include <algorithm>
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
      if (system.particles().ring(chain.upper[link]).size() < 2) return;
      (void)system.edits().separate(chain.lower[link - 1], chain.upper[link]);
      cuts.push_back(link);
    } else if (!cuts.empty()) {
      const std::size_t which = random() % cuts.size();
      (void)system.edits().combine(chain.lower[cuts[which] - 1], chain.upper[cuts[which]]);
      cuts.erase(cuts.begin() + static_cast<std::ptrdiff_t>(which));
    }
  }
};

/// A long chain with everything that an island may have in it: damped links, a rope, a spring, plates, a nail that comes
/// and goes, closings and hands.
struct MixedChain {
  System system;
  scenes::Chain chain;
  std::mt19937 random;
  std::vector<GripId> grips;
  std::vector<std::size_t> loops;  ///< these links' lower ends are on their way to those ten links further down

  MixedChain(unsigned seed, IntegrationMode mode) : system({.mode = mode}), random(seed) {
    constexpr int links = 300;
    const auto joint = [](int i) {
      return Vec3{0.07 * i, 0.07 * (i % 2), 0.03 * (i % 3)};
    };  // a straight one is singular
    for (int i = 0; i < links; ++i) {
      chain.links.push_back(system.bodies().create());
      chain.upper.push_back(system.particles().create(chain.links.back(), joint(i), 0.05));
      chain.lower.push_back(system.particles().create(chain.links.back(), joint(i + 1), 0.05));
      if (i % 40 == 20) {  // a plate, and a particle that it carries
        (void)system.particles().create(chain.links.back(), joint(i) + Vec3{0, 0, 0.05}, 0.02);
        (void)system.particles().create(chain.links.back(), joint(i + 1) + Vec3{0, 0, 0.05}, 0.02);
      } else {
        system.bodies().set_rod(chain.links.back(), 0.1, 0.005);
      }
      if (i % 7 == 0) system.bodies().set_damping(chain.links.back(), 0.3);
      if (i > 0) (void)system.edits().combine(chain.lower[i - 1], chain.upper[i]);
    }
    system.particles().nail(chain.upper[0]);
    const ParticleId hook = system.particles().create(system.bodies().create({.kind = BodyKind::static_}),
                                                      system.particles().position(chain.lower[299]) + Vec3{0, 0.2, 0});
    (void)system.joints().create(
        DistanceSpec{.kind = ConstraintKind::rope, .p = hook, .q = chain.lower[299], .length = 0.5});
    (void)system.bonds().create(chain.lower[100], chain.lower[140],
                                SpringLaw{.stiffness = 40, .damping = 0.5, .length = 3});
    (void)system.step(1.0 / 240);
  }
  enum Edit { cut, close, call_off, grab, let_go, damp, nail };

  void edit(std::vector<Edit> choice) {
    const std::size_t link = 2 + random() % 280;
    switch (choice[random() % choice.size()]) {
      case cut:
        if (system.particles().ring(chain.upper[link]).size() > 1)
          (void)system.edits().separate(chain.lower[link - 1], chain.upper[link]);
        return;
      case close:
        if (loops.size() > 2) return;
        (void)system.edits().combine(chain.lower[link], chain.lower[link + 10], 0.5);
        return loops.push_back(link);
      case call_off:
        if (loops.empty()) return;
        (void)system.edits().separate(chain.lower[loops.back()], chain.lower[loops.back() + 10]);
        return loops.pop_back();
      case grab:
        return grips.push_back(
            system.grips().create(chain.links[link], {}, system.particles().position(chain.upper[link])));
      case let_go:
        if (grips.empty()) return;
        system.grips().destroy(grips.front());
        grips.erase(grips.begin());
        return;
      case damp: return system.bodies().set_damping(chain.links[link], random() % 2 ? 0.5 : 0);
      case nail:
        system.particles().is_nailed(chain.upper[150]) ? system.particles().release(chain.upper[150])
                                                       : system.particles().nail(chain.upper[150]);
    }
  }
};

/// The largest distance between points of two chains.
template <class World>
double difference(const World& a, const World& b) {
  double farthest = 0;
  for (const ParticleId p : a.chain.lower)
    farthest = std::max(farthest, norm(a.system.particles().position(p) - b.system.particles().position(p)));
  return farthest;
}

TEST(FollowingIsland, gives_what_an_island_that_is_built_anew_gives) {
  for (const bool rods : {false, true}) {
    BusyChain followed(rods), renewed(rods);
    for (int step = 0; step < 60; ++step) {
      followed.edit(), renewed.edit();
      (void)renewed.system.snapshot();  // builds all islands anew
      (void)followed.system.step(1.0 / 240), (void)renewed.system.step(1.0 / 240);
      ASSERT_EQ(followed.system.validate(), std::vector<std::string>{});
      ASSERT_LT(difference(followed, renewed), 1e-7) << "step " << step;
      ASSERT_LT(followed.system.worst_gap(), 1e-8) << "step " << step;
    }
  }
}

// Cuts by themselves: whatever projects velocities does so for all that is in one problem, pieces that were cut off too.
TEST(FollowingIsland, gives_the_same_with_grips_closings_nails_joints_and_damping) {
  using enum MixedChain::Edit;
  const std::vector<MixedChain::Edit> choices[] = {{cut, grab, let_go, damp},
                                                   {close, call_off, grab, let_go, damp, nail}};
  for (unsigned seed = 1; seed <= sampled(60u); ++seed) {
    const auto mode = seed % 2 ? IntegrationMode::robust : IntegrationMode::energy_keeping;
    MixedChain followed(seed, mode), renewed(seed, mode);
    for (int step = 0; step < 30; ++step) {
      followed.edit(choices[seed % 3 == 0]), renewed.edit(choices[seed % 3 == 0]);
      (void)renewed.system.snapshot();  // builds all islands anew
      (void)followed.system.step(1.0 / 480), (void)renewed.system.step(1.0 / 480);
      ASSERT_EQ(followed.system.validate(), std::vector<std::string>{});
      ASSERT_LT(difference(followed, renewed), 1e-9) << "seed " << seed << " step " << step;
    }
  }
}

TEST(FollowingIsland, settles_a_rejoined_hinge_around_it_and_tells_what_that_changes) {
  for (const bool nailed : {false, true}) {
    System system{SystemOptions{.gravity = {}, .mode = IntegrationMode::robust}};
    std::vector<ParticleId> upper, lower;
    const auto joint = [](int i) { return Vec3{0.07 * i, 0.07 * (i % 2), 0.03 * (i % 3)}; };
    for (int i = 0; i < 2000; ++i) {
      const BodyId link = system.bodies().create();
      upper.push_back(system.particles().create(link, joint(i), 0.05));
      lower.push_back(system.particles().create(link, joint(i + 1), 0.05));
      system.bodies().set_rod(link, 0.1, 0.005);
      if (i > 0) (void)system.edits().combine(lower[static_cast<std::size_t>(i) - 1], upper.back());
    }
    if (nailed) system.particles().nail(upper.front());
    system.particles().set_velocity(lower[700], {0, 1, 2});
    (void)system.step(1.0 / 240);
    (void)system.edits().separate(lower[699], upper[700]);
    for (int i = 0; i < 3; ++i) (void)system.step(1.0 / 240);
    ASSERT_GT(norm(system.particles().position(lower[699]) - system.particles().position(upper[700])), 1e-6);

    const Energy energy = system.energy();
    const Vec3 momentum = system.momentum(), spin = system.angular_momentum();
    const Vec3 far = system.particles().position(lower[1900]);
    const RestructureReport report = system.edits().combine(lower[699], upper[700]);
    EXPECT_LT(system.worst_gap(), 1e-9);
    const Energy after = system.energy();
    EXPECT_NEAR(report.energy_change, after.kinetic + after.potential - energy.kinetic - energy.potential,
                1e-12 * energy.kinetic);
    EXPECT_LT(norm(report.momentum_change - (system.momentum() - momentum)), 1e-13);
    EXPECT_LT(norm(report.angular_momentum_change - (system.angular_momentum() - spin)), 1e-10);
    EXPECT_LT(norm(report.momentum_change), 1e-13);
    if (!nailed) {
      EXPECT_LT(norm(report.angular_momentum_change), 1e-10);
    }
    EXPECT_EQ(system.particles().position(lower[1900]), far);
  }
}

// The eight links between both places change to the articulate of the ten, whose island is small and waits for another.
TEST(FollowingIsland, of_a_cut_and_a_rejoined_piece_lets_all_points_beyond_the_cut_fall) {
  double fall[2];
  for (const bool renewed : {false, true}) {
    System system{SystemOptions{.gravity = {0, -1, 0}, .mode = IntegrationMode::robust}};
    const scenes::Chain chain = scenes::make_chain(system, {.links = 114, .direction = {0, 1, 0}});
    (void)system.edits().separate(chain.lower[103], chain.upper[104]);
    (void)system.step(0.01);
    (void)system.edits().separate(chain.lower[95], chain.upper[96]);
    (void)system.edits().combine(chain.lower[103], chain.upper[104]);
    if (renewed) (void)system.snapshot();
    (void)system.step(0.01);
    EXPECT_EQ(system.islands().size(), renewed ? 2u : 1u);
    fall[renewed] = system.particles().velocity(chain.upper[96]).y;
  }
  EXPECT_LT(fall[1], -0.01);
  EXPECT_NEAR(fall[0], fall[1], 1e-9);
}

TEST(FollowingIsland, keeps_a_rope_beside_a_cut) {
  const auto make = [](System& system, ConstraintId& rope) {
    auto chain = scenes::make_chain(system, {.links = 300});
    const ParticleId hook =
        system.particles().create(system.bodies().create({.kind = BodyKind::static_}), {30, 0.2, 0});
    rope = system.joints().create(
        DistanceSpec{.kind = ConstraintKind::rope, .p = hook, .q = chain.upper[299], .length = 0.5});
    for (int i = 0; i < 5; ++i) (void)system.step(1.0 / 120);
    (void)system.edits().separate(chain.lower[298], chain.upper[299]);
    return chain;
  };
  System followed{SystemOptions{.mode = IntegrationMode::robust}},
      renewed{SystemOptions{.mode = IntegrationMode::robust}};
  ConstraintId rope;
  const scenes::Chain chain = make(followed, rope);
  (void)make(renewed, rope);
  const ParticleId end = chain.upper[299];
  for (int i = 0; i < 100; ++i) {
    (void)renewed.snapshot();  // builds its islands anew; the other's follows the cut
    (void)followed.step(1.0 / 120), (void)renewed.step(1.0 / 120);
    ASSERT_LT(norm(followed.particles().position(end) - Vec3{30, 0.2, 0}), 0.5 + 1e-8) << "step " << i;
    ASSERT_LT(norm(followed.particles().position(end) - renewed.particles().position(end)), 1e-7) << "step " << i;
  }
  EXPECT_GT(norm(followed.joints().state(rope).force), 0);
}

TEST(FollowingIsland, replays_to_the_same_bits_from_a_snapshot_amid_the_cuts) {
  BusyChain world(true);
  for (int i = 0; i < 5; ++i) world.edit(), (void)world.system.step(1.0 / 240);
  world.system.record().start();
  for (int i = 0; i < 30; ++i) world.edit(), (void)world.system.step(1.0 / 240);
  const Recording recording = world.system.record().stop();
  System other;
  EXPECT_EQ(other.record().replay(recording), std::nullopt);
}

/// Boxes that are tied and parted: with few ropes in islands of some boxes, with many most of them in one.
struct BusyBoxes {
  System system{{.gravity = {}, .mode = IntegrationMode::robust}};
  scenes::LooseBodies boxes;
  std::size_t changes;
  BusyBoxes(std::size_t ropes, std::size_t changes) : boxes(system, 5, ropes), changes(changes) {}
  StepReport step() {
    boxes.change(changes);
    return system.step(1.0 / 120);
  }
};

TEST(FollowingIsland, of_loose_bodies_that_are_tied_and_parted_gives_what_islands_that_are_built_anew_give) {
  for (const std::size_t ropes : {60u, 160u}) {
    for (const std::size_t changes : {ropes / 10, std::size_t{2}}) {
      BusyBoxes followed(ropes, changes), renewed(ropes, changes);
      for (int step = 0; step < 60; ++step) {
        (void)renewed.system.snapshot();  // builds all islands anew
        const StepReport a = followed.step(), b = renewed.step();
        ASSERT_EQ(a.unconverged + b.unconverged, 0);
        ASSERT_EQ(followed.system.islands().size(), renewed.system.islands().size()) << "step " << step;
        ASSERT_EQ(followed.system.validate(), std::vector<std::string>{});
        for (std::size_t i = 0; i < followed.boxes.knots.size(); ++i)
          ASSERT_LT(norm(followed.system.particles().position(followed.boxes.knots[i]) -
                         renewed.system.particles().position(renewed.boxes.knots[i])),
                    1e-9)
              << ropes << " ropes, step " << step;
      }
    }
  }
}

TEST(FollowingIsland, of_loose_bodies_replays_to_the_same_bits_from_a_snapshot_amid_the_changes) {
  for (const std::size_t ropes : {60u, 160u}) {
    BusyBoxes world(ropes, 4);
    for (int i = 0; i < 10; ++i) (void)world.step();
    world.system.record().start();
    for (int i = 0; i < 20; ++i) (void)world.step();
    const Recording recording = world.system.record().stop();
    System other;
    EXPECT_EQ(other.record().replay(recording), std::nullopt);
  }
}

TEST(FollowingIsland, of_loose_bodies_replays_to_the_same_bits_if_snapshots_were_taken_meanwhile) {
  BusyBoxes world(160, 4);
  for (int i = 0; i < 10; ++i) (void)world.step();
  world.system.record().start();
  for (int i = 0; i < 20; ++i) {
    (void)world.step();
    if (i % 7 == 3) (void)world.system.snapshot();
    if (i % 7 == 5) world.system.edits().begin(), (void)world.system.snapshot(), (void)world.system.edits().end();
  }
  EXPECT_FALSE(world.system.edits().undo()) << "a snapshot is no edit";
  const Recording recording = world.system.record().stop();
  System other;
  EXPECT_EQ(other.record().replay(recording), std::nullopt);
}

/// Boxes and a nailed chain, among which ropes, springs, grips and cuts come and go. What happens next depends
/// on `now` alone, so that a restored system can go on in the same way.
struct RandomScene {
  System system;
  struct Now {
    std::vector<BodyId> boxes;
    std::vector<ParticleId> knots;  ///< of the boxes, then the upper ends of the links
    scenes::Chain chain;
    std::vector<ConstraintId> ropes;
    std::vector<BondId> springs;
    std::vector<GripId> grips;
    std::vector<std::size_t> cuts;
    std::mt19937 random;
  } now;

  explicit RandomScene(IntegrationMode mode) : system({.gravity = {0, -1, 0}, .mode = mode, .threads = 1}) {}
  void build(unsigned seed) {
    now.random.seed(seed);
    for (int i = 0; i < 27; ++i) {
      const Vec3 place{1.0 * (i % 3), 1.0 * (i / 3 % 3), 1.0 * (i / 9)};
      now.boxes.push_back(system.bodies().create(Box{{0.5, 0.5, 0.5}}, {.position = place,
                                                                        .velocity = {0.02 * (i % 4), 0.01 * (i % 5), 0},
                                                                        .spin = {0.1 * (i % 5), 0, 0.1 * (i % 3)},
                                                                        .attachments = {{0.25, 0.25, 0.25}}}));
      now.knots.push_back(system.bodies().attachments(now.boxes.back())[0]);
    }
    now.chain = scenes::make_chain(system, {.links = 60, .top = {-1.5, 3, 0}, .direction = {0, -0.8, 0.6}});
    now.knots.insert(now.knots.end(), now.chain.upper.begin(), now.chain.upper.end());
  }
  template <class T>
  T take_any(std::vector<T>& list) {
    std::swap(list[now.random() % list.size()], list.back());
    const T taken = list.back();
    list.pop_back();
    return taken;
  }
  void change() {
    const ParticleId p = now.knots[now.random() % now.knots.size()], q = now.knots[now.random() % now.knots.size()];
    const double apart = norm(system.particles().position(p) - system.particles().position(q));
    const std::size_t link = 1 + now.random() % 59, choice = now.random() % 12;
    // Ends of a straight chain are multiples of 0.1 m apart: round-off must not decide.
    const bool may_tie = system.particles().body(p) != system.particles().body(q) && apart > 0.15 && apart < 1.65;
    if (choice < 3 && may_tie)
      now.ropes.push_back(system.joints().create(
          DistanceSpec{.kind = ConstraintKind::rope, .p = p, .q = q, .length = (1 + 0.02 * (link % 3)) * apart}));
    else if (choice < 5 && !now.ropes.empty())
      system.joints().destroy(take_any(now.ropes));
    else if (choice == 5 && may_tie)
      now.springs.push_back(system.bonds().create(p, q, SpringLaw{.stiffness = 5, .damping = 0.1, .length = 1}));
    else if (choice == 6 && !now.springs.empty())
      system.bonds().destroy(take_any(now.springs));
    else if (choice == 7)
      now.grips.push_back(system.grips().create(now.boxes[link % 27], {}, system.particles().position(p)));
    else if (choice == 8 && !now.grips.empty())
      system.grips().destroy(take_any(now.grips));
    else if (choice == 9 && !now.ropes.empty())
      system.joints().set_active(now.ropes[link % now.ropes.size()], link % 2);
    else if (choice == 10 && now.cuts.size() < 3 && system.particles().ring(now.chain.upper[link]).size() > 1)
      (void)system.edits().separate(now.chain.lower[link - 1], now.chain.upper[link]), now.cuts.push_back(link);
    else if (choice == 11 && !now.cuts.empty())
      (void)system.edits().combine(now.chain.lower[now.cuts.back() - 1], now.chain.upper[now.cuts.back()]),
          now.cuts.pop_back();
  }
  void step() {
    for (std::size_t i = 1 + now.random() % 6; i > 0; --i) change();
    (void)system.step(1.0 / 240);
  }
};

TEST(FollowingIsland, of_random_scenes_continues_to_the_same_bits_from_a_snapshot_at_any_step) {
  for (unsigned seed = 1; seed <= sampled(60u); ++seed) {
    const auto mode = seed % 3 ? IntegrationMode::robust : IntegrationMode::energy_keeping;
    RandomScene scene(mode);
    scene.build(seed);
    std::mt19937 random(seed);
    for (int round = 0; round < 6; ++round) {
      for (std::size_t i = random() % 15; i > 0; --i) scene.step();
      RandomScene other(mode);
      other.system.restore(scene.system.snapshot());
      other.now = scene.now;
      for (int step = 0; step < 10; ++step) {
        scene.step(), other.step();
        ASSERT_EQ(scene.system.state_hash(), other.system.state_hash()) << "seed " << seed << " step " << step;
      }
      ASSERT_EQ(scene.system.validate(), std::vector<std::string>{}) << "seed " << seed;
    }
  }
}

TEST(FollowingIsland, of_random_scenes_gives_what_islands_that_are_built_anew_give) {
  for (unsigned seed = 1; seed <= sampled(60u); ++seed) {
    const auto mode = seed % 3 ? IntegrationMode::robust : IntegrationMode::energy_keeping;
    RandomScene followed(mode), renewed(mode);
    followed.build(seed), renewed.build(seed);
    for (int step = 0; step < 60; ++step) {
      (void)renewed.system.snapshot();  // builds all islands anew
      followed.step(), renewed.step();
      // A large part that was cut off has not left: what corrects velocities and energy still does so for both together.
      if (followed.system.islands().size() != renewed.system.islands().size()) break;
      for (const ParticleId p : followed.now.knots)
        ASSERT_LT(norm(followed.system.particles().position(p) - renewed.system.particles().position(p)), 1e-7)
            << "seed " << seed << " step " << step;
    }
  }
}

TEST(FollowingIsland, ends_with_an_island_for_each_piece) {
  BusyChain world(true);
  (void)world.system.edits().separate(world.chain.lower[249], world.chain.upper[250]);
  for (int i = 0; i < 130; ++i) (void)world.system.step(1.0 / 240);  // a fall of the free half is exact only by itself
  const Vec3 v = world.system.particles().velocity(world.chain.lower[499]);
  EXPECT_LT(v.y, -1) << "the cut-off half falls";
  EXPECT_EQ(world.system.bodies().articulate_count(), 2u);
}

}  // namespace
}  // namespace iota
