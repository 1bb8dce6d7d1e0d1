// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>
#include <type_traits>

namespace iota {

/// Cores that this process may use, at least 1.
int available_threads();

/// Work shared among threads (oneTBB). Calls that run at the same time must touch different data; then results do not
/// depend on the number of threads or their order. With one thread all calls run in order on the caller's.
class Parallel {
 public:
  /// threads: their number, including the calling one; 0: all cores.
  explicit Parallel(int threads = 0);
  ~Parallel();
  Parallel(Parallel&&) noexcept;
  Parallel& operator=(Parallel&&) noexcept;

  int threads() const { return threads_; }

  /// Calls work(i) once for every i in [0, count), at most `grain` of them in one task. `work` must not throw.
  /// Runs serially with one thread or one grain. Allocates nothing when warm.
  template <class Work>
  void for_each(std::size_t count, std::size_t grain, Work&& work) const {
    if (threads_ == 1 || count <= grain) {
      for (std::size_t i = 0; i < count; ++i) work(i);
      return;
    }
    using Function = std::remove_reference_t<Work>;
    run(count, grain, const_cast<void*>(static_cast<const void*>(&work)),
        [](void* function, std::size_t i) { (*static_cast<Function*>(function))(i); });
  }

 private:
  void run(std::size_t count, std::size_t grain, void* work, void (*call)(void*, std::size_t)) const;

  int threads_ = 1;
  struct Arena;  // made when first needed
  mutable std::unique_ptr<Arena> arena_;
};

}  // namespace iota
