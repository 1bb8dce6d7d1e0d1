// SPDX-License-Identifier: Apache-2.0
#include "base/schema.h"

#include "base/archive.h"

#include <algorithm>
#include <bit>
#include <limits>
#include <map>
#include <sstream>
#include <stdexcept>

namespace iota {
namespace {

constexpr std::size_t most_text = 1 << 20, most_entries = 4096;
constexpr std::uint32_t most_size = 1 << 20;
constexpr std::size_t most_growth = 64, least_room = 16 << 20;  // of a translation

[[noreturn]] void refuse_schema() { throw std::invalid_argument("restore: the schema of this snapshot is damaged"); }
[[noreturn]] void refuse_tables() {
  throw std::invalid_argument("restore: the tables of this snapshot do not fit their schema");
}

/// A word without spaces, not too long.
std::string schema_word(std::istream& in) {
  std::string found;
  if (!(in >> found) || found.size() > 200) refuse_schema();
  return found;
}

std::uint32_t schema_number(std::istream& in, std::uint32_t most) {
  std::uint64_t found = 0;
  if (!(in >> found) || found > most) refuse_schema();
  return static_cast<std::uint32_t>(found);
}

char schema_kind(std::istream& in, std::string_view kinds) {
  const std::string found = schema_word(in);
  if (found.size() != 1 || kinds.find(found[0]) == std::string_view::npos) refuse_schema();
  return found[0];
}

Schema::Field schema_field(std::istream& in, std::uint32_t record_size) {
  Schema::Field field;
  field.name = schema_word(in);
  field.kind = schema_kind(in, "uif");
  field.size = schema_number(in, 8);
  field.offset = schema_number(in, record_size);
  field.count = schema_number(in, record_size);
  const bool is_size = field.kind == 'f' ? field.size == 4 || field.size == 8 : std::has_single_bit(field.size);
  if (!is_size || field.offset + std::uint64_t{field.size} * field.count > record_size) refuse_schema();
  return field;
}

/// The bytes of an item at the beginning of `rest`, which are taken away from it. Of a list without its count.
struct SchemaPart {
  const Schema::Item* item = nullptr;
  std::uint64_t count = 1;
  std::span<const std::byte> bytes;
};

class SchemaCursor {
 public:
  explicit SchemaCursor(std::span<const std::byte> bytes) : bytes_(bytes) {}
  std::span<const std::byte> take(std::uint64_t size) {
    if (size > bytes_.size()) refuse_tables();
    const auto taken = bytes_.first(size);
    bytes_ = bytes_.subspan(size);
    return taken;
  }
  std::uint64_t take_count(std::uint64_t item_size) {
    std::uint64_t count = 0;
    std::memcpy(&count, take(sizeof count).data(), sizeof count);
    if (count > bytes_.size() / std::max<std::uint64_t>(item_size, 1)) refuse_tables();
    return count;
  }
  std::span<const std::byte> rest() const { return bytes_; }

 private:
  std::span<const std::byte> bytes_;
};

/// Meshes as letter I had them: their number; of each its key and two words, vertices and triangles.
std::span<const std::byte> take_old_meshes(SchemaCursor& cursor) {
  const auto begin = cursor.rest();
  for (std::uint64_t left = cursor.take_count(16); left > 0; --left) {
    (void)cursor.take(16);
    (void)cursor.take(24 * cursor.take_count(24));
    (void)cursor.take(12 * cursor.take_count(12));
  }
  return begin.first(begin.size() - cursor.rest().size());
}

std::vector<SchemaPart> schema_parts(const Schema& schema, std::span<const std::byte> bytes) {
  SchemaCursor cursor(bytes);
  std::vector<SchemaPart> parts;
  for (const Schema::Item& item : schema.items) {
    SchemaPart part{&item, 1, {}};
    const std::uint64_t size = schema.records[item.record].size;
    if (item.kind == 'm') {
      part.bytes = take_old_meshes(cursor);
      part.count = part.bytes.size();
    } else {
      if (item.kind == 'l') part.count = cursor.take_count(size);
      part.bytes = cursor.take(part.count * size);
    }
    parts.push_back(part);
  }
  if (!cursor.rest().empty()) refuse_tables();
  return parts;
}

template <class Visit>
void with_number_type(char kind, std::uint32_t size, Visit visit) {
  if (kind == 'f') return size == 4 ? visit(float{}) : visit(double{});
  const bool is_signed = kind == 'i';
  switch (size) {
    case 1: return is_signed ? visit(std::int8_t{}) : visit(std::uint8_t{});
    case 2: return is_signed ? visit(std::int16_t{}) : visit(std::uint16_t{});
    case 4: return is_signed ? visit(std::int32_t{}) : visit(std::uint32_t{});
    default: return is_signed ? visit(std::int64_t{}) : visit(std::uint64_t{});
  }
}

/// A number in another type. One that it cannot have becomes zero.
template <class To, class From>
To number_as(From value) {
  if constexpr (std::is_floating_point_v<To>) {
    return static_cast<To>(value);
  } else {
    const auto exact = static_cast<long double>(value);
    const bool fits = exact >= static_cast<long double>(std::numeric_limits<To>::min()) &&
                      exact <= static_cast<long double>(std::numeric_limits<To>::max());
    return fits ? static_cast<To>(value) : To{};
  }
}

/// The bytes to copy from a record of one schema to that of another.
struct FieldCopy {
  const Schema::Field *from, *to;

  void run(const std::byte* source, std::byte* target) const {
    const std::uint32_t count = std::min(from->count, to->count);
    source += from->offset, target += to->offset;
    if (from->kind == to->kind && from->size == to->size) {
      std::memcpy(target, source, std::size_t{count} * to->size);
      return;
    }
    with_number_type(from->kind, from->size, [&]<class From>(From) {
      with_number_type(to->kind, to->size, [&]<class To>(To) {
        for (std::uint32_t i = 0; i < count; ++i) {
          From value;
          std::memcpy(&value, source + i * sizeof value, sizeof value);
          const To other = number_as<To>(value);
          std::memcpy(target + i * sizeof other, &other, sizeof other);
        }
      });
    });
  }
};

std::vector<FieldCopy> field_copies(const Schema::Record& from, const Schema::Record& to) {
  std::map<std::string_view, const Schema::Field*> by_name;
  for (const Schema::Field& field : from.fields) by_name.emplace(field.name, &field);
  std::vector<FieldCopy> all;
  for (const Schema::Field& field : to.fields)
    if (const auto found = by_name.find(field.name); found != by_name.end()) all.push_back({found->second, &field});
  return all;
}

}  // namespace

std::string Schema::text() const {
  std::ostringstream out;
  out << "schema " << records.size() << ' ' << items.size() << '\n';
  for (const Record& record : records) {
    out << record.size << ' ' << record.fields.size() << '\n';
    for (const Field& field : record.fields)
      out << (field.name.empty() ? "-" : field.name) << ' ' << field.kind << ' ' << field.size << ' ' << field.offset
          << ' ' << field.count << '\n';
  }
  for (const Item& item : items) out << item.name << ' ' << item.kind << ' ' << item.record << '\n';
  return out.str();
}

Schema Schema::from_text(std::string_view text) {
  if (text.size() > most_text) refuse_schema();
  std::istringstream in{std::string(text)};
  if (schema_word(in) != "schema") refuse_schema();
  Schema schema;
  const std::uint32_t record_count = schema_number(in, most_entries), item_count = schema_number(in, most_entries);
  for (std::uint32_t left = record_count; left > 0; --left) {
    Record record;
    record.size = schema_number(in, most_size);
    for (std::uint32_t fields = schema_number(in, most_entries); fields > 0; --fields)
      record.fields.push_back(schema_field(in, record.size));
    for (Field& field : record.fields)
      if (field.name == "-") field.name.clear();
    schema.records.push_back(std::move(record));
  }
  for (std::uint32_t left = item_count; left > 0; --left) {
    Item item;
    item.name = schema_word(in);
    item.kind = schema_kind(in, "vlm");
    item.record = schema_number(in, record_count);
    if (item.record >= record_count) refuse_schema();
    schema.items.push_back(std::move(item));
  }
  return schema;
}

SchemaGaps::SchemaGaps(const Schema& schema) {
  for (const Schema::Item& item : schema.items) {
    const Schema::Record& record = schema.records[item.record];
    std::vector<Schema::Field> fields = record.fields;
    std::ranges::sort(fields, {}, &Schema::Field::offset);
    Item& made = items_.emplace_back(Item{item.kind == 'l', record.size, {}});
    std::size_t end = 0;
    const auto add = [&](std::size_t next) {
      if (next > end) made.runs.push_back({end, next - end});
    };
    for (const Schema::Field& field : fields) {
      add(field.offset);
      end = std::max(end, field.offset + std::size_t{field.size} * field.count);
    }
    add(record.size);
  }
}

void SchemaGaps::clear(std::span<std::byte> bytes) const {
  const auto take = [&](std::size_t size) {
    if (size > bytes.size()) refuse_tables();
    const auto taken = bytes.first(size);
    bytes = bytes.subspan(size);
    return taken.data();
  };
  for (const Item& item : items_) {
    std::uint64_t count = 1;
    if (item.is_list) std::memcpy(&count, take(sizeof count), sizeof count);
    if (count > bytes.size() / std::max<std::size_t>(item.size, 1)) refuse_tables();
    std::byte* begin = take(count * item.size);
    for (const Run& run : item.runs)
      for (std::uint64_t i = 0; i < count; ++i) std::memset(begin + i * item.size + run.offset, 0, run.size);
  }
}

std::vector<std::byte> translate(const Schema& from, std::span<const std::byte> bytes, const Schema& to,
                                 std::span<const std::byte> standard) {
  std::map<std::string_view, SchemaPart> by_name;
  for (const SchemaPart& part : schema_parts(from, bytes)) by_name.emplace(part.item->name, part);
  const std::size_t room = most_growth * bytes.size() + least_room;
  std::vector<std::byte> out;
  Writer writer(out);
  const auto append = [&](std::span<const std::byte> more) { out.insert(out.end(), more.begin(), more.end()); };
  for (const SchemaPart& usual : schema_parts(to, standard)) {
    const Schema::Item& item = *usual.item;
    const Schema::Record& record = to.records[item.record];
    const auto found = by_name.find(item.name);
    const bool is_old_meshes = found != by_name.end() && found->second.item->kind == 'm' && item.kind == 'l';
    if (found == by_name.end() || (found->second.item->kind != item.kind && !is_old_meshes)) {
      if (item.kind == 'l') writer.value(usual.count);
      append(usual.bytes);
      continue;
    }
    const SchemaPart& part = found->second;
    if (item.kind == 'l') writer.value(part.count);
    if (is_old_meshes) {
      append(part.bytes);
      continue;
    }
    if (part.count > (room - std::min(room, out.size())) / std::max(record.size, 1U)) refuse_tables();
    const Schema::Record& old = from.records[part.item->record];
    const std::vector<FieldCopy> all = field_copies(old, record);
    for (std::uint64_t i = 0; i < part.count; ++i) {
      const std::size_t at = out.size();
      append(record.standard);
      for (const FieldCopy& copy : all) copy.run(part.bytes.data() + i * old.size, out.data() + at);
    }
  }
  return out;
}

}  // namespace iota
