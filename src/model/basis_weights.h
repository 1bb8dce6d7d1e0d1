// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "model/structure.h"

#include <array>

namespace iota::model {

/// Weights of the basis points of a body whose sum is a place. Of a body whose basis does not span the place, of its
/// nearest place on the line or in the plane of the basis.
class BasisWeights {
 public:
  BasisWeights(const Structure&, std::uint32_t body);

  std::array<double, 4> of_place(const Vec3& place) const {
    std::array<double, 4> weights = of_direction(place - origin_);
    weights[0] += 1;
    return weights;
  }
  /// Of a vector: their sum is zero.
  std::array<double, 4> of_direction(const Vec3& v) const {
    const double b = dot(duals_[0], v), c = dot(duals_[1], v), d = dot(duals_[2], v);
    return {-b - c - d, b, c, d};
  }

 private:
  Vec3 origin_;
  std::array<Vec3, 3> duals_;  ///< v = sum_k (dual_k . v) e_k for v in the span of the vectors e_k from the first point
};

}  // namespace iota::model
