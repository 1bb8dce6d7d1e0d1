// SPDX-License-Identifier: Apache-2.0
// Access to the server: checks of Host, Origin and token, and parsing of a request's target.
//
// A page of another site can make a browser send requests to a loopback port, and can point its own name at it (DNS
// rebinding). Origin detects the first, Host the second; the token excludes other programs and users.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace iota::net {

/// "/a%20b?x=1" as path "/a b" and query "x=1".
struct RequestTarget {
  std::string path;
  std::string query;
};

/// Empty if the target is not an absolute path or is badly escaped.
std::optional<RequestTarget> parse_target(std::string_view target);

/// Unescaped value of the first `name` in a query, empty if there is none.
std::string query_value(std::string_view query, std::string_view name);

enum class Scheme : std::uint8_t { http, https };

/// The endpoint of a request.
struct Endpoint {
  std::string bound_host;     ///< as given to the server
  std::string local_address;  ///< address literal of this connection on our side
  std::uint16_t port = 0;
  Scheme scheme = Scheme::http;
};

/// The reason to refuse a Host header, or nothing. Allowed: localhost, 127.0.0.1, [::1], the bound host, and the
/// address of the connection, each with our port. (An address literal is safe: rebinding needs a name.)
std::optional<std::string> refuse_host(std::string_view host, const Endpoint& endpoint);

/// The reason to refuse an Origin header, or nothing: it must be our own page's, "http://" or "https://" and the Host.
std::optional<std::string> refuse_origin(std::string_view origin, Scheme scheme, std::string_view host);

}  // namespace iota::net
