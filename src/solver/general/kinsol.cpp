// SPDX-License-Identifier: Apache-2.0
// KINSOL of SUNDIALS: Hindmarsh et al., SUNDIALS: Suite of nonlinear and differential/algebraic equation solvers, ACM
// TOMS 31 (2005). Newton with line search over its dense linear solver.
#include "solver/general/general.h"

#include <algorithm>
#include <exception>
#include <stdexcept>

#ifdef IOTA_HAVE_KINSOL
#include <kinsol/kinsol.h>
#include <nvector/nvector_serial.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_dense.h>
#endif

namespace iota::solver {

#ifdef IOTA_HAVE_KINSOL

namespace {

template <class Handle, class Free>
struct Owned {
  Handle handle{};
  Free free;
  Owned(Handle h, Free f) : handle(h), free(f) {
    if (!handle) throw std::runtime_error("KINSOL found no memory");
  }
  ~Owned() { free(handle); }
  Owned(const Owned&) = delete;
  Owned& operator=(const Owned&) = delete;
  operator Handle() const { return handle; }
};

/// The user data of KINSOL's callbacks. They are called from C, so no exception may leave them.
struct Call {
  NonlinearProblem& problem;
  std::vector<double> jacobian;
  std::exception_ptr thrown;

  template <class Work>
  int guarded(Work work) {
    try {
      return work() ? 0 : 1;  // 1: try a shorter step
    } catch (...) {
      thrown = std::current_exception();
      return -1;
    }
  }
};

std::span<double> numbers(N_Vector v) { return {N_VGetArrayPointer(v), static_cast<std::size_t>(N_VGetLength(v))}; }

int evaluate(N_Vector x, N_Vector f, void* data) {
  Call& call = *static_cast<Call*>(data);
  return call.guarded([&] {
    call.problem.evaluate(numbers(x), numbers(f));
    return std::isfinite(largest(numbers(f)));
  });
}

int fill_jacobian(N_Vector x, N_Vector, SUNMatrix matrix, void* data, N_Vector, N_Vector) {
  Call& call = *static_cast<Call*>(data);
  return call.guarded([&] {
    const std::size_t n = numbers(x).size();
    calc_jacobian(call.problem, numbers(x), call.jacobian);
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = 0; j < n; ++j)
        SM_ELEMENT_D(matrix, static_cast<sunindextype>(i), static_cast<sunindextype>(j)) = call.jacobian[i * n + j];
    return std::isfinite(largest(call.jacobian));
  });
}

void say_nothing(int, const char*, const char*, char*, void*) {}

class Kinsol final : public Solver {
  Ending search(NonlinearProblem& problem, std::span<double> x, const SolverOptions& options) override {
    SUNContext made = nullptr;
    SUNContext_Create(nullptr, &made);
    const Owned context(made, [](SUNContext c) { SUNContext_Free(&c); });
    const auto n = static_cast<sunindextype>(x.size());
    const auto free_vector = [](N_Vector v) { N_VDestroy(v); };
    const Owned answer(N_VMake_Serial(n, x.data(), context), free_vector);
    const Owned ones(N_VNew_Serial(n, context), free_vector);
    N_VConst(1, ones);
    const Owned matrix(SUNDenseMatrix(n, n, context), [](SUNMatrix m) { SUNMatDestroy(m); });
    const Owned linear(SUNLinSol_Dense(answer, matrix, context), [](SUNLinearSolver s) { SUNLinSolFree(s); });
    const Owned memory(KINCreate(context), [](void* m) { KINFree(&m); });

    Call call{problem, std::vector<double>(x.size() * x.size()), nullptr};
    double size = 0;
    for (const double v : x) size += v * v;
    KINSetErrHandlerFn(memory, say_nothing, nullptr);
    KINInit(memory, evaluate, answer);
    KINSetUserData(memory, &call);
    KINSetLinearSolver(memory, linear, matrix);
    KINSetJacFn(memory, fill_jacobian);
    KINSetMaxSetupCalls(memory, 1);  // a new Jacobian at each iteration
    KINSetFuncNormTol(memory, options.tolerance);
    KINSetScaledStepTol(memory, 1e-14);
    KINSetMaxNewtonStep(memory, 1e3 * std::max(std::sqrt(size), std::sqrt(static_cast<double>(n))));
    KINSetNumMaxIters(memory, options.max_iterations);
    const int flag = KINSol(memory, answer, KIN_LINESEARCH, ones, ones);
    if (call.thrown) std::rethrow_exception(call.thrown);

    long iterations = 0;
    KINGetNumNonlinSolvIters(memory, &iterations);
    char* const name = KINGetReturnFlagName(flag);
    Ending ending{static_cast<int>(iterations), flag == KIN_SUCCESS || flag == KIN_INITIAL_GUESS_OK
                                                    ? "converged"
                                                    : std::string("KINSOL gave up: ") + (name ? name : "?")};
    std::free(name);
    return ending;
  }
};

}  // namespace

bool has_kinsol() { return true; }
std::unique_ptr<Solver> make_kinsol() { return std::make_unique<Kinsol>(); }

#else

bool has_kinsol() { return false; }
std::unique_ptr<Solver> make_kinsol() { throw std::runtime_error("this build has no SUNDIALS"); }

#endif

}  // namespace iota::solver
