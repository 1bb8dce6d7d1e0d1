// SPDX-License-Identifier: Apache-2.0
#include "edit/editor.h"

#include "base/seal.h"
#include "base/text.h"
#include "ingredient/tables.h"

namespace iota::edit {

namespace {

// The tables of a snapshot are in the order of the list of ingredients: its length is a part of the version, so that one
// more is another format. Change the letter before it if a table changes.
constexpr auto ingredients = static_cast<char>(std::tuple_size_v<ingredient::Ingredients>);
constexpr Seal snapshot_seal{{'I', 'O', 'T', 'A', 'S', 'O', 'J', ingredients}, "snapshot"};

}  // namespace

void Editor::mark_velocity_dirty(std::uint32_t particle) {
  model.mark_velocities(model.bodies[model.particles[particle].body].articulate);
}

Snapshot Editor::pack() {
  std::vector<std::byte> content;
  Writer writer(content);
  model.archive(writer);
  return {seal(snapshot_seal, content)};
}

Snapshot Editor::snapshot(Origin origin) {
  if (origin == Origin::anywhere) islands.renew();
  keys_saved_below_ = held.functions.next_key;
  return pack();
}

model::Model Editor::unpack(const Snapshot& snapshot, Origin origin) {
  Reader reader(unseal(snapshot_seal, snapshot.bytes));
  model::Model restored;
  restored.archive(reader);
  if (!reader.ok() || !reader.at_end())
    throw std::invalid_argument("restore: the tables of this snapshot are damaged, or of another build of Iota");
  if (origin == Origin::anywhere)
    if (const std::vector<std::string> complaints = ingredient::validate(restored); !complaints.empty())
      throw std::invalid_argument(text("restore: the tables of this snapshot do not fit together: ", complaints.front(),
                                       complaints.size() > 1 ? text(", and ", complaints.size() - 1, " more") : ""));
  return restored;
}

void Editor::restore(const Snapshot& snapshot, Origin origin) {
  model::Model restored = unpack(snapshot, origin);
  restored.take_over(model);
  model = std::move(restored);
  model.list_flagged();
  islands.forget();
  held.forget();
  orientations.forget();
}

}  // namespace iota::edit
