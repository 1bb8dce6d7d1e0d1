// SPDX-License-Identifier: Apache-2.0
#include "tests/cpp/allocations.h"

#include <cstdlib>
#include <new>

namespace iota {
std::atomic<long> allocations{0}, allocated_bytes{0};
}

namespace {
void count(std::size_t size) { ++iota::allocations, iota::allocated_bytes += static_cast<long>(size); }
}  // namespace

// Counting is all these do; the default ones are not callable once replaced.
void* operator new(std::size_t size) {
  count(size);
  if (void* p = std::malloc(size ? size : 1)) return p;
  throw std::bad_alloc();
}
void* operator new(std::size_t size, const std::nothrow_t&) noexcept {  // as std::stable_sort asks
  count(size);
  return std::malloc(size ? size : 1);
}
void operator delete(void* p) noexcept { std::free(p); }
void operator delete(void* p, std::size_t) noexcept { std::free(p); }
