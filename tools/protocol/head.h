// SPDX-License-Identifier: Apache-2.0
// Made by tools/generate_protocol.py from protocol/schema.json; changes here are lost.
//
// Messages between server and page: little-endian, the first byte is the message's type. Records of entities travel in
// entities_set, one after the other. encode() and append_record() throw std::length_error (string or array above its limit) or
// std::invalid_argument (a float that is not finite). decode_...() never throws for bad
// bytes: it checks bounds, counts, UTF-8, enumerators, finite floats and trailing bytes,
// and gives a message or a reason.
#pragma once

#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>
#include <variant>
#include <vector>

namespace iota::protocol {

using Vec3 = std::array<float, 3>;
/// x y z w.
using Quat = std::array<float, 4>;

/// Names an entity among those of its kind: a slot is used again under another generation. Null: generation 0.
struct Id {
  std::uint32_t slot = 0, generation = 0;
  explicit operator bool() const { return generation != 0; }
  auto fields() const { return std::tie(slot, generation); }
  bool operator==(const Id&) const = default;
};

/// The server lets viewers send a message, tells them that they only watch, or ignores it.
enum class Viewers : std::uint8_t { allowed, told, ignored };

/// The name of a type in iota._protocol; only of the types in what a script is told of clients.
template <class T>
inline constexpr const char* record_name = nullptr;
template <>
inline constexpr const char* record_name<Id> = "Id";

/// A decoded message, or the reason why there is none.
template <class T>
struct Decoded {
  std::optional<T> value;
  std::string error;
  explicit operator bool() const { return value.has_value(); }
};
