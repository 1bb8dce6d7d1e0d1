// SPDX-License-Identifier: Apache-2.0
#include "model/basis_weights.h"

namespace iota::model {

BasisWeights::BasisWeights(const Structure& model, std::uint32_t body_slot) {
  const Body& body = model.bodies[body_slot];
  origin_ = model.position(body.basis[0]);
  for (int i = 1; i < body.rank; ++i) vectors_[i - 1] = model.position(body.basis[i]) - origin_;
  Mat3 gram;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) gram.m[i][j] = dot(vectors_[i], vectors_[j]);
  gram_ = symmetric_eigen(gram);
}

std::array<double, 4> BasisWeights::of(const Vec3& place) const {
  const Vec3 r = place - origin_;
  const Vec3 c = solve_semidefinite(gram_, {dot(vectors_[0], r), dot(vectors_[1], r), dot(vectors_[2], r)}, 1e-15);
  return {1 - c.x - c.y - c.z, c.x, c.y, c.z};
}

}  // namespace iota::model
