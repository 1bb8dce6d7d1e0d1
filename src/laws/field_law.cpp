// SPDX-License-Identifier: Apache-2.0
#include "laws/field_law.h"

#include "laws/law_list.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace iota::laws {

namespace {

using expression::Formula;
using expression::Node;
using expression::Program;

constexpr std::size_t field_variable_count = std::size(FieldLaw::variables);

using FieldLawList = LawList<FieldLaws>;

constexpr std::uint32_t first_velocity = 3;  // among the variables
constexpr std::size_t rate_count = 9;

FieldState state_of(const ParticleArrays& a, std::size_t i, double t) {
  return {{a.x[i], a.y[i], a.z[i]}, {a.vx[i], a.vy[i], a.vz[i]}, a.m[i], t};
}

}  // namespace

FieldLaw::FieldLaw(std::uint32_t number) : number_(number), parameter_count_(field_law_parameters(number).size()) {
  FieldLawList::visit(number_,
                      [&]<class Law>() { has_energy_ = Law::has_energy, depends_on_velocity_ = Law::has_drag; });
}

FieldLaw::FieldLaw(std::string_view text, std::vector<std::string> parameters) : parameter_count_(parameters.size()) {
  std::vector<std::string> inputs(std::begin(variables), std::end(variables));
  inputs.insert(inputs.end(), parameters.begin(), parameters.end());
  Formula formula(std::move(inputs));
  const auto definitions = expression::parse(text, formula);
  expression::require_mentioned(text, std::span(formula.inputs()).subspan(field_variable_count));
  const Node zero = formula.constant(0);
  std::array<Node, 3> force;
  force.fill(zero);
  Node energy = zero;
  bool any = false;
  for (const auto& d : definitions) {
    for (std::uint32_t k = 0; k < 3; ++k)
      if (d.name == std::array{"fx", "fy", "fz"}[k]) force[k] = d.node, any = true;
    if (d.name != "energy") continue;
    energy = d.node, any = true;
    for (std::uint32_t k = 0; k < 3; ++k)
      if (formula.depends_on(energy, first_velocity + k))
        throw expression::ExpressionError("an energy cannot depend on a velocity; put damping into 'fx = ...'", text,
                                          d.position);
  }
  if (!any)
    throw expression::ExpressionError("a field defines 'energy' (J), or 'fx', 'fy' or 'fz' (N)", text,
                                      definitions.back().position);
  has_energy_ = energy != zero;
  for (std::uint32_t k = 0; k < 3; ++k)
    force[k] = formula.make(expression::Op::subtract, force[k], formula.derivative(energy, k));
  std::vector<bool> uniform(formula.inputs().size(), true);
  std::fill_n(uniform.begin(), field_variable_count - 1, false);  // all but t
  force_ = Program(formula, force, uniform);
  energy_ = Program(formula, std::array{energy}, uniform);
  std::array<Node, rate_count> rates;
  for (std::uint32_t k = 0; k < rate_count; ++k) rates[k] = formula.derivative(force[k / 3], first_velocity + k % 3);
  depends_on_velocity_ = std::any_of(rates.begin(), rates.end(), [&](Node rate) {
    return formula[rate].op != expression::Op::constant || formula[rate].value != 0;
  });
  if (depends_on_velocity_) rates_ = Program(formula, rates, uniform);
}

template <class Take>
void FieldLaw::run(const Program& program, const ParticleArrays& a, std::size_t first, std::size_t count, double t,
                   const double* parameters, Take take) const {
  static thread_local Program::Workspace workspace;
  std::array<double, field_variable_count + max_field_parameters> uniforms{};
  uniforms[field_variable_count - 1] = t;
  std::copy_n(parameters, parameter_count_, uniforms.begin() + field_variable_count);
  constexpr std::size_t block = Program::block;
  std::array<std::array<double, block>, rate_count> results;
  std::array<double*, rate_count> outputs;
  for (std::size_t k = 0; k < rate_count; ++k) outputs[k] = results[k].data();
  for (std::size_t start = 0; start < count; start += block) {
    const std::size_t n = std::min(block, count - start), j = first + start;
    const double* const lanes[field_variable_count + max_field_parameters] = {
        a.x.data() + j,  a.y.data() + j,  a.z.data() + j, a.vx.data() + j,
        a.vy.data() + j, a.vz.data() + j, a.m.data() + j};
    program.run(n, lanes, uniforms.data(), outputs.data(), workspace);
    take(start, n, outputs.data());
  }
}

void FieldLaw::evaluate(const ParticleArrays& a, std::size_t first, std::size_t count, double t,
                        const double* parameters, double* out) const {
  if (number_ == field_law_count)
    return run(force_, a, first, count, t, parameters, [&](std::size_t start, std::size_t n, double* const* forces) {
      for (std::size_t i = 0; i < n; ++i)
        for (std::size_t k = 0; k < 3; ++k) out[3 * (start + i) + k] = forces[k][i];
    });
  FieldLawList::visit(number_, [&]<class Law>() {
    for (std::size_t i = 0; i < count; ++i) {
      const Vec3 f = Law::force(state_of(a, first + i, t), parameters);
      out[3 * i] = f.x, out[3 * i + 1] = f.y, out[3 * i + 2] = f.z;
    }
  });
}

void FieldLaw::evaluate_rates(const ParticleArrays& a, std::size_t first, std::size_t count, double t,
                              const double* parameters, double* out) const {
  std::fill_n(out, rate_count * count, 0.0);
  if (!depends_on_velocity_) return;
  if (number_ == field_law_count)
    return run(rates_, a, first, count, t, parameters, [&](std::size_t start, std::size_t n, double* const* rates) {
      for (std::size_t i = 0; i < n; ++i) {
        double* const to = out + rate_count * (start + i);
        double sum = 0;
        for (std::size_t k = 0; k < rate_count; ++k) to[k] = rates[k][i], sum += 0 * rates[k][i];
        if (sum != 0) std::fill_n(to, rate_count, 0.0);
      }
    });
  FieldLawList::visit(number_, [&]<class Law>() {
    if constexpr (Law::has_drag)
      for (std::size_t i = 0; i < count; ++i)
        for (std::size_t k = 0; k < 3; ++k) out[rate_count * i + 4 * k] = -Law::drag(parameters);
  });
}

double FieldLaw::energy(const ParticleArrays& a, double t, const double* parameters) const {
  double sum = 0;
  const auto add = [&](double energy) {
    if (std::isfinite(energy)) sum += energy;
  };
  if (!has_energy_) return sum;
  if (number_ == field_law_count)
    run(energy_, a, 0, a.size(), t, parameters, [&](std::size_t, std::size_t n, double* const* energies) {
      for (std::size_t i = 0; i < n; ++i) add(energies[0][i]);
    });
  else
    FieldLawList::visit(number_, [&]<class Law>() {
      for (std::size_t i = 0; i < a.size(); ++i) add(Law::energy(state_of(a, i, t), parameters));
    });
  return sum;
}

std::uint32_t find_field_law(std::string_view name) { return FieldLawList::find(name); }
const char* field_law_name(std::uint32_t number) { return FieldLawList::name(number); }
std::span<const Parameter> field_law_parameters(std::uint32_t number) { return FieldLawList::parameters(number); }

}  // namespace iota::laws
