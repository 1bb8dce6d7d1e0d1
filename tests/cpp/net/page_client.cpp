// SPDX-License-Identifier: Apache-2.0
#include "net/page_client.h"

#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/read.hpp>
#include <boost/asio/write.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>

namespace iota::test {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using asio::ip::tcp;
using error_code = boost::system::error_code;

tcp::endpoint loopback(std::uint16_t port) { return {asio::ip::address_v4::loopback(), port}; }

beast::string_view view(std::string_view text) { return {text.data(), text.size()}; }

}  // namespace

HttpAnswer http_request(std::uint16_t port, std::string_view method, std::string_view target, const Headers& headers) {
  asio::io_context io;
  tcp::socket socket(io);
  error_code error;
  socket.connect(loopback(port), error);
  if (error) return {};
  http::request<http::empty_body> request;
  request.method_string(view(method));
  request.target(view(target));
  request.version(11);
  request.set(http::field::host, "localhost:" + std::to_string(port));
  for (const auto& [name, value] : headers) request.set(name, value);
  http::write(socket, request, error);
  beast::flat_buffer buffer;
  http::response_parser<http::string_body> parser;
  parser.skip(method == "HEAD");
  http::read(socket, buffer, parser, error);
  if (error) return {};
  HttpAnswer answer{parser.get().result_int(), {}, parser.get().body()};
  for (const auto& field : parser.get()) answer.headers[std::string(field.name_string())] = std::string(field.value());
  return answer;
}

std::string raw_request(std::uint16_t port, std::string_view bytes, std::chrono::milliseconds patience) {
  asio::io_context io;
  tcp::socket socket(io);
  error_code error;
  socket.connect(loopback(port), error);
  asio::write(socket, asio::buffer(bytes.data(), bytes.size()), error);
  std::string answer;
  asio::async_read(socket, asio::dynamic_buffer(answer), [](error_code, std::size_t) {});
  io.run_for(patience);
  socket.close();
  io.restart();
  io.run();
  return answer;
}

struct PageClient::Implementation {
  asio::io_context io;
  websocket::stream<tcp::socket> socket{io};
  beast::flat_buffer buffer;
  bool is_reading = false, has_frame = false, is_closed = true;
  bool is_small = false;

  void read() {
    is_reading = true;
    socket.async_read(buffer, [this](error_code error, std::size_t) {
      is_reading = false;
      if (error) {
        is_closed = true;
      } else {
        has_frame = true;
      }
    });
  }

  bool send(asio::const_buffer bytes, bool is_binary) {
    if (is_closed) return false;
    bool is_done = false;
    error_code result;
    socket.binary(is_binary);
    socket.async_write(bytes, [&](error_code error, std::size_t) {
      is_done = true;
      result = error;
    });
    io.restart();
    while (!is_done && io.run_one() > 0) {
    }
    return !result;
  }
};

PageClient::PageClient() : implementation_(std::make_unique<Implementation>()) {}
PageClient::~PageClient() { cut(); }

void PageClient::use_small_buffer() { implementation_->is_small = true; }

unsigned PageClient::connect(std::uint16_t port, std::string_view target, std::string_view host,
                             std::string_view origin) {
  auto& socket = implementation_->socket;
  error_code error;
  socket.next_layer().open(tcp::v4(), error);
  if (implementation_->is_small) socket.next_layer().set_option(asio::socket_base::receive_buffer_size(16384), error);
  socket.next_layer().connect(loopback(port), error);
  if (error) return 0;
  socket.next_layer().set_option(tcp::no_delay(true), error);
  socket.read_message_max(64 * 1024 * 1024);
  socket.set_option(websocket::stream_base::decorator([origin = std::string(origin)](websocket::request_type& request) {
    if (!origin.empty()) request.set(http::field::origin, origin);
  }));
  websocket::response_type response;
  const std::string host_header = host.empty() ? "localhost:" + std::to_string(port) : std::string(host);
  socket.handshake(response, host_header, view(target), error);
  implementation_->is_closed = static_cast<bool>(error);
  return response.result_int();
}

bool PageClient::send(std::span<const std::uint8_t> frame) {
  return implementation_->send(asio::buffer(frame.data(), frame.size()), true);
}

bool PageClient::send_text(std::string_view text) {
  return implementation_->send(asio::buffer(text.data(), text.size()), false);
}

std::optional<std::vector<std::uint8_t>> PageClient::receive(std::chrono::milliseconds patience) {
  Implementation& self = *implementation_;
  if (!self.is_reading && !self.has_frame && !self.is_closed) self.read();
  const auto end = std::chrono::steady_clock::now() + patience;
  self.io.restart();
  while (!self.has_frame && !self.is_closed && self.io.run_one_until(end) > 0) {
  }
  if (!self.has_frame) return std::nullopt;
  self.has_frame = false;
  const auto data = self.buffer.cdata();
  const auto* first = static_cast<const std::uint8_t*>(data.data());
  std::vector<std::uint8_t> frame(first, first + data.size());
  self.buffer.consume(self.buffer.size());
  return frame;
}

bool PageClient::is_closed() const { return implementation_->is_closed; }
unsigned PageClient::close_code() const { return implementation_->socket.reason().code; }
std::string PageClient::close_reason() const {
  const auto& reason = implementation_->socket.reason().reason;
  return {reason.data(), reason.size()};
}

void PageClient::cut() {
  error_code ignored;
  implementation_->socket.next_layer().close(ignored);
  implementation_->is_closed = true;
  implementation_->io.restart();
  implementation_->io.run();
}

}  // namespace iota::test
