// SPDX-License-Identifier: Apache-2.0
#include "binders.h"

#include <nanobind/stl/set.h>
#include <nanobind/stl/tuple.h>

#include <chrono>
#include <cstring>
#include <optional>
#include <set>
#include <tuple>

namespace iota::bindings {

namespace {

/// The state of a Python `Log`.
struct LogObject {
  nb::object system_object;
  SystemObject* system;

  Log use(const char* what) const { return system->use_between_steps(what).log(); }
};

nb::bytes as_bytes(std::span<const std::byte> bytes) { return nb::bytes(bytes.data(), bytes.size()); }

Snapshot snapshot_of(const nb::bytes& data) {
  const auto* bytes = static_cast<const std::byte*>(data.data());
  return {{bytes, bytes + data.size()}};
}

// The checksum at the end of a snapshot tells it from others.
std::uint64_t mark_of(std::span<const std::byte> state) {
  std::uint64_t mark = 0;
  std::memcpy(&mark, state.last(sizeof mark).data(), sizeof mark);
  return mark;
}

nb::list states(const std::vector<std::span<const std::byte>>& all, const std::set<std::uint64_t>& known) {
  nb::list list;
  for (const std::span<const std::byte> state : all) {
    const std::uint64_t mark = mark_of(state);
    list.append(nb::make_tuple(mark, known.contains(mark) ? nb::object(nb::none()) : as_bytes(state)));
  }
  return list;
}

std::vector<Snapshot> snapshots_of(const std::vector<nb::bytes>& all) {
  std::vector<Snapshot> out;
  for (const nb::bytes& each : all) out.push_back(snapshot_of(each));
  return out;
}

const char* const function_kinds[] = {"bond", "law", "field", "surface"};

void repeat(const LogObject& self, const nb::bytes& commands) {
  Log log = self.use("repeat");
  SystemObject& system = *self.system;
  const auto* bytes = static_cast<const std::byte*>(commands.data());
  {
    nb::gil_scoped_release unlocked;
    log.repeat({bytes, bytes + commands.size()});
  }
  // Functions that raise were told when they did so first.
  system.failures.clear();
  (void)take_solver_failure();
}

template <class HandleType>
bool tell_id(nb::handle object, std::optional<std::tuple<std::string, std::uint32_t, std::uint32_t>>& id) {
  const HandleType* handle = nullptr;
  if (!nb::try_cast<const HandleType*>(object, handle) || !handle) return false;
  const std::string name = name_of(handle->id);
  id = {name.substr(0, name.find(' ')), handle->id.slot, handle->id.generation};
  return true;
}

template <class HandleType>
bool make_handle(const LogObject& self, const std::string& kind, std::uint32_t slot, std::uint32_t generation,
                 nb::object& made) {
  decltype(HandleType::id) id;
  id.slot = slot, id.generation = generation;
  const std::string name = name_of(id);
  if (name.substr(0, name.find(' ')) != kind) return false;
  made = nb::cast(HandleType{self.system_object, self.system, id});
  return true;
}

}  // namespace

void bind_log(nb::module_& module) {
  nb::class_<LogObject>(module, "Log", "All commands of a system in pieces, and what a journal needs beside them.",
                        nb::type_slots(handle_slots<LogObject>))
      .def(
          "__init__",
          [](LogObject* self, nb::handle system) { new (self) LogObject{nb::borrow(system), to_system(system)}; },
          "system"_a, nb::sig("def __init__(self, system: System) -> None"))
      .def(
          "start", [](const LogObject& self, double cut_each) { self.use("start").start(cut_each); },
          "cut_each"_a = 0.0, "Logs from now on. cut_each: see `take_cut`, s of real time; 0: never.")
      .def(
          "stop", [](const LogObject& self) { self.use("stop").stop(); }, "Logs no more.")
      .def(
          "take",
          [](const LogObject& self) -> std::optional<std::tuple<nb::bytes, bool, double, std::uint64_t, double>> {
            System& system = self.system->use_between_steps("take");
            if (system.edits().is_open()) return std::nullopt;
            const LogPiece piece = system.log().take();
            return std::tuple(as_bytes(piece.commands), piece.is_broken, piece.time, piece.hash, piece.seconds);
          },
          "None while a batch of edits is open. Else the commands that were not taken yet; whether the state was replaced, so that "
          "a snapshot has to follow; the time (s) and the hash of the state; the seconds of real time.")
      .def(
          "take_cut",
          [](const LogObject& self) -> std::optional<std::tuple<nb::bytes, double, std::uint64_t, double, double>> {
            const LogPiece piece = self.system->engine.log().take_cut();
            if (piece.commands.empty()) return std::nullopt;
            const std::chrono::duration<double> age = std::chrono::steady_clock::now() - piece.ended;
            return std::tuple(as_bytes(piece.commands), piece.time, piece.hash, piece.seconds, age.count());
          },
          "On any thread: the commands until the log was last cut, as of `take`, and the seconds since then. The log is cut from time "
          "to time after a step: not after a change of the structure, nor before the first call of `take`, until its next. None if it "
          "was not cut.")
      .def(
          "hold_cuts", [](const LogObject& self) { self.use("hold_cuts").hold_cuts(); },
          "The log is not cut until the next call of `take`.")
      .def_prop_ro(
          "hash", [](const LogObject& self) { return self.use("hash").hash(); },
          "A hash of the state, found in a fifth of the time of `System.state_hash`.")
      .def(
          "snapshot", [](const LogObject& self) { return as_bytes(self.use("snapshot").snapshot().bytes); },
          "As `System.snapshot`.")
      .def(
          "quick_snapshot",
          [](const LogObject& self) { return as_bytes(self.use("quick_snapshot").quick_snapshot().bytes); },
          "A snapshot that does not change the later steps, which then may differ from it in the last bits.")
      .def_prop_ro(
          "is_editing", [](const LogObject& self) { return self.system->use().edits().is_open(); },
          "Whether a batch of edits is open: a state in its midst cannot be gone on from.")
      .def("repeat", &repeat, "commands"_a, "Repeats commands of `take`. Raises ValueError for damaged ones.")
      .def(
          "history",
          [](const LogObject& self, const std::set<std::uint64_t>& known) {
            const Log log = self.use("history");
            return std::pair(states(log.undo_states(), known), states(log.redo_states(), known));
          },
          "known"_a,
          nb::sig("def history(self, known: collections.abc.Set[int]) -> tuple[list[tuple[int, bytes | None]], "
                  "list[tuple[int, bytes | None]]]"),
          "The states of undo and redo, newest last: the mark of each, and its bytes unless its mark is known.")
      .def(
          "set_history",
          [](const LogObject& self, const std::vector<nb::bytes>& undo, const std::vector<nb::bytes>& redo,
             const std::string& schema) {
            self.use("set_history").set_history(snapshots_of(undo), snapshots_of(redo), schema);
          },
          "undo"_a, "redo"_a, "schema"_a = "",
          "schema: that of the snapshots of the program that had these states. Raises ValueError for states that do not fit it.")
      .def(
          "let_go",
          [](const LogObject& self) {
            Grips grips = self.system->use_between_steps("let_go").grips();
            for (const GripId grip : grips.ids()) grips.destroy(grip);
          },
          "Ends all grips.")
      .def(
          "functions",
          [](const LogObject& self) {
            std::vector<std::tuple<std::string, std::uint64_t, std::string, bool>> all;
            for (const FunctionUse& use : self.use("functions").functions())
              all.emplace_back(function_kinds[static_cast<std::size_t>(use.kind)], use.key, use.name, use.is_there);
            return all;
          },
          "The functions of the script that are used: kind, key, name, whether this process has it.")
      .def(
          "give_function",
          [](const LogObject& self, std::uint64_t key, nb::handle function, const std::string& name) {
            auto source =
                std::make_shared<BondFunction>(BondFunction{{nb::borrow(function), "function " + name}, {}, {}, {}});
            self.system->keep(source);
            Log log = self.use("give_function");
            log.give_function(key, std::get<ScriptedLaw>(self.system->make_scripted_law(source, name)));
          },
          "key"_a, "function"_a, "name"_a)
      .def(
          "id_of",
          [](const LogObject&, nb::handle object) {
            std::optional<std::tuple<std::string, std::uint32_t, std::uint32_t>> id;
            (void)(tell_id<BodyHandle>(object, id) || tell_id<ParticleHandle>(object, id) ||
                   tell_id<BondHandle>(object, id) || tell_id<ConstraintHandle>(object, id));
            return id;
          },
          "handle"_a, nb::sig("def id_of(self, handle: object) -> tuple[str, int, int] | None"),
          "Kind, slot and generation of a body, particle, bond or constraint.")
      .def(
          "handle_of",
          [](const LogObject& self, const std::string& kind, std::uint32_t slot, std::uint32_t generation) {
            nb::object made = nb::none();
            (void)(make_handle<BodyHandle>(self, kind, slot, generation, made) ||
                   make_handle<ParticleHandle>(self, kind, slot, generation, made) ||
                   make_handle<BondHandle>(self, kind, slot, generation, made) ||
                   make_handle<ConstraintHandle>(self, kind, slot, generation, made));
            return made;
          },
          "kind"_a, "slot"_a, "generation"_a,
          nb::sig("def handle_of(self, kind: str, slot: int, generation: int) -> typing.Any"),
          "The handle with an id of `id_of`, None for another kind; it may be stale.");
}

}  // namespace iota::bindings
