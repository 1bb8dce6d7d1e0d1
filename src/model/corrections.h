// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/archive.h"

#include <iota/vec3.h>

#include <atomic>
#include <cstdint>
#include <vector>

namespace iota::model {

/// The corrections of the velocities of rings at the end of the last step, to satisfy the constraints, m/s; by the rings'
/// slots. The steps of many scenes have none; then they take no memory. Not in `Ring`, as only loads need them.
class Corrections {
 public:
  Vec3 operator[](std::uint32_t ring) const { return ring < values_.size() ? values_[ring] : Vec3{}; }
  /// Many threads may set those of different rings at the same time. Without room only zeros can be set.
  void set(std::uint32_t ring, const Vec3& value) {
    if (ring < values_.size())
      values_[ring] = value;
    else if (value != Vec3{})
      std::atomic_ref(lacks_room_).store(true, std::memory_order_relaxed);
  }
  bool are_none() const { return values_.empty(); }
  /// Whether some could not be set since there was last room for all.
  bool lacks_room() const { return lacks_room_; }
  void make_room(std::uint32_t rings) { values_.resize(rings), lacks_room_ = false; }

  template <class Archive>
  void archive(Archive& ar, std::uint32_t rings) {
    ar.vector(values_);
    if (values_.size() > rings) ar.fail(), values_.clear();
  }

 private:
  std::vector<Vec3> values_;
  bool lacks_room_ = false;
};

}  // namespace iota::model
