// SPDX-License-Identifier: Apache-2.0
#include "model/basis_weights.h"

#include "tests/cpp/model/small_model.h"

#include <gtest/gtest.h>

namespace iota::model {
namespace {

TEST(BasisWeights, give_back_places_in_the_span_of_the_basis_and_the_nearest_ones_to_others) {
  const Vec3 corners[4] = {{0.1, 0, 0}, {2, 0.3, 0}, {0, 1, -0.4}, {0.2, 0, 3}};
  for (int rank = 1; rank <= 4; ++rank) {
    Model model;
    const std::uint32_t body = model.make_body(BodyKind::dynamic, 0);
    for (int k = 0; k < rank; ++k) (void)model.make_particle(body, corners[k], 1, {});
    model.rebuild_basis(body);
    ASSERT_EQ(model.bodies[body].rank, rank);
    const BasisWeights weights(model, body);
    const auto sum = [&](const std::array<double, 4>& w) {
      Vec3 place;
      for (int k = 0; k < rank; ++k)
        place += w[static_cast<std::size_t>(k)] * model.position(model.bodies[body].basis[static_cast<std::size_t>(k)]);
      return place;
    };
    Vec3 inside;
    for (int k = 0; k < rank; ++k) inside += ((k + 1.0) / (rank * (rank + 1) / 2.0)) * corners[k];
    EXPECT_LT(norm(sum(weights.of(inside)) - inside), 1e-12) << rank;
    const Vec3 outside{3, -2, 1}, nearest = sum(weights.of(outside));
    for (int k = 1; k < rank; ++k) EXPECT_NEAR(dot(outside - nearest, corners[k] - corners[0]), 0, 1e-10) << rank;
  }
}

}  // namespace
}  // namespace iota::model
