// SPDX-License-Identifier: Apache-2.0
#include "net/server.h"

#include "net/connection.h"
#include "net/hub.h"

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>

#include <chrono>
#include <exception>
#include <stdexcept>
#include <system_error>
#include <thread>
#include <utility>

namespace iota::net {
namespace {

namespace asio = boost::asio;
using asio::ip::tcp;
using error_code = boost::system::error_code;
using namespace std::chrono_literals;

constexpr auto farewell_time = 250ms;
constexpr auto accept_pause = 100ms;

[[noreturn]] void fail(const error_code& error, const std::string& what) { throw std::system_error(error, what); }

std::string place_of(const ServerOptions& options) { return options.host + " port " + std::to_string(options.port); }

ServerOptions checked(ServerOptions options) {
  if (options.token.empty()) throw std::invalid_argument("the server needs a token");
  protocol::encode(protocol::Welcome{protocol::protocol_version, options.world, 1, options.dt});  // throws
  return options;
}

error_code try_listen(tcp::acceptor& acceptor, const tcp::endpoint& endpoint) {
  error_code error;
  acceptor.open(endpoint.protocol(), error);
  if (error) return error;
#ifndef _WIN32
  // Else a restart would have to wait for connections of the one before to be forgotten. (On Windows the option would
  // allow two servers on one port.)
  acceptor.set_option(asio::socket_base::reuse_address(true), error);
#endif
  acceptor.bind(endpoint, error);
  if (!error) acceptor.listen(asio::socket_base::max_listen_connections, error);
  return error;
}

/// A socket that listens, on the first of the host's addresses that lets it. Throws std::system_error.
tcp::acceptor listen(asio::io_context& io, const ServerOptions& options) {
  error_code error;
  tcp::resolver resolver(io);
  const auto found = resolver.resolve(options.host, std::to_string(options.port), tcp::resolver::passive, error);
  if (error) fail(error, "cannot find the address of host '" + options.host + "'");
  for (const auto& entry : found) {
    tcp::acceptor acceptor(io);
    error = try_listen(acceptor, entry.endpoint());
    if (!error) return acceptor;
    if (error == asio::error::address_in_use) break;  // not on another address instead: the user would not find it
  }
  if (error == asio::error::address_in_use) fail(error, place_of(options) + " is taken, choose another port");
  fail(error, "cannot listen on " + place_of(options));
}

}  // namespace

struct Server::Implementation {
  explicit Implementation(ServerOptions given)
      : options(checked(std::move(given))),
        hub(options.world, options.dt, options.max_clients),
        context{options, hub, 0, {}, false, {}},
        acceptor(listen(io, options)),
        timer(io) {
    context.port = acceptor.local_endpoint().port();
    context.on_all_closed = [this] { io.stop(); };
    accept();
    thread = std::thread([this] { run(); });
  }

  ~Implementation() {
    asio::post(io, [this] { finish(); });
    thread.join();
    context.on_all_closed = nullptr;  // connections that are left go with io
  }
  Implementation(const Implementation&) = delete;
  Implementation& operator=(const Implementation&) = delete;

  void run() {
    for (;;) {
      try {
        io.run();
        return;
      } catch (const std::exception&) {
        // Out of memory in one client's handler: that client is lost with its handler, the others go on.
      }
    }
  }

  void accept() {
    acceptor.async_accept([this](error_code error, tcp::socket socket) {
      if (context.is_finishing) return;
      if (!error) {
        start_connection(std::move(socket), context);
        return accept();
      }
      // Mostly: no file descriptor left. Trying again at once would only burn time.
      timer.expires_after(accept_pause);
      timer.async_wait([this](error_code) {
        if (!context.is_finishing) accept();
      });
    });
  }

  void finish() {
    context.is_finishing = true;
    error_code ignored;
    acceptor.close(ignored);
    timer.expires_after(farewell_time);
    timer.async_wait([this](error_code) { io.stop(); });
    const auto open = context.open;  // closing may take some out
    for (OpenConnection* connection : open) {
      if (context.open.contains(connection)) connection->finish();
    }
    if (context.open.empty()) io.stop();
  }

  void deliver_if(bool is_due) {
    if (is_due) asio::post(io, [this] { hub.deliver(); });
  }

  const ServerOptions options;
  Hub hub;
  ConnectionContext context;
  asio::io_context io{1};  // destroyed first: handlers own connections, which refer to the members above
  tcp::acceptor acceptor;
  asio::steady_timer timer;
  std::thread thread;
};

Server::Server(ServerOptions options) : implementation_(std::make_unique<Implementation>(std::move(options))) {}
Server::~Server() = default;

std::uint16_t Server::port() const { return implementation_->context.port; }

std::string Server::url() const {
  std::string host = implementation_->options.host;
  if (host == "0.0.0.0" || host == "::" || host.empty()) host = "127.0.0.1";
  if (host.find(':') != std::string::npos) host = "[" + host + "]";
  return "http://" + host + ":" + std::to_string(port()) + "/?token=" + implementation_->options.token;
}

void Server::publish(const PoseSnapshot& snapshot) {
  implementation_->deliver_if(implementation_->hub.publish(snapshot));
}

void Server::publish_structure(std::uint32_t structure_version, std::span<const BodyArticulate> articulates) {
  implementation_->deliver_if(implementation_->hub.publish_structure(structure_version, articulates));
}

void Server::set_scene(std::string_view key, std::string_view json) {
  implementation_->deliver_if(implementation_->hub.set_scene(key, json));
}

void Server::notice(std::uint32_t client, std::uint8_t level, std::string_view title, std::string_view text,
                    std::string_view hint) {
  implementation_->deliver_if(implementation_->hub.notice(client, level, title, text, hint));
}

void Server::effect(std::string_view kind, const Vec3f& position) {
  implementation_->deliver_if(implementation_->hub.effect(kind, position));
}

std::vector<InputEvent> Server::take_input() { return implementation_->hub.take_input(); }

ServerStatistics Server::statistics() const {
  const Counters& now = implementation_->hub.counters();
  return {now.clients,        now.bytes_sent,       now.frames_sent,    now.frames_dropped,
          now.frames_refused, now.upgrades_refused, now.clients_dropped};
}

}  // namespace iota::net
