// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "math/mat3.h"
#include "model/structure.h"

#include <array>

namespace iota::model {

/// Affine coordinates in a body's basis points, by the Gram matrix of the vectors from the first to the others.
class BasisWeights {
 public:
  BasisWeights(const Structure&, std::uint32_t body);
  /// The weights of the point nearest to `place` in the span of the basis.
  std::array<double, 4> of(const Vec3& place) const;

 private:
  Vec3 origin_;
  std::array<Vec3, 3> vectors_;
  SymmetricEigen gram_;
};

}  // namespace iota::model
