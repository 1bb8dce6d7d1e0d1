// SPDX-License-Identifier: Apache-2.0
// Files of the built page: the file of a path, its type, and how long a browser may cache it.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace iota::net {

struct StaticFile {
  std::filesystem::path path;
  std::string_view mime_type;
  std::string_view cache_control;
  std::string_view encoding;  ///< "br" or "gzip" for the build's compressed copy, else empty
  std::string etag;           ///< from size and time of change
};

/// The file under `folder` that the unescaped `path` of a request means ("/" is index.html). Nothing if there is no
/// such regular file, if it is outside of the folder (.., links), or if a part of its name is hidden. `accepted` is the
/// request's Accept-Encoding: a compressed copy beside the file is used if its encoding is accepted.
std::optional<StaticFile> find_static_file(const std::filesystem::path& folder, std::string_view path,
                                           std::string_view accepted = {});

/// Its contents; nothing if it cannot be read.
std::optional<std::string> read_static_file(const StaticFile& file);

}  // namespace iota::net
