// SPDX-License-Identifier: Apache-2.0
// Worlds that other processes of this machine serve: a gallery passes the WebSockets of their clients on to them, after
// its own checks of Host, Origin and token. So one world cannot slow the others, or end them.
#pragma once

#include "net/connection.h"
#include "net/stream.h"

#include <boost/beast/http/empty_body.hpp>
#include <boost/beast/http/message.hpp>

#include <array>
#include <cstdint>
#include <map>
#include <mutex>
#include <optional>
#include <string>

namespace iota::net {

/// The worlds, by id. From any thread.
class Relays {
 public:
  struct Target {
    std::uint16_t port = 0;  ///< of the process, on the loopback address; 0: it does not run yet, and clients wait
    std::array<std::string, 3> tokens;  ///< its own, by role
  };
  void set(const std::string& world, Target target);
  void remove(const std::string& world);
  std::optional<Target> find(const std::string& world) const;
  /// Connections that are passed on, or wait.
  int visitors(const std::string& world) const;
  void count(const std::string& world, int change);

 private:
  mutable std::mutex mutex_;
  std::map<std::string, Target> targets_;
  std::map<std::string, int> visitors_;
};

/// Passes on a request for a WebSocket of `world`, and then all bytes in both directions.
void start_relay(Stream stream, const boost::beast::http::request<boost::beast::http::empty_body>& request,
                 const std::string& world, protocol::Role role, ConnectionContext& context);

}  // namespace iota::net
