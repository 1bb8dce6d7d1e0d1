// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/archive.h"

#include <iota/log.h>

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <vector>

namespace iota::model {
struct Model;
}

namespace iota::edit {

template <class C>
void write(std::vector<std::byte>& bytes, const C& command);  // commands.h

/// The commands that `Log` gives in pieces. It cuts some by itself, since to ask for them from a script takes longer than
/// all else that a journal costs a small world. Only `take_cut` may be called on any thread.
class CommandLog {
 public:
  using Clock = std::chrono::steady_clock;

  void start(double cut_each);
  void stop();
  template <class C>
  void record(const C& command) {
    if (!is_on_ || is_broken_) return;
    write(open_, command);
    if (open_.size() > Log::most_bytes) break_off();
  }
  /// The state was replaced, which no command repeats.
  void break_off();
  void hold_cuts() { cut_at_ = Clock::time_point::max(); }
  /// After a step with no batch of edits open.
  void cut_if_due(const model::Model& m) {
    if (cut_at_ == Clock::time_point::max()) return;
    if (const Clock::time_point now = Clock::now(); now >= cut_at_) cut(m, now);
  }
  LogPiece take(const model::Model&);
  LogPiece take_cut();

 private:
  void cut(const model::Model&, Clock::time_point now);
  void append_open(LogPiece&, const model::Model&, Clock::time_point now);

  bool is_on_ = false;
  bool is_broken_ = false;
  std::vector<std::byte> open_;  // since the last cut
  Clock::duration cut_each_{};   // 0: never
  Clock::time_point cut_at_ = Clock::time_point::max(), began_;
  std::uint32_t structure_version_ = 0;  // at the last call of `take`

  std::mutex mutex_;
  LogPiece cut_;
};

}  // namespace iota::edit
