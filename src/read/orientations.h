// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ingredient/model.h"

#include <cstdint>
#include <span>

namespace iota::read {

/// Frames for drawing, stored in the model's bodies. They are updated when read, and no force depends on them.
class Orientations {
 public:
  /// Updates them for the present step and structure, if necessary.
  void refresh(model::Model&);
  /// The same for some bodies, and for all if one of them is a rod or a ball: their frames have a past.
  void refresh(model::Model&, std::span<const std::uint32_t> bodies);
  void forget() { made_for_ = nothing; }

 private:
  static constexpr std::uint64_t nothing = ~0ull;
  std::uint64_t made_for_ = nothing;
};

}  // namespace iota::read
