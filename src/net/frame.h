// SPDX-License-Identifier: Apache-2.0
// A message as it goes over the wire to clients.
#pragma once

#include <iota_protocol.h>

#include <cstdint>
#include <memory>
#include <vector>

namespace iota::net {

/// One encoded message, shared by the queues of all clients.
using Frame = std::shared_ptr<const std::vector<std::uint8_t>>;

template <class Message>
Frame make_frame(const Message& message) {
  return std::make_shared<const std::vector<std::uint8_t>>(protocol::encode(message));
}

inline constexpr float farthest = 1e9F;  ///< coordinate of any place, m: the engine's limit

}  // namespace iota::net
