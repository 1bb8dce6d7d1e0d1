// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

namespace iota::shape {

/// A shape as plain data, for tables and commands. The object of a key is outside the tables.
struct Data {
  std::uint32_t kind = 0, padding = 0;  ///< number in the list
  std::array<double, 4> sizes{};        ///< in the order of the list, those of three numbers as three
  std::uint64_t key = 0;                ///< of a mesh, by its content
};

}  // namespace iota::shape
