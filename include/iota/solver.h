// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

/// Solvers for simultaneous equations, and the place to put others. The step equations of a `System` can be given to any
/// of them (`System::set_solver`), and so can equations of your own.
namespace iota {

/// n equations f(x) = 0 in n unknowns. (The thesis' number_of_equations, equations_evaluate, equations_jacobian.)
/// Scale unknowns and equations so that 1 is a usual size: solvers measure all of them alike.
class NonlinearProblem {
 public:
  virtual ~NonlinearProblem() = default;
  virtual std::size_t size() const = 0;
  /// Writes f(x), n numbers. A value that is not finite makes a solver try a shorter step; exceptions reach the caller.
  virtual void evaluate(std::span<const double> x, std::span<double> f) = 0;
  /// Writes df_i/dx_j at jacobian[i n + j] and returns true, or returns false: differences are taken then.
  virtual bool jacobian(std::span<const double> x, std::span<double> jacobian);
};

/// The problem's own Jacobian, n x n row-major, or forward differences: n evaluations.
void calc_jacobian(NonlinearProblem&, std::span<const double> x, std::span<double> jacobian);

struct SolverOptions {
  double tolerance = 1e-10;  ///< of the largest |f_i|
  int max_iterations = 200;
};

struct [[nodiscard]] SolverReport {
  bool converged = false;  ///< largest |f_i| <= tolerance, measured afterwards and not taken from the solver
  int iterations = 0;      ///< as the solver counts them
  int evaluations = 0;     ///< of f, including those for finite differences
  double residual = 0;     ///< largest |f_i| at the answer; infinite where one is not finite
  std::string reason;      ///< a plain sentence on why it ended
};

/// Finds a root from a first guess. Derive, implement `search`, and register it to have it everywhere by name.
class Solver {
 public:
  virtual ~Solver() = default;

  /// x: the guess, and the best point found. Not converged is a result. Throws std::invalid_argument for x of the wrong
  /// size or not finite and for options out of range; what the problem throws passes, and x is then as it was.
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
/// which is what a `System` calls its own.
void register_solver(std::string_view name, SolverFactory factory);
/// Throws std::invalid_argument for an unknown name, listing the known ones.
std::unique_ptr<Solver> make_solver(std::string_view name);
std::vector<std::string> solver_names();
///@}

}  // namespace iota
