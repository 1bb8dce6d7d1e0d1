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
  std::string public_origin = {};  ///< of a proxy in front of this server, such as https://worlds.example.org
};

/// Whether a Host header is that of a public origin.
bool is_public_host(std::string_view host, std::string_view public_origin);

/// A public origin in small letters: http:// or https://, a name, perhaps a port. Throws std::invalid_argument for others.
std::string checked_origin(std::string_view origin);

/// The reason to refuse a Host header, or nothing. Allowed: localhost, 127.0.0.1, [::1], the bound host, and the
/// address of the connection, each with our port (an address literal is safe: rebinding needs a name); and that of the
/// public origin.
std::optional<std::string> refuse_host(std::string_view host, const Endpoint& endpoint);

/// The reason to refuse an Origin header, or nothing: it must be our own page's, "http://" or "https://" and the Host, or
/// the public origin if the Host is.
std::optional<std::string> refuse_origin(std::string_view origin, Scheme scheme, std::string_view host,
                                         std::string_view public_origin = {});

}  // namespace iota::net
