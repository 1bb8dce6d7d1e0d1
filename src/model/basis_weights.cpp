// SPDX-License-Identifier: Apache-2.0
#include "model/basis_weights.h"

#include "math/mat3.h"

namespace iota::model {

BasisWeights::BasisWeights(const Structure& structure, std::uint32_t slot) {
  const Body& body = structure.bodies[slot];
  origin_ = structure.position(body.basis[0]);
  std::array<Vec3, 3> vectors;
  for (int k = 1; k < body.rank; ++k)
    vectors[static_cast<std::size_t>(k - 1)] = structure.position(body.basis[static_cast<std::size_t>(k)]) - origin_;
  Mat3 gram;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) gram.m[i][j] = dot(vectors[i], vectors[j]);
  const SymmetricEigen eigen = symmetric_eigen(gram);
  const auto solve = [&](const Vec3& v) {
    return solve_semidefinite(eigen, {dot(vectors[0], v), dot(vectors[1], v), dot(vectors[2], v)}, 1e-12);
  };
  const Vec3 x = solve({1, 0, 0}), y = solve({0, 1, 0}), z = solve({0, 0, 1});
  duals_ = {Vec3{x.x, y.x, z.x}, Vec3{x.y, y.y, z.y}, Vec3{x.z, y.z, z.z}};
}

}  // namespace iota::model
