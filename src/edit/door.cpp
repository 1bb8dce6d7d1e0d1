// SPDX-License-Identifier: Apache-2.0
#include "edit/door.h"

#include "base/seal.h"
#include "base/text.h"
#include "edit/command_list.h"
#include "edit/table_schema.h"
#include "ingredient/quantities.h"

#include <cstring>

namespace iota::edit {

namespace {

/// Calls read(number, reader), which reads a command, for each that `write` appended.
template <class Read>
void read_all(std::span<const std::byte> bytes, Read read) {
  Reader reader(bytes);
  for (std::size_t number = 1; !reader.at_end(); ++number) {
    read(number, reader);
    if (!reader.ok())
      throw std::invalid_argument(text("replay: command ", number, " of the recording is cut short or damaged"));
  }
}

void require_commands(std::span<const std::byte> bytes) {
  read_all(bytes, [](std::size_t, Reader& reader) { read_command(reader, [](const auto&) {}); });
}

}  // namespace

std::string queued_edits() {
  std::vector<std::string_view> names;
  const auto add = [&]<class C>() {
    if constexpr (is_queueable<C>)
      if (std::find(names.begin(), names.end(), C::queued_as) == names.end()) names.push_back(C::queued_as);
  };
  for_each_command_type(add);
  std::sort(names.begin(), names.end());
  std::string list;
  for (const std::string_view name : names) list += (list.empty() ? "" : ", ") + std::string(name);
  return list;
}

void Door::refuse_in_step() {
  throw std::logic_error("while the system steps, only " + queued_edits() +
                         " may be asked for; they are applied right after the step");
}

void Door::apply_queue(StepReport& report) {
  if (queue_.empty()) return;
  report.edits.emplace();
  report.edits->articulates_before = editor_.model.articulate_count();
  ++editor_.model.edits;
  ingredient::begin_edits(editor_.model);
  const double before = editor_.held.book().edits;
  const std::uint32_t version = editor_.model.structure_version;
  const std::vector<std::byte> edits = std::exchange(queue_, {});
  const auto apply_one = [&]<class C>(const C& command) {
    if constexpr (!is_queueable<C>)
      return;
    else if constexpr (std::is_same_v<decltype(apply(editor_, command)), RestructureReport>)
      add_report(*report.edits, apply(editor_, command));
    else
      apply(editor_, command);
  };
  read_all(edits, [&](std::size_t, Reader& reader) {
    try {
      read_command(reader, apply_one);
    } catch (const std::exception& error) {
      report.warnings.push_back(std::string("an edit asked for during the step could not be made: ") + error.what());
    }
  });
  report.edits->changed = report.edits->changed || editor_.model.structure_version != version;
  report.edits->articulates_after = editor_.model.articulate_count();
  report.edits->structure_version = editor_.model.structure_version;
  editor_.held.note_change();
  report.edits->energy_change = editor_.held.book().edits - before;
}

Snapshot Door::take_snapshot(For reader) {
  record(TakeSnapshot{});
  if (reader == For::others) return editor_.snapshot();
  editor_.islands.renew(editor_.model);
  return editor_.pack();
}

void Door::start_recording() {
  editor_.forget_history();  // a replay would not have this history
  recording_ = Recording{editor_.snapshot(), {}, {}};
  log_.break_off();
  editor_.keeps_functions = true;
}

Recording Door::stop_recording() {
  if (!recording_) throw std::logic_error("stop_recording: nothing is being recorded");
  Recording recording = std::move(*recording_);
  recording_.reset();
  editor_.keeps_functions = false;
  return recording;
}

void Door::record_step(const Step& step) {
  record(step);
  if (!editor_.batch) log_.cut_if_due(editor_.model);
  if (recording_) recording_->hashes.push_back(editor_.model.hash());
}

namespace {

struct KeepFunctions {
  explicit KeepFunctions(Editor& editor) : editor(editor) { editor.keeps_functions = true; }
  ~KeepFunctions() { editor.keeps_functions = false; }
  Editor& editor;
};

void repeat_one(std::size_t number, Reader& reader, const ExecuteNext& execute) {
  try {
    execute(reader);
  } catch (const std::logic_error& error) {
    throw std::invalid_argument(text("replay: command ", number, " cannot be applied: ", error.what()));
  }
}

}  // namespace

std::optional<std::uint64_t> Door::replay(const Recording& recording, const ExecuteNext& execute) {
  const std::span<const std::byte> commands = recording.commands;
  require_commands(commands);  // throws before anything changes
  editor_.restore(recording.start);
  editor_.forget_history();
  const KeepFunctions keep(editor_);
  std::size_t steps = 0;
  std::optional<std::uint64_t> differs;
  const bool is_comparable = has_own_tables(recording.start.bytes);  // hashes are those of tables
  Reader reader(commands);
  for (std::size_t number = 1; !differs && !reader.at_end(); ++number) {
    const auto index = std::to_integer<std::uint8_t>(commands[commands.size() - reader.remaining()]);
    repeat_one(number, reader, execute);
    if (!is_comparable || index != index_of<Step>) continue;
    if (steps >= recording.hashes.size() || editor_.model.hash() != recording.hashes[steps++])
      differs = editor_.model.step;
  }
  log_.break_off();
  return differs;
}

void Door::repeat(std::span<const std::byte> commands, const ExecuteNext& execute) {
  require_commands(commands);  // throws before anything changes
  const KeepFunctions keep(editor_);
  read_all(commands, [&](std::size_t number, Reader& reader) { repeat_one(number, reader, execute); });
}

}  // namespace iota::edit

namespace iota {

namespace {

// Commands are numbered by their places in a list, which a recording contains.
constexpr Seal recording_seal{{'I', 'O', 'T', 'A', 'R', 'C', 'B', 0}, "recording"};
constexpr Seal letter_a_seal{{'I', 'O', 'T', 'A', 'R', 'C', 'A', 110},
                             "recording"};  // 110 commands, without their list

}  // namespace

std::vector<std::byte> Recording::to_bytes() const {
  std::vector<std::byte> content;
  Writer writer(content);
  const std::string& list = edit::own_commands();
  writer.vector(std::vector<char>(list.begin(), list.end()));
  writer.vector(start.bytes), writer.vector(commands), writer.vector(hashes);
  return seal(recording_seal, content);
}

Recording Recording::from_bytes(std::span<const std::byte> bytes) {
  const auto& mark = letter_a_seal.mark;
  const bool is_of_letter_a = bytes.size() >= mark.size() && std::memcmp(bytes.data(), mark.data(), mark.size()) == 0;
  Reader reader(unseal(is_of_letter_a ? letter_a_seal : recording_seal, bytes));
  Recording recording;
  std::vector<char> list;
  if (!is_of_letter_a) reader.vector(list);
  reader.vector(recording.start.bytes), reader.vector(recording.commands), reader.vector(recording.hashes);
  if (!reader.ok() || !reader.at_end()) throw std::invalid_argument("this is not a recording: its parts do not fit");
  const std::string_view names =
      is_of_letter_a ? edit::commands_of_letter_a() : std::string_view(list.data(), list.size());
  recording.commands = edit::in_own_commands(names, recording.commands);
  return recording;
}

}  // namespace iota
