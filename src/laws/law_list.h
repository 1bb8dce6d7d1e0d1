// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <tuple>
#include <utility>

namespace iota::laws {

struct Parameter;

/// A list of laws, each a type with a `name` and `parameters`, addressed by number.
template <class Laws>
struct LawList {
  static constexpr std::uint32_t count = std::tuple_size_v<Laws>;

  /// Calls visit.operator()<Law>() with the law of that number; does nothing beyond the end of the list.
  template <class Visit>
  static void visit(std::uint32_t number, Visit visit) {
    [&]<std::size_t... I>(std::index_sequence<I...>) {
      ((number == I ? visit.template operator()<std::tuple_element_t<I, Laws>>() : void()), ...);
    }(std::make_index_sequence<count>{});
  }
  static const char* name(std::uint32_t number) {
    const char* name = "";
    visit(number, [&]<class Law>() { name = Law::name; });
    return name;
  }
  static std::span<const Parameter> parameters(std::uint32_t number) {
    std::span<const Parameter> list;
    visit(number, [&]<class Law>() { list = Law::parameters; });
    return list;
  }
  /// Number of the law of that name; `count` for an unknown name.
  static std::uint32_t find(std::string_view name) {
    std::uint32_t number = 0;
    while (number < count && name != LawList::name(number)) ++number;
    return number;
  }
};

}  // namespace iota::laws
