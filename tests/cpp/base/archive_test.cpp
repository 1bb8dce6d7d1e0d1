// SPDX-License-Identifier: Apache-2.0
#include "base/archive.h"

#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <set>
#include <string_view>

namespace iota {
namespace {

struct Record {
  double mass = 0;
  std::uint32_t slot = 0;
  std::array<std::int8_t, 4> bytes{};

  /// One function for both directions, as all tables have it.
  template <class Archive>
  void archive(Archive& ar, std::vector<double>& list) {
    ar.value(mass), ar.vector(list), ar.value(slot), ar.value(bytes);
  }
};

std::vector<std::byte> written(Record record, std::vector<double> list) {
  std::vector<std::byte> bytes;
  Writer writer(bytes);
  record.archive(writer, list);
  return bytes;
}

TEST(Archive, reads_values_back_in_the_order_of_writing) {
  const std::vector<std::byte> bytes = written({2.5, 7, {1, -1, 0, 127}}, {1, 2, 3});
  Record record;
  std::vector<double> list;
  Reader reader(bytes);
  record.archive(reader, list);
  EXPECT_TRUE(reader.ok() && reader.at_end());
  EXPECT_EQ(record.mass, 2.5);
  EXPECT_EQ(record.slot, 7u);
  EXPECT_EQ(record.bytes, (std::array<std::int8_t, 4>{1, -1, 0, 127}));
  EXPECT_EQ(list, (std::vector<double>{1, 2, 3}));
}

TEST(Archive, of_any_part_of_the_bytes_is_refused_and_reads_zeros) {
  const std::vector<std::byte> whole = written({2.5, 7, {1, 2, 3, 4}}, {1, 2, 3});
  for (std::size_t size = 0; size < whole.size(); ++size) {
    const std::vector<std::byte> part(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size));
    Record record{9, 9, {9, 9, 9, 9}};
    std::vector<double> list{9};
    Reader reader(part);
    record.archive(reader, list);
    EXPECT_FALSE(reader.ok()) << size << " bytes of " << whole.size();
    EXPECT_EQ(record.bytes, (std::array<std::int8_t, 4>{})) << "values after the end read as zero";
  }
}

TEST(Archive, does_not_trust_a_count_and_so_asks_for_no_memory_that_is_not_there) {
  std::vector<std::byte> bytes;
  Writer writer(bytes);
  for (const std::uint64_t count : {std::uint64_t{2}, std::uint64_t{1} << 61, ~std::uint64_t{0}}) {
    bytes.clear();
    std::uint64_t said = count;
    double only = 1;
    writer.value(said), writer.value(only);
    std::vector<double> list{5};
    Reader reader(bytes);
    reader.vector(list);
    EXPECT_FALSE(reader.ok());
    EXPECT_TRUE(list.empty());
  }
}

TEST(Archive, tells_bytes_that_are_left_over) {
  std::vector<std::byte> bytes = written({}, {});
  bytes.push_back(std::byte{0});
  Record record;
  std::vector<double> list;
  Reader reader(bytes);
  record.archive(reader, list);
  EXPECT_TRUE(reader.ok());
  EXPECT_FALSE(reader.at_end());
}

TEST(Archive, that_failed_once_stays_failed) {
  const std::vector<std::byte> bytes = written({2.5, 7, {}}, {});
  Record record;
  std::vector<double> list;
  Reader reader(bytes);
  reader.fail();
  record.archive(reader, list);
  EXPECT_FALSE(reader.ok());
  EXPECT_EQ(record.mass, 0) << "after a failure nothing is read";
}

TEST(Hasher, is_the_64_bit_fnv_1a) {
  const auto hash_of = [](std::string_view text) {
    Hasher hasher;
    hasher.bytes(text.data(), text.size());
    return hasher.result();
  };
  // Test vectors of its authors, http://www.isthe.com/chongo/tech/comp/fnv.
  EXPECT_EQ(hash_of(""), 0xcbf29ce484222325u);
  EXPECT_EQ(hash_of("a"), 0xaf63dc4c8601ec8cu);
  EXPECT_EQ(hash_of("foobar"), 0x85944171f73967e8u);
}

TEST(Hasher, tells_zero_from_minus_zero_since_it_compares_bits) {
  Hasher plus, minus;
  plus.value(0.0), minus.value(-0.0);
  EXPECT_NE(plus.result(), minus.result());
}

TEST(WordHasher, differs_by_each_bit_of_each_value_and_by_their_order) {
  std::set<std::uint64_t> results;
  const auto add = [&](std::uint64_t a, std::uint32_t b, double c) {
    WordHasher hasher;
    hasher.value(a), hasher.value(b), hasher.value(c);
    results.insert(hasher.result());
  };
  add(0, 0, 0.0), add(0, 0, -0.0);
  for (int bit = 0; bit < 64; ++bit) add(std::uint64_t{1} << bit, 0, 0.0);
  for (int bit = 0; bit < 32; ++bit) add(0, std::uint32_t{1} << bit, 0.0);
  for (int bit = 0; bit < 63; ++bit) add(0, 0, std::bit_cast<double>(std::uint64_t{1} << bit));
  EXPECT_EQ(results.size(), 2u + 64u + 32u + 63u);
}

}  // namespace
}  // namespace iota
