// SPDX-License-Identifier: Apache-2.0
#include "net/static_files.h"

#include <algorithm>
#include <array>
#include <fstream>
#include <iterator>
#include <system_error>
#include <utility>

namespace iota::net {
namespace {

namespace fs = std::filesystem;

std::string_view mime_type_of(const fs::path& file) {
  static constexpr std::array<std::pair<std::string_view, std::string_view>, 24> types{{
      {".html", "text/html; charset=utf-8"},
      {".js", "text/javascript; charset=utf-8"},
      {".mjs", "text/javascript; charset=utf-8"},
      {".css", "text/css; charset=utf-8"},
      {".json", "application/json"},
      {".map", "application/json"},
      {".webmanifest", "application/manifest+json"},
      {".txt", "text/plain; charset=utf-8"},
      {".svg", "image/svg+xml"},
      {".png", "image/png"},
      {".jpg", "image/jpeg"},
      {".jpeg", "image/jpeg"},
      {".webp", "image/webp"},
      {".ico", "image/x-icon"},
      {".ktx2", "image/ktx2"},
      {".wasm", "application/wasm"},
      {".glb", "model/gltf-binary"},
      {".gltf", "model/gltf+json"},
      {".woff", "font/woff"},
      {".woff2", "font/woff2"},
      {".ttf", "font/ttf"},
      {".mp3", "audio/mpeg"},
      {".ogg", "audio/ogg"},
      {".wav", "audio/wav"},
  }};
  const std::string extension = file.extension().string();
  const auto* found = std::find_if(types.begin(), types.end(), [&](const auto& t) { return t.first == extension; });
  return found == types.end() ? "application/octet-stream" : found->second;
}

/// No empty, hidden or parent part, no backslash, no control character.
bool is_plain(std::string_view path) {
  if (path.empty() || path.front() != '/') return false;
  const auto is_odd = [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == '\\' || c == ':'; };
  if (std::any_of(path.begin(), path.end(), is_odd)) return false;
  return path.find("//") == std::string_view::npos && path.find("/.") == std::string_view::npos;
}

bool is_inside(const fs::path& folder, const fs::path& file) {
  const auto [end, ignored] = std::mismatch(folder.begin(), folder.end(), file.begin(), file.end());
  return end == folder.end();
}

/// Whether an Accept-Encoding header contains a coding with a weight above zero.
bool accepts(std::string_view header, std::string_view coding) {
  while (!header.empty()) {
    const std::size_t end = std::min(header.find(','), header.size());
    std::string_view item = header.substr(0, end);
    header.remove_prefix(std::min(end + 1, header.size()));
    const auto trim = [](std::string_view& text) {
      while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) text.remove_prefix(1);
      while (!text.empty() && (text.back() == ' ' || text.back() == '\t')) text.remove_suffix(1);
    };
    const std::size_t semicolon = std::min(item.find(';'), item.size());
    std::string_view weight = item.substr(semicolon);
    item = item.substr(0, semicolon);
    trim(item);
    if (item != coding) continue;
    const std::size_t equals = weight.find('=');
    if (equals == std::string_view::npos) return true;
    weight.remove_prefix(equals + 1);
    trim(weight);
    return weight.find_first_not_of("0.") != std::string_view::npos;
  }
  return false;
}

constexpr std::array<std::pair<std::string_view, std::string_view>, 2> codings{{{"br", ".br"}, {"gzip", ".gz"}}};

}  // namespace

std::optional<StaticFile> find_static_file(const fs::path& folder, std::string_view path, std::string_view accepted) {
  if (!is_plain(path)) return std::nullopt;
  const std::string_view name = path == "/" ? "index.html" : path.substr(1);
  std::error_code error;
  const fs::path root = fs::canonical(folder, error);
  if (error) return std::nullopt;
  StaticFile file;
  file.path = fs::canonical(root / fs::path(name), error);  // follows links, to detect links to outside
  if (error || !is_inside(root, file.path) || !fs::is_regular_file(file.path, error)) return std::nullopt;
  file.mime_type = mime_type_of(file.path);
  for (const auto& [coding, ending] : codings) {
    if (!accepts(accepted, coding)) continue;
    const fs::path copy = fs::canonical(fs::path(file.path).concat(ending), error);
    if (error || !is_inside(root, copy) || !fs::is_regular_file(copy, error)) continue;
    file.path = copy;
    file.encoding = coding;
    break;
  }
  const auto size = fs::file_size(file.path, error);
  if (error) return std::nullopt;
  const auto changed = fs::last_write_time(file.path, error).time_since_epoch().count();
  if (error) return std::nullopt;
  file.etag = '"' + std::to_string(size) + '-' + std::to_string(changed) + '"';
  // The page's build adds a hash of the contents to the names below assets/.
  file.cache_control = path.rfind("/assets/", 0) == 0 ? "public, max-age=31536000, immutable" : "no-cache";
  return file;
}

std::optional<std::string> read_static_file(const StaticFile& file) {
  std::ifstream in(file.path, std::ios::binary);
  if (!in) return std::nullopt;
  std::string contents((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
  if (in.bad()) return std::nullopt;
  return contents;
}

}  // namespace iota::net
