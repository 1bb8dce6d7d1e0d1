// SPDX-License-Identifier: Apache-2.0
#include "ingredient/pushes.h"
#include "tests/cpp/ingredient/collected_loads.h"
#include "tests/cpp/model/small_model.h"

#include <gtest/gtest.h>

namespace iota::ingredient {
namespace {

/// A push on the hinge of two rods, of which the second may be of another kind.
Vec3 share_of_first(BodyKind second) {
  model::SmallModel m;
  const auto chain = m.chain(2);
  m.model.bodies[chain[1]].kind = second;
  const std::uint32_t p = m.particle(chain[0], 1);
  m.model.pushes.make(m.model.particles[p].ring).before = {6, 0, 0};
  return CollectedLoads<Pushes>(m.model, chain[0]).on(p, Load::Kind::outside);
}

TEST(Pushes, on_a_hinge_are_shared_by_the_bodies_that_can_move) {
  EXPECT_EQ(share_of_first(BodyKind::dynamic), (Vec3{3, 0, 0}));
  EXPECT_EQ(share_of_first(BodyKind::static_), (Vec3{6, 0, 0}));
}

}  // namespace
}  // namespace iota::ingredient
