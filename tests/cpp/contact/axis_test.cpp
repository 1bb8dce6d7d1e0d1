// SPDX-License-Identifier: Apache-2.0
// The separating axis of two polytopes, against all planes of their faces and pairs of edges without any pruning.
#include "contact/axis.h"

#include "placed.h"

#include <gtest/gtest.h>

namespace iota::contact {
namespace {

double separation_of_all_planes(const ConvexPart& a, const ConvexPart& b) {
  double most = -1e300;
  const auto look = [&](const Vec3& direction) {
    const double length = norm(direction);
    if (!(length > 1e-6)) return;
    for (const double sign : {1.0, -1.0}) {
      const Vec3 n = (sign / length) * direction;
      most = std::max(most, dot(n, a.corners[a.support(-n)] - b.corners[b.support(n)]));
    }
  };
  for (const Vec3& normal : a.normals) look(normal);
  for (const Vec3& normal : b.normals) look(normal);
  for (const Polytope::Edge& i : a.core->edges)
    for (const Polytope::Edge& k : b.core->edges)
      look(cross(a.corners[i.to] - a.corners[i.from], b.corners[k.to] - b.corners[k.from]));
  return most;
}

TEST(Axes, have_the_largest_separation_of_all_planes) {
  RandomShapes random(5);
  const int polytopes[] = {1, 3, 8};
  for (int round = 0; round < 3000; ++round) {
    const int kind = polytopes[round % 3], other_kind = polytopes[round / 3 % 3];
    if (kind == 3 && other_kind == 3) continue;  // no faces
    const Outline one = placed(random.make(kind, 1), {}, random.turn());
    const Outline other =
        placed(random.make(other_kind, 1), random.number(0.3, 1.5) * rotate(random.turn(), {1, 0, 0}), random.turn());
    const auto hull_of = [](const Solid& solid) {
      return solid.form->mesh ? try_polytope(solid.form->mesh->mesh()) : std::nullopt;
    };
    const std::optional<Polytope> hull = hull_of(one.solids[0]), other_hull = hull_of(other.solids[0]);
    ConvexPart a, b;
    place_part(one.solids[0], hull ? &*hull : nullptr, {}, a),
        place_part(other.solids[0], other_hull ? &*other_hull : nullptr, {}, b);
    const std::optional<Axis> axis = find_axis(a, b, {}, 10);
    ASSERT_TRUE(axis);
    const double most = separation_of_all_planes(a, b);
    // Corners that are nearest have no plane of their own: any two edges may be a better one by chance.
    EXPECT_LE(axis->most_apart, most + 1e-12);
    if (most < 0) {
      EXPECT_NEAR(axis->most_apart, most, 1e-9);
    } else {
      EXPECT_GE(axis->most_apart, 0);
    }
    EXPECT_NEAR(axis->apart, axis->most_apart,
                2e-3 * (a.size + b.size));  // faces are preferred to nearly the same edges
    EXPECT_NEAR(dot(axis->normal, a.corners[a.support(-axis->normal)] - b.corners[b.support(axis->normal)]),
                axis->apart, 1e-9);
    EXPECT_FALSE(find_axis(a, b, {}, axis->most_apart - 1e-6));
  }
}

TEST(Axes, of_hulls_with_many_edges_are_found_near_their_direction) {
  RandomShapes random(12);
  std::vector<Vec3> places;
  for (int k = 0; k < 80; ++k) places.push_back(rotate(random.turn(), {0.5, 0, 0}));
  const Outline ball = placed(convex_hull(places), {});
  const Polytope hull = *try_polytope(ball.solids[0].form->mesh->mesh());
  for (int round = 0; round < 50; ++round) {
    ConvexPart a, b;
    place_part({ball.solids[0].form, 1, random.number(0.9, 0.97) * rotate(random.turn(), {1, 0, 0}), random.turn()},
               &hull, {}, a);
    place_part({ball.solids[0].form, 2, {}, random.turn()}, &hull, {}, b);
    const std::optional<Axis> axis = find_axis(a, b, {}, 10);
    ASSERT_TRUE(axis);
    const double most = separation_of_all_planes(a, b);
    EXPECT_LE(axis->most_apart, most + 1e-12);
    if (most < 0) {
      EXPECT_NEAR(axis->most_apart, most, 1e-9);
    }
  }
}

TEST(Axes, are_those_along_which_parts_stay_apart_on_their_way) {
  const Outline box = placed(Box{{1, 1, 1}}, {-1.02, 1 - 1e-9, 0}), next = placed(Box{{1, 1, 1}}, {});
  ConvexPart a, b;
  place_part(box.solids[0], nullptr, {}, a), place_part(next.solids[0], nullptr, {}, b);
  EXPECT_EQ(find_axis(a, b, {}, 1)->normal, (Vec3{-1, 0, 0}));
  EXPECT_EQ(find_axis(a, b, {0.1, 0, 0}, 1)->normal, (Vec3{0, 1, 0}));
  EXPECT_EQ(find_axis(a, b, {0.1, -0.2, 0}, 1)->normal, (Vec3{-1, 0, 0}));
}

}  // namespace
}  // namespace iota::contact
