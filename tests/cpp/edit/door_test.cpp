// SPDX-License-Identifier: Apache-2.0
#include "system/core.h"

#include <gtest/gtest.h>
#include <iota/system.h>

#include <algorithm>
#include <string>

namespace iota {
namespace {

// The list that the header of System tells.
TEST(Door, names_the_edits_that_may_be_asked_for_during_a_step) {
  EXPECT_EQ(
      System::queued_edits(),
      "combine, destroy, nail, release, separate, set_active, set_color, set_compliance, set_coordinate, set_kind, set_length, set_material, "
      "set_radius");
}

TEST(Door, refuses_other_edits_during_a_step_and_says_which_it_takes) {
  System system;
  const BodyId body = system.bodies().create();
  const ParticleId p = system.particles().create(body, {0, 0, 0});
  std::string text;
  system.fields().create([&](const ParticleBatch& batch) {
    std::fill(batch.force, batch.force + 3 * batch.count, 0.0);
    try {
      system.particles().set_mass(p, 2);
    } catch (const std::logic_error& error) {
      text = error.what();
    }
  });
  (void)system.step(0.01);
  EXPECT_NE(text.find(System::queued_edits()), std::string::npos) << text;
  EXPECT_EQ(system.particles().mass(p), 1);
}

TEST(Door, counts_commands_that_may_move_something_but_no_forces) {
  Core core;
  const BodyId body = Bodies(core).create();
  const ParticleId p = Particles(core).create(body, {0, 0, 0});
  const std::uint64_t before = core.model.edits;
  EXPECT_GT(before, 0u);
  Particles(core).apply_force(p, {1, 0, 0});
  Bodies(core).apply_force(body, {1, 0, 0});
  Bodies(core).set_radius(body, 0.1);
  EXPECT_EQ(core.model.edits, before);
  Particles(core).set_position(p, {1, 0, 0});
  EXPECT_GT(core.model.edits, before);
}

}  // namespace
}  // namespace iota
