// SPDX-License-Identifier: Apache-2.0
// One TCP connection: serves files of the page until the client asks for a WebSocket, then frames. Internal to the
// server: only this header and its two .cpp files use Boost.
#pragma once

#include "net/access.h"
#include "net/hub.h"
#include "net/server.h"

#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/ssl/context.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace iota::net {

/// The state of a connection. Those that are not welcomed yet are not trusted and share few places.
enum class Standing : std::uint8_t {
  idle,      ///< nothing complete was received yet, or since the last answer
  served,    ///< a file is on its way to it
  welcomed,  ///< a client
};

/// A connection that the server can ask to end.
class OpenConnection {
 public:
  /// Sends the queue, then closes.
  virtual void finish() = 0;
  /// Closes immediately, to make room.
  virtual void evict() = 0;
  virtual Standing standing() const = 0;

 protected:
  ~OpenConnection() = default;
};

class Relays;
class Requests;

/// Shared by all connections. Outlives them; used on the server's thread only.
struct ConnectionContext {
  const ServerOptions& options;
  Counters& counters;
  boost::asio::ssl::context* tls;  ///< null: plain http for all
  /// The hub for a hello, or none and the reason.
  std::function<std::pair<std::shared_ptr<Hub>, std::string>(const std::string& world)> find_world;
  Relays& relays;      ///< worlds of other processes
  Requests& requests;  ///< that the program answers
  std::uint16_t port = 0;
  std::vector<OpenConnection*> open;  ///< the oldest first
  bool is_finishing = false;
  std::function<void()> on_all_closed;  ///< called when the last one closes while finishing

  void opened(OpenConnection& connection) { open.push_back(&connection); }
  bool is_open(OpenConnection* connection) const { return std::ranges::find(open, connection) != open.end(); }
  void closed(OpenConnection& connection) {
    std::erase(open, &connection);
    if (is_finishing && open.empty() && on_all_closed) on_all_closed();
  }
};

/// The TLS context of a certificate; null for an empty one. Throws std::invalid_argument for a damaged one.
std::unique_ptr<boost::asio::ssl::context> make_tls(const Certificate& certificate);

/// Takes over an accepted socket; the connection keeps itself alive during its operations.
void start_connection(boost::asio::ip::tcp::socket socket, ConnectionContext& context);

}  // namespace iota::net
