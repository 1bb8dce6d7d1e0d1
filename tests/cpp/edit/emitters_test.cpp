// SPDX-License-Identifier: Apache-2.0
#include "edit/emitters.h"
#include "tests/cpp/refused.h"

#include <iota/system.h>

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <stdexcept>

namespace iota {
namespace {

TEST(Emitter, with_invalid_options_is_refused_by_the_name_of_the_option) {
  System system;
  const auto refused = [&](const char* words, const std::function<void(EmitterOptions&)>& damage) {
    EmitterOptions options;
    damage(options);
    expect_refused(system, [&] { (void)system.emitters().create(options); }, words);
  };
  refused("cannot be born in a half", [](EmitterOptions& o) { o.source = HalfSpace{}; });
  refused("rate", [](EmitterOptions& o) { o.rate = -1; });
  refused("at most 1e9 births", [](EmitterOptions& o) { o.rate = 2e9; });
  refused("velocity_spread", [](EmitterOptions& o) { o.velocity_spread = -1; });
  refused("lifetime", [](EmitterOptions& o) { o.lifetime = 0; });
  refused("must be below the lifetime", [](EmitterOptions& o) { o.lifetime_spread = o.lifetime; });
  refused("mass", [](EmitterOptions& o) { o.mass = 0; });
  refused("damping", [](EmitterOptions& o) { o.damping = std::nan(""); });
  refused("at most 8 keys, got 9", [](EmitterOptions& o) { o.curve.resize(9); });
  refused("rising life", [](EmitterOptions& o) { o.curve = {{0.5, 1}, {0.4, 1}}; });
  refused("rising life", [](EmitterOptions& o) { o.curve = {{0.5, 1}, {1.1, 1}}; });
  refused("radius", [](EmitterOptions& o) { o.curve = {{0.5, -1}}; });
  refused("orientation", [](EmitterOptions& o) { o.orientation = {0, 0, 0, 0}; });
}

TEST(Emitter, emits_nothing_while_it_is_off_and_at_its_new_place_after_a_move) {
  System system{SystemOptions{.gravity = {}}};
  const EmitterId emitter = system.emitters().create({.rate = 200, .velocity = {}, .lifetime = 100});
  system.emitters().set_active(emitter, false);
  (void)system.step(0.1);
  EXPECT_EQ(system.emitters().born(emitter), 0u);
  system.emitters().set_active(emitter, true);
  system.emitters().move(emitter, {5, 0, 0}, {});
  (void)system.step(0.1);
  EXPECT_EQ(system.emitters().born(emitter), 20u);
  for (const ParticleId p : system.emitters().particles(emitter))
    EXPECT_LE(norm(system.particles().position(p) - Vec3{5, 0, 0}), 0.0101);
  EXPECT_THROW(system.emitters().set_rate(emitter, -1), std::invalid_argument);
}

TEST(Emitter, that_is_destroyed_leaves_its_particles_with_the_look_that_they_had) {
  System system{SystemOptions{.gravity = {}}};
  const EmitterId emitter =
      system.emitters().create({.rate = 50, .lifetime = 1, .curve = {{0, 1, {1, 0, 0, 1}}, {1, 3, {0, 0, 1, 1}}}});
  for (int i = 0; i < 50; ++i) (void)system.step(0.01);
  const ParticleId oldest = system.emitters().particles(emitter)[0];
  const ParticleAttributes look = system.particles().attributes(oldest);
  EXPECT_GT(look.radius, 1.5);
  system.emitters().destroy(emitter);
  (void)system.step(0.01);
  EXPECT_EQ(system.particles().attributes(oldest).radius, look.radius);
  EXPECT_EQ(system.particles().attributes(oldest).color, look.color);
}

}  // namespace
}  // namespace iota
