// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iota/view.h>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace iota {

/// A whole system in bytes: all but what is code (functions of bonds, laws, fields and surfaces) and the triangles of
/// meshes.
struct Snapshot {
  std::vector<std::byte> bytes;
  friend bool operator==(const Snapshot&, const Snapshot&) = default;
};

/// A snapshot and all that happened since: replaying it gives the same hash after every step.
struct Recording {
  Snapshot start;
  std::vector<std::byte> commands;    ///< one after the other, each as its number and its fields
  std::vector<std::uint64_t> hashes;  ///< one per step

  /// For a file: with a mark, the version of the format and a checksum.
  std::vector<std::byte> to_bytes() const;
  /// Throws std::invalid_argument for bytes that `to_bytes` did not make, or that were cut short or damaged since.
  static Recording from_bytes(std::span<const std::byte>);
  friend bool operator==(const Recording&, const Recording&) = default;
};

/// Recording, and repeating what was recorded.
class Record : public View {
 public:
  explicit Record(Core& core) : View(core) {}

  void start();
  Recording stop();
  /// Restores the recording's start and repeats it; returns the number of the first step whose hash differs, if any.
  /// Throws std::invalid_argument for a damaged recording: before anything has changed where bytes are not a command, else
  /// after the last command that could be applied.
  std::optional<std::uint64_t> replay(const Recording&);
};

}  // namespace iota
