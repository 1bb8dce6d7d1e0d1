// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "net/entity_store.h"
#include "net/pose_encoder.h"

#include <chrono>
#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace iota::net {

class Hub;

/// The entities and poses of a world that one viewer has not been sent. Poses are encoded when they are asked for, so
/// they are the newest, and always of the last body that was sent for a slot.
class Updates {
 public:
  /// The next message, entities before poses, or none if there is nothing new. Valid until the next call.
  std::optional<std::span<const std::uint8_t>> next(Hub& hub);
  /// Number of poses since the last call that were replaced by newer ones before they were asked for.
  std::uint64_t take_skipped() { return std::exchange(skipped_, 0); }

 private:
  std::deque<Frame> entities_;
  Frame outgoing_;
  std::vector<std::uint8_t> pose_bytes_;
  PoseDelta delta_;
  std::uint64_t sent_entities_ = 0;  ///< version
  std::uint64_t sent_pose_ = 0;      ///< number
  std::uint64_t skipped_ = 0;
  std::chrono::steady_clock::time_point keyframe_sent_;
};

}  // namespace iota::net
