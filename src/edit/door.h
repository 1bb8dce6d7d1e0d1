// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "edit/command_log.h"
#include "edit/commands.h"
#include "ingredient/quantities.h"

#include <iota/reports.h>

#include <functional>
#include <utility>

namespace iota::edit {

template <class C>
using ResultOf = decltype(apply(std::declval<Editor&>(), std::declval<const C&>()));

/// Reads a command (`read_command`) and executes it.
using ExecuteNext = std::function<void(Reader&)>;

/// Every command passes through `execute`, from a user's call, a queue or a recording.
class Door {
 public:
  explicit Door(Editor& editor) : editor_(editor) {}

  /// Applies a command and records it. During a step a queueable one waits for the end of the step, and any other throws
  /// std::logic_error.
  template <class C>
  ResultOf<C> execute(const C& command);

  /// @name Steps
  ///@{
  bool is_stepping() const { return is_stepping_; }
  [[noreturn]] static void refuse_in_step();
  void begin_step() { is_stepping_ = true; }
  void end_step() { is_stepping_ = false; }
  /// Applies the commands requested during the step, in order, as one edit.
  void apply_queue(StepReport&);
  ///@}

  /// @name Recordings
  ///@{
  bool is_recording() const { return recording_.has_value(); }
  /// A journal is read by another process, which has functions of its own.
  enum class For : std::uint8_t { others, journal };
  Snapshot take_snapshot(For = For::others);
  void start_recording();
  Recording stop_recording();
  /// Records a completed step.
  void record_step(const Step&);
  /// Restores the start and has each command that follows executed. Returns the number of the first step
  /// with another hash, if any. Throws std::invalid_argument for a damaged recording: before any change if bytes are
  /// not a command, else after the last command that could be applied.
  std::optional<std::uint64_t> replay(const Recording&, const ExecuteNext& execute);
  ///@}

  /// @name Logs: see `Log`
  ///@{
  CommandLog& log() { return log_; }
  void repeat(std::span<const std::byte> commands, const ExecuteNext& execute);
  ///@}

 private:
  template <class C>
  ResultOf<C> put_off(const C& command);
  template <class C>
  ResultOf<C> make(const C& command);
  template <class C>
  ResultOf<C> report(const C& command);
  /// An open batch is no longer empty.
  template <class C>
  void note_edit();
  template <class C>
  void record(const C& command);

  Editor& editor_;
  bool is_stepping_ = false;
  std::vector<std::byte> queue_;  // requested during the step, as in a recording
  std::optional<Recording> recording_;
  CommandLog log_;
};

// --- definitions --------------------------------------------------------------------------------------------------------

// Functions of their own for the two ways and for a result: otherwise the compiler moves the report once more.
template <class C>
ResultOf<C> Door::execute(const C& command) {
  if (is_stepping_) return put_off(command);
  return make(command);
}

template <class C>
ResultOf<C> Door::put_off(const C& command) {
  if constexpr (is_queueable<C>) {
    write(queue_, command);
    if constexpr (std::is_same_v<ResultOf<C>, RestructureReport>) {
      RestructureReport report;
      report.queued = true;
      return report;
    } else {
      static_assert(std::is_void_v<ResultOf<C>>, "the caller of a queued command cannot get its result");
    }
  } else {
    refuse_in_step();
  }
}

template <class C>
ResultOf<C> Door::make(const C& command) {
  if constexpr (!keeps_energy<C>) {
    editor_.held.note_change();
    ingredient::note_edits(editor_.model, wakes_what_it_changes<C>);
    if constexpr (!moves_nothing<C>) ++editor_.model.edits;
  }
  if constexpr (std::is_void_v<ResultOf<C>>) {
    apply(editor_, command);
    note_edit<C>();
    record(command);
  } else {
    return report(command);
  }
}

template <class C>
ResultOf<C> Door::report(const C& command) {
  ResultOf<C> result = apply(editor_, command);
  if constexpr (std::is_same_v<ResultOf<C>, RestructureReport>)
    if (editor_.batch) editor_.batch->add(result);
  note_edit<C>();
  record(command);
  return result;
}

template <class C>
void Door::note_edit() {
  if constexpr (!std::is_same_v<C, BeginEdit> && !std::is_same_v<C, EndEdit> && !std::is_same_v<C, TakeSnapshot>)
    if (editor_.batch) editor_.batch->is_empty = false;
}

template <class C>
void Door::record(const C& command) {
  if (recording_) write(recording_->commands, command);
  log_.record(command);
}

}  // namespace iota::edit
