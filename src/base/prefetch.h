// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

namespace iota {

/// Asks for all memory of an object that is needed soon. A walk over large objects in no order waits for one line of memory after another
/// otherwise, as no processor guesses the next object.
template <class T>
void prefetch([[maybe_unused]] const T& object) {
#if defined(__GNUC__)
  constexpr std::size_t line = 64;
  const char* const begin = reinterpret_cast<const char*>(&object);
  for (std::size_t at = 0; at < sizeof(T); at += line) __builtin_prefetch(begin + at);
  __builtin_prefetch(begin + sizeof(T) - 1);
#endif
}

}  // namespace iota
