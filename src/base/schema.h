// SPDX-License-Identifier: Apache-2.0
// The meaning of the bytes of an archive: its items by name, and the fields of their records by name and type. With the schema
// that an older program has written, its bytes are translated into those of the present one.
#pragma once

#include "base/fields.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace iota {

struct Schema {
  /// `count` numbers, one after the other. kind: u unsigned, i signed, f floating.
  struct Field {
    std::string name;
    char kind = 'u';
    std::uint32_t size = 1, offset = 0, count = 1;
    friend bool operator==(const Field&, const Field&) = default;
  };
  struct Record {
    std::uint32_t size = 0;
    std::vector<Field> fields;
    std::vector<std::byte> standard;  ///< a record with the values of a new one; not in the text
    friend bool operator==(const Record&, const Record&) = default;
  };
  /// kind: v a value, l the number of records (u64) and the records, m meshes as letter I of snapshots had them.
  struct Item {
    std::string name;
    char kind = 'v';
    std::uint32_t record = 0;
  };
  std::vector<Record> records;
  std::vector<Item> items;

  std::string text() const;
  /// Throws std::invalid_argument for a text that is not of a schema.
  static Schema from_text(std::string_view text);
};

/// Bytes of a schema `from` as those of `to`. Items and fields are found by their names: unknown ones are left out, and
/// missing ones are as in `standard`, the bytes of a new object. Numbers change their type. Throws std::invalid_argument for bytes that
/// do not fit their schema, or whose translation is much larger than they are.
std::vector<std::byte> translate(const Schema& from, std::span<const std::byte> bytes, const Schema& to,
                                 std::span<const std::byte> standard);

/// The bytes between the fields of the records of an archive, which are whatever the memory held before.
class SchemaGaps {
 public:
  /// Without meshes of letter I.
  explicit SchemaGaps(const Schema& schema);
  /// Sets them to 0. Throws std::invalid_argument for bytes that do not fit the schema.
  void clear(std::span<std::byte> bytes) const;

 private:
  struct Run {
    std::size_t offset, size;
  };
  struct Item {
    bool is_list;
    std::size_t size;  ///< of a record
    std::vector<Run> runs;
  };
  std::vector<Item> items_;
};

/// A specialization names the fields of a struct: `visit(value, see)` calls see(name, field) for each. See IOTA_FIELDS.
template <class T>
struct FieldNames;

#define IOTA_PARENTHESES ()
#define IOTA_EXPAND(...) IOTA_EXPAND_3(IOTA_EXPAND_3(IOTA_EXPAND_3(IOTA_EXPAND_3(__VA_ARGS__))))
#define IOTA_EXPAND_3(...) IOTA_EXPAND_2(IOTA_EXPAND_2(IOTA_EXPAND_2(IOTA_EXPAND_2(__VA_ARGS__))))
#define IOTA_EXPAND_2(...) IOTA_EXPAND_1(IOTA_EXPAND_1(IOTA_EXPAND_1(IOTA_EXPAND_1(__VA_ARGS__))))
#define IOTA_EXPAND_1(...) __VA_ARGS__
#define IOTA_SEE_EACH(field, ...) \
  see(#field, v.field);           \
  __VA_OPT__(IOTA_SEE_AGAIN IOTA_PARENTHESES(__VA_ARGS__))
#define IOTA_SEE_AGAIN() IOTA_SEE_EACH
/// In namespace iota: the names of the fields of a struct that are saved, also inherited ones.
#define IOTA_FIELDS(Type, ...)                  \
  template <>                                   \
  struct FieldNames<Type> {                     \
    template <class See>                        \
    static void visit(const Type& v, See see) { \
      IOTA_EXPAND(IOTA_SEE_EACH(__VA_ARGS__))   \
    }                                           \
  };

namespace detail {

template <class T>
concept HasFields = requires(const T& v) { FieldNames<T>::visit(v, [](const char*, const auto&) {}); };

template <class T>
inline constexpr bool is_number = std::is_arithmetic_v<T> || std::is_enum_v<T>;

template <class T>
constexpr char kind_of_number() {
  if constexpr (std::is_enum_v<T>)
    return std::is_signed_v<std::underlying_type_t<T>> ? 'i' : 'u';
  else if constexpr (std::is_floating_point_v<T>)
    return 'f';
  else
    return std::is_signed_v<T> ? 'i' : 'u';
}

template <class T>
inline constexpr bool is_numbers = false;
template <class T, std::size_t n>
inline constexpr bool is_numbers<std::array<T, n>> = is_number<T>;
template <class T>
inline constexpr bool is_some_array = false;
template <class T, std::size_t n>
inline constexpr bool is_some_array<std::array<T, n>> = true;

/// Adds the fields of a value that begins at an offset.
template <class T>
void add_fields(const T& v, const std::string& name, const std::byte* begin, std::vector<Schema::Field>& fields) {
  const auto offset = [&](const auto& part) {
    return static_cast<std::uint32_t>(reinterpret_cast<const std::byte*>(&part) - begin);
  };
  const std::string prefix = name.empty() ? name : name + ".";
  if constexpr (is_number<T>) {
    fields.push_back({name, kind_of_number<T>(), sizeof(T), offset(v), 1});
  } else if constexpr (is_numbers<T>) {
    using Number = typename T::value_type;
    fields.push_back({name, kind_of_number<Number>(), sizeof(Number), offset(v), static_cast<std::uint32_t>(v.size())});
  } else if constexpr (is_some_array<T>) {
    for (std::size_t i = 0; i < v.size(); ++i) add_fields(v[i], prefix + std::to_string(i), begin, fields);
  } else if constexpr (HasFields<T>) {
    FieldNames<T>::visit(v,
                         [&](const char* each, const auto& field) { add_fields(field, prefix + each, begin, fields); });
  } else {
    std::vector<Schema::Field> own;
    int number = 0;
    for_each_field(v, [&](const auto& field) { add_fields(field, std::to_string(number++), begin, own); });
    bool is_uniform = true;  // as vectors and ids: one field
    for (const auto& each : own) is_uniform = is_uniform && each.kind == own[0].kind && each.size == own[0].size;
    is_uniform = is_uniform && own.size() <= 4 && own.size() * own[0].size == sizeof(T);
    if (is_uniform)
      fields.push_back({name, own[0].kind, own[0].size, own[0].offset, static_cast<std::uint32_t>(own.size())});
    else
      for (auto& each : own) fields.push_back({prefix + each.name, each.kind, each.size, each.offset, each.count});
  }
}

template <class T>
Schema::Record record_of() {
  const T v{};
  const auto* begin = reinterpret_cast<const std::byte*>(&v);
  Schema::Record record{sizeof(T), {}, std::vector<std::byte>(sizeof(T))};
  add_fields(v, "", begin, record.fields);
  for (const Schema::Field& field : record.fields)  // without the bytes between the fields, which may be anything
    std::memcpy(record.standard.data() + field.offset, begin + field.offset, std::size_t{field.size} * field.count);
  return record;
}

}  // namespace detail

/// An archive like `Writer` that makes the schema.
class SchemaWriter {
 public:
  explicit SchemaWriter(Schema& schema) : schema_(schema) {}
  /// The name of the items that follow; several are numbered.
  void name(std::string_view name) { name_ = name, number_ = 0; }
  template <class T>
  void value(const T&) {
    add(detail::record_of<T>(), 'v');
  }
  template <class T>
  void vector(const std::vector<T>&) {
    add(detail::record_of<T>(), 'l');
  }
  void fail() {}

 private:
  void add(Schema::Record record, char kind) {
    const auto found = std::ranges::find(schema_.records, record);
    const auto index = static_cast<std::uint32_t>(found - schema_.records.begin());
    if (found == schema_.records.end()) schema_.records.push_back(std::move(record));
    schema_.items.push_back({name_ + "." + std::to_string(number_++), kind, index});
  }
  Schema& schema_;
  std::string name_;
  int number_ = 0;
};

}  // namespace iota
