// SPDX-License-Identifier: Apache-2.0
// What a viewer is told step by step adds up to what there is.
#include <gtest/gtest.h>
#include <iota/scene.h>
#include <iota/system.h>

#include <map>
#include <random>
#include <string>

namespace iota {
namespace {

/// A viewer that keeps what it is told, as text. Places within bodies are left out: edits that contradict each other bend
/// bodies that they do not touch.
class Viewer {
 public:
  void take(const SceneChanges& changes) {
    if (changes.is_whole) bodies_.clear(), memberships_.clear(), ties_.clear(), nails_.clear();
    for (const DrawnBody& body : changes.bodies.set) bodies_[body.id.slot] = text(body);
    for (const Membership& m : changes.memberships) memberships_[m.body] = std::to_string(m.articulate);
    for (const DrawnTie& tie : changes.ties.set)
      ties_[tie.slot] = std::to_string(static_cast<int>(tie.kind)) + text(tie.length) + text(tie.a) + text(tie.b);
    for (const DrawnNail& nail : changes.nails.set) nails_[nail.slot] = text(nail.at);
    for (const std::uint32_t slot : changes.bodies.gone) bodies_.erase(slot), memberships_.erase(slot);
    for (const std::uint32_t slot : changes.ties.gone) ties_.erase(slot);
    for (const std::uint32_t slot : changes.nails.gone) nails_.erase(slot);
  }
  bool operator==(const Viewer&) const = default;
  std::size_t bodies() const { return bodies_.size(); }

  /// Where the two differ, for a failure.
  std::string difference(const Viewer& other) const {
    std::string out;
    const auto compare = [&](const char* what, const Things& mine, const Things& theirs) {
      for (const auto& [slot, thing] : mine)
        if (const auto found = theirs.find(slot); found == theirs.end() || found->second != thing)
          out += what + (" " + std::to_string(slot)) + ": " + thing + " instead of " +
                 (found == theirs.end() ? "nothing" : found->second) + "\n";
    };
    for (const auto& [what, things] : {std::pair{"body", &Viewer::bodies_},
                                       {"membership", &Viewer::memberships_},
                                       {"tie", &Viewer::ties_},
                                       {"nail", &Viewer::nails_}}) {
      compare(what, this->*things, other.*things);
      compare(what, other.*things, this->*things);
    }
    return out;
  }

 private:
  using Things = std::map<std::uint32_t, std::string>;
  static std::string text(double value) { return " " + std::to_string(std::lround(value * 1e4)); }
  static std::string text(const Anchor& at) {
    return " @" + std::to_string(at.body.slot) + "." + std::to_string(at.body.generation);
  }
  static std::string text(const DrawnBody& body) {
    return std::to_string(body.id.generation) + " " + std::to_string(static_cast<int>(body.kind)) + " " +
           std::to_string(body.particles) + " " + std::to_string(body.solids.size()) + " " +
           std::to_string(body.lines.size());
  }

  Things bodies_, memberships_, ties_, nails_;
};

/// Edits at random; what an edit refuses is left out.
class Editor {
 public:
  explicit Editor(std::uint32_t seed) : random_(seed) {}

  void edit(System& system) {
    try {
      apply(system, random_() % 16);
    } catch (const std::invalid_argument&) {
    }
  }

 private:
  template <class Ids>
  auto any(const Ids& ids) {
    return ids[random_() % ids.size()];
  }
  Vec3 place() {
    std::uniform_real_distribution<double> at(-1, 1);
    return {at(random_), at(random_), at(random_)};
  }
  void apply(System& system, std::uint32_t what) {
    const std::vector<ParticleId> particles = system.particles().ids();
    if (particles.size() < 12 || what < 3) {
      const BodyId body = system.bodies().create();
      const ParticleId p = system.particles().create(body, place()), q = system.particles().create(body, place());
      if (what == 1) (void)system.cosmetic_bonds().create(p, q);
      return;
    }
    const ParticleId p = any(particles), q = any(particles);
    switch (what) {
      case 3: (void)system.edits().combine(p, q); break;
      case 4: (void)system.edits().combine(system.particles().body(p), system.particles().body(q)); break;
      case 5: (void)system.edits().separate(p, q); break;
      case 6: (void)system.edits().separate(p, any(system.particles().ring(p))); break;
      case 7: system.particles().destroy(p); break;
      case 8: system.bodies().destroy(system.particles().body(p)); break;
      case 9: system.particles().is_nailed(p) ? system.particles().release(p) : system.particles().nail(p); break;
      case 10: (void)system.bonds().create(p, q, SpringLaw{.stiffness = 1, .length = 0.5}); break;
      case 11:
        if (!system.bonds().ids().empty()) system.bonds().destroy(any(system.bonds().ids()));
        break;
      case 12:
        (void)system.joints().create(DistanceSpec{.kind = ConstraintKind::rope, .p = p, .q = q, .length = 3});
        break;
      case 13:
        if (!system.joints().ids().empty()) system.joints().set_active(any(system.joints().ids()), random_() % 2);
        break;
      case 14:
        system.bodies().set_kind(system.particles().body(p), random_() % 2 ? BodyKind::static_ : BodyKind::dynamic);
        break;
      case 15: system.bodies().set_active(system.particles().body(p), random_() % 2); break;
    }
  }

  std::mt19937 random_;
};

TEST(SceneChanges, of_single_edits_add_up_to_the_whole_scene) {
  for (std::uint32_t seed = 0; seed < 30; ++seed) {
    System system;
    system.set_usual_radius(0.03);
    Editor editor(seed);
    Viewer viewer;
    viewer.take(system.viewer().take_scene_changes());
    const Snapshot start = system.snapshot();
    for (int round = 0; round < 40; ++round) {
      for (int edits = 0; edits < 3; ++edits) editor.edit(system);
      if (round == 20) system.restore(start);
      const SceneChanges changes = system.viewer().take_scene_changes();
      EXPECT_EQ(changes.is_whole, round == 20);
      viewer.take(changes);
      Viewer fresh;
      fresh.take(system.viewer().take_scene_changes(true));
      ASSERT_TRUE(viewer == fresh) << "seed " << seed << ", round " << round << "\n" << viewer.difference(fresh);
    }
  }
}

TEST(SceneChanges, a_step_without_an_edit_tells_nothing) {
  System system;
  const BodyId body = system.bodies().create();
  (void)system.particles().create(body, {0, 0, 0});
  (void)system.viewer().take_scene_changes();
  (void)system.step(0.01);
  const SceneChanges changes = system.viewer().take_scene_changes();
  EXPECT_FALSE(changes.is_whole);
  EXPECT_TRUE(changes.bodies.set.empty() && changes.bodies.gone.empty() && changes.memberships.empty());
}

TEST(SceneChanges, are_whole_where_the_usual_radius_is_another_one) {
  System system;
  const BodyId rod = system.bodies().create();
  (void)system.particles().create(rod, {0, 0, 0});
  (void)system.particles().create(rod, {1, 0, 0});
  SceneChanges changes = system.viewer().take_scene_changes();
  EXPECT_DOUBLE_EQ(changes.usual_radius, 0.06);
  ASSERT_EQ(changes.bodies.set.size(), 1u);
  EXPECT_DOUBLE_EQ(changes.bodies.set[0].radius, 0.06);
  system.set_usual_radius(0.01);
  changes = system.viewer().take_scene_changes();
  EXPECT_TRUE(changes.is_whole);
  EXPECT_EQ(changes.usual_radius, 0.01);
  EXPECT_EQ(changes.bodies.set.at(0).radius, 0.01);
  EXPECT_FALSE(system.viewer().take_scene_changes().is_whole);
  system.bodies().set_radius(rod, 0.5);
  changes = system.viewer().take_scene_changes();
  EXPECT_FALSE(changes.is_whole);
  EXPECT_EQ(changes.bodies.set.at(0).radius, 0.5);
}

TEST(SceneChanges, a_cut_touches_its_own_bodies_and_the_articulate_of_the_smaller_side) {
  System system;
  std::vector<ParticleId> ends;
  for (int i = 0; i < 1000; ++i) {
    const BodyId link = system.bodies().create();
    const ParticleId p = system.particles().create(link, {0.1 * i, 0, 0}),
                     q = system.particles().create(link, {0.1 * i + 0.1, 0, 0});
    if (!ends.empty()) (void)system.edits().combine(ends.back(), p);
    ends.push_back(q);
  }
  EXPECT_EQ(system.viewer().take_scene_changes().bodies.set.size(), 1000u);
  const ParticleId cut = system.particles().ring(ends[899])[1];
  ASSERT_TRUE(system.edits().separate(ends[899], cut).changed);
  const SceneChanges changes = system.viewer().take_scene_changes();
  EXPECT_LE(changes.bodies.set.size(), 2u);
  EXPECT_EQ(changes.memberships.size(), 100u);
  EXPECT_EQ(changes.events.size(), 1u);
}

TEST(SceneChanges, a_body_made_after_a_restore_is_new_though_its_id_was_in_use) {
  System system;
  (void)system.particles().create(system.bodies().create(), {0, 0, 0});
  (void)system.viewer().take_scene_changes();
  const Snapshot start = system.snapshot();
  const BodyId first = system.bodies().create();
  (void)system.particles().create(first, {1, 0, 0});
  (void)system.viewer().take_scene_changes();
  system.restore(start);
  const BodyId second = system.bodies().create();
  (void)system.particles().create(second, {2, 0, 0});
  ASSERT_EQ(first, second);
  const SceneChanges changes = system.viewer().take_scene_changes();
  ASSERT_EQ(changes.bodies.set.size(), 2u);
  EXPECT_FALSE(changes.bodies.set[0].is_new);
  EXPECT_TRUE(changes.bodies.set[1].is_new);
}

TEST(SceneChanges, events_come_when_something_happens_and_not_when_it_is_called_off_or_undone) {
  System system;
  const auto point = [&](double x) { return system.particles().create(system.bodies().create(), {x, 0, 0}); };
  const ParticleId p = point(0), q = point(1);
  (void)system.viewer().take_scene_changes();
  const auto kinds = [&] {
    std::string out;
    for (const ViewEvent& event : system.viewer().take_scene_changes().events)
      out += event.kind == ViewEvent::Kind::join ? 'j' : 'b';
    return out;
  };
  (void)system.edits().combine(p, q, 0.05);
  EXPECT_EQ(kinds(), "") << "not yet";
  for (int i = 0; i < 10; ++i) (void)system.step(0.01);
  EXPECT_EQ(kinds(), "j");
  (void)system.edits().separate(p, q);
  EXPECT_EQ(kinds(), "b");
  system.particles().nail(p), system.particles().nail(p), system.particles().release(p);
  EXPECT_EQ(kinds(), "b") << "a nail is drawn, and does not flash";
  system.edits().begin();
  (void)system.edits().combine(p, q);
  (void)system.edits().end();
  system.edits().undo();
  EXPECT_EQ(kinds(), "");
}

}  // namespace
}  // namespace iota
