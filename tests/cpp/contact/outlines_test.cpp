// SPDX-License-Identifier: Apache-2.0
// Outlines that follow a structure through steps and edits, against those that are described anew.
#include "contact/outlines.h"

#include "system/core.h"
#include "tests/cpp/allocations.h"

#include <gtest/gtest.h>

#include <random>

namespace iota::contact {
namespace {

/// All of a tree, in words.
std::string text(const OutlineTree& tree) {
  std::string out;
  const auto add = [&](const Vec3& v) {
    for (const double x : {v.x, v.y, v.z}) out += " " + std::to_string(x);
  };
  for (std::uint32_t body = 0; body < tree.count(); ++body) {
    if (!tree.has(body)) continue;
    out += std::to_string(body) + ":";
    for (const Solid& solid : tree[body].solids)
      out += " solid", add(solid.position), out += std::to_string(solid.turn.w);
    for (const Line& line : tree[body].lines) out += " line " + std::to_string(line.radius), add(line.a), add(line.b);
    out += "\n";
  }
  return out;
}

struct Scene {
  Core core;
  std::mt19937 random{5};
  double number() { return std::uniform_real_distribution<double>(-1, 1)(random); }
  Vec3 place() { return {number(), number(), number()}; }
  template <class List>
  auto any(const List& list) {
    return list[random() % list.size()];
  }

  void edit() {
    Bodies bodies(core);
    Particles particles(core);
    const std::vector<BodyId> all = bodies.ids();
    if (all.size() < 10) {
      if (random() % 2) return void(bodies.create(Box{{0.3, 0.2, 0.1}}, {.position = 3 * place()}));
      const BodyId body = bodies.create();
      for (int i = 0; i < 1 + static_cast<int>(random() % 3); ++i) (void)particles.create(body, 3 * place());
      return;
    }
    const BodyId body = any(all);
    switch (random() % 13) {
      case 0: return bodies.destroy(body);
      case 1: return bodies.set_kind(body, any(std::array{BodyKind::static_, BodyKind::dynamic, BodyKind::inactive}));
      case 2: return bodies.set_pose(body, place(), {0, 0, 0, 1});
      case 3: return bodies.set_radius(body, 0.1 + 0.05 * number());
      case 4: return void(Edits(core).combine(body, any(all)));
      case 5: return void(particles.create(body, place()));
      case 6: return particles.set_attributes(bodies.particles(body).at(0), {.radius = 0.1 + 0.05 * number()});
      case 7: return particles.set_position(bodies.particles(body).at(0), place());
      case 8: {
        const std::vector<ParticleId> own = bodies.particles(body);
        return void(CosmeticBonds(core).create(any(own), any(own)));
      }
      case 9:
      case 10: return bodies.set_stride(body, any(std::array{0, 0, 1, 5}));
      case 11: {  // not with a static one: where both can't meet, a step moves its points back
        const BodyId other = any(all);
        if (bodies.kind(body) == BodyKind::static_ || bodies.kind(other) == BodyKind::static_) return;
        return void(Edits(core).combine(any(bodies.particles(body)), any(bodies.particles(other))));
      }
      default: return void(Edits(core).separate(any(bodies.particles(body)), any(bodies.particles(body))));
    }
  }
};

/// The bodies that are listed as movable and fixed, and those that are so.
void expect_right_lists(const Outlines& outlines, const model::Model& model) {
  std::vector<std::uint32_t> movable, fixed;
  model.bodies.for_each([&](std::uint32_t body, const model::Body& record) {
    if (!outlines.has(body) || model.is_frozen(body)) return;
    (record.kind == BodyKind::static_ ? fixed : movable).push_back(body);
  });
  EXPECT_EQ(outlines.movable(), movable);
  EXPECT_EQ(outlines.fixed(), fixed);
}

TEST(Outlines, that_have_followed_edits_and_steps_are_those_described_anew) {
  Scene scene;
  Core& core = scene.core;
  core.model.gravity = {};
  core.model.rest_after = 0.05;
  Snapshot start = core.editor.snapshot();
  Emitters emitters(core);
  (void)emitters.create({.rate = 300, .lifetime = 0.2, .mass = 0.1});
  int refused = 0;
  for (int round = 0; round < 600; ++round) {
    for (int i = round % 4; i > 0; --i) {
      try {
        scene.edit();
      } catch (const std::exception&) {
        ++refused;
      }
    }
    if (round % 3) (void)core.execute(edit::Step{0.01});
    if (round == 200) core.editor.restore(start);
    if (round == 300) core.execute(edit::SetUsualRadius{0.07});
    const std::string followed = text(core.outlines.refresh(core.model.step));
    expect_right_lists(core.outlines, core.model);
    // Another reader describes everything; the first one goes on from its own state.
    core.model.changed_outlines.is_on = false;
    Outlines fresh(core.model);
    ASSERT_EQ(followed, text(fresh.refresh(core.model.step))) << "round " << round;
    for (const BodyId body : Bodies(core).ids())
      ASSERT_EQ(core.outlines.reach(body.slot), fresh.reach(body.slot)) << "round " << round << " body " << body.slot;
  }
  EXPECT_LT(refused, 300);
}

TEST(Outlines, follow_step_by_step_also_without_an_edit) {
  Scene scene;
  Core& core = scene.core;
  Bodies bodies(core);
  for (int i = 0; i < 40; ++i) {
    (void)bodies.create(Capsule{0.1, 0.3}, {.position = 3 * scene.place(), .velocity = scene.place()});
    const BodyId rod = bodies.create();
    for (int p = 0; p < 2; ++p) (void)Particles(core).create(rod, 3 * scene.place(), 1, 0.5 * scene.place());
  }
  for (int step = 0; step < 60; ++step) {
    (void)core.execute(edit::Step{0.02});
    const OutlineTree& tree = core.outlines.refresh(core.model.step);
    for (std::uint32_t body = 0; body < tree.count(); ++body)
      for (const Line& line : tree[body].lines) ASSERT_EQ(line.a, core.model.position(line.p));
  }
}

TEST(Outlines, a_warm_look_at_all_of_them_allocates_nothing) {
  Scene scene;
  Core& core = scene.core;
  Bodies bodies(core);
  for (int i = 0; i < 100; ++i) {
    (void)bodies.create(Capsule{0.1, 0.3}, {.position = 3 * scene.place(), .velocity = 0.1 * scene.place()});
    const BodyId rod = bodies.create();
    for (int p = 0; p < 2; ++p) (void)Particles(core).create(rod, 3 * scene.place());
  }
  (void)core.outlines.refresh(core.model.step);
  for (int step = 0; step < 30; ++step)
    (void)core.execute(edit::Step{0.01}), (void)core.outlines.refresh(core.model.step);
  long count = 0;
  for (int step = 0; step < 30; ++step) {
    (void)core.execute(edit::Step{0.01});
    const long before = allocations;
    (void)core.outlines.refresh(core.model.step);
    count += allocations - before;
  }
  EXPECT_EQ(count, 0);
}

TEST(Outlines, solids_of_the_same_mesh_share_its_triangles) {
  Scene scene;
  Bodies bodies(scene.core);
  const Mesh mesh = convex_hull(std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}});
  for (int i = 0; i < 3; ++i) (void)bodies.create(mesh);
  const OutlineTree& tree = scene.core.outlines.refresh(0);
  EXPECT_EQ(tree[0].solids[0].form, tree[2].solids[0].form);
}

}  // namespace
}  // namespace iota::contact
