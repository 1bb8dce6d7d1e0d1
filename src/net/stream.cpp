// SPDX-License-Identifier: Apache-2.0
#include "net/stream.h"

#include <boost/asio/post.hpp>
#include <boost/asio/ssl/stream_base.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <boost/beast/ssl/ssl_stream.hpp>
#include <boost/beast/websocket/ssl.hpp>
#include <boost/beast/websocket/teardown.hpp>

#include <variant>

namespace iota::net {

namespace beast = boost::beast;
using Plain = beast::tcp_stream;
using Encrypted = beast::ssl_stream<Plain>;

namespace {

/// Runs on the executor of the stream, as all handlers do: Boost 1.81 cannot post to the erased executor of a handler.
template <class Done>
auto on_stream(Done done) {
  return [done = std::move(done)](auto... results) mutable -> void { std::move(done)(results...); };
}

}  // namespace

class Stream::Layer : public std::variant<Plain, Encrypted> {
 public:
  using std::variant<Plain, Encrypted>::variant;

  template <class Visitor>
  decltype(auto) visit(Visitor&& visitor) {
    return std::visit(std::forward<Visitor>(visitor), static_cast<std::variant<Plain, Encrypted>&>(*this));
  }
  Plain& lowest() {
    return visit([](auto& layer) -> Plain& { return beast::get_lowest_layer(layer); });
  }
};

Stream::Stream(boost::asio::ip::tcp::socket socket)
    : layer_(std::make_unique<Layer>(std::in_place_type<Plain>, std::move(socket))) {}
Stream::~Stream() = default;
Stream::Stream(Stream&&) noexcept = default;
Stream& Stream::operator=(Stream&&) noexcept = default;

Scheme Stream::scheme() const { return layer_->index() == 0 ? Scheme::http : Scheme::https; }
Stream::executor_type Stream::get_executor() { return layer_->lowest().get_executor(); }
boost::asio::ip::tcp::socket& Stream::socket() { return layer_->lowest().socket(); }
void Stream::expires_after(std::chrono::steady_clock::duration time) { layer_->lowest().expires_after(time); }
void Stream::expires_never() { layer_->lowest().expires_never(); }
void Stream::close() { layer_->lowest().close(); }

void Stream::encrypt(boost::asio::ssl::context& context) {
  Plain plain = std::move(std::get<Plain>(*layer_));
  layer_->emplace<Encrypted>(std::move(plain), context);
}

void Stream::start_handshake(boost::asio::const_buffer read, DoneHandshake done) {
  std::get<Encrypted>(*layer_).async_handshake(boost::asio::ssl::stream_base::server, read, on_stream(std::move(done)));
}

void Stream::start_read(const FirstBuffers<boost::asio::mutable_buffer>& buffers, DoneSome done) {
  layer_->visit([&](auto& layer) { layer.async_read_some(buffers, on_stream(std::move(done))); });
}

void Stream::start_write(const FirstBuffers<boost::asio::const_buffer>& buffers, DoneSome done) {
  layer_->visit([&](auto& layer) { layer.async_write_some(buffers, on_stream(std::move(done))); });
}

void Stream::start_shutdown_send(Done done) {
  if (auto* encrypted = std::get_if<Encrypted>(layer_.get()))
    return encrypted->async_shutdown(on_stream(std::move(done)));
  error_code error;
  socket().shutdown(boost::asio::ip::tcp::socket::shutdown_send, error);
  boost::asio::post(get_executor(), [done = std::move(done), error]() mutable { std::move(done)(error); });
}

void Stream::tear_down(beast::role_type role, error_code& error) {
  using beast::websocket::teardown;
  layer_->visit([&](auto& layer) { teardown(role, layer, error); });
}

void Stream::start_teardown(beast::role_type role, Done done) {
  using beast::websocket::async_teardown;
  layer_->visit([&](auto& layer) { async_teardown(role, layer, on_stream(std::move(done))); });
}

}  // namespace iota::net
