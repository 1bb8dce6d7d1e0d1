// SPDX-License-Identifier: Apache-2.0
// A step that is tried, and stored only when it is committed.
#include "island/island.h"

#include "edit/nails.h"
#include "edit/separate.h"
#include "scenes/chain.h"
#include "scenes/net.h"
#include "system/core.h"
#include "tests/cpp/modes.h"

#include <gtest/gtest.h>

#include <cstddef>
#include <functional>
#include <memory>
#include <vector>

namespace iota::island {
namespace {

constexpr double dt = 1.0 / 60;

struct Scene {
  const char* name;
  int steps;
  std::function<void(System&)> build;
  std::function<void(Core&, int)> edit = [](Core&, int) {};  ///< before a step
  int tries = 1;  ///< 2: the first one of a step has the factors of the last step
};

/// A pendulum whose joint has a stop, a motor and friction, on a rope that becomes taut; a grip pulls, a rod spins.
void build_rows(System& system) {
  system.set_damping(0.2);
  const BodyId block = system.bodies().create(Box{{0.2, 0.3, 0.4}}, {.position = {3, 0, 0}});
  const ConstraintId joint =
      system.joints().create(JointSpec{.a = block, .at = {3, 0.5, 0}, .angle = {-0.2, 0.3, 1, 5, 0.5, 3, 0.1, 0.2}});
  (void)joint;
  const auto chain = scenes::make_chain(system, {.links = 5, .rods = true});
  const ParticleId hook = system.particles().create(system.bodies().create(), {0, 0.2, 0});
  system.particles().nail(hook);
  system.joints().create(DistanceSpec{.kind = ConstraintKind::rope, .p = hook, .q = chain.lower[4], .length = 0.6});
  system.bodies().set_angular_velocity(chain.links[4], {0, -30, 2});
  (void)system.grips().create(chain.links[2], {}, {0.3, 0.1, 0.1});
}

/// Two nails too far apart for the chain between them, and two particles that are closing.
void build_conflict(System& system) {
  const auto chain = scenes::make_chain(system, {.links = 6});
  system.particles().nail(chain.lower.back(), {0.9, 0, 0});
  const auto a = scenes::make_chain(system, {.links = 3, .top = {0, 2, 0}});
  const auto b = scenes::make_chain(system, {.links = 3, .top = {0, 1.8, 0}});
  (void)system.edits().combine(a.lower.back(), b.lower.back(), 0.2);
}

void build_sleepers(System& system) {
  system.set_damping(6);
  system.set_rest({.after = 0.05, .speed = 0.3});
  const auto chain = scenes::make_chain(system, {.links = 4, .direction = {0.6, -0.8, 0}});
  (void)scenes::make_chain(system, {.links = 4, .top = {3, 0, 0}});
}

/// Long enough to follow an edit in place: a cut in the middle leaves both halves in one problem.
void build_chain(System& system) { (void)scenes::make_chain(system, {.links = 80, .direction = {0.6, -0.8, 0}}); }
void cut_chain(Core& core, int step) {
  if (step != 4) return;
  std::vector<ParticleId> ring;
  core.model.rings.for_each([&](std::uint32_t, const model::Ring& r) {
    if (r.count != 2 || !ring.empty() || norm(r.position) < 4) return;
    const std::uint32_t next = core.model.particles[r.first].next_in_ring;
    ring = {core.model.particles.id(r.first), core.model.particles.id(next)};
  });
  ASSERT_FALSE(ring.empty());
  (void)core.execute(edit::Separate{ring[0], ring[1]});
}

/// Is nailed in the middle, and so may be in pieces until a step has looked.
void nail_chain(Core& core, int step) {
  if (step != 4) return;
  std::uint32_t middle = model::none;
  core.model.rings.for_each([&](std::uint32_t, const model::Ring& r) {
    if (r.count == 2 && norm(r.position) > 4 && middle == model::none) middle = r.first;
  });
  ASSERT_NE(middle, model::none);
  core.execute(edit::Nail{.particle = core.model.particles.id(middle), .in_place = true});
}

const Scene tried_scenes[] = {
    {"rows", 30, build_rows},
    {"conflict", 8, build_conflict},
    {"sleepers", 30, build_sleepers},
    {"cut", 8, build_chain, cut_chain},
    {"nailed", 8, build_chain, nail_chain},
    {.name = "net",
     .steps = 4,
     .build = [](System& system) { (void)scenes::make_net(system, {.side = 8}); },
     .tries = 2},
};

std::vector<std::byte> bytes_of(Core& core) {
  std::vector<std::byte> bytes;
  Writer writer(bytes);
  core.model.archive(writer);
  return bytes;
}

/// A system whose islands are stepped one by one, each with a number of tries.
struct Stepped {
  Core core;
  int tries;

  Stepped(const Snapshot& snapshot, int tries) : tries(tries) { core.editor.restore(snapshot); }
  void step() {
    (void)core.islands.update(core.model, core.parallel);
    const auto awake = core.islands.awake(core.model);
    const std::vector<std::byte> before = bytes_of(core);
    for (Island* const island : awake)
      for (int i = 0; i < tries; ++i) island->try_step(core.model, dt);
    EXPECT_EQ(bytes_of(core), before) << "a try changes the problem alone";
    for (Island* const island : awake) reports.push_back(island->commit(core.model, dt));
    ingredient::end_step(core.model, dt);
    core.model.time += dt, core.model.last_dt = dt, ++core.model.step;
  }
  std::vector<solver::AdvanceReport> reports;
};

TEST(Island, that_tries_a_step_again_gives_the_same_bits_as_one_that_tries_once) {
  for (const IntegrationMode mode : all_modes)
    for (const Scene& scene : tried_scenes) {
      SCOPED_TRACE(std::string(scene.name) + " in mode " + std::to_string(static_cast<int>(mode)));
      System system({.mode = mode});
      scene.build(system);
      const Snapshot start = system.snapshot();
      const auto once = std::make_unique<Stepped>(start, scene.tries),
                 again = std::make_unique<Stepped>(start, scene.tries + 1);
      for (int i = 0; i < scene.steps; ++i) {
        for (Stepped* const s : {once.get(), again.get()}) scene.edit(s->core, i), s->step();
        ASSERT_EQ(bytes_of(once->core), bytes_of(again->core)) << "step " << i;
      }
      ASSERT_EQ(once->reports.size(), again->reports.size());
      ASSERT_FALSE(once->reports.empty());
      for (std::size_t i = 0; i < once->reports.size(); ++i) {
        EXPECT_EQ(once->reports[i].iterations, again->reports[i].iterations);
        EXPECT_EQ(once->reports[i].dissipated, again->reports[i].dissipated);
        EXPECT_EQ(once->reports[i].lost, again->reports[i].lost);
      }
    }
}

TEST(Island, stores_nothing_without_a_try_and_a_try_only_once) {
  System system;
  (void)scenes::make_chain(system, {.links = 3});
  Stepped stepped(system.snapshot(), 1);
  stepped.step();
  Core& core = stepped.core;
  const std::vector<std::byte> after = bytes_of(core);
  for (Island* const island : core.islands.awake(core.model)) (void)island->commit(core.model, dt);
  EXPECT_EQ(bytes_of(core), after);
}

TEST(Island, that_tried_another_length_of_step_before_is_not_changed_by_that) {
  System system({.mode = IntegrationMode::energy_keeping});
  (void)scenes::make_chain(system, {.links = 12});
  Stepped once(system.snapshot(), 1), other(system.snapshot(), 1);
  for (int i = 0; i < 20; ++i) {
    once.step();
    (void)other.core.islands.update(other.core.model, other.core.parallel);
    for (Island* const island : other.core.islands.awake(other.core.model)) island->try_step(other.core.model, 5 * dt);
    other.step();
    ASSERT_EQ(bytes_of(once.core), bytes_of(other.core)) << "step " << i;
  }
}

}  // namespace
}  // namespace iota::island
