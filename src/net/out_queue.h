// SPDX-License-Identifier: Apache-2.0
// Queued frames of one client. Frames with a complete state (settings, the list of clients) have a key and replace an
// unsent frame of that key; the others (notices, effects) are queued, up to a limit.
#pragma once

#include "net/frame.h"

#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace iota::net {

class OutQueue {
 public:
  explicit OutQueue(std::size_t max_bytes) : max_bytes_(max_bytes) {}

  /// False, and nothing is queued, if the frames without a key would exceed the limit.
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
