// SPDX-License-Identifier: Apache-2.0
#include "model/scene_log.h"

namespace iota::model {

void ChangedSlots::mark(std::uint32_t slot, Mark mark) {
  if (marks_.size() <= slot) marks_.resize(slot + std::size_t{1}, unchanged);
  if (marks_[slot] == unchanged) slots_.push_back(slot);
  if (mark == created || marks_[slot] == unchanged) marks_[slot] = mark;
}

}  // namespace iota::model
