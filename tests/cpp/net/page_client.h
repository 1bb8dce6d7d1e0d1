// SPDX-License-Identifier: Apache-2.0
// A client for tests of the server: a plain interface, so that only one unit compiles Beast.
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace iota::test {

struct HttpAnswer {
  unsigned status = 0;  ///< 0: no answer, the connection was closed
  std::map<std::string, std::string> headers;
  std::string body;
};

using Headers = std::map<std::string, std::string>;

/// One request on a new connection. Host is "localhost:PORT" unless `headers` gives another.
HttpAnswer http_request(std::uint16_t port, std::string_view method, std::string_view target,
                        const Headers& headers = {});

/// Writes `bytes` to a new TCP connection and gives what comes back until it closes or `patience` is over.
std::string raw_request(std::uint16_t port, std::string_view bytes,
                        std::chrono::milliseconds patience = std::chrono::milliseconds(300));

class PageClient {
 public:
  PageClient();
  ~PageClient();
  PageClient(const PageClient&) = delete;
  PageClient& operator=(const PageClient&) = delete;

  /// Upgrades; gives the status, 101 when it went well. `host` and `origin` as headers; no Origin when empty.
  unsigned connect(std::uint16_t port, std::string_view target, std::string_view host = {},
                   std::string_view origin = {});
  /// False when the connection is closed.
  bool send(std::span<const std::uint8_t> frame);
  bool send_text(std::string_view text);
  /// The next frame, or nothing when none comes in time or the connection is closed.
  std::optional<std::vector<std::uint8_t>> receive(
      std::chrono::milliseconds patience = std::chrono::milliseconds(2000));
  bool is_closed() const;
  /// Code and reason of the server's close frame, once closed.
  unsigned close_code() const;
  std::string close_reason() const;
  /// Cuts the connection without a word.
  void cut();
  /// A small receive buffer, so that a client that does not read is felt soon. Before connect().
  void use_small_buffer();

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace iota::test
