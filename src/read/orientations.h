// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ingredient/model.h"

namespace iota::read {

/// Frames for drawing, in the model's bodies. They are made when somebody reads them, and no force depends on them.
class Orientations {
 public:
  /// Makes them for the present step and structure, unless they are.
  void refresh(model::Model&);
  void forget() { made_for_ = nothing; }

 private:
  static constexpr std::uint64_t nothing = ~0ull;
  std::uint64_t made_for_ = nothing;
};

}  // namespace iota::read
