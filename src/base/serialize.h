// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/archive.h"
#include "base/fields.h"

#include <array>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

namespace iota {

/// The enumerator with the largest value; enumerators start at 0 without gaps. A specialization beside the enum makes
/// it serializable: a number beyond it is refused when it is read.
template <class Enum>
struct LastEnumerator;

namespace detail {

template <class T>
inline constexpr bool is_array = false;
template <class T, std::size_t n>
inline constexpr bool is_array<std::array<T, n>> = true;
template <class T>
inline constexpr bool is_list = std::is_same_v<T, std::string>;
template <class T>
inline constexpr bool is_list<std::vector<T>> = true;
template <class T>
inline constexpr bool is_variant = false;
template <class... Ts>
inline constexpr bool is_variant<std::variant<Ts...>> = true;

/// Makes a variant hold a default value of its index-th alternative.
template <class... Ts>
void emplace(std::variant<Ts...>& v, std::size_t index) {
  [&]<std::size_t... i>(std::index_sequence<i...>) {
    ((i == index ? (void)v.template emplace<i>() : void()), ...);
  }(std::index_sequence_for<Ts...>{});
}

}  // namespace detail

/// Writes or reads anything made of numbers, enums, strings, vectors, arrays, variants and plain structs of these, field
/// by field: padding is never saved. A Reader fails at truth values other than 0 and 1, at enumerators and alternatives
/// that do not exist and at counts above the remaining bytes; it allocates no more than these bytes need.
template <class Archive, class T>
void serialize(Archive& ar, T& v) {
  using Plain = std::remove_const_t<T>;
  constexpr bool reads = std::is_same_v<Archive, Reader>;
  // A number below `count`.
  const auto index = [&]<class Number>(Number number, std::size_t count) {
    ar.value(number);
    if (static_cast<std::size_t>(number) < count) return number;
    ar.fail();
    return Number{};
  };
  if constexpr (std::is_same_v<Plain, bool>) {
    const bool is_true = index(static_cast<std::uint8_t>(v), 2);
    if constexpr (reads) v = is_true;
  } else if constexpr (std::is_enum_v<Plain>) {
    using Number = std::make_unsigned_t<std::underlying_type_t<Plain>>;
    const auto number = index(static_cast<Number>(v), static_cast<std::size_t>(LastEnumerator<Plain>::value) + 1);
    if constexpr (reads) v = static_cast<Plain>(number);
  } else if constexpr (std::is_arithmetic_v<Plain>) {
    ar.value(v);
  } else if constexpr (detail::is_array<Plain>) {
    for (auto& item : v) serialize(ar, item);
  } else if constexpr (detail::is_list<Plain>) {
    if constexpr (reads) {
      v.clear();
      for (std::size_t left = ar.count(1); left > 0 && ar.ok(); --left) {
        v.push_back({});
        serialize(ar, v.back());
      }
    } else {
      ar.value(static_cast<std::uint64_t>(v.size()));
      for (auto& item : v) serialize(ar, item);
    }
  } else if constexpr (detail::is_variant<Plain>) {
    static_assert(std::variant_size_v<Plain> <= 256);
    const auto alternative = index(static_cast<std::uint8_t>(v.index()), std::variant_size_v<Plain>);
    if constexpr (reads) detail::emplace(v, alternative);
    std::visit([&](auto& item) { serialize(ar, item); }, v);
  } else {
    for_each_field(v, [&](auto& field) { serialize(ar, field); });
  }
}

}  // namespace iota
