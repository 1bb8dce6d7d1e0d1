// SPDX-License-Identifier: Apache-2.0
// Springs and other forces in heaps by sweeps, judged from places and momenta, beside the equations of all rows.
#include "solver/heap_forces.h"

#include "gravity.h"

#include <iota/system.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace iota {
namespace {

struct ForcedHeap {
  System system;
  std::vector<BodyId> bodies;
  std::vector<ParticleId> centers;

  explicit ForcedHeap(bool by_sweeps, const Vec3& gravity = {0, -9.81, 0}, double friction = 0.5)
      : system({.gravity = gravity}) {
    StepBudget budget = system.budget();
    budget.contacts = by_sweeps ? 1 : 0;
    system.set_budget(budget);
    system.set_usual_material(Material{friction});
    if (gravity == Vec3{}) return;
    const BodyId ground = system.bodies().create_obstacle(HalfSpace{{0, 1, 0}}, {}, {});
    system.bodies().set_material(ground, Material{friction});
  }
  void add_cube(const Vec3& position, const Vec3& velocity = {}) {
    bodies.push_back(
        system.bodies().create(Box{{0.2, 0.2, 0.2}}, {.mass = 2, .position = position, .velocity = velocity}));
    centers.push_back(system.bodies().create_attachment(bodies.back(), position));
  }
  ParticleId anchor(const Vec3& position) {
    return system.particles().create(system.bodies().create({.kind = BodyKind::static_}), position);
  }
  Vec3 place(std::size_t i) const { return system.bodies().center_of_mass(bodies[i]); }
  /// The steps that were solved contact by contact.
  int run(int steps, double h = 1.0 / 60) {
    int approximate = 0;
    for (int i = 0; i < steps; ++i) {
      const StepReport report = system.step(h);
      approximate += report.approximate;
      EXPECT_EQ(report.unconverged, 0);
    }
    return approximate;
  }
};

TEST(HeapForces, of_a_spring_hold_a_cube_that_others_push_where_exact_steps_have_it) {
  for (const double stiffness : {30.0, 3e3, 3e5}) {
    std::vector<double> ends;
    for (const bool by_sweeps : {true, false}) {
      ForcedHeap heap(by_sweeps, {3, -9.81, 0}, 0.1);  // downhill to the right
      for (int i = 0; i < 4; ++i) heap.add_cube({0.201 * i, 0.1, 0});
      const SpringLaw spring{.stiffness = stiffness, .damping = 2 * std::sqrt(8 * stiffness), .length = 1};
      heap.system.bonds().create(heap.centers.back(), heap.anchor({1.603, 0.1, 0}), spring);
      const int approximate = heap.run(400);
      EXPECT_EQ(approximate > 0, by_sweeps);
      ends.push_back(heap.place(0).x);
    }
    EXPECT_NEAR(ends[0], ends[1], 1e-3 + 0.02 * 8 * 3 / stiffness) << stiffness;
  }
}

TEST(HeapForces, of_any_stiffness_and_step_make_no_energy) {
  for (const double stiffness : {1.0, 1e3, 1e6, 1e9})
    for (const double h : {1.0 / 30, 1.0 / 120}) {
      ForcedHeap heap(true);
      for (int i = 0; i < 6; ++i) heap.add_cube({0.21 * (i % 3), 0.1 + 0.21 * (i / 3), 0.01 * i});
      for (std::size_t i = 0; i < 3; ++i)
        heap.system.bonds().create(heap.centers[i], heap.centers[5 - i],
                                   SpringLaw{.stiffness = stiffness, .length = 0.3});
      const double before = heap.system.step(h).energy.total();
      double most = before;
      for (int i = 0; i < 120; ++i) most = std::max(most, heap.system.step(h).energy.total());
      EXPECT_LE(most, before + 1e-9 * std::abs(before)) << stiffness << " " << h;
      for (const BodyId body : heap.bodies) EXPECT_LT(norm(heap.system.bodies().velocity(body)), 50);
    }
}

TEST(HeapForces, between_bodies_in_space_keep_momentum_and_angular_momentum) {
  ForcedHeap heap(true, {});
  for (int i = 0; i < 6; ++i)
    heap.add_cube({0.205 * (i % 3), 0.205 * (i / 3), 0.02 * i}, {0.1 * i, 0.3 - 0.2 * (i % 2), 0.05 * i});
  heap.system.bonds().create(heap.centers[0], heap.centers[5],
                             SpringLaw{.stiffness = 400, .damping = 3, .length = 0.2});
  heap.system.bonds().create(heap.centers[1], heap.centers[3], SpringLaw{.stiffness = 50, .length = 0.4});
  const Vec3 momentum = heap.system.momentum(), angular = heap.system.angular_momentum();
  const int approximate = heap.run(120);
  EXPECT_GT(approximate, 20);
  EXPECT_LT(norm(heap.system.momentum() - momentum), 1e-10);
  EXPECT_LT(norm(heap.system.angular_momentum() - angular), 1e-10);
}

TEST(HeapForces, leave_a_large_heap_to_sweeps) {
  ForcedHeap heap(true);
  StepBudget budget = heap.system.budget();
  budget.contacts = StepBudget{}.contacts;
  heap.system.set_budget(budget);
  for (int i = 0; i < 90; ++i)
    heap.add_cube({0.21 * (i % 4) + 0.02 * (i % 3), 0.12 + 0.21 * (i / 16), 0.21 * (i / 4 % 4)});
  heap.system.bonds().create(heap.centers[20], heap.centers[70], SpringLaw{.stiffness = 40, .length = 0.3});
  EXPECT_GT(heap.run(40), 20);
}

}  // namespace
}  // namespace iota
