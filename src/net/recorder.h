// SPDX-License-Identifier: Apache-2.0
// Records what the viewers of a world are sent, as a viewer that nobody sees. Messages to single clients are not in it.
#pragma once

#include "net/hub.h"
#include "net/updates.h"

#include <chrono>
#include <cstddef>
#include <mutex>
#include <span>
#include <vector>

namespace iota::net {

class Recorder final : public ClientLink {
 public:
  /// `hub` must outlive its use of the recorder. pose_time: between two recorded poses, at least.
  Recorder(Hub& hub, std::chrono::duration<double> pose_time) : hub_(hub), pose_time_(pose_time) {}

  // By the hub, on the server's thread.
  void send(const Frame& frame, std::string_view key) override;
  void world_changed() override;
  void drop(std::string_view) override {}
  void world_ended() override {}

  /// The messages since the last call, from any thread. While `max_waiting_bytes` wait, entities and poses are skipped:
  /// they are recorded in their state at a later time.
  std::vector<RecordedMessage> take();

  static constexpr std::size_t max_waiting_bytes = 16 << 20;

 private:
  using Clock = std::chrono::steady_clock;
  void add(std::span<const std::uint8_t> bytes);
  bool has_room();

  Hub& hub_;
  const std::chrono::duration<double> pose_time_;
  const Clock::time_point began_ = Clock::now();
  Clock::time_point next_pose_ = began_;
  Updates updates_;

  std::mutex mutex_;
  std::vector<RecordedMessage> waiting_;
  std::size_t waiting_bytes_ = 0;
};

}  // namespace iota::net
