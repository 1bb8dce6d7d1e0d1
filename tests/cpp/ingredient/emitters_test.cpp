// SPDX-License-Identifier: Apache-2.0
#include "ingredient/emitters.h"

#include "ingredient/tables.h"
#include "shape/shape.h"
#include "tests/cpp/model/small_model.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <string>

namespace iota::ingredient {
namespace {

/// An emitter with one particle of its own.
struct Source {
  model::SmallModel m;
  std::uint32_t emitter, body, particle;

  Source() {
    Emitter e;
    e.source = shape::to_data(Sphere{0.1});
    e.rate = 10, e.mass = 0.1, e.max_count = 5;
    emitter = m.model.emitters.create(e).slot;
    body = m.body({{0, 0, 0}});
    particle = m.particle(body, 0);
    model::Attributes a;
    a.particle = particle, a.emitter = emitter;
    m.model.particles[particle].attributes = m.model.attributes.create(a).slot;
    m.model.emitters[emitter].alive = 1;
  }
  bool complains(const std::string& text) const {
    const auto complaints = validate(m.model);
    return std::any_of(complaints.begin(), complaints.end(),
                       [&](const std::string& c) { return c.find(text) != std::string::npos; });
  }
};

TEST(Emitters, count_their_particles) {
  Source s;
  EXPECT_EQ(validate(s.m.model), std::vector<std::string>{});
  Emitters::forget_particle(s.m.model, s.particle);
  EXPECT_EQ(s.m.model.emitters[s.emitter].alive, 0u);
  EXPECT_TRUE(s.complains("counts 0 particles, has 1"));
}

TEST(Emitters, of_numbers_that_no_step_could_take_are_found) {
  const auto damaged = [](auto damage, const char* text) {
    Source s;
    damage(s.m.model.emitters[s.emitter]);
    EXPECT_TRUE(s.complains(text)) << text;
  };
  damaged([](Emitter& e) { e.rate = std::numeric_limits<double>::infinity(); }, "births");
  damaged([](Emitter& e) { e.due = -1; }, "births");
  damaged([](Emitter& e) { e.key_count = 9; }, "9 keys");
  damaged([](Emitter& e) { e.mass = std::numeric_limits<double>::quiet_NaN(); }, "gives a mass of");
  damaged([](Emitter& e) { e.source.kind = 99; }, "has no shape");
}

}  // namespace
}  // namespace iota::ingredient
