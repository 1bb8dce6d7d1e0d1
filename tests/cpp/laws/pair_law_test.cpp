// SPDX-License-Identifier: Apache-2.0
#include "laws/pair_law.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace iota::laws {
namespace {

std::vector<std::string> parameter_names(std::uint32_t law) {
  std::vector<std::string> names;
  for (const Parameter& p : pair_law_parameters(law)) names.emplace_back(p.name);
  return names;
}

void expect_near(double a, double b, const std::string& what) {
  EXPECT_NEAR(a, b, 1e-12 * (std::abs(a) + std::abs(b) + 1e-3)) << what;
}

TEST(PairLaw, every_law_of_the_list_equals_its_text) {
  std::mt19937 random(5);
  const auto between = [&](double low, double high) { return std::uniform_real_distribution(low, high)(random); };
  for (std::uint32_t number = 0; number < pair_law_count; ++number) {
    const PairLaw listed(number), written(pair_law_text(number), parameter_names(number));
    const std::string name = pair_law_name(number);
    EXPECT_EQ(find_pair_law(name), number);
    EXPECT_EQ(listed.has_energy(), written.has_energy()) << name;
    EXPECT_EQ(listed.has_damping(), written.has_damping()) << name;
    EXPECT_EQ(listed.has_drag(), written.has_drag()) << name;
    constexpr std::size_t n = 100;
    std::vector<std::vector<double>> columns(max_parameters, std::vector<double>(n));
    std::vector<double> r(n), v(n), m_p(n), m_q(n), force(n), drag(n), force_written(n), drag_written(n);
    for (std::size_t i = 0; i < n; ++i) {
      r[i] = between(0.3, 3), v[i] = between(-2, 2), m_p[i] = between(0.1, 2), m_q[i] = between(0.1, 2);
      double p[max_parameters];
      for (int k = 0; k < max_parameters; ++k) p[k] = columns[k][i] = between(0.2, 2);
      const PairState state{r[i], v[i], 0.5, m_p[i], m_q[i]};
      const Elastic a = listed.elastic(state, p), b = written.elastic(state, p);
      expect_near(a.energy, b.energy, name);
      expect_near(a.slope, b.slope, name);
      expect_near(a.curvature, b.curvature, name);
      expect_near(listed.damping(state, p).value, written.damping(state, p).value, name);
      expect_near(listed.damping(state, p).slope, written.damping(state, p).slope, name);
      expect_near(listed.drag(state, p), written.drag(state, p), name);
    }
    const double* parameters[max_parameters];
    for (int k = 0; k < max_parameters; ++k) parameters[k] = columns[k].data();
    for (const bool same : {false, true}) {
      PairBatch batch{.count = n,
                      .r = r.data(),
                      .v = v.data(),
                      .m_p = m_p.data(),
                      .m_q = m_q.data(),
                      .t = 0.5,
                      .parameters = parameters,
                      .same_parameters = same,
                      .force = force.data(),
                      .drag = drag.data()};
      listed.evaluate(batch);
      batch.force = force_written.data(), batch.drag = drag_written.data();
      written.evaluate(batch);
      for (std::size_t i = 0; i < n; ++i) {
        double p[max_parameters];
        for (int k = 0; k < max_parameters; ++k) p[k] = columns[k][same ? 0 : i];
        const PairState state{r[i], v[i], 0.5, m_p[i], m_q[i]};
        expect_near(force[i], force_written[i], name);
        expect_near(force[i], listed.damping(state, p).value - listed.elastic(state, p).slope, name);
        expect_near(drag[i], drag_written[i], name);
      }
    }
  }
}

TEST(PairLaw, an_expression_is_split_into_energy_push_damping_and_drag) {
  const PairLaw law("energy = k*r^2; force = t*r - c*v*r; drag = 3*r", {"k", "c"});
  const double p[] = {5, 7};
  const PairState s{2, 0.5, 11, 1, 1};
  EXPECT_TRUE(law.has_energy() && law.has_push() && law.has_damping() && law.has_drag() && law.depends_on_time());
  EXPECT_EQ(law.elastic(s, p).energy, 20);
  EXPECT_EQ(law.elastic(s, p).slope, 20);
  EXPECT_EQ(law.elastic(s, p).curvature, 10);
  EXPECT_EQ(law.push(s, p).value, 22);
  EXPECT_EQ(law.push(s, p).slope, 11);
  EXPECT_EQ(law.damping(s, p).value, -7);
  EXPECT_EQ(law.damping(s, p).slope, -14);
  EXPECT_EQ(law.drag(s, p), 6);
}

TEST(PairLaw, texts_that_are_no_law_are_refused_with_the_place) {
  const auto error_of = [](const char* text) -> std::string {
    try {
      (void)PairLaw(text, {"k"});
    } catch (const expression::ExpressionError& error) {
      return error.what();
    }
    return "none";
  };
  EXPECT_NE(error_of("-k*r").find("write 'energy = ...'"), std::string::npos);
  EXPECT_NE(error_of("enrgy = k*r").find("defines 'energy', 'force' or 'drag'"), std::string::npos);
  EXPECT_NE(error_of("energy = k*v").find("cannot depend on v"), std::string::npos);
  EXPECT_NE(error_of("drag = k*v").find("cannot depend on v"), std::string::npos);
  EXPECT_NE(error_of("force = -kk*r").find("did you mean"), std::string::npos);
}

}  // namespace
}  // namespace iota::laws
