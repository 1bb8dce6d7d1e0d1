// SPDX-License-Identifier: Apache-2.0
// A TCP connection that may be encrypted, with a time limit: one type for http and https, so that sessions are no
// templates. Satisfies Asio's AsyncReadStream and AsyncWriteStream, and Beast's requirements for WebSocket.
//
// Handlers and buffers lose their types here, so that Beast's operations on both layers are compiled once, in
// stream.cpp, and not again for every operation of a session (which took 80 of a unit's 100 s).
#pragma once

#include "net/access.h"

#include <boost/asio/any_completion_handler.hpp>
#include <boost/asio/buffer.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/ssl/context.hpp>
#include <boost/beast/core/role.hpp>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstddef>
#include <memory>
#include <utility>

namespace iota::net {

class Stream {
  using error_code = boost::system::error_code;
  using Done = boost::asio::any_completion_handler<void(error_code)>;
  using DoneSome = boost::asio::any_completion_handler<void(error_code, std::size_t)>;
  using DoneHandshake = boost::asio::any_completion_handler<void(error_code), void(error_code, std::size_t)>;

  /// The first buffers of any sequence: reading or writing "some" may leave the rest.
  template <class Buffer>
  class FirstBuffers {
   public:
    using value_type = Buffer;
    template <class Buffers>
    explicit FirstBuffers(const Buffers& buffers) {
      const auto end = boost::asio::buffer_sequence_end(buffers);
      for (auto it = boost::asio::buffer_sequence_begin(buffers); it != end && count_ < kept_.size(); ++it)
        if (const Buffer buffer(*it); buffer.size() > 0) kept_[count_++] = buffer;
    }
    const Buffer* begin() const { return kept_.data(); }
    const Buffer* end() const { return kept_.data() + count_; }

   private:
    std::array<Buffer, 8> kept_{};
    std::size_t count_ = 0;
  };

 public:
  using executor_type = boost::asio::any_io_executor;

  explicit Stream(boost::asio::ip::tcp::socket socket);
  ~Stream();
  Stream(Stream&&) noexcept;
  Stream& operator=(Stream&&) noexcept;

  Scheme scheme() const;
  executor_type get_executor();
  boost::asio::ip::tcp::socket& socket();
  const boost::asio::ip::tcp::socket& socket() const { return const_cast<Stream*>(this)->socket(); }
  void expires_after(std::chrono::steady_clock::duration time);
  void expires_never();
  /// Closes immediately, without a shutdown.
  void close();

  /// Encrypts from now on; a handshake has to follow.
  void encrypt(boost::asio::ssl::context& context);
  /// `read`: bytes read already, the start of the handshake. The handler gets the number of used ones; it must be
  /// callable without that, too, as Beast 1.81 checks by mistake.
  template <class Handler>
  void async_handshake(boost::asio::const_buffer read, Handler&& handler) {
    start_handshake(read, DoneHandshake(std::forward<Handler>(handler)));
  }

  template <class Buffers, class Handler>
  void async_read_some(const Buffers& buffers, Handler&& handler) {
    start_read(FirstBuffers<boost::asio::mutable_buffer>(buffers), DoneSome(std::forward<Handler>(handler)));
  }
  template <class Buffers, class Handler>
  void async_write_some(const Buffers& buffers, Handler&& handler) {
    start_write(FirstBuffers<boost::asio::const_buffer>(buffers), DoneSome(std::forward<Handler>(handler)));
  }

  /// Tells the client that no more data will be sent.
  template <class Handler>
  void async_shutdown_send(Handler&& handler) {
    start_shutdown_send(Done(std::forward<Handler>(handler)));
  }

  // Called by Beast's WebSocket, found by argument-dependent lookup.
  friend void beast_close_socket(Stream& stream) { stream.close(); }
  friend void teardown(boost::beast::role_type role, Stream& stream, error_code& error) {
    stream.tear_down(role, error);
  }
  template <class Handler>
  friend void async_teardown(boost::beast::role_type role, Stream& stream, Handler&& handler) {
    stream.start_teardown(role, Done(std::forward<Handler>(handler)));
  }

 private:
  class Layer;

  void start_handshake(boost::asio::const_buffer read, DoneHandshake done);
  void start_read(const FirstBuffers<boost::asio::mutable_buffer>& buffers, DoneSome done);
  void start_write(const FirstBuffers<boost::asio::const_buffer>& buffers, DoneSome done);
  void start_shutdown_send(Done done);
  void tear_down(boost::beast::role_type role, error_code& error);
  void start_teardown(boost::beast::role_type role, Done done);

  std::unique_ptr<Layer> layer_;
};

}  // namespace iota::net
