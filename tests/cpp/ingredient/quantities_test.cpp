// SPDX-License-Identifier: Apache-2.0
// Energies, momenta and gaps against closed forms and plain sums.
#include "ingredient/quantities.h"
#include "ingredient/bonds.h"
#include "tests/cpp/model/small_model.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace iota::ingredient {
namespace {

using model::InertiaPair;
using model::SmallModel;

void set_velocity(Model& model, std::uint32_t p, const Vec3& v) { model.rings[model.particles[p].ring].velocity = v; }

TEST(Quantities, of_points_are_plain_sums) {
  SmallModel m;
  m.model.gravity = {0, -10, 0};
  const std::uint32_t a = m.body({{1, 2, 0}}, 3), b = m.body({{0, -1, 4}}, 5);
  set_velocity(m.model, m.particle(a, 0), {1, 2, 2}), set_velocity(m.model, m.particle(b, 0), {0, 0, -2});
  EXPECT_DOUBLE_EQ(calc_energies(m.model).kinetic, 0.5 * 3 * 9 + 0.5 * 5 * 4);
  EXPECT_DOUBLE_EQ(calc_energies(m.model).potential, 10 * (3 * 2 - 5 * 1));
  EXPECT_EQ(calc_momenta(m.model).linear, (Vec3{3, 6, 6 - 10}));
  const Vec3 angular = 3 * cross({1, 2, 0}, {1, 2, 2}) + 5 * cross({0, -1, 4}, {0, 0, -2});
  EXPECT_LT(norm(calc_momenta(m.model).angular - angular), 1e-13);
}

TEST(Quantities, of_a_shared_ring_count_both_masses) {
  SmallModel m;
  const auto chain = m.chain(2);
  const std::uint32_t p = m.particle(chain[0], 1);
  set_velocity(m.model, p, {0, 3, 0});
  EXPECT_DOUBLE_EQ(m.model.ring_mass(m.model.particles[p].ring), 2);
  EXPECT_DOUBLE_EQ(calc_energies(m.model).kinetic, 9);
  EXPECT_EQ(calc_momenta(m.model).linear, (Vec3{0, 6, 0}));
}

TEST(Quantities, of_an_inactive_body_are_zero) {
  SmallModel m;
  const std::uint32_t body = m.body({{0, 5, 0}}, 1, BodyKind::inactive);
  set_velocity(m.model, m.particle(body, 0), {1, 1, 1});
  EXPECT_EQ(calc_energies(m.model).kinetic, 0);
  EXPECT_EQ(calc_energies(m.model).potential, 0);
  EXPECT_EQ(calc_momenta(m.model).linear, Vec3{});
}

TEST(Quantities, an_inertia_pair_holds_the_energy_of_its_relative_velocity) {
  SmallModel m;
  const std::uint32_t rod = m.body({{0, 0, 0}, {1, 0, 0}});
  InertiaPair pair;
  pair.body = rod, pair.p = m.particle(rod, 0), pair.q = m.particle(rod, 1), pair.inertia = -0.2;
  m.model.bodies[rod].first_inertia = m.model.inertia_pairs.create(pair).slot;
  set_velocity(m.model, pair.q, {0, 2, 0});
  EXPECT_DOUBLE_EQ(calc_energies(m.model).kinetic, 0.5 * 4 - 0.5 * 0.2 * 4);
}

TEST(Quantities, worst_gap_is_the_largest_of_rigid_distances_and_nails) {
  SmallModel m;
  const std::uint32_t rod = m.body({{0, 0, 0}, {1, 0, 0}});
  EXPECT_EQ(worst_gap(m.model), 0);
  const std::uint32_t p = m.particle(rod, 1), ring = m.model.particles[p].ring;
  m.model.rings[ring].position = {1.25, 0, 0};
  EXPECT_NEAR(worst_gap(m.model), 0.25, 1e-12);
  m.model.rings[ring].nailed = 1;
  // A nail counts from where it was at the last step: moved since, it has not been asked for yet.
  m.model.nails.make(ring) = {{9, 9, 9}, {1.25, 0.5, 0}, {}};
  EXPECT_NEAR(worst_gap(m.model), 0.5, 1e-12);
}

TEST(Quantities, the_energy_of_a_spring_equals_that_of_its_text) {
  SmallModel m;
  m.model.gravity = {};
  const std::uint32_t p = m.particle(m.body({{0, 0, 0}}), 0), q = m.particle(m.body({{3, 0, 0}}), 0);
  Bond spring;
  spring.p = p, spring.q = q;
  const Law& law = m.model.laws[spring_law];
  for (std::uint32_t i = 0; i < law.parameter_count; ++i) {
    const std::string name = law.parameters[i].data();
    spring.parameters[i] = name == "stiffness" ? 7 : name == "length" ? 1 : 0;
  }
  const std::uint32_t bond = Bonds::add(m.model, spring);
  EXPECT_DOUBLE_EQ(Bonds::energy(m.model, bond), 0.5 * 7 * 4);
  EXPECT_DOUBLE_EQ(calc_energies(m.model).potential, 0.5 * 7 * 4);
  EXPECT_LT(norm(Bonds::force(m.model, bond) - Vec3{-14, 0, 0}), 1e-13) << "on the second particle, towards the first";
}

TEST(Quantities, a_gap_that_is_not_a_number_is_the_largest) {
  SmallModel m;
  const std::vector<std::uint32_t> links = m.chain(4);
  ASSERT_LT(worst_gap(m.model), 1e-12);
  for (const std::uint32_t link : links) {
    Vec3& place = m.model.rings[m.model.particles[m.particle(link, 1)].ring].position;
    const Vec3 before = place;
    place.x = std::numeric_limits<double>::quiet_NaN();
    EXPECT_TRUE(std::isinf(worst_gap(m.model))) << "link " << link;
    place = before;
  }
}

TEST(Quantities, energy_that_edits_change_is_booked_once) {
  SmallModel m;
  m.model.gravity = {};
  const std::uint32_t p = m.particle(m.body({{0, 0, 0}}), 0);
  begin_edits(m.model);
  book_edits(m.model, calc_energies(m.model).total());
  EXPECT_EQ(energy_of_edits(m.model), 0);
  begin_edits(m.model);
  set_velocity(m.model, p, {2, 0, 0});
  EXPECT_DOUBLE_EQ(energy_of_edits(m.model), 2);
  begin_edits(m.model);
  set_velocity(m.model, p, {4, 0, 0});
  book_edits(m.model, calc_energies(m.model).total());
  EXPECT_DOUBLE_EQ(energy_of_edits(m.model), 8) << "a second beginning changes nothing";
}

}  // namespace
}  // namespace iota::ingredient
