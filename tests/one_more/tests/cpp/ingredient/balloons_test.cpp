// SPDX-License-Identifier: Apache-2.0
// All that an ingredient does by being in the list: it acts in steps, counts, is saved, and follows edits.
#include "ingredient/balloons.h"

#include "ingredient/quantities.h"
#include "system/core.h"

#include <gtest/gtest.h>

namespace iota::ingredient {
namespace {

/// A rod of 2 kg along y, at rest without gravity, with 4 N at its lower end.
struct LiftedRod {
  Core core;
  std::uint32_t rod, low;

  LiftedRod() {
    core.model.gravity = {};
    rod = core.model.make_body(BodyKind::dynamic, 0);
    low = core.model.make_particle(rod, {}, 1, {});
    (void)core.model.make_particle(rod, {0, 1, 0}, 1, {});
    core.model.rebuild_basis(rod);
    core.model.balloons.make(ring()).lift = {0, 4, 0};
  }
  std::uint32_t ring() const { return core.model.particles[low].ring; }
  double height() const { return core.model.rings[ring()].position.y; }
  void step(int count) {
    for (int i = 0; i < count; ++i) (void)core.stepper.step(0.01);
  }
};

TEST(Balloons, lift_a_body_and_count_in_energy_and_load) {
  LiftedRod lifted;
  const double before = calc_energies(lifted.core.model).total();
  lifted.step(100);
  EXPECT_NEAR(lifted.height(), 0.5 * (4.0 / 2) * 1, 1e-9);  // F / m t^2 / 2
  EXPECT_NEAR(calc_energies(lifted.core.model).total(), before, 1e-9);
  EXPECT_NEAR(calc_outside_load(lifted.core.model, lifted.rod, {}).force.y, 4, 1e-9);
}

TEST(Balloons, come_back_from_a_snapshot) {
  LiftedRod lifted;
  const Snapshot saved = lifted.core.editor.snapshot();
  lifted.step(50);
  const double height = lifted.height();
  lifted.core.model.balloons.make(lifted.ring()).lift = {};
  lifted.core.editor.restore(saved);
  EXPECT_EQ(lifted.height(), 0);
  lifted.step(50);
  EXPECT_EQ(lifted.height(), height);
}

TEST(Balloons, end_with_their_ring_and_are_kept_by_an_audit_until_then) {
  LiftedRod lifted;
  EXPECT_TRUE(Balloons::holds(lifted.core.model, lifted.low));
  const std::uint32_t ring = lifted.ring();
  lifted.core.model.rings[ring].count = 0;
  Balloons::ring_changed(lifted.core.model, ring);
  EXPECT_EQ(lifted.core.model.balloons.find(ring), nullptr);
}

}  // namespace
}  // namespace iota::ingredient
