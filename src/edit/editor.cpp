// SPDX-License-Identifier: Apache-2.0
#include "edit/editor.h"

#include "base/seal.h"
#include "base/text.h"
#include "ingredient/tables.h"

namespace iota::edit {

namespace {

constexpr Seal snapshot_seal{{'I', 'O', 'T', 'A', 'S', 'N', 'P', 'A'}, "snapshot"};

/// `survivor()`: the object that absorbed it, called only for a stale id.
template <class Table, KindName name, class Survivor>
std::uint32_t slot_of(const Table& table, Id<name> id, Survivor survivor) {
  const std::string_view kind = name.text;
  if (table.contains(id)) return id.slot;
  if (!id) throw StaleIdError(text("this ", kind, " id is null: it never named a ", kind));
  if (const std::optional<Id<name>> other = survivor())
    throw StaleIdError(text(kind, " ", id.slot, " is gone: it was absorbed by ", kind, " ", other->slot));
  throw StaleIdError(text(kind, " ", id.slot, " is gone: it was destroyed"));
}

template <class Table, KindName name>
std::uint32_t slot_of(const Table& table, Id<name> id) {
  return slot_of(table, id, [] { return std::optional<Id<name>>(); });
}

}  // namespace

std::uint32_t require(const model::Model& m, BodyId id) {
  return slot_of(m.bodies, id, [&] { return m.survivor_of(id); });
}
std::uint32_t require(const model::Model& m, ParticleId id) {
  return slot_of(m.particles, id, [&] { return m.survivor_of(id); });
}
std::uint32_t require(const model::Model& m, BondId id) { return slot_of(m.bonds, id); }
std::uint32_t require(const model::Model& m, CosmeticBondId id) { return slot_of(m.cosmetic_bonds, id); }
std::uint32_t require(const model::Model& m, AngleSpringId id) { return slot_of(m.angle_springs, id); }
std::uint32_t require(const model::Model& m, LawId id) { return slot_of(m.laws, id); }
std::uint32_t require(const model::Model& m, GroupId id) { return slot_of(m.groups, id); }
std::uint32_t require(const model::Model& m, FieldId id) { return slot_of(m.fields, id); }
std::uint32_t require(const model::Model& m, PairsId id) { return slot_of(m.pairs, id); }
std::uint32_t require(const model::Model& m, ConstraintId id) { return slot_of(m.constraints, id); }
std::uint32_t require(const model::Model& m, GripId id) { return slot_of(m.grips, id); }
std::uint32_t require(const model::Model& m, EmitterId id) { return slot_of(m.emitters, id); }

void Editor::mark_velocity_dirty(std::uint32_t particle) {
  model.mark_velocities(model.bodies[model.particles[particle].body].articulate);
}

Snapshot Editor::snapshot() {
  std::vector<std::byte> content;
  Writer writer(content);
  model.archive(writer);
  // A restored system builds its islands from saved data; so must this one, or replays differ in the last bits.
  islands.renew();
  keys_saved_below_ = held.functions.next_key;
  return {seal(snapshot_seal, content)};
}

void Editor::restore(const Snapshot& snapshot, Origin origin) {
  Reader reader(unseal(snapshot_seal, snapshot.bytes));
  model::Model restored;
  restored.archive(reader);
  if (!reader.ok() || !reader.at_end())
    throw std::invalid_argument("restore: the tables of this snapshot are damaged, or of another build of Iota");
  if (origin == Origin::anywhere)
    if (const std::vector<std::string> complaints = ingredient::validate(restored); !complaints.empty())
      throw std::invalid_argument(text("restore: the tables of this snapshot do not fit together: ", complaints.front(),
                                       complaints.size() > 1 ? text(", and ", complaints.size() - 1, " more") : ""));
  restored.take_over(model);
  model = std::move(restored);
  model.list_flagged();
  islands.forget();
  held.forget();
  orientations.forget();
}

}  // namespace iota::edit
