// SPDX-License-Identifier: Apache-2.0
// The four points that carry a body.
#include "ingredient/tables.h"
#include "tests/cpp/model/small_model.h"

#include <gtest/gtest.h>

#include <numeric>
#include <random>

namespace iota::model {
namespace {

int rank_of(const std::vector<Vec3>& places) {
  SmallModel m;
  return m.model.bodies[m.body(places)].rank;
}

TEST(Basis, has_one_point_more_than_the_body_has_dimensions) {
  EXPECT_EQ(rank_of({{1, 2, 3}}), 1);
  EXPECT_EQ(rank_of({{1, 2, 3}, {1, 2, 3}}), 1) << "two points at one place";
  EXPECT_EQ(rank_of({{0, 0, 0}, {1, 1, 1}, {3, 3, 3}}), 2);
  EXPECT_EQ(rank_of({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}}), 3);
  EXPECT_EQ(rank_of({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}}), 4);
}

TEST(Basis, takes_a_body_for_flat_that_is_thinner_than_a_ten_millionth_of_its_extent) {
  for (const double scale : {1e-6, 1.0, 1e6}) {
    const auto of_thickness = [&](double t) {
      return rank_of({{0, 0, 0}, {scale, 0, 0}, {0, scale, 0}, {0, 0, t * scale}});
    };
    EXPECT_EQ(of_thickness(2e-7), 4);
    EXPECT_EQ(of_thickness(0.5e-7), 3);
  }
}

TEST(Basis, of_a_rod_is_its_two_ends) {
  SmallModel m;
  const std::uint32_t rod = m.body({{0, 0, 0}, {0.4, 0, 0}, {1, 0, 0}, {0.7, 0, 0}});
  EXPECT_EQ(m.model.bodies[rod].basis[0], m.particle(rod, 0));
  EXPECT_EQ(m.model.bodies[rod].basis[1], m.particle(rod, 2));
  EXPECT_EQ(m.model.row(rod, 0).length, 1);
  EXPECT_EQ(m.model.extent(rod), 1);
}

TEST(Basis, carries_every_other_particle_by_weights_that_sum_to_one) {
  std::mt19937 random(4);
  const auto number = [&] { return std::uniform_real_distribution<double>(-1, 1)(random); };
  for (int dimensions = 1; dimensions <= 3; ++dimensions) {
    for (int i = 0; i < 50; ++i) {
      SmallModel m;
      std::vector<Vec3> places;
      for (int n = 0; n < 7; ++n)
        places.push_back({number(), dimensions > 1 ? number() : 0, dimensions > 2 ? number() : 0});
      const std::uint32_t body = m.body(places);
      ASSERT_EQ(m.model.bodies[body].rank, dimensions + 1);
      // Moved as one rigid body would move, the carried ones are where the motion has them.
      const Vec3 drift{1, -2, 3}, spin{0.3, 0.2, -0.7};
      m.model.for_each_particle_of(body, [&](std::uint32_t p) {
        m.model.rings[m.model.particles[p].ring].velocity = drift + cross(spin, m.model.position(p));
      });
      m.model.for_each_particle_of(body, [&](std::uint32_t p) {
        const std::array<double, 4> weights = m.model.weights(p);
        EXPECT_NEAR(std::accumulate(weights.begin(), weights.end(), 0.0), 1, 1e-12);
        const auto [x, v] = m.model.carried(p);
        EXPECT_LT(norm(x - m.model.position(p)), 1e-11);
        EXPECT_LT(norm(v - m.model.velocity(p)), 1e-10);
        EXPECT_TRUE(m.model.follows_basis(p));
      });
      EXPECT_TRUE(ingredient::validate(m.model).empty());
    }
  }
}

TEST(Basis, has_no_markers_as_they_have_no_mass) {
  SmallModel m;
  const std::uint32_t body = m.body({{0, 0, 0}, {1, 0, 0}});
  const std::uint32_t marker = m.model.make_marker(body, {5, 0, 0});
  m.model.rebuild_basis(body);
  EXPECT_EQ(m.model.bodies[body].rank, 2);
  EXPECT_LT(m.model.particles[marker].basis_index, 0);
  EXPECT_EQ(m.model.affine[marker].weights[0], -4);
  EXPECT_EQ(m.model.affine[marker].weights[1], 5);
}

TEST(Basis, puts_a_marker_on_the_nearest_place_that_it_spans) {
  SmallModel m;
  const std::uint32_t rod = m.body({{0, 0, 0}, {1, 0, 0}});
  EXPECT_TRUE(m.model.spans(rod, {0.3, 0, 0}));
  EXPECT_TRUE(m.model.spans(rod, {7, 0, 0}));
  EXPECT_FALSE(m.model.spans(rod, {0.3, 0.01, 0}));
  const std::uint32_t marker = m.model.make_marker(rod, {0.3, 4, 0});
  EXPECT_LT(norm(m.model.position(marker) - Vec3{0.3, 0, 0}), 1e-15);
}

TEST(Basis, that_stays_the_same_keeps_the_warm_start_of_its_rows_and_else_forgets_it) {
  SmallModel m;
  const std::uint32_t rod = m.body({{0, 0, 0}, {1, 0, 0}});
  m.model.row(rod, 0).multiplier = 5;
  m.model.rebuild_basis(rod);
  EXPECT_EQ(m.model.row(rod, 0).multiplier, 5);
  m.model.make_particle(rod, {2, 0, 0}, 1, {});
  m.model.rebuild_basis(rod);
  EXPECT_EQ(m.model.row(rod, 0).multiplier, 0);
}

TEST(Basis, drops_an_inertia_that_would_leave_the_mass_matrix_indefinite) {
  for (const double mass : {1.0, 0.25}) {
    SmallModel m;
    const std::uint32_t rod = m.body({{0, 0, 0}, {1, 0, 0}}, mass);
    InertiaPair pair;
    pair.body = rod, pair.p = m.particle(rod, 0), pair.q = m.particle(rod, 1), pair.inertia = -0.2;
    m.model.bodies[rod].first_inertia = m.model.inertia_pairs.create(pair).slot;
    m.model.keep_inertia_positive(rod);
    // [m - J, J; J, m - J] with J = 0.2: positive definite above m = 0.4.
    EXPECT_EQ(m.model.inertia_pairs.size(), mass > 0.4 ? 1u : 0u);
  }
}

}  // namespace
}  // namespace iota::model
