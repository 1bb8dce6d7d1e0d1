// SPDX-License-Identifier: Apache-2.0
// A TCP connection that may be encrypted, with a time limit: one type for http and https, so that sessions are no
// templates. Satisfies Asio's AsyncReadStream and AsyncWriteStream, and Beast's requirements for WebSocket.
#pragma once

#include "net/access.h"

#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/ssl/context.hpp>
#include <boost/asio/ssl/stream_base.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <boost/beast/ssl/ssl_stream.hpp>
#include <boost/beast/websocket/ssl.hpp>
#include <boost/beast/websocket/teardown.hpp>

#include <chrono>
#include <utility>
#include <variant>

namespace iota::net {

class Stream {
  using Plain = boost::beast::tcp_stream;
  using Encrypted = boost::beast::ssl_stream<Plain>;
  using error_code = boost::system::error_code;

 public:
  using executor_type = Plain::executor_type;

  explicit Stream(boost::asio::ip::tcp::socket socket) : layer_(std::in_place_type<Plain>, std::move(socket)) {}

  Scheme scheme() const { return std::holds_alternative<Plain>(layer_) ? Scheme::http : Scheme::https; }
  executor_type get_executor() { return lowest().get_executor(); }
  boost::asio::ip::tcp::socket& socket() { return lowest().socket(); }
  const boost::asio::ip::tcp::socket& socket() const { return const_cast<Stream*>(this)->lowest().socket(); }
  void expires_after(std::chrono::steady_clock::duration time) { lowest().expires_after(time); }
  void expires_never() { lowest().expires_never(); }
  /// Closes immediately, without a shutdown.
  void close() { lowest().close(); }

  /// Encrypts from now on; a handshake has to follow.
  void encrypt(boost::asio::ssl::context& context) {
    Plain plain = std::move(std::get<Plain>(layer_));
    layer_.emplace<Encrypted>(std::move(plain), context);
  }
  /// `read`: bytes read already, the start of the handshake. The handler gets the number of used ones; it must be
  /// callable without that, too, as Beast 1.81 checks by mistake.
  template <class Buffers, class Handler>
  void async_handshake(const Buffers& read, Handler&& handler) {
    std::get<Encrypted>(layer_).async_handshake(boost::asio::ssl::stream_base::server, read,
                                                std::forward<Handler>(handler));
  }

  template <class Buffers, class Handler>
  void async_read_some(const Buffers& buffers, Handler&& handler) {
    std::visit([&](auto& layer) { layer.async_read_some(buffers, std::forward<Handler>(handler)); }, layer_);
  }
  template <class Buffers, class Handler>
  void async_write_some(const Buffers& buffers, Handler&& handler) {
    std::visit([&](auto& layer) { layer.async_write_some(buffers, std::forward<Handler>(handler)); }, layer_);
  }

  /// Tells the client that no more data will be sent.
  template <class Handler>
  void async_shutdown_send(Handler&& handler) {
    if (auto* encrypted = std::get_if<Encrypted>(&layer_)) {
      return encrypted->async_shutdown(std::forward<Handler>(handler));
    }
    error_code error;
    socket().shutdown(boost::asio::ip::tcp::socket::shutdown_send, error);
    boost::asio::post(get_executor(), [handler = std::forward<Handler>(handler), error]() mutable { handler(error); });
  }

  // Called by Beast's WebSocket, found by argument-dependent lookup.
  friend void beast_close_socket(Stream& stream) { stream.close(); }
  friend void teardown(boost::beast::role_type role, Stream& stream, error_code& error) {
    using boost::beast::websocket::teardown;
    std::visit([&](auto& layer) { teardown(role, layer, error); }, stream.layer_);
  }
  template <class Handler>
  friend void async_teardown(boost::beast::role_type role, Stream& stream, Handler&& handler) {
    using boost::beast::websocket::async_teardown;
    std::visit([&](auto& layer) { async_teardown(role, layer, std::forward<Handler>(handler)); }, stream.layer_);
  }

 private:
  Plain& lowest() {
    return std::visit([](auto& layer) -> Plain& { return boost::beast::get_lowest_layer(layer); }, layer_);
  }

  std::variant<Plain, Encrypted> layer_;
};

}  // namespace iota::net
