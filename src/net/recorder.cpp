// SPDX-License-Identifier: Apache-2.0
#include "net/recorder.h"

#include <algorithm>
#include <utility>

namespace iota::net {

void Recorder::send(const Frame& frame, std::string_view) { add(*frame); }

void Recorder::world_changed() {
  const auto now = Clock::now();
  if (now < next_pose_ || !has_room()) return;
  const auto interval = std::chrono::duration_cast<Clock::duration>(pose_time_);
  next_pose_ = std::max(next_pose_ + interval, now);  // keeps the rate if this call is a little late
  while (const auto bytes = updates_.next(hub_)) add(*bytes);
}

std::vector<RecordedMessage> Recorder::take() {
  const std::lock_guard lock(mutex_);
  waiting_bytes_ = 0;
  return std::exchange(waiting_, {});
}

void Recorder::add(std::span<const std::uint8_t> bytes) {
  const double time = std::chrono::duration<double>(Clock::now() - began_).count();
  const std::lock_guard lock(mutex_);
  waiting_.push_back({time, {bytes.begin(), bytes.end()}});
  waiting_bytes_ += bytes.size();
}

bool Recorder::has_room() {
  const std::lock_guard lock(mutex_);
  return waiting_bytes_ < max_waiting_bytes;
}

}  // namespace iota::net
