// SPDX-License-Identifier: Apache-2.0
// Files of the built page: which one a path means, its type, and how long a browser may keep it.
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
  std::string_view encoding;  ///< "br" or "gzip" where the build's compressed copy is meant, else empty
  std::string etag;           ///< from size and time of change
};

/// The file under `folder` that the unescaped `path` of a request means ("/" is index.html). Nothing when there is no
/// such regular file, or it would lie outside of the folder (.., links), or a part of its name is hidden. `accepted` is the
/// request's Accept-Encoding: where it names an encoding in which the build has put a copy beside the file, that is found.
std::optional<StaticFile> find_static_file(const std::filesystem::path& folder, std::string_view path,
                                           std::string_view accepted = {});

/// Its contents; nothing when it cannot be read.
std::optional<std::string> read_static_file(const StaticFile& file);

}  // namespace iota::net
