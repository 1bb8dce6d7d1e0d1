// SPDX-License-Identifier: Apache-2.0
#include "net/entity_store.h"

#include <gtest/gtest.h>

#include <string>
#include <variant>
#include <vector>

namespace iota::net {
namespace {

constexpr std::uint8_t label = entity_kind<protocol::LabelEntity>();
constexpr std::uint8_t visual = entity_kind<protocol::VisualEntity>();

EntityChanges set(std::uint8_t kind, protocol::Id id, std::vector<std::uint8_t> record) {
  EntityChanges changes;
  changes.set(kind, id, record);
  return changes;
}

EntityChanges destroyed(std::uint8_t kind, protocol::Id id) {
  EntityChanges changes;
  changes.destroy(kind, id);
  return changes;
}

std::vector<protocol::ServerMessage> messages_since(EntityStore& store, std::uint64_t version) {
  std::vector<protocol::ServerMessage> messages;
  for (const Frame& frame : store.frames_since(version)) {
    const auto decoded = protocol::decode_server_message(*frame);
    if (decoded) messages.push_back(*decoded.value);
  }
  EXPECT_EQ(messages.size(), store.frames_since(version).size()) << "each frame is a message";
  return messages;
}

TEST(EntityStore, a_new_client_gets_the_latest_record_of_each_and_none_of_destroyed_ones) {
  EntityStore store;
  store.apply(set(label, {0, 1}, {1}));
  store.apply(set(label, {1, 1}, {2}));
  store.apply(set(label, {0, 1}, {3}));
  store.apply(set(label, {2, 1}, {4}));
  store.apply(destroyed(label, {2, 1}));
  const auto messages = messages_since(store, 0);
  ASSERT_EQ(messages.size(), 1u);
  const auto& told = std::get<protocol::EntitiesSet>(messages[0]);
  EXPECT_EQ(told.kind, "label");
  EXPECT_EQ(told.records, (std::vector<std::uint8_t>{3, 2}));
}

TEST(EntityStore, a_client_that_is_behind_gets_the_changes_since) {
  EntityStore store;
  store.apply(set(label, {0, 1}, {1}));
  store.apply(set(label, {1, 1}, {2}));
  const std::uint64_t known = store.version();
  EXPECT_TRUE(store.frames_since(known).empty());
  store.apply(set(label, {1, 1}, {5}));
  store.apply(destroyed(label, {0, 1}));
  const auto messages = messages_since(store, known);
  ASSERT_EQ(messages.size(), 2u);
  EXPECT_EQ(std::get<protocol::EntitiesSet>(messages[0]).records, (std::vector<std::uint8_t>{5}));
  EXPECT_EQ(std::get<protocol::EntitiesDestroyed>(messages[1]).ids, (std::vector<protocol::Id>{{0, 1}}));
}

TEST(EntityStore, a_slot_that_is_used_again_has_the_newer_generation) {
  EntityStore store;
  store.apply(set(label, {3, 1}, {1}));
  EXPECT_EQ(store.generations(label)[3], 1u);
  store.apply(destroyed(label, {3, 1}));
  store.apply(set(label, {3, 2}, {2}));
  EXPECT_EQ(store.generations(label)[3], 2u);
  EXPECT_EQ(std::get<protocol::EntitiesSet>(messages_since(store, 0).at(0)).records, (std::vector<std::uint8_t>{2}));
}

TEST(EntityStore, referred_entities_are_created_first_and_destroyed_last) {
  EntityStore store;
  store.apply(set(label, {0, 1}, {1}));
  store.apply(set(visual, {0, 1}, {2}));
  auto messages = messages_since(store, 0);
  ASSERT_EQ(messages.size(), 2u);
  EXPECT_EQ(std::get<protocol::EntitiesSet>(messages[0]).kind, "visual");
  const std::uint64_t known = store.version();
  store.apply(destroyed(visual, {0, 1}));
  store.apply(destroyed(label, {0, 1}));
  messages = messages_since(store, known);
  ASSERT_EQ(messages.size(), 2u);
  EXPECT_EQ(std::get<protocol::EntitiesDestroyed>(messages[1]).kind, "visual");
}

TEST(EntityStore, many_records_travel_in_several_messages) {
  EntityStore store;
  const std::vector<std::uint8_t> record(1000);
  EntityChanges changes;
  for (std::uint32_t slot = 0; slot < 3000; ++slot) changes.set(label, {slot, 1}, record);
  store.apply(changes);
  std::size_t bytes = 0;
  const auto messages = messages_since(store, 0);
  for (const auto& message : messages) bytes += std::get<protocol::EntitiesSet>(message).records.size();
  EXPECT_EQ(bytes, 3000 * record.size());
  EXPECT_EQ(messages.size(), 3u) << "of about 1 MiB each";
}

TEST(EntityChanges, appended_ones_follow_those_before) {
  EntityChanges changes = set(label, {0, 1}, {1, 2});
  changes.append(destroyed(label, {1, 1}));
  changes.append(set(label, {2, 1}, {3}));
  std::string told;
  changes.for_each([&](std::uint8_t, protocol::Id id, std::span<const std::uint8_t> record) {
    told += std::to_string(id.slot) + ":";
    for (const std::uint8_t byte : record) told += std::to_string(byte);
    told += " ";
  });
  EXPECT_EQ(told, "0:12 1: 2:3 ");
}

TEST(EntityKind, has_a_name_that_gives_it_back) {
  for (std::uint8_t kind = 0; kind < entity_kind_count; ++kind) EXPECT_EQ(entity_kind_of(entity_kind_name(kind)), kind);
  EXPECT_FALSE(entity_kind_of("ghost"));
}

}  // namespace
}  // namespace iota::net
