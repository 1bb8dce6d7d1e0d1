// SPDX-License-Identifier: Apache-2.0
#include "net/presenter.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace iota::net {
namespace {

/// The slots that changes set and destroy, by kind.
struct Told {
  std::map<std::string, std::vector<std::uint32_t>> set, destroyed;
  std::map<std::string, std::uint32_t> generation;  ///< of the last one set

  explicit Told(const EntityChanges& changes) {
    changes.for_each([&](std::uint8_t kind, protocol::Id id, std::span<const std::uint8_t> record) {
      const std::string name(entity_kind_name(kind));
      (record.empty() ? destroyed : set)[name].push_back(id.slot);
      generation[name] = id.generation;
    });
  }
};

const std::vector<std::string> simple_kinds{"joint", "nail", "particle_set", "tie"};

/// One of each thing that is one entity, in slot 3, as the engine describes it.
SceneChanges one_of_each(bool is_whole) {
  SceneChanges changes;
  changes.is_whole = is_whole;
  const Anchor world{{}, {1, 2, 3}};
  changes.ties.set.push_back({3, DrawnTie::Kind::rope, 0.5, world, world});
  changes.joints.set.push_back({3, "revolute", world, world, {0, 0, 1}});
  changes.nails.set.push_back({3, world});
  changes.particle_sets.set.push_back({3, true, 100});
  return changes;
}

SceneChanges all_gone() {
  SceneChanges changes;
  changes.is_whole = false;
  for (auto* const gone : {&changes.ties.gone, &changes.joints.gone, &changes.nails.gone, &changes.particle_sets.gone})
    *gone = {3, 7};  // nothing was ever told of 7
  return changes;
}

TEST(Presenter, tells_each_thing_once_until_it_changes) {
  Presenter presenter;
  const Told first(presenter.present(one_of_each(true)));
  for (const std::string& kind : simple_kinds) EXPECT_EQ(first.set.at(kind), std::vector<std::uint32_t>{3}) << kind;
  EXPECT_TRUE(presenter.present(one_of_each(false)).empty());
  SceneChanges moved = one_of_each(false);
  moved.nails.set[0].at.point.x = 5;
  const Told second(presenter.present(moved));
  EXPECT_EQ(second.set.size(), 1u);
  EXPECT_EQ(second.generation.at("nail"), first.generation.at("nail"));
}

TEST(Presenter, reports_a_destroyed_entity_once_and_its_slot_gets_another_generation) {
  Presenter presenter;
  const Told first(presenter.present(one_of_each(true)));
  const Told gone(presenter.present(all_gone()));
  for (const std::string& kind : simple_kinds)
    EXPECT_EQ(gone.destroyed.at(kind), std::vector<std::uint32_t>{3}) << kind;
  EXPECT_TRUE(presenter.present(all_gone()).empty());
  const Told again(presenter.present(one_of_each(false)));
  for (const std::string& kind : simple_kinds) EXPECT_GT(again.generation.at(kind), first.generation.at(kind)) << kind;
}

TEST(Presenter, destroys_entities_that_a_complete_list_lacks) {
  Presenter presenter;
  (void)presenter.present(one_of_each(true));
  SceneChanges partial;
  partial.is_whole = false;
  EXPECT_TRUE(presenter.present(partial).empty());
  const Told gone(presenter.present(SceneChanges{}));
  for (const std::string& kind : simple_kinds)
    EXPECT_EQ(gone.destroyed.at(kind), std::vector<std::uint32_t>{3}) << kind;
}

TEST(Presenter, knows_a_body_by_the_id_that_viewers_have_until_it_is_gone) {
  Presenter presenter;
  const auto present = [&](BodyId id) {
    SceneChanges changes;
    changes.is_whole = false;
    DrawnBody body;
    body.id = id;
    body.particles = 1;
    changes.bodies.set.push_back(body);
    (void)presenter.present(changes);
  };
  present({2, 1});
  const protocol::Id old = presenter.id_of({2, 1});
  EXPECT_EQ(presenter.body(old), (BodyId{2, 1}));
  present({2, 5});  // another one in the same slot
  EXPECT_EQ(presenter.body(old), std::nullopt);
  EXPECT_EQ(presenter.id_of({2, 1}), protocol::Id{});
  EXPECT_EQ(presenter.body(presenter.id_of({2, 5})), (BodyId{2, 5}));
  SceneChanges gone;
  gone.is_whole = false;
  gone.bodies.gone.push_back(2);
  (void)presenter.present(gone);
  EXPECT_EQ(presenter.id_of({2, 5}), protocol::Id{});
}

}  // namespace
}  // namespace iota::net
