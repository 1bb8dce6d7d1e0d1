// SPDX-License-Identifier: Apache-2.0
#include "ingredient/affine_rows.h"
#include "tests/cpp/ingredient/collected_loads.h"
#include "tests/cpp/model/small_model.h"

#include <gtest/gtest.h>

namespace iota::ingredient {
namespace {

/// Three points on a line; the middle one is in no basis.
struct Bar {
  model::SmallModel m;
  std::uint32_t body = m.body({{0, 0, 0}, {4, 0, 0}, {1, 0, 0}}), middle = m.particle(body, 2);
};

TEST(AffineRows, of_a_carried_particle_carry_nothing) {
  Bar bar;
  bar.m.model.affine.at(bar.middle).multiplier = {0, 8, 0};
  EXPECT_TRUE(CollectedLoads<AffineRows>(bar.m.model, bar.body).list.empty());
}

TEST(AffineRows, share_their_force_with_the_basis_by_its_weights) {
  Bar bar;
  bar.m.model.affine.at(bar.middle).multiplier = {0, 8, 0};
  bar.m.model.rings[bar.m.model.particles[bar.middle].ring].nailed = 1;  // an unknown of its own
  const CollectedLoads<AffineRows> loads(bar.m.model, bar.body);
  EXPECT_EQ(loads.on(bar.middle, Load::Kind::within), (Vec3{0, -8, 0}));
  EXPECT_LT(norm(loads.on(bar.m.particle(bar.body, 0), Load::Kind::within) - Vec3{0, 6, 0}), 1e-12);
  EXPECT_LT(norm(loads.on(bar.m.particle(bar.body, 1), Load::Kind::within) - Vec3{0, 2, 0}), 1e-12);
}

TEST(AffineRows, their_gap_is_the_distance_from_the_place_in_the_body) {
  Bar bar;
  bar.m.model.rings[bar.m.model.particles[bar.middle].ring].position = {1, 0.25, 0};
  EXPECT_NEAR(AffineRows::worst_gap(Scope(bar.m.model)), 0.25, 1e-12);
}

}  // namespace
}  // namespace iota::ingredient
