// SPDX-License-Identifier: Apache-2.0
#include "solver/sparse/block_factor.h"

#include "tests/cpp/solver/sparse/dense_twin.h"

namespace iota::solver {
namespace {

template <int Pivot>
struct TwoLeaves {
  std::array<std::array<double, Pivot * Pivot>, 2> diagonal;
  std::array<std::array<double, 3 * Pivot>, 2> lower, upper;
  std::array<double, 9> target;  // of both
  std::array<std::array<double, Pivot>, 2> own;
  std::array<double, 3> later;

  template <int N>
  Leaves<Pivot, N> from(std::size_t first) {
    Leaves<Pivot, N> leaves;
    for (std::size_t lane = 0; lane < N; ++lane) {
      leaves.diagonal[lane] = diagonal[first + lane].data();
      leaves.lower[lane] = lower[first + lane].data(), leaves.upper[lane] = upper[first + lane].data();
      leaves.target[lane] = target.data(), leaves.target_stride[lane] = 3;
      leaves.own[lane] = own[first + lane].data(), leaves.later[lane] = later.data();
    }
    return leaves;
  }
  bool operator==(const TwoLeaves&) const = default;
};

template <int Pivot, bool Symmetric>
void expect_equal_bits_in_lanes(std::mt19937& random) {
  std::uniform_real_distribution<double> number(-1, 1);
  TwoLeaves<Pivot> together;
  for (std::size_t leaf = 0; leaf < 2; ++leaf) {
    for (double& v : together.diagonal[leaf]) v = number(random);
    for (std::size_t k = 0; k < Pivot; ++k) together.diagonal[leaf][k * (Pivot + 1)] += k < 3 ? 5 : -5;
    for (auto* list : {&together.lower[leaf], &together.upper[leaf]})
      for (double& v : *list) v = number(random);
    for (double& v : together.own[leaf]) v = number(random);
  }
  for (double& v : together.target) v = number(random);
  for (double& v : together.later) v = number(random);
  TwoLeaves<Pivot> alone = together;
  const auto pair = together.template from<2>(0);
  EXPECT_EQ(pair.template eliminate<Symmetric>(3), 0);
  pair.template finish<Symmetric>();
  const auto first = alone.template from<1>(0), second = alone.template from<1>(1);
  EXPECT_EQ(first.template eliminate<Symmetric>(3) + second.template eliminate<Symmetric>(3), 0);
  first.template finish<Symmetric>(), second.template finish<Symmetric>();
  EXPECT_TRUE(together == alone);
}

TEST(Leaves, get_the_same_bits_in_lanes_as_alone) {
  std::mt19937 random(3);
  for (int i = 0; i < 200; ++i) {
    expect_equal_bits_in_lanes<3, true>(random), expect_equal_bits_in_lanes<3, false>(random);
    expect_equal_bits_in_lanes<4, true>(random), expect_equal_bits_in_lanes<4, false>(random);
    expect_equal_bits_in_lanes<6, true>(random), expect_equal_bits_in_lanes<6, false>(random);
  }
}

TEST(BlockFactor, equals_a_dense_solve_on_random_symmetric_matrices) {
  std::mt19937 random(1);
  for (int i = 0; i < 300; ++i) Twin(random_graph(random), true, random).expect_equal_solutions();
}

TEST(BlockFactor, equals_a_dense_solve_on_random_unsymmetric_matrices) {
  std::mt19937 random(2);
  for (int i = 0; i < 300; ++i) {
    Twin twin(random_graph(random), false, random);
    const std::vector<double> expected = twin.solve_densely();
    (void)twin.factor.factorize();
    std::vector<double> x = twin.right_side;
    twin.factor.solve(x);
    double largest = 0;
    for (const double v : expected) largest = std::max(largest, std::abs(v));
    for (std::size_t k = 0; k < x.size(); ++k) ASSERT_NEAR(x[k], expected[k], 1e-7 * (1 + largest));
  }
}

TEST(Panels, give_the_solution_of_a_dense_one) {
  std::mt19937 random(17);
  for (const bool symmetric : {true, false})
    for (const bool diagonals : {false, true})
      for (const bool rows : {false, true}) {
        if (rows && !symmetric) continue;  // pivots of random rows may then have any sign
        Twin twin(net(9, diagonals, rows), symmetric, random);
        EXPECT_FALSE(twin.pattern.panels().empty());
        twin.expect_equal_solutions();
      }
}

TEST(Panels, hold_all_wide_vertices_and_nothing_twice) {
  BlockPattern pattern;
  CouplingGraph graph = net(40, true, true);
  pattern.analyze(graph);
  std::vector<int> times(pattern.vertices().size(), 0);
  std::uint32_t last_before = 0;
  for (const auto& panel : pattern.panels()) {
    const auto members = pattern.panel_vertices().subspan(panel.first, panel.count);
    std::uint32_t columns = 0;
    for (const std::uint32_t v : members) ++times[v], columns += pattern.vertices()[v].pivot;
    EXPECT_EQ(columns, panel.columns);
    EXPECT_LE(last_before, members.back()) << "in order of elimination";
    last_before = members.back();
    for (std::size_t i = 0; i + 1 < members.size(); ++i)
      EXPECT_EQ(pattern.entries()[pattern.vertices()[members[i]].first_entry].vertex, members[i + 1]);
  }
  for (std::size_t v = 0; v < times.size(); ++v) {
    EXPECT_LE(times[v], 1);
    if (pattern.vertices()[v].is_wide()) EXPECT_EQ(times[v], 1);
  }
}

}  // namespace
}  // namespace iota::solver
