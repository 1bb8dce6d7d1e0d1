// SPDX-License-Identifier: Apache-2.0
// Requests of HTTP that the program answers, beside the files of the page: lists, pictures, metrics, commands of a page.
#pragma once

#include "net/server.h"

#include <cstdint>
#include <functional>
#include <map>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

namespace iota::net {

/// The requests that wait for the program. From any thread, except where noted.
class Requests {
 public:
  using Take = std::function<void(Answer)>;

  /// is_open: as of `Server::serve_requests`.
  void serve(std::vector<std::string> paths, bool is_open = false);
  bool serves(const std::string& path) const;
  bool is_open(const std::string& path) const;

  /// `take` is called with the answer on the server's thread, at most once. Returns the number of the request.
  std::uint64_t add(Request request, Take take);
  /// Nobody waits for the answer any more.
  void remove(std::uint64_t number);

  /// The requests since the last call, in order of arrival.
  std::vector<Request> take();
  /// Called on the server's thread. Without effect if nobody waits.
  void answer(std::uint64_t number, Answer answer);

 private:
  mutable std::mutex mutex_;
  std::map<std::string, bool> is_open_;  // by path
  std::vector<Request> untaken_;
  std::map<std::uint64_t, Take> waiting_;
  std::uint64_t last_ = 0;
};

}  // namespace iota::net
