// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iota/forces.h>
#include <iota/record.h>

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace iota {

/// The commands of some time, for a journal.
struct LogPiece {
  std::vector<std::byte> commands;  ///< as in a `Recording`
  double time = 0;                  ///< of the system after them, s
  std::uint64_t hash = 0;           ///< `Log::hash` after them; 0 without commands
  double seconds = 0;               ///< of real time in which they were given
  std::chrono::steady_clock::time_point ended;
  /// The state was replaced by a `restore`, or more was logged than `Log::most_bytes`: a snapshot has to come before what is
  /// logged next. Then there are no commands.
  bool is_broken = false;
};

/// A function of the script that something in the system uses. It is not saved: the tables refer to it by its key, which
/// functions get in the order of their registration.
struct FunctionUse {
  enum class Kind : std::uint8_t { bond, law, field, surface };
  Kind kind;
  std::uint64_t key;
  std::string name;  ///< empty for a surface, and for the bond of a missing function
  bool is_there;
};

/// All commands of a running system, in pieces: a snapshot and the commands since then lead to the same bits. What a
/// journal needs beside them: states for undo and redo. Independent of `Record`.
class Log : public View {
 public:
  static constexpr std::size_t most_bytes = std::size_t{64} << 20;  ///< between two calls of `take`

  explicit Log(Core& core) : View(core) {}

  /// cut_each: see `take_cut`, s of real time; 0: never.
  void start(double cut_each = 0);
  void stop();
  /// The commands that were not taken yet.
  LogPiece take();
  /// The commands until the log was last cut, which it is from time to time after a step: not in a batch of edits, not
  /// after a change of the structure, nor before the first call of `take`, until its next. May be called on any thread while
  /// the system runs. Empty if it was not cut.
  LogPiece take_cut();
  /// It is not cut until the next call of `take`.
  void hold_cuts();
  /// A hash of the state, found in a fifth of the time of `System::state_hash`.
  std::uint64_t hash() const;
  /// As `System::snapshot`, but later it does not keep functions of the script alive for a `restore`.
  Snapshot snapshot();
  /// As `snapshot`, without a change of what the steps after it do: a system restored from it may differ in the last bits.
  Snapshot quick_snapshot();
  /// Repeats commands, from the state in which they were made. Throws std::invalid_argument for damaged ones: before any
  /// change if bytes are not a command, otherwise after the last command that could be applied.
  void repeat(std::span<const std::byte> commands);

  /// The states to which undo and redo return, the newest last. Valid until the next command.
  std::vector<std::span<const std::byte>> undo_states() const;
  std::vector<std::span<const std::byte>> redo_states() const;
  /// schema: that of the snapshots of the program that had these states. Throws std::invalid_argument as `System::restore`,
  /// without a change.
  void set_history(std::vector<Snapshot> undo, std::vector<Snapshot> redo, std::string_view schema = {});

  /// By kind, then by slot of the user.
  std::vector<FunctionUse> functions() const;
  /// The function of bonds that refer to it by this key.
  void give_function(std::uint64_t key, ScriptedLaw);
};

}  // namespace iota
