// SPDX-License-Identifier: Apache-2.0
#include "net/updates.h"

#include "net/hub.h"

namespace iota::net {
namespace {

using namespace std::chrono_literals;

constexpr auto keyframe_time = 1s;
constexpr std::uint8_t body_kind = entity_kind<protocol::BodyEntity>();

}  // namespace

std::optional<std::span<const std::uint8_t>> Updates::next(Hub& hub) {
  if (entities_.empty() && sent_entities_ != hub.entities().version()) {
    const std::vector<Frame>& frames = hub.entities().frames_since(sent_entities_);
    entities_.assign(frames.begin(), frames.end());
    sent_entities_ = hub.entities().version();
  }
  if (!entities_.empty()) {
    outgoing_ = std::move(entities_.front());
    entities_.pop_front();
    return *outgoing_;
  }
  if (sent_pose_ == hub.pose_number()) return std::nullopt;
  if (sent_pose_ != 0) skipped_ += hub.pose_number() - sent_pose_ - 1;
  sent_pose_ = hub.pose_number();
  const auto now = std::chrono::steady_clock::now();
  delta_.encode(hub.poses(), hub.entities().generations(body_kind), now - keyframe_sent_ >= keyframe_time, pose_bytes_);
  if (delta_.last_was_keyframe()) keyframe_sent_ = now;
  return pose_bytes_;
}

}  // namespace iota::net
