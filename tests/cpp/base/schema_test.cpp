// SPDX-License-Identifier: Apache-2.0
#include "base/schema.h"

#include "base/archive.h"

#include <gtest/gtest.h>

#include <random>
#include <stdexcept>

namespace iota {
namespace {

struct PlaceOfTest {
  double x = 1, y = 2, z = 3;
};

enum class ColorOfTest : std::uint8_t { red, green };

/// A record as an older program has it.
struct OlderRecord {
  std::uint32_t gone = 7;
  float weight = 0.5F;
  ColorOfTest color = ColorOfTest::green;
  PlaceOfTest place;
  std::array<double, 2> list{10, 20};
};

/// The same record today: a field is gone, one is new, one is wider, one longer, and the order is another one.
struct NewerRecord {
  PlaceOfTest place;
  double weight = -1;
  std::array<double, 3> list{-1, -2, -3};
  std::int32_t fresh = 42;
  ColorOfTest color = ColorOfTest::red;
};

}  // namespace

IOTA_FIELDS(OlderRecord, gone, weight, color, place, list)
IOTA_FIELDS(NewerRecord, place, weight, list, fresh, color)

namespace {

template <class Record>
struct TestWorld {
  std::vector<Record> records;
  double time = 5;
  std::vector<std::uint32_t> extra{1, 2, 3};
  bool has_extra = true;

  template <class Archive>
  void archive(Archive& ar) {
    if (has_extra) ar.name("extra"), ar.vector(extra);
    ar.name("records"), ar.vector(records);
    ar.name("time"), ar.value(time);
  }
  std::vector<std::byte> bytes() {
    std::vector<std::byte> out;
    Writer writer(out);
    archive(writer);
    return out;
  }
  Schema schema() {
    Schema found;
    SchemaWriter writer(found);
    archive(writer);
    return found;
  }
};

TEST(Schema, an_older_record_is_read_by_the_names_of_its_fields) {
  TestWorld<OlderRecord> older;
  older.records.resize(2);
  older.records[1].weight = 0.25F;
  older.records[1].place.y = 9;
  older.time = 8;
  TestWorld<NewerRecord> newer;
  newer.has_extra = false;
  const auto bytes = translate(Schema::from_text(older.schema().text()), older.bytes(), newer.schema(), newer.bytes());
  TestWorld<NewerRecord> read;
  read.has_extra = false;
  Reader reader(bytes);
  read.archive(reader);
  ASSERT_TRUE(reader.ok() && reader.at_end());
  ASSERT_EQ(read.records.size(), 2U);
  EXPECT_EQ(read.records[1].weight, 0.25);
  EXPECT_EQ(read.records[1].place.y, 9);
  EXPECT_EQ(read.records[1].color, ColorOfTest::green);
  EXPECT_EQ(read.records[1].list, (std::array<double, 3>{10, 20, -3}));
  EXPECT_EQ(read.records[1].fresh, 42) << "a field that is new is as in a new record";
  EXPECT_EQ(read.time, 8);
}

TEST(Schema, a_table_that_is_new_is_as_in_a_new_world) {
  TestWorld<OlderRecord> older, newer;
  older.has_extra = false;
  older.time = 3;
  const auto bytes = translate(older.schema(), older.bytes(), newer.schema(), newer.bytes());
  TestWorld<OlderRecord> read;
  read.extra.clear();
  Reader reader(bytes);
  read.archive(reader);
  ASSERT_TRUE(reader.ok() && reader.at_end());
  EXPECT_EQ(read.extra, (std::vector<std::uint32_t>{1, 2, 3}));
  EXPECT_EQ(read.time, 3);
}

TEST(Schema, the_same_schema_gives_the_same_bytes) {
  TestWorld<OlderRecord> world;
  world.records.resize(3);
  const Schema schema = world.schema();
  EXPECT_EQ(Schema::from_text(schema.text()).text(), schema.text());
  const auto again = translate(schema, world.bytes(), schema, TestWorld<OlderRecord>().bytes());
  TestWorld<OlderRecord> read;
  Reader reader(again);
  read.archive(reader);
  EXPECT_EQ(read.records.size(), 3U);
  EXPECT_EQ(read.records[2].place.z, 3);
}

TEST(Schema, bytes_between_fields_tell_nothing_of_the_memory) {
  Schema schema;
  SchemaWriter names(schema);
  names.name("records");
  names.vector(std::vector<NewerRecord>());
  std::vector<std::byte> bytes(8 + 2 * sizeof(NewerRecord), std::byte{0xcd}), expected(bytes.size());
  std::vector<NewerRecord> records(2);
  records[1].fresh = 43;
  const std::uint64_t count = records.size();
  for (std::vector<std::byte>* each : {&bytes, &expected}) {
    std::memcpy(each->data(), &count, sizeof count);
    for (std::size_t i = 0; i < records.size(); ++i)
      FieldNames<NewerRecord>::visit(records[i], [&](const char*, const auto& field) {
        const auto offset =
            reinterpret_cast<const std::byte*>(&field) - reinterpret_cast<const std::byte*>(&records[i]);
        std::memcpy(each->data() + 8 + i * sizeof(NewerRecord) + offset, &field, sizeof field);
      });
  }
  ASSERT_NE(bytes, expected) << "there are such bytes";
  SchemaGaps(schema).clear(bytes);
  EXPECT_EQ(bytes, expected);
}

TEST(Schema, a_number_that_a_type_cannot_have_becomes_zero) {
  Schema from, to;
  SchemaWriter wide(from), narrow(to);
  wide.name("n"), wide.vector(std::vector<double>());
  narrow.name("n"), narrow.vector(std::vector<std::uint8_t>());
  std::vector<std::byte> bytes, standard, expected;
  Writer writer(bytes), usual(standard), good(expected);
  writer.vector(std::vector<double>{1, 300, -1, 255});
  usual.vector(std::vector<std::uint8_t>());
  good.vector(std::vector<std::uint8_t>{1, 0, 0, 255});
  EXPECT_EQ(translate(from, bytes, to, standard), expected);
}

TEST(Schema, damaged_texts_and_bytes_are_refused_or_read_as_something_whole) {
  TestWorld<OlderRecord> world;
  world.records.resize(4);
  const std::string text = world.schema().text();
  const auto bytes = world.bytes();
  std::mt19937 random(1);
  int refused = 0;
  for (int i = 0; i < 3000; ++i) {
    std::string damaged = text;
    auto tables = bytes;
    if (i % 2 == 0) damaged[random() % damaged.size()] = static_cast<char>(random() % 128);
    if (i % 3 == 0) damaged.resize(random() % damaged.size());
    if (i % 5 == 0) tables.resize(random() % tables.size());
    if (i % 7 == 0) tables[random() % tables.size()] = static_cast<std::byte>(random());
    try {
      const auto out = translate(Schema::from_text(damaged), tables, world.schema(), bytes);
      Reader reader(out);
      TestWorld<OlderRecord> read;
      read.archive(reader);
      EXPECT_TRUE(reader.ok() && reader.at_end());
    } catch (const std::invalid_argument& error) {
      ++refused;
    }
  }
  EXPECT_GT(refused, 1000);
}

TEST(Schema, a_text_that_promises_much_more_than_there_is_makes_no_room_for_it) {
  Schema from, to;
  SchemaWriter writer(from);
  writer.name("n"), writer.vector(std::vector<std::uint8_t>());
  SchemaWriter large(to);
  large.name("n"), large.vector(std::vector<std::array<double, 4096>>());
  std::vector<std::byte> bytes, standard;
  Writer small(bytes), usual(standard);
  small.vector(std::vector<std::uint8_t>(100'000));
  usual.vector(std::vector<std::uint8_t>());
  EXPECT_THROW(translate(from, bytes, to, standard), std::invalid_argument);
}

}  // namespace
}  // namespace iota
