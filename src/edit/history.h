// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ingredient/model.h"

#include <iota/record.h>

#include <array>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <vector>

namespace iota {
struct RestructureReport;
}

namespace iota::edit {

/// A batch of edits with one report, undone as one.
class Batch {
 public:
  Batch(const model::Model&, Snapshot before);
  ~Batch();

  void add(const RestructureReport&);
  /// One report of all edits.
  RestructureReport finish(const model::Model&);
  /// Before an edit assigns places of bodies of a joint. Its angles will be counted on from the present ones when the batch
  /// ends, and not from those between two of its edits.
  void note_coordinates(const model::Model&, std::uint32_t joint);
  /// After an edit has assigned a coordinate of a joint: its angles are counted on from there.
  void forget_coordinates(std::uint32_t joint);
  void count_coordinates(model::Model&) const;

  int depth = 1;  ///< of nested batches
  bool is_empty = true, is_undoable = true;
  Snapshot before;

 private:
  std::unique_ptr<RestructureReport> report_;
  std::vector<BodyId> bodies_;  // alive at the start, in order of slots
  std::vector<ParticleId> particles_;
  struct Coordinates {
    ConstraintId joint;
    std::array<double, joint_coordinates.size()> values;
  };
  std::map<std::uint32_t, Coordinates> coordinates_;  // by the slots of joints
  std::uint32_t version_;
  double edit_energy_;
};

/// Merges several reports.
void add_report(RestructureReport& sum, const RestructureReport& report);

/// States for undo or redo, newest last: at most `most` of them, with `most_bytes` in total.
class History {
 public:
  static constexpr std::size_t most = 64, most_bytes = std::size_t{256} << 20;
  void push(Snapshot);
  std::optional<Snapshot> pop();
  void clear() { states_.clear(), bytes_ = 0; }
  std::size_t size() const { return states_.size(); }
  const std::deque<Snapshot>& states() const { return states_; }

 private:
  std::deque<Snapshot> states_;
  std::size_t bytes_ = 0;
};

}  // namespace iota::edit
