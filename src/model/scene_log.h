// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iota/view_event.h>

#include <cstdint>
#include <vector>

namespace iota::model {

/// Slots of a table that were created, changed or destroyed since the last call of `take`, each once.
class ChangedSlots {
 public:
  void note(std::uint32_t slot, bool is_new = false) {
    if (is_on) mark(slot, is_new ? created : changed);
  }
  /// Whether it was created since: an older item in its slot, of any id, was another one.
  bool is_new(std::uint32_t slot) const { return slot < marks_.size() && marks_[slot] == created; }
  const std::vector<std::uint32_t>& slots() const { return slots_; }
  void clear() {
    for (const std::uint32_t slot : slots_) marks_[slot] = unchanged;
    slots_.clear();
  }

  bool is_on = false;  ///< logs nothing while off

 private:
  enum Mark : std::uint8_t { unchanged, changed, created };
  void mark(std::uint32_t slot, Mark);
  std::vector<std::uint32_t> slots_;
  std::vector<Mark> marks_;
};

/// The log of changes for a viewer. A logged body is described with its attached items. Ingredients log items that
/// change or end without a body in their own logs, beside their tables: see Model::watch_scene.
struct SceneLog {
  ChangedSlots bodies, memberships;
  std::vector<ViewEvent> events;
  bool is_whole = true;     ///< a complete description is needed
  double usual_radius = 0;  ///< of the last description, m

  bool is_on() const { return bodies.is_on; }
  void note(ViewEvent::Kind kind, const Vec3& position) {
    if (is_on()) events.push_back({kind, position});
  }
};

}  // namespace iota::model
