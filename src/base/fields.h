// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <type_traits>

namespace iota {

namespace detail {

/// Converts to any type, so that the number of fields can be counted by trying initializers.
struct Anything {
  template <class T>
  operator T() const;
};

template <class T, class... Initializers>
constexpr std::size_t count_fields() {
  if constexpr (requires { T{Initializers{}..., Anything{}}; })
    return count_fields<T, Initializers..., Anything>();
  else
    return sizeof...(Initializers);
}

}  // namespace detail

/// The number of fields of an aggregate without base classes.
template <class T>
inline constexpr std::size_t field_count = detail::count_fields<std::remove_const_t<T>>();

/// Calls visit(field) for each field of an aggregate, in order: so a struct can be saved without a list of its fields,
/// and a new field cannot be forgotten.
template <class T, class Visit>
void for_each_field(T& v, Visit visit) {
  constexpr std::size_t n = field_count<T>;
  static_assert(std::is_aggregate_v<std::remove_const_t<T>> && n <= 14, "add a line below for more fields");
  const auto all = [&](auto&... fields) { (visit(fields), ...); };
  // clang-format off
  if constexpr (n == 1) { auto& [a] = v; all(a); }
  if constexpr (n == 2) { auto& [a, b] = v; all(a, b); }
  if constexpr (n == 3) { auto& [a, b, c] = v; all(a, b, c); }
  if constexpr (n == 4) { auto& [a, b, c, d] = v; all(a, b, c, d); }
  if constexpr (n == 5) { auto& [a, b, c, d, e] = v; all(a, b, c, d, e); }
  if constexpr (n == 6) { auto& [a, b, c, d, e, f] = v; all(a, b, c, d, e, f); }
  if constexpr (n == 7) { auto& [a, b, c, d, e, f, g] = v; all(a, b, c, d, e, f, g); }
  if constexpr (n == 8) { auto& [a, b, c, d, e, f, g, h] = v; all(a, b, c, d, e, f, g, h); }
  if constexpr (n == 9) { auto& [a, b, c, d, e, f, g, h, i] = v; all(a, b, c, d, e, f, g, h, i); }
  if constexpr (n == 10) { auto& [a, b, c, d, e, f, g, h, i, j] = v; all(a, b, c, d, e, f, g, h, i, j); }
  if constexpr (n == 11) { auto& [a, b, c, d, e, f, g, h, i, j, k] = v; all(a, b, c, d, e, f, g, h, i, j, k); }
  if constexpr (n == 12) { auto& [a, b, c, d, e, f, g, h, i, j, k, l] = v; all(a, b, c, d, e, f, g, h, i, j, k, l); }
  if constexpr (n == 13) { auto& [a, b, c, d, e, f, g, h, i, j, k, l, m] = v; all(a, b, c, d, e, f, g, h, i, j, k, l, m); }
  if constexpr (n == 14) { auto& [a, b, c, d, e, f, g, h, i, j, k, l, m, o] = v; all(a, b, c, d, e, f, g, h, i, j, k, l, m, o); }
  // clang-format on
}

}  // namespace iota
