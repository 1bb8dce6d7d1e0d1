// SPDX-License-Identifier: Apache-2.0
// The stream of a connection over real sockets; encrypted ones are in server_test.cpp.
#include "net/stream.h"

#include <boost/asio/connect.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/read.hpp>
#include <boost/asio/write.hpp>

#include <gtest/gtest.h>

#include <array>
#include <chrono>
#include <optional>
#include <string>
#include <vector>

namespace iota::net {
namespace {

using boost::asio::ip::tcp;

/// A stream and the plain socket at its other end.
struct Connected {
  boost::asio::io_context io;
  tcp::socket far{io};
  std::optional<Stream> stream;

  Connected() {
    tcp::acceptor acceptor(io, {boost::asio::ip::address_v4::loopback(), 0});
    far.connect(acceptor.local_endpoint());
    stream.emplace(acceptor.accept());
  }
};

TEST(Stream, reads_and_writes_several_buffers_at_once) {
  Connected c;
  boost::asio::write(c.far, boost::asio::buffer("abcdef", 6));
  std::array<char, 2> first{};
  std::array<char, 4> second{};
  const std::array<boost::asio::mutable_buffer, 3> into{boost::asio::buffer(first), boost::asio::mutable_buffer{},
                                                        boost::asio::buffer(second)};
  std::size_t received = 0;
  c.stream->async_read_some(into, [&](boost::system::error_code error, std::size_t size) {
    EXPECT_FALSE(error);
    received = size;
  });
  c.io.run();
  EXPECT_EQ(received, 6u);
  EXPECT_EQ(std::string(first.data(), 2) + std::string(second.data(), 4), "abcdef");

  const std::array<boost::asio::const_buffer, 2> from{boost::asio::buffer(second), boost::asio::buffer(first)};
  std::size_t sent = 0;
  c.io.restart();
  c.stream->async_write_some(from, [&](boost::system::error_code, std::size_t size) { sent = size; });
  c.io.run();
  std::string back(sent, ' ');
  boost::asio::read(c.far, boost::asio::buffer(back));
  EXPECT_EQ(back, "cdefab");
}

TEST(Stream, that_has_more_buffers_than_it_keeps_writes_the_first_ones) {
  Connected c;
  const std::string letter = "x";
  const std::vector<boost::asio::const_buffer> many(20, boost::asio::buffer(letter));
  std::size_t sent = 0;
  c.stream->async_write_some(many, [&](boost::system::error_code, std::size_t size) { sent = size; });
  c.io.run();
  EXPECT_GE(sent, 1u);
  EXPECT_LE(sent, 20u);
}

TEST(Stream, tells_the_other_end_that_no_more_comes) {
  Connected c;
  bool is_done = false;
  c.stream->async_shutdown_send([&](boost::system::error_code error) { is_done = !error; });
  c.io.run();
  EXPECT_TRUE(is_done);
  char byte = 0;
  boost::system::error_code error;
  (void)c.far.read_some(boost::asio::buffer(&byte, 1), error);
  EXPECT_EQ(error, boost::asio::error::eof);
}

TEST(Stream, gives_up_after_its_time) {
  Connected c;
  c.stream->expires_after(std::chrono::milliseconds(20));
  std::array<char, 4> into{};
  boost::system::error_code error;
  c.stream->async_read_some(boost::asio::buffer(into), [&](boost::system::error_code e, std::size_t) { error = e; });
  c.io.run();
  EXPECT_TRUE(error);
}

}  // namespace
}  // namespace iota::net
