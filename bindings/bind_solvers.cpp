// SPDX-License-Identifier: Apache-2.0
// Equations of the script for solvers of the engine, and solvers of the script for equations of the engine.
// `iota.solvers` is the public interface.
#include "binders.h"

#include <iota/solver.h>

#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/tuple.h>

#include <algorithm>
#include <memory>
#include <tuple>
#include <utility>

namespace iota::bindings {

namespace {

using DenseArray = nb::ndarray<nb::numpy, double, nb::c_contig>;

/// A copy owned by Python.
template <class... Sizes>
nb::object make_array(std::span<const double> values, Sizes... sizes) {
  auto* const copy = new double[std::max<std::size_t>(values.size(), 1)];
  std::copy(values.begin(), values.end(), copy);
  const nb::capsule owner(copy, [](void* p) noexcept { delete[] static_cast<double*>(p); });
  return nb::cast(DenseArray(copy, {static_cast<std::size_t>(sizes)...}, owner));
}

/// Copies the script's numbers; ValueError if their shape is wrong. `what`: "evaluate(x)".
template <class... Sizes>
void read_array(nb::handle values, std::span<double> out, const char* what, Sizes... sizes) {
  const nb::tuple wanted = nb::make_tuple(static_cast<std::size_t>(sizes)...);
  const nb::object array = nb::module_::import_("numpy").attr("array")(values, "dtype"_a = "float64", "order"_a = "C");
  if (!nb::object(array.attr("shape")).equal(wanted)) {
    const std::string text = std::string(what) + " must be numbers of shape " + nb::repr(wanted).c_str() + ", not " +
                             nb::repr(nb::object(array.attr("shape"))).c_str();
    throw nb::value_error(text.c_str());
  }
  const auto view = nb::cast<nb::ndarray<const double, nb::c_contig, nb::device::cpu>>(array);
  std::copy_n(view.data(), out.size(), out.data());
}

/// Equations of the script. Called with the interpreter's lock held.
class ScriptedProblem final : public NonlinearProblem {
 public:
  ScriptedProblem(std::size_t size, nb::object evaluate, nb::object jacobian)
      : size_(size), evaluate_(std::move(evaluate)), jacobian_(std::move(jacobian)) {}
  std::size_t size() const override { return size_; }
  void evaluate(std::span<const double> x, std::span<double> f) override {
    read_array(evaluate_(make_array(x, size_)), f, "evaluate(x)", size_);
  }
  bool jacobian(std::span<const double> x, std::span<double> out) override {
    if (jacobian_.is_none()) return false;
    const nb::object values = jacobian_(make_array(x, size_));
    if (values.is_none()) return false;
    read_array(values, out, "jacobian(x)", size_, size_);
    return true;
  }

 private:
  std::size_t size_;
  nb::object evaluate_, jacobian_;
};

/// Equations of the engine for a solver of the script; valid during its call.
struct Equations {
  NonlinearProblem* problem = nullptr;
  NonlinearProblem& use() const {
    if (!problem) raise_runtime("these equations are valid only during the call of the solver");
    return *problem;
  }
};

nb::object& solver_failure() {
  static nb::object* const failure = new nb::object;  // never destroyed: the interpreter may end before
  return *failure;
}

class ScriptedSolver final : public Solver {
 public:
  explicit ScriptedSolver(std::string name) : name_(std::move(name)) {}

 protected:
  Ending search(NonlinearProblem& problem, std::span<double> x, const SolverOptions& options) override {
    // Steps are solved without the lock; a thread with the lock solves equations of the script.
    const MidStep mid_step(!PyGILState_Check());
    nb::gil_scoped_acquire lock;
    try {
      return ask(problem, x, options);
    } catch (nb::python_error& error) {
      if (MidStep::is_now() && !solver_failure().is_valid()) solver_failure() = nb::borrow(error.value());
      throw;
    }
  }

 private:
  Ending ask(NonlinearProblem& problem, std::span<double> x, const SolverOptions& options) {
    const auto equations = std::make_shared<Equations>(&problem);
    struct Withdraw {
      Equations& equations;
      ~Withdraw() { equations.problem = nullptr; }
    } withdraw{*equations};
    const nb::object function = nb::module_::import_("iota.solvers").attr("_functions")[nb::str(name_.c_str())];
    read_array(function(equations, make_array(x, x.size()), options.tolerance, options.max_iterations), x,
               ("the solver " + name_).c_str(), x.size());
    return {0, "the solver ended"};
  }

  std::string name_;
};

using Solution = std::tuple<nb::object, bool, int, int, double, std::string>;

Solution solve_equations(std::size_t size, nb::object evaluate, nb::object jacobian, nb::handle x0,
                         const std::string& method, double tolerance, int max_iterations) {
  ScriptedProblem problem(size, std::move(evaluate), std::move(jacobian));
  std::vector<double> x(size);
  read_array(x0, x, "the first guess", size);
  const SolverReport r = make_solver(method)->solve(problem, x, {tolerance, max_iterations});
  return {make_array(x, size), r.converged, r.iterations, r.evaluations, r.residual, r.reason};
}

}  // namespace

nb::object take_solver_failure() { return std::exchange(solver_failure(), nb::object()); }

void bind_solvers(nb::module_& module) {
  nb::class_<Equations>(module, "Equations", "The argument of a solver of the script: equations to solve.")
      .def_prop_ro(
          "size", [](const Equations& self) { return self.use().size(); }, "Number of equations, and of unknowns.")
      .def(
          "evaluate",
          [](const Equations& self, nb::handle x) {
            NonlinearProblem& problem = self.use();
            std::vector<double> at(problem.size()), f(problem.size());
            read_array(x, at, "x", at.size());
            problem.evaluate(at, f);
            return make_array(f, f.size());
          },
          "x"_a,
          nb::sig(
              "def evaluate(self, x: collections.abc.Sequence[float] | numpy.typing.NDArray[numpy.float64]) -> numpy.typing.NDArray[numpy.float64]"),
          "f(x), n numbers; zero at a root.")
      .def(
          "jacobian",
          [](const Equations& self, nb::handle x) {
            NonlinearProblem& problem = self.use();
            const std::size_t n = problem.size();
            std::vector<double> at(n), values(n * n);
            read_array(x, at, "x", n);
            calc_jacobian(problem, at, values);
            return make_array(values, n, n);
          },
          "x"_a,
          nb::sig(
              "def jacobian(self, x: collections.abc.Sequence[float] | numpy.typing.NDArray[numpy.float64]) -> numpy.typing.NDArray[numpy.float64]"),
          "(n, n): df_i/dx_j; finite differences if the equations have no Jacobian.");
  module.def(
      "solve_equations", &solve_equations, "size"_a, "evaluate"_a, "jacobian"_a.none(), "x0"_a, "method"_a,
      "tolerance"_a, "max_iterations"_a,
      nb::sig("def solve_equations(size: int, evaluate: object, jacobian: object | None, x0: object, method: str, "
              "tolerance: float, max_iterations: int) -> tuple[numpy.typing.NDArray[numpy.float64], bool, int, "
              "int, float, str]"),
      "See iota.solve.");
  module.def(
      "register_solver",
      [](const std::string& name) { register_solver(name, [name] { return std::make_unique<ScriptedSolver>(name); }); },
      "name"_a, "See iota.solver.");
  module.def("solver_names", &solver_names, "See iota.solver_names.");
}

}  // namespace iota::bindings
