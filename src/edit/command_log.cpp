// SPDX-License-Identifier: Apache-2.0
#include "edit/command_log.h"

#include "ingredient/model.h"

#include <utility>

namespace iota::edit {

void CommandLog::start(double cut_each) {
  stop();
  is_on_ = true;
  cut_each_ = std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(cut_each));
  began_ = Clock::now();
}

void CommandLog::stop() {
  is_on_ = is_broken_ = false;
  open_.clear();
  hold_cuts();
  (void)take_cut();
}

void CommandLog::break_off() {
  if (!is_on_) return;
  is_broken_ = true;
  open_.clear();
  hold_cuts();
}

void CommandLog::cut(const model::Model& m, Clock::time_point now) {
  if (m.structure_version != structure_version_) {
    hold_cuts();
    return;
  }
  cut_at_ = now + cut_each_;
  const std::lock_guard lock(mutex_);
  if (cut_.commands.size() + open_.size() > Log::most_bytes)
    break_off();
  else
    append_open(cut_, m, now);
}

void CommandLog::append_open(LogPiece& piece, const model::Model& m, Clock::time_point now) {
  piece.seconds += std::chrono::duration<double>(now - std::exchange(began_, now)).count();
  piece.time = m.time;
  piece.ended = now;
  if (open_.empty()) return;
  piece.commands.insert(piece.commands.end(), open_.begin(), open_.end());
  piece.hash = m.quick_hash();
  open_.clear();
}

LogPiece CommandLog::take(const model::Model& m) {
  const Clock::time_point now = Clock::now();
  LogPiece piece = take_cut();
  append_open(piece, m, now);
  piece.is_broken = std::exchange(is_broken_, false);
  if (piece.is_broken) piece.commands.clear(), piece.hash = 0;
  structure_version_ = m.structure_version;
  if (is_on_ && cut_each_.count() > 0) cut_at_ = now + cut_each_;
  return piece;
}

LogPiece CommandLog::take_cut() {
  const std::lock_guard lock(mutex_);
  return std::exchange(cut_, {});
}

}  // namespace iota::edit
