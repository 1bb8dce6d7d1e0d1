// SPDX-License-Identifier: Apache-2.0
// A problem whose structure changes in place steps as one that is built and analyzed anew.
#include "solver/integrator.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <utility>
#include <vector>

namespace iota::solver {
namespace {

using Pair = std::array<std::uint32_t, 2>;

BilinearConstraint rope_between(const Pair& ends, double length) {
  BilinearConstraint row;
  for (const int arm : {0, 1}) row.add(arm, ends[0], -1), row.add(arm, ends[1], 1);
  row.product = length * length, row.scale = 2 * length, row.reference = length;
  return row;
}

/// Points that rods join to a tree, with ropes, springs, grips and nails, of which a problem is built.
struct Structure {
  std::vector<Vec3> position, velocity;
  std::vector<double> mass;
  std::vector<Pair> rods, ropes, springs;
  std::vector<std::uint32_t> grips, nails;

  double distance(const Pair& ends) const { return norm(position[ends[1]] - position[ends[0]]); }

  /// Adds everything; a problem that is being changed takes what it lacks.
  void add_to(Problem& problem) const {
    for (std::uint32_t node = 0; node < mass.size(); ++node) problem.add_mass(node, mass[node]);
    for (const Pair& rod : rods) {
      for (const std::uint32_t end : rod) problem.add_mass(end, -0.01);
      problem.couple_masses(rod[0], rod[1], 0.01);
      problem.add(DistanceConstraint{rod, distance(rod), distance(rod)}, {});
    }
    for (const Pair& rope : ropes) {
      problem.add(rope_between(rope, 1.1 * distance(rope)), {});
      (void)problem.pool_of<BilinearConstraint>().law(0);
    }
    for (const Pair& spring : springs) {
      SpringForce force;
      force.arm.nodes = {spring[0], spring[1]}, force.arm.weights = {-1, 1}, force.arm.count = 2;
      force.stiffness = 5, force.damping = 0.1, force.length = 0.9 * distance(spring);
      problem.add(force, {});
    }
    for (const std::uint32_t node : grips) {
      GripForce force;
      force.arm.nodes[0] = node, force.arm.weights[0] = 1, force.arm.count = 1;
      force.arm.origin = position[node] + Vec3{0.01, 0.02, 0}, force.stiffness = 3, force.damping = 1;
      problem.add(force, {});
    }
    for (const std::uint32_t node : nails) {
      AffineConstraint nail;
      nail.nodes[0] = node, nail.weights[0] = 1, nail.count = 1;
      nail.target = nail.target_start = position[node];
      problem.add(nail, {});
    }
    // What an owner does before each step.
    for (RowLaw& law : problem.pool_of<BilinearConstraint>().laws) law = {.lower = 0};
  }
  Problem build() const {
    Problem problem;
    problem.add_nodes(mass.size());
    add_to(problem);
    return problem;
  }
  void load(Problem& problem) const {
    problem.gravity = {0, -9.81, 0};
    problem.position = position, problem.velocity = velocity;
    problem.clear_multipliers();
    for (RowLaw& law : problem.pool_of<BilinearConstraint>().laws) law = {.lower = 0};
  }
};

/// A structure that changes, and the problem that follows.
struct Changing {
  Structure now;
  Problem problem;
  Integrator integrator;
  std::mt19937 random;

  explicit Changing(unsigned seed) : random(seed) {
    std::uniform_real_distribution<double> number(-1, 1);
    for (std::uint32_t n = 0; n < 60; ++n) {
      const std::uint32_t to =
          n == 0 ? 0 : n - 1 - static_cast<std::uint32_t>(random() % std::min<std::uint32_t>(n, 2));
      const Vec3 step{0.3 + 0.1 * number(random), 0.2 * number(random), 0.2 * number(random)};
      now.position.push_back(n == 0 ? Vec3{} : now.position[to] + step);
      now.velocity.push_back({}), now.mass.push_back(1 + 0.5 * number(random));
      if (n > 0) now.rods.push_back({to, n});
    }
    now.nails = {0};
    problem = now.build();
    integrator.compile(problem);
  }

  std::uint32_t any_node() { return static_cast<std::uint32_t>(random() % now.mass.size()); }
  Pair any_pair() {  // of nodes that are apart
    const std::uint32_t a = any_node();
    std::uint32_t b = any_node();
    while (now.distance({a, b}) < 0.05) b = any_node();
    return {a, b};
  }
  template <class T>
  T take_any(std::vector<T>& list) {
    const auto at = list.begin() + static_cast<std::ptrdiff_t>(random() % list.size());
    const T taken = *at;
    list.erase(at);
    return taken;
  }

  /// Opens `nodes` and adds what is there now.
  void follow(const std::vector<std::uint32_t>& nodes, std::vector<std::uint32_t> removed = {}) {
    problem.open(nodes);
    now.add_to(problem);
    for (const std::uint32_t node : removed) problem.mark_for_removal(node);
    integrator.follow(problem);
  }
  void follow_at(const Pair& ends) { follow(std::vector(ends.begin(), ends.end())); }
  void follow_at(std::uint32_t node) { follow(std::vector{node}); }

  /// One end of a rod comes off its node, which is there twice then.
  void cut() {
    Pair& rod = now.rods[random() % now.rods.size()];
    const std::uint32_t end = random() % 2, old = rod[end], fresh = problem.add_node_beside(old);
    now.position.push_back(now.position[old]), now.velocity.push_back(now.velocity[old]);
    now.mass.push_back(now.mass[old] /= 2);
    rod[end] = fresh;
    follow_at(Pair{old, fresh});
  }
  /// The last node goes, with all that ends there.
  void remove_last() {
    const auto last = static_cast<std::uint32_t>(now.mass.size() - 1);
    std::vector<std::uint32_t> nodes{last};
    const auto ends_there = [&](const Pair& ends) {
      const bool ends_here = ends[0] == last || ends[1] == last;
      if (ends_here) nodes.insert(nodes.end(), ends.begin(), ends.end());
      return ends_here;
    };
    std::erase_if(now.rods, ends_there), std::erase_if(now.ropes, ends_there), std::erase_if(now.springs, ends_there);
    std::erase(now.grips, last), std::erase(now.nails, last);
    now.position.pop_back(), now.velocity.pop_back(), now.mass.pop_back();
    follow(nodes, {last});
  }
  void edit() {
    switch (random() % 7) {
      case 0: return cut();
      case 1: return now.mass.size() > 55 ? remove_last() : cut();
      case 2: now.ropes.push_back(any_pair()); return follow_at(now.ropes.back());
      case 3: now.springs.push_back(any_pair()); return follow_at(now.springs.back());
      case 4: now.grips.push_back(any_node()); return follow_at(now.grips.back());
      case 5: return now.ropes.empty() ? void() : follow_at(take_any(now.ropes));
      default: return now.grips.empty() ? void() : follow_at(take_any(now.grips));
    }
  }
};

/// Of a step of each of two problems from the same state.
double difference_after_a_step(const Structure& structure, Problem& a, Integrator& of_a, Problem& b, Integrator& of_b) {
  structure.load(a), structure.load(b);
  (void)of_a.advance(a, 1.0 / 120, IntegratorSettings::robust()),
      (void)of_b.advance(b, 1.0 / 120, IntegratorSettings::robust());
  double farthest = 0;
  for (std::size_t i = 0; i < a.size(); ++i) farthest = std::max(farthest, norm(a.position[i] - b.position[i]));
  return farthest;
}

TEST(FollowingProblem, steps_as_one_that_is_built_anew) {
  for (unsigned seed = 1; seed <= 8; ++seed) {
    Changing changing(seed);
    for (int edit = 0; edit < 40; ++edit) {
      changing.edit();
      ASSERT_EQ(changing.problem.size(), changing.now.mass.size());
      Problem anew = changing.now.build();
      Integrator integrator;
      integrator.compile(anew);
      for (std::size_t i = 0; i < anew.size(); ++i) ASSERT_NEAR(changing.problem.mass[i], anew.mass[i], 1e-14);
      ASSERT_EQ(changing.problem.multiplier_count(), anew.multiplier_count());
      ASSERT_LT(difference_after_a_step(changing.now, changing.problem, changing.integrator, anew, integrator), 1e-9)
          << "seed " << seed << " edit " << edit;
    }
  }
}

// A borrowed island: one body after another, which may have another structure.
TEST(AssemblyStructure, of_problems_that_are_built_in_the_place_of_others_is_like_that_of_new_ones) {
  std::mt19937 random(3);
  const auto number = [&] { return std::uniform_real_distribution(0.5, 1.5)(random); };
  Problem reused;
  Integrator integrator;
  int alike = 0;
  std::uint64_t before = 0;
  for (int round = 0; round < 60; ++round) {
    Structure structure;
    const std::uint32_t points = 2 + random() % 2;
    for (std::uint32_t i = 0; i < points; ++i) {
      structure.position.push_back({1.0 * i, number(), number()}), structure.velocity.push_back({number(), 0, 0});
      structure.mass.push_back(number());
      if (i > 0) structure.rods.push_back({i - 1, i});
    }
    if (random() % 6 == 0) structure.springs.push_back({0, points - 1});
    if (random() % 6 == 0) structure.nails.push_back(0);
    const auto step = [&](Problem& problem, Integrator& with) {
      problem.add_nodes(points);
      structure.add_to(problem);
      problem.gravity = {0, -9.81, 0};
      std::copy(structure.position.begin(), structure.position.end(), problem.position.begin());
      std::copy(structure.velocity.begin(), structure.velocity.end(), problem.velocity.begin());
      const std::uint64_t made = problem.structure();
      with.compile(problem);
      for (const auto& settings : {IntegratorSettings::energy_keeping(), IntegratorSettings::robust()})
        (void)with.advance(problem, 0.01, settings);
      return made;
    };
    reused.clear();
    const std::uint64_t made = step(reused, integrator);
    alike += std::exchange(before, made) == made;
    Problem fresh;
    Integrator own;
    (void)step(fresh, own);
    for (std::uint32_t i = 0; i < points; ++i) {
      ASSERT_EQ(reused.position[i], fresh.position[i]) << "round " << round;
      ASSERT_EQ(reused.velocity[i], fresh.velocity[i]) << "round " << round;
    }
  }
  EXPECT_GT(alike, 5);
  EXPECT_LT(alike, 55);
}

}  // namespace
}  // namespace iota::solver
