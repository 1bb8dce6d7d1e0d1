// SPDX-License-Identifier: Apache-2.0
#include "base/side_table.h"

#include <gtest/gtest.h>

#include <map>
#include <random>

namespace iota {
namespace {

TEST(SideTable, agrees_with_a_map_through_random_edits) {
  std::mt19937 random(5);
  SideTable<double> table;
  std::map<std::uint32_t, double> twin;
  for (int i = 0; i < 20000; ++i) {
    const auto slot = static_cast<std::uint32_t>(random() % 100), other = static_cast<std::uint32_t>(random() % 100);
    switch (random() % 4) {
      case 0:
      case 1: table.make(slot) = twin[slot] = i; break;
      case 2: table.erase(slot), twin.erase(slot); break;
      default:
        table.copy(slot, other);
        if (twin.count(slot)) twin[other] = double{twin[slot]};
    }
    ASSERT_EQ(table.size(), twin.size());
    ASSERT_EQ(table.has(slot), twin.count(slot) == 1);
    ASSERT_EQ(table[slot], twin.count(slot) ? twin[slot] : 0.0);
  }
  std::map<std::uint32_t, double> seen;
  table.for_each([&](std::uint32_t slot, double value) { seen[slot] = value; });
  EXPECT_EQ(seen, twin);
}

TEST(SideTable, is_saved_and_restored_and_refuses_bytes_that_name_a_slot_twice_or_none) {
  SideTable<double> table, restored;
  table.make(7) = 1, table.make(2) = 3;
  std::vector<std::byte> bytes;
  Writer writer(bytes);
  table.archive(writer, 8);
  Reader reader(bytes);
  restored.archive(reader, 8);
  EXPECT_TRUE(reader.ok() && reader.at_end());
  EXPECT_EQ(restored[7], 1);
  EXPECT_EQ(restored[2], 3);

  Reader of_fewer_slots(bytes);
  restored.archive(of_fewer_slots, 7);
  EXPECT_FALSE(of_fewer_slots.ok());
  EXPECT_TRUE(restored.is_empty() && !restored.has(2));

  std::vector<double> values{1, 2};
  std::vector<std::uint32_t> owners{3, 3};
  bytes.clear();
  writer.vector(values), writer.vector(owners);
  Reader twice(bytes);
  restored.archive(twice, 8);
  EXPECT_FALSE(twice.ok());
}

}  // namespace
}  // namespace iota
