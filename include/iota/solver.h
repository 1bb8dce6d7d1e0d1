// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

/// Solvers for simultaneous equations, and a registry for further ones. They solve the step equations of a `System`
/// (`System::set_solver`) or your own equations.
namespace iota {

/// n equations f(x) = 0 in n unknowns. (The thesis' number_of_equations, equations_evaluate, equations_jacobian.)
/// Scale unknowns and equations so that 1 is a typical size: the tolerance is the same for all.
class NonlinearProblem {
 public:
  virtual ~NonlinearProblem() = default;
  virtual std::size_t size() const = 0;
  /// Writes f(x), n numbers. A value that is not finite makes a solver try a shorter step; exceptions reach the caller.
  virtual void evaluate(std::span<const double> x, std::span<double> f) = 0;
  /// Writes df_i/dx_j to jacobian[i n + j] and returns true, or returns false: then finite differences are used.
  virtual bool jacobian(std::span<const double> x, std::span<double> jacobian);
};

/// The problem's own Jacobian, n x n row-major, or forward differences: n evaluations.
void calc_jacobian(NonlinearProblem&, std::span<const double> x, std::span<double> jacobian);

struct SolverOptions {
  double tolerance = 1e-10;  ///< of the largest |f_i|
  int max_iterations = 200;
};

struct [[nodiscard]] SolverReport {
  bool converged = false;  ///< largest |f_i| <= tolerance, measured after the solve
  int iterations = 0;      ///< as counted by the solver
  int evaluations = 0;     ///< of f, including those for finite differences
  double residual = 0;     ///< largest |f_i| at the result; infinite if one is not finite
  std::string reason;      ///< a plain sentence on why it ended
};

/// Finds a root from a first guess. Derive, implement `search`, and register it under a name.
class Solver {
 public:
  virtual ~Solver() = default;

  /// x: the guess, and the best point found. Non-convergence is a result. Throws std::invalid_argument for x of the
  /// wrong size or not finite and for options out of range; exceptions of the problem propagate with x unchanged.
  SolverReport solve(NonlinearProblem&, std::span<double> x, const SolverOptions& = {});

 protected:
  struct Ending {
    int iterations = 0;
    std::string reason;
  };
  /// Improves x in place; options are in range, x is finite and has the problem's size.
  virtual Ending search(NonlinearProblem&, std::span<double> x, const SolverOptions&) = 0;
};

/// @name Solvers by name
/// "newton": Newton-Raphson with line search and backtracking, least-squares steps where the Jacobian is singular.
/// "kinsol": KINSOL of SUNDIALS (Lawrence Livermore), where this build has it.
/// All of this is safe to call from several threads.
///@{
using SolverFactory = std::function<std::unique_ptr<Solver>()>;
inline constexpr std::size_t max_solver_name = 31;  ///< characters
/// Replaces a former one of that name. Throws std::invalid_argument for a name that is empty, too long, or "direct",
/// the name of a `System`'s own solver.
void register_solver(std::string_view name, SolverFactory factory);
/// Throws std::invalid_argument for an unknown name, listing the known ones.
std::unique_ptr<Solver> make_solver(std::string_view name);
std::vector<std::string> solver_names();
///@}

}  // namespace iota
