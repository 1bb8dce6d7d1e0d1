// SPDX-License-Identifier: Apache-2.0
// The equations of the step in the hands of other solvers.
#include "scenes/chain.h"

#include <iota/solver.h>

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <limits>

namespace iota {
namespace {

constexpr double dt = 1.0 / 120;

/// Passes on to "newton" and looks over its shoulder.
struct Watched final : Solver {
  static inline std::atomic<int> asked = 0;
  static inline std::atomic<double> worst_derivative = 0;
  Ending search(NonlinearProblem& problem, std::span<double> x, const SolverOptions& options) override {
    ++asked;
    const std::size_t n = problem.size();
    std::vector<double> exact(n * n), low(n), high(n), moved(x.begin(), x.end());
    EXPECT_TRUE(problem.jacobian(x, exact));
    double worst = 0;
    for (std::size_t j = 0; j < n; ++j) {
      const double step = 1e-6;
      moved[j] = x[j] + step, problem.evaluate(moved, high);
      moved[j] = x[j] - step, problem.evaluate(moved, low);
      moved[j] = x[j];
      for (std::size_t i = 0; i < n; ++i)
        worst = std::max(worst, std::abs(exact[i * n + j] - (high[i] - low[i]) / (2 * step)));
    }
    worst_derivative = std::max(worst_derivative.load(), worst);
    const SolverReport report = make_solver("newton")->solve(problem, x, options);
    return {report.iterations, report.reason};
  }
};

void make_chain(System& system) { scenes::make_chain(system, {.links = 6, .direction = {0.8, -0.6, 0}}); }

/// A four-bar linkage in a plane: one redundant row for each of its out-of-plane motions is left to the solver.
void make_loop(System& system) {
  const Vec3 corners[] = {{0, 0, 0}, {0, 0.4, 0}, {0.7, 0.6, 0}, {0.8, 0, 0}};
  ParticleId last;
  for (int i = 0; i < 3; ++i) {
    const BodyId bar = system.bodies().create();
    const ParticleId a = system.particles().create(bar, corners[i]), b = system.particles().create(bar, corners[i + 1]);
    if (i > 0) (void)system.edits().combine(last, a);
    if (i == 0) system.particles().nail(a);
    last = b;
  }
  system.particles().nail(last);
}

void make_springs(System& system) {
  Vec3 place{0, 0, 0};
  ParticleId last;
  for (int i = 0; i < 5; ++i) {
    const BodyId body = system.bodies().create();
    const ParticleId p = system.particles().create(body, place, 0.1 + i),
                     q = system.particles().create(body, place + Vec3{0, 0.1, 0});
    system.particles().create(body, place + Vec3{0.1, 0, 0.02 * i});
    if (i > 0) system.bonds().create(last, p, SpringLaw{.stiffness = 1e4, .damping = 1});
    if (i == 0) system.particles().nail(q);
    last = q;
    place = place + Vec3{0.2, 0.02 * i, 0.1};
  }
}

struct Scene {
  const char* name;
  void (*make)(System&);
};
const Scene scenes_to_solve[] = {{"chain", make_chain}, {"loop", make_loop}, {"springs", make_springs}};

std::vector<std::string> built_in_solvers() {
  std::vector<std::string> names{"newton"};
  for (const std::string& name : solver_names())
    if (name == "kinsol") names.push_back(name);
  return names;
}

class SolverOfTheStep : public testing::TestWithParam<std::tuple<std::string, Scene, IntegrationMode>> {};
INSTANTIATE_TEST_SUITE_P(ByName, SolverOfTheStep,
                         testing::Combine(testing::ValuesIn(built_in_solvers()), testing::ValuesIn(scenes_to_solve),
                                          testing::Values(IntegrationMode::robust, IntegrationMode::energy_keeping)),
                         [](const auto& info) {
                           return std::get<0>(info.param) + "_" + std::get<1>(info.param).name +
                                  (std::get<2>(info.param) == IntegrationMode::robust ? "_robust" : "_energy_keeping");
                         });

TEST_P(SolverOfTheStep, moves_the_world_as_the_built_in_one_does) {
  const auto& [solver, scene, mode] = GetParam();
  System direct({.mode = mode}), other({.mode = mode});
  scene.make(direct), scene.make(other);
  other.set_solver(solver);
  EXPECT_EQ(other.solver(), solver);
  double moved = 0;
  for (int i = 0; i < 60; ++i) {
    (void)direct.step(dt);
    const StepReport report = other.step(dt);
    EXPECT_EQ(report.warnings, std::vector<std::string>{});
    EXPECT_EQ(report.unconverged, 0);
    const auto particles = direct.particles().ids();
    for (const ParticleId p : particles) {
      EXPECT_LT(norm(direct.particles().position(p) - other.particles().position(p)), 2e-7) << "step " << i;
      moved = std::max(moved, norm(direct.particles().velocity(p)));
    }
    if (HasFailure()) return;
  }
  EXPECT_GT(moved, 0.1);
}

TEST(SolverOfTheStep, is_shown_equations_whose_jacobian_is_their_derivative) {
  register_solver("watched", [] { return std::make_unique<Watched>(); });
  for (const IntegrationMode mode : {IntegrationMode::robust, IntegrationMode::energy_keeping})
    for (const Scene& scene : scenes_to_solve) {
      System system({.mode = mode});
      scene.make(system);
      system.set_solver("watched");
      Watched::asked = 0, Watched::worst_derivative = 0;
      for (int i = 0; i < 5; ++i) (void)system.step(dt);
      EXPECT_GE(Watched::asked, 5) << scene.name;
      EXPECT_LT(Watched::worst_derivative, 1e-7) << scene.name;
    }
}

struct Hopeless final : Solver {
  Ending search(NonlinearProblem&, std::span<double> x, const SolverOptions&) override {
    if (x.size() > 10) throw std::runtime_error("not today");
    for (double& v : x) v = std::numeric_limits<double>::quiet_NaN();
    return {1, "converged"};
  }
};

TEST(SolverOfTheStep, that_fails_or_throws_is_replaced_and_named) {
  register_solver("hopeless", [] { return std::make_unique<Hopeless>(); });
  for (const int links : {1, 8}) {
    System direct, other;
    scenes::make_chain(direct, {.links = links}), scenes::make_chain(other, {.links = links});
    other.set_solver("hopeless");
    (void)direct.step(dt);
    const StepReport report = other.step(dt);
    ASSERT_EQ(report.warnings.size(), 1u);
    EXPECT_EQ(report.warnings[0], "the solver hopeless found no root in 1 of 1 solves; the built-in one took over");
    for (const ParticleId p : direct.particles().ids())
      EXPECT_EQ(direct.particles().position(p), other.particles().position(p));
  }
}

TEST(SolverOfTheStep, is_recorded_saved_and_refused_when_unknown) {
  System system;
  scenes::make_chain(system, {.links = 3});
  system.record().start();
  system.set_solver("newton");
  for (int i = 0; i < 10; ++i) (void)system.step(dt);
  const Recording recording = system.record().stop();
  EXPECT_EQ(system.solver(), "newton");
  const Snapshot snapshot = system.snapshot();
  EXPECT_THROW(system.set_solver("no such solver"), std::invalid_argument);
  EXPECT_THROW(system.set_solver(""), std::invalid_argument);
  EXPECT_THROW(system.set_solver(std::string(32, 'x')), std::invalid_argument);
  EXPECT_EQ(system.solver(), "newton");
  system.set_solver("direct");
  EXPECT_EQ(system.solver(), "direct");
  system.restore(snapshot);
  EXPECT_EQ(system.solver(), "newton");
  EXPECT_EQ(system.record().replay(recording), std::nullopt);
}

}  // namespace
}  // namespace iota
