// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iota/view.h>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace iota {

/// A whole system in bytes, except functions (of bonds, laws, fields and surfaces).
struct Snapshot {
  std::vector<std::byte> bytes;
  friend bool operator==(const Snapshot&, const Snapshot&) = default;
};

/// A snapshot and all later commands: replaying it gives the same hash after every step.
struct Recording {
  Snapshot start;
  std::vector<std::byte> commands;    ///< one after the other, each as its number and its fields
  std::vector<std::uint64_t> hashes;  ///< one per step

  /// For a file: with a magic number, the version of the format and a checksum.
  std::vector<std::byte> to_bytes() const;
  /// Throws std::invalid_argument for bytes that are not from `to_bytes`, are truncated or damaged.
  static Recording from_bytes(std::span<const std::byte>);
  friend bool operator==(const Recording&, const Recording&) = default;
};

/// Recording and replay.
class Record : public View {
 public:
  explicit Record(Core& core) : View(core) {}

  void start();
  Recording stop();
  /// Restores the recording's start and repeats its commands; returns the number of the first step with another hash,
  /// if any. Throws std::invalid_argument for a damaged recording: before any change if bytes are not a command,
  /// otherwise after the last command that could be applied.
  std::optional<std::uint64_t> replay(const Recording&);
};

}  // namespace iota
