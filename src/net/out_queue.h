// SPDX-License-Identifier: Apache-2.0
// Frames that wait for one client. Frames that carry the whole of something (a scene key, the list of clients) have a
// key and replace an unsent frame of that key; the others (notices, effects) add up, to a cap.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace iota::net {

/// One encoded message, shared by all clients that it waits for.
using Frame = std::shared_ptr<const std::vector<std::uint8_t>>;

class OutQueue {
 public:
  explicit OutQueue(std::size_t max_bytes) : max_bytes_(max_bytes) {}

  /// False, and nothing queued, when the frames without a key would exceed the cap.
  [[nodiscard]] bool push(Frame frame, std::string_view key = {});
  /// The oldest frame; the queue must not be empty.
  Frame pop();
  bool empty() const { return waiting_.empty(); }
  void clear();

 private:
  struct Waiting {
    Frame frame;
    std::string key;
  };
  std::deque<Waiting> waiting_;
  std::size_t max_bytes_;
  std::size_t unkeyed_bytes_ = 0;
};

}  // namespace iota::net
