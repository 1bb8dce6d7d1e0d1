// SPDX-License-Identifier: Apache-2.0
#include "net/access.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <stdexcept>

namespace iota::net {
namespace {

std::string lower(std::string_view text) {
  std::string out(text);
  std::transform(out.begin(), out.end(), out.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  return out;
}

std::optional<std::string> unescape(std::string_view text) {
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '%') {
      out += text[i];
      continue;
    }
    unsigned byte = 0;
    if (i + 2 >= text.size()) return std::nullopt;
    const auto [end, error] = std::from_chars(text.data() + i + 1, text.data() + i + 3, byte, 16);
    if (error != std::errc() || end != text.data() + i + 3) return std::nullopt;
    out += static_cast<char>(byte);
    i += 2;
  }
  return out;
}

struct HostAndPort {
  std::string host;
  std::uint16_t port = 0;
};

std::string prefix(Scheme scheme) { return scheme == Scheme::https ? "https://" : "http://"; }

/// "[::1]:8080", "localhost:8080" or "localhost".
std::optional<HostAndPort> split_host(std::string_view text, Scheme scheme) {
  const std::size_t bracket = text.rfind(']');
  const std::size_t colon = text.find(':', bracket == std::string_view::npos ? 0 : bracket);
  HostAndPort out;
  out.port = scheme == Scheme::https ? 443 : 80;
  out.host = lower(text.substr(0, colon));
  if (!out.host.empty() && out.host.back() == '.') out.host.pop_back();
  if (out.host.empty()) return std::nullopt;
  if (colon == std::string_view::npos) return out;
  const char* first = text.data() + colon + 1;
  const char* last = text.data() + text.size();
  const auto [end, error] = std::from_chars(first, last, out.port);
  if (error != std::errc() || end != last) return std::nullopt;
  return out;
}

/// The form of an address or name in a Host header.
std::string in_header(std::string_view host) {
  return host.find(':') == std::string_view::npos ? lower(host) : std::string("[").append(lower(host)).append("]");
}

}  // namespace

std::optional<RequestTarget> parse_target(std::string_view target) {
  if (target.empty() || target.front() != '/') return std::nullopt;
  target = target.substr(0, target.find('#'));
  const std::size_t mark = target.find('?');
  auto path = unescape(target.substr(0, mark));
  if (!path) return std::nullopt;
  return RequestTarget{std::move(*path),
                       std::string(mark == std::string_view::npos ? std::string_view() : target.substr(mark + 1))};
}

std::string query_value(std::string_view query, std::string_view name) {
  while (!query.empty()) {
    const std::size_t end = std::min(query.find('&'), query.size());
    const std::string_view pair = query.substr(0, end);
    query.remove_prefix(std::min(end + 1, query.size()));
    const std::size_t equals = pair.find('=');
    if (equals != std::string_view::npos && pair.substr(0, equals) == name) {
      return unescape(pair.substr(equals + 1)).value_or(std::string());
    }
  }
  return {};
}

std::optional<std::string> refuse_host(std::string_view host, const Endpoint& endpoint) {
  const auto found = split_host(host, endpoint.scheme);
  if (!found) return "the Host header is missing or malformed";
  if (is_public_host(host, endpoint.public_origin)) return std::nullopt;
  const std::array<std::string, 5> allowed{"localhost", "127.0.0.1", "[::1]", in_header(endpoint.bound_host),
                                           in_header(endpoint.local_address)};
  if (found->port != endpoint.port || std::find(allowed.begin(), allowed.end(), found->host) == allowed.end()) {
    return "the Host header is not this server's, open " + prefix(endpoint.scheme) +
           "localhost:" + std::to_string(endpoint.port);
  }
  return std::nullopt;
}

bool is_public_host(std::string_view host, std::string_view public_origin) {
  if (public_origin.empty()) return false;
  return lower(host) == public_origin.substr(public_origin.find("://") + 3);
}

std::string checked_origin(std::string_view origin) {
  const std::string given = lower(origin);
  for (const Scheme scheme : {Scheme::http, Scheme::https}) {
    const std::string start = prefix(scheme);
    if (!given.starts_with(start)) continue;
    const std::string host = given.substr(start.size());
    const bool is_plain = std::ranges::all_of(host, [](char c) {
      return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') ||
             std::string_view(".-:[]").find(c) != std::string_view::npos;
    });
    if (is_plain && split_host(host, scheme)) return given;
  }
  throw std::invalid_argument("a public address is like https://worlds.example.org, not '" + std::string(origin) + "'");
}

std::optional<std::string> refuse_origin(std::string_view origin, Scheme scheme, std::string_view host,
                                         std::string_view public_origin) {
  const std::string given = lower(origin);
  if (is_public_host(host, public_origin) && given == public_origin) return std::nullopt;
  if (const std::string start = prefix(scheme); given.compare(0, start.size(), start) == 0) {
    const auto page = split_host(std::string_view(given).substr(start.size()), scheme);
    const auto server = split_host(host, scheme);
    if (page && server && page->host == server->host && page->port == server->port) return std::nullopt;
  }
  return "the Origin header is not this server's page";
}

}  // namespace iota::net
