// SPDX-License-Identifier: Apache-2.0
// What one viewer has not been sent yet.
#include "net/updates.h"

#include "net/hub.h"

#include <gtest/gtest.h>

#include <optional>
#include <variant>

namespace iota::net {
namespace {

class UpdatesTest : public testing::Test {
 protected:
  void publish(std::uint64_t step, float x, EntityChanges changes = {}) {
    PoseSnapshot snapshot;
    snapshot.step = step;
    snapshot.bodies.push_back({0, {x, 0, 0}, {0, 0, 0, 1}});
    snapshot.bodies.push_back({1, {0, 1, 0}, {0, 0, 0, 1}});
    (void)hub.publish(snapshot, std::move(changes));
    hub.deliver();
  }
  static EntityChanges body(std::uint32_t slot) {
    protocol::BodyEntity entity;
    entity.id = {slot, 1};
    std::vector<std::uint8_t> record;
    protocol::append_record(entity, record);
    EntityChanges changes;
    changes.set(entity_kind<protocol::BodyEntity>(), entity.id, record);
    return changes;
  }
  /// The next message; nothing if there is none.
  std::optional<protocol::ServerMessage> next() {
    const auto bytes = updates.next(hub);
    if (!bytes) return std::nullopt;
    return *protocol::decode_server_message(*bytes).value;
  }

  Counters counters;
  Hub hub{"world", 2, counters, [] {}};
  Updates updates;
};

TEST_F(UpdatesTest, are_entities_first_and_then_the_newest_poses) {
  EXPECT_FALSE(next()) << "nothing was published";
  publish(1, 0, body(0));
  const auto first = next(), second = next();
  ASSERT_TRUE(first && second);
  EXPECT_TRUE(std::holds_alternative<protocol::EntitiesSet>(*first));
  EXPECT_TRUE(std::get<protocol::Poses>(*second).keyframe);
  EXPECT_FALSE(next());
  publish(2, 0.1F);
  const auto third = next();
  ASSERT_TRUE(third);
  const auto& poses = std::get<protocol::Poses>(*third);
  EXPECT_FALSE(poses.keyframe);
  EXPECT_EQ(poses.bodies.size() + poses.far_bodies.size(), 1u) << "only what moved";
}

TEST_F(UpdatesTest, skip_poses_that_were_not_asked_for_and_count_them) {
  publish(1, 0);
  ASSERT_TRUE(next());
  EXPECT_EQ(updates.take_skipped(), 0u);
  for (std::uint64_t step = 2; step <= 5; ++step) publish(step, 0.1F * static_cast<float>(step));
  const auto newest = next();
  ASSERT_TRUE(newest);
  EXPECT_EQ(std::get<protocol::Poses>(*newest).step, 5u);
  EXPECT_FALSE(next());
  EXPECT_EQ(updates.take_skipped(), 3u);
  EXPECT_EQ(updates.take_skipped(), 0u);
}

}  // namespace
}  // namespace iota::net
