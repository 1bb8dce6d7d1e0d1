// SPDX-License-Identifier: Apache-2.0
#include "solver/step_equations.h"

#include <algorithm>

namespace iota::solver {

template <class Visit>
void StepEquations::for_each_row(Visit visit) const {
  problem_.for_each_constraint_pool([&]<class C>(ConstraintPool<C>& pool) {
    for (std::size_t k = 0; k < pool.items.size(); ++k)
      for (int r = 0; r < C::rows; ++r) {
        visit(pool.slots[k].unknown + static_cast<std::uint32_t>(r), pool.multiplier(k)[r],
              !ConeConstraint<C> && !pool.is_equation(k, r));
      }
  });
}

StepEquations::StepEquations(Newton& newton, Problem& problem, const Stage& stage)
    : newton_(newton), problem_(problem), stage_(stage) {
  const std::size_t n = newton.assembly_.unknown_count();
  const double length = newton.reference_length(), force_scale = newton.assembly_.inverse_scale(stage);
  row_scale_.assign(n, 0), column_scale_.assign(n, 0);
  double mass = 0;
  for (const double m : problem.mass) mass += m / static_cast<double>(problem.size());
  for (std::size_t i = 0; i < problem.size(); ++i) {
    const auto node = static_cast<std::uint32_t>(i);
    const std::uint32_t unknown = newton.assembly_.unknown_of(node);
    std::fill_n(row_scale_.begin() + unknown, 3, force_scale / problem.mass[i]);
    std::fill_n(column_scale_.begin() + unknown, 3, length);
  }
  problem.for_each_constraint_pool([&]<class C>(const ConstraintPool<C>& pool) {
    for (std::size_t k = 0; k < pool.items.size(); ++k) {
      std::fill_n(row_scale_.begin() + pool.slots[k].unknown, C::rows, 1 / pool.items[k].reference_length());
      std::fill_n(column_scale_.begin() + pool.slots[k].unknown, C::rows, stage.inertia * mass * length);
    }
  });
}

std::vector<double> StepEquations::unknowns() const {
  std::vector<double> out(size());
  for (std::size_t i = 0; i < problem_.size(); ++i) {
    const Vec3& u = newton_.u_[i];
    double* const at = out.data() + newton_.assembly_.unknown_of(static_cast<std::uint32_t>(i));
    at[0] = u.x, at[1] = u.y, at[2] = u.z;
  }
  for_each_row([&](std::uint32_t unknown, double multiplier, bool) { out[unknown] = multiplier; });
  for (std::size_t i = 0; i < out.size(); ++i) out[i] /= column_scale_[i];
  return out;
}

double StepEquations::assign(std::span<const double> unknowns) {
  for (std::size_t i = 0; i < problem_.size(); ++i) {
    const double* const at = unknowns.data() + newton_.assembly_.unknown_of(static_cast<std::uint32_t>(i));
    newton_.u_[i] = newton_.reference_length() * Vec3{at[0], at[1], at[2]};
    newton_.x_[i] = problem_.position[i] + stage_.h * problem_.velocity[i] + newton_.u_[i];
  }
  for_each_row([&](std::uint32_t unknown, double& multiplier, bool bound) {
    if (!bound) multiplier = column_scale_[unknown] * unknowns[unknown];
  });
  newton_.measure(problem_, stage_);
  return newton_.residual_.worst;
}

void StepEquations::evaluate(std::span<const double> x, std::span<double> f) {
  (void)assign(x);
  for (std::size_t i = 0; i < f.size(); ++i) f[i] = row_scale_[i] * newton_.assembly_.residuals()[i];
  for_each_row([&](std::uint32_t unknown, double multiplier, bool bound) {
    if (bound) f[unknown] = row_scale_[unknown] * (multiplier - column_scale_[unknown] * x[unknown]);
  });
}

bool StepEquations::jacobian(std::span<const double> x, std::span<double> jacobian) {
  (void)assign(x);
  Assembly& assembly = newton_.assembly_;
  assembly.assemble(problem_, stage_, newton_.x_.data(), Hessian::exact);
  const bool is_symmetric = assembly.factor().storage() == Storage::symmetric;
  const double *const diagonals = assembly.factor().diagonals(), *const lower = assembly.factor().lower(),
                      *const upper = assembly.factor().upper();
  std::fill(jacobian.begin(), jacobian.end(), 0.0);
  const auto put = [&](std::size_t i, std::size_t j, double value) {
    jacobian[i * size() + j] = row_scale_[i] * value * column_scale_[j];
  };
  const BlockPattern& pattern = assembly.pattern();
  for (const BlockPattern::Vertex& v : pattern.vertices()) {
    for (std::uint32_t i = 0; i < v.pivot; ++i)
      for (std::uint32_t j = 0; j < v.pivot; ++j) {
        const bool mirrored = is_symmetric && j > i;  // of a symmetric matrix only the lower triangle is filled
        put(v.unknown + i, v.unknown + j, diagonals[v.diagonal + (mirrored ? j * v.pivot + i : i * v.pivot + j)]);
      }
    for (const auto& entry : pattern.entries().subspan(v.first_entry, v.entry_count))
      for (std::uint32_t i = 0; i < entry.width; ++i)
        for (std::uint32_t j = 0; j < v.pivot; ++j) {
          const std::size_t at = entry.offset + i * v.pivot + j;
          put(entry.unknown + i, v.unknown + j, lower[at]);
          put(v.unknown + j, entry.unknown + i, is_symmetric ? lower[at] : upper[at]);
        }
  }
  for_each_row([&](std::uint32_t unknown, double, bool bound) {
    if (bound) put(unknown, unknown, -1);
  });
  return true;
}

}  // namespace iota::solver
