// SPDX-License-Identifier: Apache-2.0
// Edits of a heap whose steps are left to sweeps: they move bodies and joints alone, in no time, and keep momenta.
#include <iota/system.h>

#include <gtest/gtest.h>

#include <cmath>
#include <utility>
#include <vector>

namespace iota {
namespace {

constexpr double edge = 0.2, h = 1.0 / 60;

struct Heap {
  System system;
  std::vector<BodyId> cubes;  // a wall of three rows on the ground, or in space

  explicit Heap(double contacts = 1, bool is_on_ground = true) : system({.gravity = {0, is_on_ground ? -9.81 : 0, 0}}) {
    StepBudget budget = system.budget();
    budget.contacts = contacts;
    system.set_budget(budget);
    system.set_usual_material(Material{0.5});
    if (is_on_ground)
      system.bodies().set_material(system.bodies().create_obstacle(HalfSpace{{0, 1, 0}}, {}, {}), Material{0.5});
    for (int k = 0; k < 18; ++k)
      cubes.push_back(system.bodies().create(Box{{edge, edge, edge}},
                                             SolidOptions{.position = {edge * (k % 6), edge * (0.5 + k / 6), 0}}));
    for (int k = 0; k < 5; ++k) (void)system.step(h);
  }
  std::pair<Vec3, Vec3> momenta() const {
    Vec3 p, l;
    for (const BodyId body : cubes) {
      const double m = system.bodies().mass(body);
      const Vec3 v = system.bodies().velocity(body), c = system.bodies().center_of_mass(body);
      p += m * v, l += system.bodies().angular_momentum(body) + m * cross(c, v);
    }
    return {p, l};
  }
};

TEST(HeapProjection, an_assigned_velocity_moves_its_neighbors_by_the_sweeps_of_the_next_step) {
  Heap swept(1, false);
  System& system = swept.system;
  const double m = system.bodies().mass(swept.cubes[6]);
  system.bodies().set_velocity(swept.cubes[6], {3, 0, 0});  // of a row of six
  EXPECT_GT(system.step(h).approximate, 0);
  EXPECT_GT(system.bodies().velocity(swept.cubes[11]).x, 0.1);
  EXPECT_LT(system.bodies().velocity(swept.cubes[6]).x, 1);
  EXPECT_LT(norm(swept.momenta().first - Vec3{3 * m, 0, 0}), 1e-9 * m);
}

TEST(HeapProjection, assigned_velocities_of_hinged_bodies_meet_the_hinge_and_keep_its_momenta) {
  Heap swept(1, false);
  System& system = swept.system;
  const BodyId a = swept.cubes[16], b = swept.cubes[17];
  const Vec3 at = 0.5 * (system.bodies().center_of_mass(a) + system.bodies().center_of_mass(b));
  const ParticleId p = system.bodies().create_attachment(a, at), q = system.bodies().create_attachment(b, at);
  (void)system.edits().combine(p, q);
  (void)system.step(h);
  system.bodies().set_velocity(a, {0, 1, 0.5});
  system.bodies().set_angular_velocity(a, {2, 0, 1});
  const auto [before, angular_before] = swept.momenta();
  EXPECT_EQ(system.step(h).approximate, 1);
  const Vec3 hinge = system.particles().position(system.particles().contains(p) ? p : q);
  const auto velocity_at = [&](BodyId body) {
    return system.bodies().velocity(body) +
           cross(system.bodies().angular_velocity(body), hinge - system.bodies().center_of_mass(body));
  };
  EXPECT_LT(norm(velocity_at(a) - velocity_at(b)), 1e-9);
  EXPECT_GT(norm(velocity_at(b)), 0.1);
  const auto [after, angular_after] = swept.momenta();
  EXPECT_LT(norm(after - before), 1e-9 * norm(before));
  EXPECT_LT(norm(angular_after - angular_before), 1e-9 * norm(angular_before));
}

// By the equations of all contacts each edit closed the overlaps of the whole heap, and 400 bodies took 76 s for it.
TEST(HeapProjection, points_that_are_joined_meet_and_nothing_else_moves) {
  Heap swept;
  System& system = swept.system;
  const BodyId a = swept.cubes[13], b = swept.cubes[15];
  const Vec3 at = system.bodies().center_of_mass(swept.cubes[14]) + Vec3{0, 0.3, 0}, gap{1e-3, 2e-3, -1e-3};
  const ParticleId p = system.bodies().create_attachment(a, at), q = system.bodies().create_attachment(b, at + gap);
  const ParticleId corner =
      system.bodies().create_attachment(a, system.bodies().center_of_mass(a) + Vec3{0.1, 0.1, 0.1});
  const double length = norm(system.particles().position(p) - system.particles().position(corner));
  std::vector<Vec3> places;
  for (const BodyId body : swept.cubes) places.push_back(system.bodies().center_of_mass(body));
  const auto [before, angular_before] = swept.momenta();
  (void)system.edits().combine(p, q);
  for (std::size_t k = 0; k < places.size(); ++k) {
    const bool is_joined = swept.cubes[k] == a || swept.cubes[k] == b;
    const double way = norm(system.bodies().center_of_mass(swept.cubes[k]) - places[k]);
    if (is_joined) {
      EXPECT_GT(way, 1e-5) << k;
      EXPECT_LT(way, norm(gap)) << k;
    } else {
      EXPECT_EQ(way, 0) << k;
    }
  }
  const ParticleId hinge = system.particles().contains(p) ? p : q;
  EXPECT_NEAR(norm(system.particles().position(hinge) - system.particles().position(corner)), length, 1e-9);
  EXPECT_LT(system.worst_gap(), 1e-2 * edge);
  EXPECT_LT(norm(swept.momenta().first - before), 1e-9);
  for (int k = 0; k < 30; ++k) EXPECT_EQ(system.step(h).unconverged, 0);
  EXPECT_NEAR(norm(system.particles().position(hinge) - system.particles().position(corner)), length, 1e-9);
}

TEST(HeapProjection, a_swept_heap_that_is_edited_goes_where_the_equations_lead_it) {
  const auto run = [](double contacts) {
    Heap heap(contacts);
    System& system = heap.system;
    system.bodies().set_velocity(heap.cubes[17], {0.5, 1, 0});
    const ParticleId p = system.bodies().create_attachment(
        heap.cubes[12], system.bodies().center_of_mass(heap.cubes[12]) + Vec3{0.1, 0.1, 0});
    const ParticleId q = system.bodies().create_attachment(
        heap.cubes[13], system.bodies().center_of_mass(heap.cubes[13]) + Vec3{-0.1, 0.1, 0});
    (void)system.edits().combine(p, q);
    system.bodies().set_velocity(heap.cubes[12], {0, 1, 0});
    std::vector<Vec3> places;
    for (int k = 0; k < 8; ++k) (void)system.step(h);
    for (const BodyId body : heap.cubes) places.push_back(system.bodies().center_of_mass(body));
    return places;
  };
  const std::vector<Vec3> swept = run(1), exact = run(0);
  for (std::size_t k = 0; k < swept.size(); ++k) EXPECT_LT(norm(swept[k] - exact[k]), 0.1 * edge) << k;
}

}  // namespace
}  // namespace iota
