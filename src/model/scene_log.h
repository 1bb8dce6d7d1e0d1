// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iota/scene.h>

#include <cstdint>
#include <utility>
#include <vector>

namespace iota::model {

/// Slots of a table that were created, changed or destroyed since they were last taken, each once.
class ChangedSlots {
 public:
  void note(std::uint32_t slot, bool is_new = false) {
    if (!is_on) return;
    if (marks_.size() <= slot) marks_.resize(slot + std::size_t{1}, unchanged);
    if (marks_[slot] == unchanged) slots_.push_back(slot);
    if (is_new || marks_[slot] == unchanged) marks_[slot] = is_new ? created : changed;
  }
  /// Whether it was created since: an older thing in its slot, whatever its id, is another one.
  bool is_new(std::uint32_t slot) const { return slot < marks_.size() && marks_[slot] == created; }
  const std::vector<std::uint32_t>& slots() const { return slots_; }
  void clear() {
    for (const std::uint32_t slot : slots_) marks_[slot] = unchanged;
    slots_.clear();
  }

  bool is_on = false;  ///< notes nothing while nobody asks

 private:
  enum Mark : std::uint8_t { unchanged, changed, created };
  std::vector<std::uint32_t> slots_;
  std::vector<Mark> marks_;
};

/// What a viewer has to be told next. A body that is noted is described with all that hangs on it. Ingredients note items
/// that change or vanish by themselves in logs of their own, beside their tables: see Model::watch_scene.
struct SceneLog {
  ChangedSlots bodies, memberships;
  std::vector<ViewEvent> events;
  bool is_whole = true;  ///< everything is to be told anew

  bool is_on() const { return bodies.is_on; }
  void note(ViewEvent::Kind kind, const Vec3& position) {
    if (is_on()) events.push_back({kind, position});
  }
};

}  // namespace iota::model
