// SPDX-License-Identifier: Apache-2.0
#include "edit/table_schema.h"

#include "base/archive.h"
#include "base/seal.h"
#include "tests/cpp/ingredient/everything.h"

#include <iota/log.h>
#include <iota/system.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <map>
#include <string>

namespace iota::edit {
namespace {

/// Seals tables with another schema than this program's, as another version would.
Snapshot with_schema(const Snapshot& own, std::string schema) {
  const std::span<const std::byte> content(own.bytes.begin() + 16, own.bytes.end() - 8);
  std::uint64_t length = 0;
  std::memcpy(&length, content.data() + 8, sizeof length);
  std::vector<std::byte> other(8);  // a hash that is not ours
  const auto append = [&](const void* data, std::size_t size) {
    const auto* begin = static_cast<const std::byte*>(data);
    other.insert(other.end(), begin, begin + size);
  };
  if (schema.empty()) schema = own_schema_text();
  const std::uint64_t count = schema.size();
  append(&count, sizeof count), append(schema.data(), schema.size());
  append(content.data() + 16 + length, content.size() - 16 - length);
  Seal mark{{}, "snapshot"};
  std::memcpy(mark.mark.data(), own.bytes.data(), sizeof mark.mark);
  return {seal(mark, other)};
}

/// A state of undo as the journal of another version has it: with the hash of its schema, and without the schema.
Snapshot state_of_undo(const Snapshot& own, const std::string& schema) {
  const Snapshot whole = with_schema(own, schema);
  const std::span<const std::byte> content(whole.bytes.begin() + 16, whole.bytes.end() - 8);
  Hasher hasher;
  hasher.bytes(schema.data(), schema.size());
  std::vector<std::byte> state(16);
  const std::uint64_t hash = hasher.result();
  std::memcpy(state.data(), &hash, sizeof hash);
  const auto tables = content.subspan(16 + schema.size());
  state.insert(state.end(), tables.begin(), tables.end());
  Seal mark{{}, "snapshot"};
  std::memcpy(mark.mark.data(), own.bytes.data(), sizeof mark.mark);
  return {seal(mark, state)};
}

TEST(TableSchema, all_of_a_record_is_in_a_field_but_what_aligns_the_next_one) {
  std::map<std::string, int> names;
  for (const Schema::Item& item : own_schema().items) {
    EXPECT_EQ(++names[item.name], 1) << item.name << " is there twice";
    std::vector<Schema::Field> fields = own_schema().records[item.record].fields;
    std::ranges::sort(fields, {}, &Schema::Field::offset);
    std::uint32_t end = 0;
    for (const Schema::Field& field : fields) {
      EXPECT_LT(field.offset - end, 8U) << item.name << ": a field before " << field.name << " is not named";
      end = field.offset + field.size * field.count;
    }
    EXPECT_LT(own_schema().records[item.record].size - end, 8U) << item.name << ": its last field is not named";
  }
  EXPECT_TRUE(names.contains("particles.0") && names.contains("gravity.0") && names.contains("Bonds.0"));
}

TEST(TableSchema, what_was_translated_is_the_same_world) {
  System original;
  model::Everything().fill(original);
  for (int i = 0; i < 5; ++i) (void)original.step(1.0 / 60);
  const Snapshot other = with_schema(original.snapshot(), {});
  System again;
  again.restore(other);
  EXPECT_EQ(again.state_hash(), original.state_hash());
  EXPECT_EQ(again.validate(), std::vector<std::string>{});
  (void)original.step(1.0 / 60), (void)again.step(1.0 / 60);
  EXPECT_EQ(again.state_hash(), original.state_hash());
}

TEST(TableSchema, a_field_that_an_older_version_did_not_have_gets_its_default_and_an_unknown_one_is_skipped) {
  System original;
  model::Everything().fill(original);
  std::string schema = own_schema_text();
  const auto rename = [&](const std::string& from, const std::string& to) {
    const std::size_t at = schema.find(from);
    ASSERT_NE(at, std::string::npos) << from;
    schema.replace(at, from.size(), to);
  };
  rename("\nbreak_force f 8", "\nold_force f 8");
  rename("\ngravity.0 v", "\nold_gravity.0 v");
  original.set_gravity({0, -1, 0});
  System again;
  again.restore(with_schema(original.snapshot(), schema));
  EXPECT_EQ(again.gravity().y, -9.81);
  EXPECT_EQ(again.validate(), std::vector<std::string>{});
  EXPECT_EQ(again.bodies().ids(), original.bodies().ids());
}

TEST(TableSchema, undo_reaches_a_state_of_an_older_version_with_the_schema_of_its_journal) {
  System original;
  model::Everything().fill(original);
  std::string schema = own_schema_text();
  const std::string field = "\nbreak_force f 8";
  schema.replace(schema.find(field), field.size(), "\nold_force f 8");
  const Snapshot state = state_of_undo(original.snapshot(), schema);
  System again;
  EXPECT_THROW(again.log().set_history({state}, {}), std::invalid_argument) << "nobody knows its tables";
  EXPECT_THROW(again.log().set_history({state}, {}, own_schema_text()), std::invalid_argument) << "of another schema";
  again.log().set_history({state}, {}, schema);
  EXPECT_TRUE(again.edits().undo());
  EXPECT_EQ(again.bodies().ids(), original.bodies().ids());
  EXPECT_EQ(again.validate(), std::vector<std::string>{});
  EXPECT_TRUE(again.edits().redo());
}

TEST(TableSchema, a_state_of_undo_is_of_its_own_program) {
  System original;
  const Snapshot own = original.snapshot();
  EXPECT_NO_THROW(original.restore(own));
  EXPECT_THROW(original.restore(with_schema(own, "schema 0 0")), std::invalid_argument);
}

}  // namespace
}  // namespace iota::edit
