// SPDX-License-Identifier: Apache-2.0
// Forces on single particles: the listed ones against their formulas, expressions against their own derivative.
#include "laws/field_law.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>

namespace iota::laws {
namespace {

/// Particles at random.
struct Particles {
  std::vector<FieldState> states;

  explicit Particles(std::size_t count) {
    std::mt19937 random(21);
    const auto number = [&] { return std::uniform_real_distribution<double>(-2, 2)(random); };
    for (std::size_t i = 0; i < count; ++i) {
      FieldState s;
      s.position = {number(), number(), number()}, s.velocity = {number(), number(), number()};
      s.mass = 1.5 + 0.5 * number(), s.t = 0.7;
      states.push_back(s);
    }
  }
  ParticleArrays arrays() const {
    ParticleArrays a;
    a.resize(states.size());
    for (std::size_t i = 0; i < states.size(); ++i) {
      const auto& [x, v, mass, t] = states[i];
      a.x[i] = x.x, a.y[i] = x.y, a.z[i] = x.z, a.vx[i] = v.x, a.vy[i] = v.y, a.vz[i] = v.z, a.m[i] = mass;
    }
    return a;
  }
  std::vector<Vec3> forces(const FieldLaw& law, const std::vector<double>& parameters) const {
    std::vector<double> rows(3 * states.size());
    law.evaluate(arrays(), 0, states.size(), 0.7, parameters.data(), rows.data());
    std::vector<Vec3> forces;
    for (std::size_t i = 0; i < states.size(); ++i) forces.push_back({rows[3 * i], rows[3 * i + 1], rows[3 * i + 2]});
    return forces;
  }
};

std::vector<double> standard_of(std::uint32_t number) {
  std::vector<double> values;
  for (const Parameter& parameter : field_law_parameters(number))
    values.push_back(parameter.standard != 0 ? parameter.standard : 0.3 + 0.1 * double(values.size()));
  return values;
}

TEST(FieldLaw, each_of_the_list_is_found_by_its_name) {
  for (std::uint32_t number = 0; number < field_law_count; ++number)
    EXPECT_EQ(find_field_law(field_law_name(number)), number);
  EXPECT_EQ(find_field_law("gale"), field_law_count);
}

TEST(FieldLaw, force_of_each_with_an_energy_is_its_negative_gradient) {
  for (std::uint32_t number = 0; number < field_law_count; ++number) {
    const FieldLaw law(number);
    if (!law.has_energy()) continue;
    const std::vector<double> parameters = standard_of(number);
    const Particles one(1);
    const Vec3 force = one.forces(law, parameters)[0];
    for (int axis = 0; axis < 3; ++axis) {
      const double step = 1e-5;
      Particles high = one, low = one;
      (&high.states[0].position.x)[axis] += step, (&low.states[0].position.x)[axis] -= step;
      const double slope =
          (law.energy(high.arrays(), 0.7, parameters.data()) - law.energy(low.arrays(), 0.7, parameters.data())) /
          (2 * step);
      EXPECT_NEAR((&force.x)[axis], -slope, 1e-7) << field_law_name(number) << " along axis " << axis;
    }
  }
}

TEST(FieldLaw, rates_are_the_derivatives_of_the_forces_by_the_velocities) {
  const Particles particles(70);
  for (const auto& [law, parameters] :
       {std::pair{FieldLaw(find_field_law("wind")), std::vector<double>{1, 2, 3, 0.7}},
        std::pair{FieldLaw("fx = -w*vz*m + t*vx^2; fy = -c*vy*sqrt(vx^2 + vy^2); fz = w*vx*x", {"w", "c"}),
                  std::vector<double>{3, 0.2}}}) {
    ASSERT_TRUE(law.depends_on_velocity());
    std::vector<double> rates(9 * 70);
    law.evaluate_rates(particles.arrays(), 0, 70, 0.7, parameters.data(), rates.data());
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double step = 1e-6;
      Particles high = particles, low = particles;
      for (std::size_t i = 0; i < 70; ++i)
        (&high.states[i].velocity.x)[axis] += step, (&low.states[i].velocity.x)[axis] -= step;
      const std::vector<Vec3> above = high.forces(law, parameters), below = low.forces(law, parameters);
      for (std::size_t i = 0; i < 70; ++i)
        for (std::size_t k = 0; k < 3; ++k)
          EXPECT_NEAR(rates[9 * i + 3 * k + axis], ((&above[i].x)[k] - (&below[i].x)[k]) / (2 * step), 1e-7);
    }
  }
}

TEST(FieldLaw, a_quadratic_drag_has_no_rate_at_rest_where_its_derivative_is_not_a_number) {
  Particles one(1);
  one.states[0].velocity = {};
  std::vector<double> rates(9, 1);
  FieldLaw("fx = -vx*sqrt(vx^2 + vy^2)", {}).evaluate_rates(one.arrays(), 0, 1, 0, nullptr, rates.data());
  EXPECT_EQ(rates, std::vector<double>(9, 0));
}

TEST(FieldLaw, well_is_an_inverse_square_far_from_its_softening) {
  const Particles particles(3);
  const std::vector<Vec3> forces = particles.forces(FieldLaw(find_field_law("well")), {1000, 0, 0, 5, 0});
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3 d = Vec3{1000, 0, 0} - particles.states[i].position;
    EXPECT_NEAR(norm(forces[i]), particles.states[i].mass * 5 / dot(d, d), 1e-16);
  }
}

TEST(FieldLaw, expressions_agree_with_the_listed_fields_that_they_spell) {
  const Particles particles(700);  // more than a block of the program
  const std::vector<double> center{0.1, 0.2, 0.3, 4, 0.5};
  const FieldLaw listed(find_field_law("well")),
      spelled("energy = -m*strength/sqrt((cx - x)^2 + (cy - y)^2 + (cz - z)^2 + soft^2)",
              {"cx", "cy", "cz", "strength", "soft"});
  EXPECT_TRUE(spelled.has_energy());
  const std::vector<Vec3> a = particles.forces(listed, center), b = particles.forces(spelled, center);
  for (std::size_t i = 0; i < a.size(); ++i) ASSERT_LT(norm(a[i] - b[i]), 1e-11 * (1 + norm(a[i]))) << i;
  EXPECT_NEAR(listed.energy(particles.arrays(), 0, center.data()), spelled.energy(particles.arrays(), 0, center.data()),
              1e-9);
}

TEST(FieldLaw, energy_and_force_of_an_expression_add_up) {
  const Particles particles(4);
  const FieldLaw law("energy = 0.5*k*x^2 + m*9.81*y; fx = -c*vx; fz = t", {"k", "c"});
  const std::vector<Vec3> forces = particles.forces(law, {3, 2});
  for (std::size_t i = 0; i < 4; ++i) {
    const FieldState& s = particles.states[i];
    EXPECT_LT(norm(forces[i] - Vec3{-3 * s.position.x - 2 * s.velocity.x, -9.81 * s.mass, 0.7}), 1e-13);
  }
}

TEST(FieldLaw, evaluates_any_part_of_the_particles_to_the_same_bits) {
  const Particles particles(100);
  const FieldLaw law("fx = sin(x + t)*m; fy = exp(-y^2)", {});
  const std::vector<Vec3> all = particles.forces(law, {});
  for (const auto& [first, count] : {std::pair<std::size_t, std::size_t>{0, 1}, {37, 50}, {99, 1}, {50, 0}}) {
    std::vector<double> rows(3 * count);
    law.evaluate(particles.arrays(), first, count, 0.7, nullptr, rows.data());
    for (std::size_t i = 0; i < count; ++i)
      EXPECT_EQ((Vec3{rows[3 * i], rows[3 * i + 1], rows[3 * i + 2]}), all[first + i]);
  }
}

TEST(FieldLaw, refuses_a_text_that_defines_no_force) {
  for (const char* text : {"", "fx", "x = 3", "fx = q", "energy = x; energy = y"})
    EXPECT_THROW(FieldLaw(text, {}), expression::ExpressionError) << text;
}

}  // namespace
}  // namespace iota::laws
