// SPDX-License-Identifier: Apache-2.0
// Ids of slot + generation against a twin that never reuses anything.
#include "base/slot_table.h"

#include <iota/ids.h>

#include <gtest/gtest.h>

#include <map>
#include <random>

namespace iota {
namespace {

using TestId = Id<"test">;
using Table = SlotTable<double, TestId>;

std::vector<std::byte> saved(Table& table) {
  std::vector<std::byte> bytes;
  Writer writer(bytes);
  table.archive(writer);
  return bytes;
}

TEST(SlotTable, agrees_with_a_map_through_random_edits) {
  std::mt19937 random(3);
  Table table;
  std::map<TestId, double> alive;
  std::vector<TestId> gone;
  for (int i = 0; i < 20000; ++i) {
    if (alive.empty() || random() % 100 < 52) {
      const TestId id = table.create(i);
      ASSERT_TRUE(alive.emplace(id, i).second) << "an id was given twice";
    } else {
      const auto victim = std::next(alive.begin(), random() % alive.size());
      table.destroy(victim->first.slot);
      gone.push_back(victim->first);
      alive.erase(victim);
    }
    ASSERT_EQ(table.size(), alive.size());
  }
  for (const auto& [id, value] : alive) {
    EXPECT_TRUE(table.contains(id));
    EXPECT_EQ(table[id.slot], value);
  }
  for (const TestId id : gone) ASSERT_FALSE(table.contains(id)) << "a stale id answers";
  std::vector<TestId> in_order;
  for (const auto& entry : alive) in_order.push_back(entry.first);
  EXPECT_EQ(table.ids(), in_order) << "ids sort by slot";
}

TEST(SlotTable, never_contains_the_null_id) {
  Table table;
  EXPECT_FALSE(table.contains(TestId{}));
  table.create(1);
  EXPECT_FALSE(table.contains(TestId{}));
  table.destroy(0);
  EXPECT_FALSE(table.contains(TestId{}));
}

TEST(SlotTable, reuses_the_slot_that_was_given_back_last) {
  Table table;
  for (const double value : {0, 1, 2}) table.create(value);
  table.destroy(0), table.destroy(2);
  EXPECT_EQ(table.create(3), (TestId{2, 3}));
  EXPECT_EQ(table.create(4), (TestId{0, 3}));
  EXPECT_EQ(table.create(5), (TestId{3, 1}));
}

TEST(SlotTable, saves_live_objects_alone_and_reads_tables_with_all) {
  Table table;
  for (int i = 0; i < 100; ++i) table.create(i);
  const std::size_t size = saved(table).size();
  for (std::uint32_t slot = 0; slot < 90; ++slot) table.destroy((7 * slot) % 100);
  const std::vector<std::byte> bytes = saved(table);
  EXPECT_EQ(bytes.size(), size - 90 * sizeof(double) + 90 * sizeof(std::uint32_t));
  std::vector<double> all(100, -1);  // as earlier versions have saved it
  std::vector<std::uint32_t> generations(100), none;
  for (std::uint32_t slot = 0; slot < 100; ++slot) {
    generations[slot] = table.id(slot).generation;
    if (table.is_alive(slot))
      all[slot] = table[slot];
    else
      none.push_back(slot);
  }
  std::vector<std::byte> whole;
  Writer writer(whole);
  writer.vector(all), writer.vector(generations), writer.vector(none), writer.value(table.size());
  for (const std::vector<std::byte>& source : {bytes, whole}) {
    Table restored;
    Reader reader(source);
    restored.archive(reader);
    EXPECT_TRUE(reader.ok() && reader.at_end());
    ASSERT_EQ(restored.ids(), table.ids());
    table.for_each([&](std::uint32_t slot, double value) { EXPECT_EQ(restored[slot], value) << slot; });
  }
}

TEST(SlotTable, that_is_restored_gives_the_same_ids_from_then_on) {
  Table table, restored;
  for (int i = 0; i < 6; ++i) table.create(i);
  table.destroy(4), table.destroy(1);
  const std::vector<std::byte> bytes = saved(table);
  Reader reader(bytes);
  restored.archive(reader);
  EXPECT_TRUE(reader.ok() && reader.at_end());
  EXPECT_EQ(restored.ids(), table.ids());
  for (int i = 0; i < 4; ++i) EXPECT_EQ(restored.create(9), table.create(9));
}

TEST(SlotTable, refuses_bytes_whose_counts_disagree) {
  Table table;
  for (int i = 0; i < 3; ++i) table.create(i);
  table.destroy(1);
  std::vector<double> items{0, 1, 2};
  const std::vector<std::uint32_t> generations{1, 2, 1};
  const auto reads = [&](std::vector<std::uint32_t> of_each, std::vector<std::uint32_t> free, std::uint32_t alive) {
    std::vector<std::byte> bytes;
    Writer writer(bytes);
    writer.vector(items), writer.vector(of_each), writer.vector(free), writer.value(alive);
    Reader reader(bytes);
    Table read;
    read.archive(reader);
    return reader.ok();
  };
  EXPECT_TRUE(reads(generations, {1}, 2));
  EXPECT_FALSE(reads({1, 2}, {1}, 2)) << "a generation is missing";
  EXPECT_FALSE(reads(generations, {1}, 3)) << "more alive than there are slots";
  EXPECT_FALSE(reads(generations, {}, 2)) << "a free slot is missing";
}

}  // namespace
}  // namespace iota
