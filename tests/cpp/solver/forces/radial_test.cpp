// SPDX-License-Identifier: Apache-2.0
#include "solver/forces/force_list.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace iota::solver {
namespace {

std::vector<laws::PairLaw> all_laws() {
  std::vector<laws::PairLaw> list;
  for (std::uint32_t i = 0; i < laws::pair_law_count; ++i) list.emplace_back(i);
  list.emplace_back("energy = a*r^3 + b*exp(-r); force = c*r - b*v*r + t; drag = a/r",
                    std::vector<std::string>{"a", "b", "c"});
  return list;
}

RadialForce force_of(const laws::PairLaw& law) {
  RadialForce f;
  f.law = &law;
  f.parameters = {0.7, 1.3, 0.9, 1.1, 0.4, 1, 1, 1};
  f.time = 0.3, f.m_p = 1.5, f.m_q = 0.5;
  return f;
}

TEST(RadialForce, has_the_stiffness_that_differences_give) {
  for (const laws::PairLaw& law : all_laws()) {
    const RadialForce f = force_of(law);
    // Damping has its slope over v only, along the line at the start; so the rate is kept small beside the rest.
    for (const auto& [e0, e1] :
         {std::pair{Vec3{1, 0.2, -0.1}, Vec3{1.01, 0.22, -0.08}}, {Vec3{1, 0.2, 0.3}, Vec3{1.5, -0.6, 0.1}}})
      for (const bool midpoint : {false, true}) {
        const ForceStage stage{0.1, midpoint, false};
        const Mat3 k = f.stiffness_matrix(e0, e1, stage);
        for (int c = 0; c < 3; ++c) {
          Vec3 up = e1, down = e1;
          double* const u[3] = {&up.x, &up.y, &up.z};
          double* const d[3] = {&down.x, &down.y, &down.z};
          const double step = 1e-6;
          *u[c] += step, *d[c] -= step;
          const Vec3 slope = (-0.5 / step) * (f.force(e0, up, stage) - f.force(e0, down, stage));
          EXPECT_NEAR(k.m[0][c], slope.x, 1e-6 * (1 + std::abs(slope.x)));
          EXPECT_NEAR(k.m[1][c], slope.y, 1e-6 * (1 + std::abs(slope.y)));
          EXPECT_NEAR(k.m[2][c], slope.z, 1e-6 * (1 + std::abs(slope.z)));
        }
      }
  }
}

TEST(RadialForce, does_at_mid_point_exactly_the_work_that_its_energy_loses) {
  std::mt19937 random(4);
  const auto number = [&] { return std::uniform_real_distribution(-1.0, 1.0)(random); };
  for (std::uint32_t i = 0; i < laws::pair_law_count; ++i) {
    const laws::PairLaw law(i);
    RadialForce f = force_of(law);
    if (law.has_drag() || law.has_damping()) continue;
    for (int round = 0; round < 100; ++round) {
      const Vec3 e0{1 + 0.3 * number(), number(), number()};
      const double size = std::pow(10, -6 * (round % 7) / 6.0);
      const Vec3 e1 = e0 + size * Vec3{0.3 * number(), number(), number()};
      const double work = dot(f.force(e0, e1, {0.01, true, false}), e1 - e0), change = f.energy(e1) - f.energy(e0);
      EXPECT_NEAR(work, -change,
                  1e-14 * (std::abs(f.energy(e0)) + std::abs(f.energy(e1)) + 1) + 1e-10 * std::abs(change))
          << laws::pair_law_name(i) << " " << size;
    }
  }
}

TEST(RadialForce, of_a_spring_is_the_spring) {
  const laws::PairLaw law(laws::find_pair_law("spring"));
  RadialForce f = force_of(law);
  f.parameters = {50, 3, 0.8};
  SpringForce spring{{}, 50, 3, 0.8};
  const Vec3 e0{1, 0.2, 0.3}, e1{1.1, -0.2, 0.1};
  for (const bool midpoint : {false, true})
    for (const bool clamp : {false, true}) {
      const ForceStage stage{0.1, midpoint, clamp};
      EXPECT_NEAR(norm(f.force(e0, e1, stage) - spring.force(e0, e1, stage)), 0, 1e-12);
      const Mat3 a = f.stiffness_matrix(e0, e1, stage), b = spring.stiffness_matrix(e0, e1, stage);
      for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 3; ++c) EXPECT_NEAR(a.m[r][c], b.m[r][c], 1e-12);
    }
}

}  // namespace
}  // namespace iota::solver
