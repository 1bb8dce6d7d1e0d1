// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iota_protocol.h>

#include <algorithm>
#include <string>
#include <string_view>

namespace iota::net {

/// As much of `text` as fits, in whole UTF-8 characters; invalid bytes become '?'. Clients refuse a message with another
/// text, and what is told to them may be an error's.
inline std::string fit_text(std::string_view text, std::size_t max_bytes) {
  std::string out(text);
  if (!protocol::detail::is_utf8(out)) {
    std::replace_if(out.begin(), out.end(), [](char c) { return static_cast<unsigned char>(c) >= 0x80; }, '?');
  }
  if (out.size() <= max_bytes) return out;
  constexpr std::string_view ellipsis = "...";
  std::size_t size = max_bytes - ellipsis.size();
  while (size > 0 && (static_cast<unsigned char>(out[size]) & 0xC0) == 0x80) --size;
  out.resize(size);
  return out.append(ellipsis);
}

}  // namespace iota::net
