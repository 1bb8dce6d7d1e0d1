// SPDX-License-Identifier: Apache-2.0
#include "system/core.h"

#include <iota/log.h>

#include <algorithm>
#include <string>
#include <utility>

namespace iota {

namespace {

/// visit(kind, key, name) for each use of a function.
template <class Visit>
void for_each_function(const Core& core, Visit visit) {
  using Kind = FunctionUse::Kind;
  const model::Model& m = core.model;
  m.bonds.for_each([&](std::uint32_t, const ingredient::Bond& bond) {
    if (bond.script == 0) return;
    const auto found = core.held.functions.of_bonds.find(bond.script);
    visit(Kind::bond, bond.script, found == core.held.functions.of_bonds.end() ? std::string() : found->second.name);
  });
  m.laws.for_each([&](std::uint32_t, const ingredient::Law& law) {
    if (law.function != 0) visit(Kind::law, law.function, std::string(law.name.data()));
  });
  m.fields.for_each([&](std::uint32_t, const ingredient::Field& field) {
    if (field.function != 0) visit(Kind::field, field.function, std::string(field.name.data()));
  });
  m.constraints.for_each([&](std::uint32_t, const ingredient::Constraint& c) {
    for (const auto& surface : c.surfaces)
      if (surface.function != 0) visit(Kind::surface, surface.function, std::string());
  });
}

bool is_there(const Core& core, FunctionUse::Kind kind, std::uint64_t key) {
  const held::Functions& functions = core.held.functions;
  switch (kind) {
    case FunctionUse::Kind::bond: return functions.of_bonds.contains(key);
    case FunctionUse::Kind::law: return functions.of_laws.contains(key);
    case FunctionUse::Kind::field: return functions.of_fields.contains(key);
    case FunctionUse::Kind::surface: return core.model.surface_functions.contains(key);
  }
  return false;
}

}  // namespace

// A function that is registered from now on must not be taken for one that another process has registered.
void Log::start(double cut_each) {
  std::uint64_t& next = core_.held.functions.next_key;
  for_each_function(core_,
                    [&](FunctionUse::Kind, std::uint64_t key, const std::string&) { next = std::max(next, key + 1); });
  core_.door.log().start(cut_each);
}

std::vector<FunctionUse> Log::functions() const {
  std::vector<FunctionUse> all;
  for_each_function(core_, [&](FunctionUse::Kind kind, std::uint64_t key, std::string name) {
    all.push_back({kind, key, std::move(name), is_there(core_, kind, key)});
  });
  return all;
}

void Log::give_function(std::uint64_t key, ScriptedLaw law) {
  core_.held.functions.of_bonds.insert_or_assign(key, std::move(law));
}

void Log::stop() { core_.door.log().stop(); }

LogPiece Log::take() { return core_.door.log().take(core_.model); }

LogPiece Log::take_cut() { return core_.door.log().take_cut(); }

void Log::hold_cuts() { core_.door.log().hold_cuts(); }

std::uint64_t Log::hash() const { return core_.model.quick_hash(); }

Snapshot Log::snapshot() { return core_.door.take_snapshot(edit::Door::For::journal); }

Snapshot Log::quick_snapshot() { return core_.editor.pack(); }

void Log::repeat(std::span<const std::byte> commands) {
  if (core_.door.is_stepping()) throw std::logic_error("repeat: not while the system steps");
  core_.door.repeat(commands, [&](Reader& reader) { core_.execute_next(reader); });
}

namespace {

std::vector<std::span<const std::byte>> bytes_of(const edit::History& history) {
  std::vector<std::span<const std::byte>> all;
  for (const Snapshot& state : history.states()) all.emplace_back(state.bytes);
  return all;
}

}  // namespace

std::vector<std::span<const std::byte>> Log::undo_states() const { return bytes_of(core_.editor.undo); }

std::vector<std::span<const std::byte>> Log::redo_states() const { return bytes_of(core_.editor.redo); }

void Log::set_history(std::vector<Snapshot> undo, std::vector<Snapshot> redo, std::string_view schema) {
  for (std::vector<Snapshot>* const states : {&undo, &redo})
    for (Snapshot& state : *states) state = edit::Editor::own_state(state, schema);
  core_.editor.forget_history();
  for (Snapshot& state : undo) core_.editor.undo.push(std::move(state));
  for (Snapshot& state : redo) core_.editor.redo.push(std::move(state));
}

}  // namespace iota
