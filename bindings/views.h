// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iota/system.h>

#include <cstddef>
#include <tuple>

namespace iota::bindings {

/// The view of a system that an id belongs to, for code that is written once for several kinds of ids.
template <std::size_t first = 0, class IdType>
auto view_of(System& system, IdType id) {
  using V = std::tuple_element_t<first, Views>;
  if constexpr (requires(const V& view) { view.contains(id); })
    return system.view<V>();
  else
    return view_of<first + 1>(system, id);
}

}  // namespace iota::bindings
