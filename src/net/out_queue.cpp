// SPDX-License-Identifier: Apache-2.0
#include "net/out_queue.h"

#include <utility>

namespace iota::net {

bool OutQueue::push(Frame frame, std::string_view key) {
  if (key.empty()) {
    if (unkeyed_bytes_ + frame->size() > max_bytes_) return false;
    unkeyed_bytes_ += frame->size();
  } else {
    for (Waiting& waiting : waiting_) {
      if (waiting.key != key) continue;
      waiting.frame = std::move(frame);
      return true;
    }
  }
  waiting_.push_back({std::move(frame), std::string(key)});
  return true;
}

Frame OutQueue::pop() {
  Waiting first = std::move(waiting_.front());
  waiting_.pop_front();
  if (first.key.empty()) unkeyed_bytes_ -= first.frame->size();
  return std::move(first.frame);
}

void OutQueue::clear() {
  waiting_.clear();
  unkeyed_bytes_ = 0;
}

}  // namespace iota::net
