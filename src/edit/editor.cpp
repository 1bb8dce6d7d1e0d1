// SPDX-License-Identifier: Apache-2.0
#include "edit/editor.h"

#include "base/seal.h"
#include "base/text.h"
#include "edit/table_schema.h"
#include "ingredient/tables.h"

#include <cstring>
#include <string_view>
#include <utility>

namespace iota::edit {

namespace {

constexpr Seal snapshot_seal{{'I', 'O', 'T', 'A', 'S', 'O', 'J', 0}, "snapshot"};
constexpr Seal letter_i_seal{{'I', 'O', 'T', 'A', 'S', 'O', 'I', 21}, "snapshot"};  // 21 ingredients, without a schema

std::uint64_t hash_of(std::string_view schema) {
  Hasher hasher;
  hasher.bytes(schema.data(), schema.size());
  return hasher.result();
}

std::uint64_t hash_of_own_schema() {
  static const std::uint64_t hash = hash_of(own_schema_text());
  return hash;
}

bool is_of_letter_i(std::span<const std::byte> bytes) {
  const auto& mark = letter_i_seal.mark;
  return bytes.size() >= mark.size() && std::memcmp(bytes.data(), mark.data(), mark.size()) == 0;
}

/// The tables of a snapshot as this program writes them. room: for those that had to be translated. missing: the schema of a
/// snapshot without one.
std::span<const std::byte> tables_of(std::span<const std::byte> bytes, std::vector<std::byte>& room,
                                     std::string_view missing = {}) {
  if (is_of_letter_i(bytes)) return room = in_own_schema(schema_of_letter_i(), unseal(letter_i_seal, bytes));
  const auto content = unseal(snapshot_seal, bytes);
  Reader reader(content);
  std::uint64_t hash = 0;
  reader.value(hash);
  const std::size_t length = reader.count(1);
  if (!reader.ok()) throw std::invalid_argument("restore: this snapshot is damaged");
  const auto rest = content.last(reader.remaining());
  std::string_view schema(reinterpret_cast<const char*>(rest.data()), length);
  const auto tables = rest.subspan(length);
  if (hash == hash_of_own_schema()) return tables;
  if (schema.empty() && hash_of(missing) == hash) schema = missing;
  if (schema.empty())
    throw std::invalid_argument("restore: this state of undo is of another version of Iota, which only it can read");
  return room = in_own_schema(schema, tables);
}

/// The bytes before the tables in a snapshot. expected: size of the tables.
std::vector<std::byte> begin_with(std::string_view schema, std::size_t expected) {
  std::vector<std::byte> bytes = begin_seal(snapshot_seal, 2 * sizeof(std::uint64_t) + schema.size() + expected);
  Writer writer(bytes);
  writer.value(hash_of_own_schema());
  writer.vector(std::vector<char>(schema.begin(), schema.end()));
  return bytes;
}

}  // namespace

bool has_own_tables(std::span<const std::byte> snapshot) {
  const auto& mark = snapshot_seal.mark;
  std::uint64_t hash = 0;
  if (snapshot.size() < 16 + sizeof hash || std::memcmp(snapshot.data(), mark.data(), mark.size()) != 0) return false;
  std::memcpy(&hash, snapshot.data() + 16, sizeof hash);
  return hash == hash_of_own_schema();
}

void Editor::mark_velocity_dirty(std::uint32_t particle) {
  model.mark_velocities(model.bodies[model.particles[particle].body].articulate);
}

// Into room of the size of the last one and some more: a list that grows while it is filled is copied.
Snapshot Editor::pack(Origin origin) {
  const std::string_view schema = origin == Origin::anywhere ? own_schema_text() : std::string_view();
  std::vector<std::byte> bytes = begin_with(schema, size_of_tables_ + size_of_tables_ / 32);
  const std::size_t head = bytes.size();
  Writer writer(bytes);
  model.archive(writer);
  size_of_tables_ = bytes.size() - head;
  static const SchemaGaps gaps(own_schema());
  gaps.clear(std::span(bytes).subspan(head));
  end_seal(bytes);
  if (bytes.capacity() > bytes.size() + bytes.size() / 16) bytes.shrink_to_fit();
  return {std::move(bytes)};
}

Snapshot Editor::own_state(const Snapshot& state, std::string_view schema) {
  std::vector<std::byte> room;
  const auto tables = tables_of(state.bytes, room, schema);
  std::vector<std::byte> bytes = begin_with({}, tables.size());
  bytes.insert(bytes.end(), tables.begin(), tables.end());
  end_seal(bytes);
  Snapshot own{std::move(bytes)};
  (void)unpack(own, Origin::anywhere);
  return own;
}

Snapshot Editor::snapshot(Origin origin) {
  if (origin == Origin::anywhere) islands.renew(model);
  keys_saved_below_ = held.functions.next_key;
  return pack(origin);
}

model::Model Editor::unpack(const Snapshot& snapshot, Origin origin) {
  std::vector<std::byte> room;
  Reader reader(tables_of(snapshot.bytes, room));
  model::Model restored;
  restored.archive(reader);
  if (!reader.ok() || !reader.at_end()) throw std::invalid_argument("restore: the tables of this snapshot are damaged");
  if (origin == Origin::anywhere)
    if (const std::vector<std::string> complaints = ingredient::validate(restored); !complaints.empty())
      throw std::invalid_argument(text("restore: the tables of this snapshot do not fit together: ", complaints.front(),
                                       complaints.size() > 1 ? text(", and ", complaints.size() - 1, " more") : ""));
  return restored;
}

void Editor::restore(const Snapshot& snapshot, Origin origin) {
  model::Model restored = unpack(snapshot, origin);
  restored.take_over(model);
  model = std::move(restored);
  model.list_flagged();
  islands.forget();
  held.forget();
  orientations.forget();
}

}  // namespace iota::edit
