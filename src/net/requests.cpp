// SPDX-License-Identifier: Apache-2.0
#include "net/requests.h"

#include <algorithm>
#include <utility>

namespace iota::net {

void Requests::serve(std::vector<std::string> paths, bool is_open) {
  const std::lock_guard lock(mutex_);
  for (std::string& path : paths) is_open_[std::move(path)] = is_open;
}

bool Requests::serves(const std::string& path) const {
  const std::lock_guard lock(mutex_);
  return is_open_.contains(path);
}

bool Requests::is_open(const std::string& path) const {
  const std::lock_guard lock(mutex_);
  const auto found = is_open_.find(path);
  return found != is_open_.end() && found->second;
}

std::uint64_t Requests::add(Request request, Take take) {
  const std::lock_guard lock(mutex_);
  request.number = ++last_;
  waiting_.emplace(last_, std::move(take));
  untaken_.push_back(std::move(request));
  return last_;
}

void Requests::remove(std::uint64_t number) {
  const std::lock_guard lock(mutex_);
  waiting_.erase(number);
  std::erase_if(untaken_, [number](const Request& each) { return each.number == number; });
}

std::vector<Request> Requests::take() {
  const std::lock_guard lock(mutex_);
  return std::exchange(untaken_, {});
}

void Requests::answer(std::uint64_t number, Answer answer) {
  Take take;
  {
    const std::lock_guard lock(mutex_);
    const auto found = waiting_.find(number);
    if (found == waiting_.end()) return;
    take = std::move(found->second);
    waiting_.erase(found);
  }
  take(std::move(answer));
}

}  // namespace iota::net
