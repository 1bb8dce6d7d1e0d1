// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "binders.h"

#include <tuple>
#include <utility>

namespace iota::bindings {

/// The members of a value as a tuple, and back. ValueError for the length of another version.
template <class T, class... Members>
nb::tuple get_state(const T& value, const std::tuple<Members T::*...>& members) {
  return std::apply([&](auto... member) { return nb::make_tuple(value.*member...); }, members);
}
template <class T, class... Members>
void set_state(T& value, const std::tuple<Members T::*...>& members, nb::handle state) {
  const auto items = nb::cast<nb::tuple>(state);
  if (items.size() != sizeof...(Members)) throw nb::value_error("this was pickled by another version of Iota");
  [&]<std::size_t... i>(std::index_sequence<i...>) {
    ((value.*std::get<i>(members) = nb::cast<Members>(items[i])), ...);
  }(std::index_sequence_for<Members...>{});
}

/// Makes a plain value picklable and copyable by these members.
template <class T, class... Members>
void def_pickled(nb::class_<T>& type, Members T::*... members) {
  const std::tuple all{members...};
  type.def(
          "__getstate__", [all](const T& self) { return get_state(self, all); },
          nb::sig("def __getstate__(self) -> tuple[typing.Any, ...]"))
      .def(
          "__setstate__", [all](T& self, nb::handle state) { set_state(*new (&self) T{}, all, state); },
          nb::sig("def __setstate__(self, state: tuple[typing.Any, ...], /) -> None"));
}

}  // namespace iota::bindings
