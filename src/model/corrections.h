// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/archive.h"

#include <iota/vec3.h>

#include <cstdint>
#include <mutex>
#include <utility>
#include <vector>

namespace iota::model {

/// The corrections of the velocities of rings at the end of the last step, to satisfy the constraints, m/s; by the rings'
/// slots. The steps of many scenes have none; then they take no memory. Not in `Ring`, as only loads need them.
class Corrections {
 public:
  Vec3 operator[](std::uint32_t ring) const { return ring < values_.size() ? values_[ring] : Vec3{}; }
  /// Many threads may set those of different rings at the same time. Without room, other values than zero wait for it.
  void set(std::uint32_t ring, const Vec3& value) {
    if (ring < values_.size())
      values_[ring] = value;
    else if (value != Vec3{})
      wait(ring, value);
  }
  bool are_none() const { return values_.empty(); }
  /// Whether some wait.
  bool lacks_room() const { return !waiting_.empty(); }
  void make_room(std::uint32_t rings) {
    values_.resize(rings);
    for (const auto& [ring, value] : waiting_) values_[ring] = value;
    std::vector<Waiting>().swap(waiting_);  // gives its memory back
  }

  template <class Archive>
  void archive(Archive& ar, std::uint32_t rings) {
    ar.vector(values_);
    if (values_.size() > rings) ar.fail(), values_.clear();
  }

 private:
  using Waiting = std::pair<std::uint32_t, Vec3>;
  void wait(std::uint32_t ring, const Vec3& value) {
    static std::mutex mutex;  // of all systems, so that this is copied: only the first correction of a scene waits
    const std::lock_guard lock(mutex);
    waiting_.push_back({ring, value});
  }

  std::vector<Vec3> values_;
  std::vector<Waiting> waiting_;
};

}  // namespace iota::model
