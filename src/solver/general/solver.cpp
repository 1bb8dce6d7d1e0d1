// SPDX-License-Identifier: Apache-2.0
#include "solver/general/general.h"

#include <algorithm>
#include <map>
#include <mutex>
#include <stdexcept>

namespace iota {

bool NonlinearProblem::jacobian(std::span<const double>, std::span<double>) { return false; }

void calc_jacobian(NonlinearProblem& problem, std::span<const double> x, std::span<double> jacobian) {
  if (problem.jacobian(x, jacobian)) return;
  const std::size_t n = problem.size();
  std::vector<double> moved(x.begin(), x.end()), f(n), f_moved(n);
  problem.evaluate(x, f);
  for (std::size_t j = 0; j < n; ++j) {
    // The square root of round-off balances the errors of the difference and of the function.
    const double wanted = 1.5e-8 * std::max(std::abs(x[j]), 1.0);
    moved[j] = x[j] + wanted;
    const double step = moved[j] - x[j];  // the actual difference
    problem.evaluate(moved, f_moved);
    for (std::size_t i = 0; i < n; ++i) jacobian[i * n + j] = (f_moved[i] - f[i]) / step;
    moved[j] = x[j];
  }
}

namespace {

class Counted final : public NonlinearProblem {
 public:
  explicit Counted(NonlinearProblem& problem) : problem_(problem) {}
  std::size_t size() const override { return problem_.size(); }
  void evaluate(std::span<const double> x, std::span<double> f) override {
    ++evaluations;
    problem_.evaluate(x, f);
  }
  bool jacobian(std::span<const double> x, std::span<double> jacobian) override {
    return problem_.jacobian(x, jacobian);
  }
  int evaluations = 0;

 private:
  NonlinearProblem& problem_;
};

struct Registry {
  std::mutex mutex;
  std::map<std::string, SolverFactory, std::less<>> factories;
  Registry() {
    factories["newton"] = solver::make_newton_raphson;
    if (solver::has_kinsol()) factories["kinsol"] = solver::make_kinsol;
  }
};

Registry& registry() {
  static Registry* const instance = new Registry;  // never destroyed: factories may hold what dies before
  return *instance;
}

}  // namespace

SolverReport Solver::solve(NonlinearProblem& problem, std::span<double> x, const SolverOptions& options) {
  const std::size_t n = problem.size();
  if (x.size() != n)
    throw std::invalid_argument("solve: " + std::to_string(n) + " equations need as many unknowns, and the guess has " +
                                std::to_string(x.size()));
  if (!std::isfinite(solver::largest(x))) throw std::invalid_argument("solve: the guess must be finite");
  if (!(options.tolerance > 0 && std::isfinite(options.tolerance)))
    throw std::invalid_argument("solve: the tolerance must be above 0, got " + std::to_string(options.tolerance));
  if (options.max_iterations < 1)
    throw std::invalid_argument("solve: max_iterations must be 1 or more, got " +
                                std::to_string(options.max_iterations));
  SolverReport report;
  if (n == 0) {
    report.converged = true, report.reason = "nothing to solve";
    return report;
  }
  Counted counted(problem);
  std::vector<double> answer(x.begin(), x.end()), f(n);
  Ending ending = search(counted, answer, options);
  counted.evaluate(answer, f);
  report.iterations = ending.iterations;
  report.evaluations = counted.evaluations;
  report.residual = solver::largest(f);
  report.converged = report.residual <= options.tolerance && std::isfinite(solver::largest(answer));
  report.reason = report.converged ? "converged" : std::move(ending.reason);
  if (!report.converged && report.reason == "converged")
    report.reason = "the solver says that it converged, but the equations say that it has not";
  std::copy(answer.begin(), answer.end(), x.begin());
  return report;
}

void register_solver(std::string_view name, SolverFactory factory) {
  if (name.empty() || name.size() > max_solver_name)
    throw std::invalid_argument("register_solver: a name has 1 to " + std::to_string(max_solver_name) +
                                " characters, and \"" + std::string(name) + "\" has " + std::to_string(name.size()));
  if (name == "direct") throw std::invalid_argument("register_solver: \"direct\" is a system's own solver");
  if (!factory) throw std::invalid_argument("register_solver: there must be a function that makes the solver");
  const std::lock_guard lock(registry().mutex);
  registry().factories.insert_or_assign(std::string(name), std::move(factory));
}

std::vector<std::string> solver_names() {
  const std::lock_guard lock(registry().mutex);
  std::vector<std::string> names;
  for (const auto& [name, factory] : registry().factories) names.push_back(name);
  return names;
}

std::unique_ptr<Solver> make_solver(std::string_view name) {
  SolverFactory factory;
  {
    const std::lock_guard lock(registry().mutex);
    const auto found = registry().factories.find(name);
    if (found != registry().factories.end()) factory = found->second;
  }
  if (factory) return factory();  // outside of the lock: it may be slow, or call the script
  if (name == "kinsol")
    throw std::invalid_argument(
        "the solver \"kinsol\" is not in this build, which was made without SUNDIALS. `make build` fetches it; or use "
        "\"newton\"");
  std::string known;
  for (const std::string& other : solver_names()) known += (known.empty() ? "\"" : "\", \"") + other;
  throw std::invalid_argument("there is no solver \"" + std::string(name) + "\", only " + known + "\"");
}

}  // namespace iota
