// SPDX-License-Identifier: Apache-2.0
#include "laws/field_law.h"

#include <algorithm>
#include <array>

namespace iota::laws {

namespace {

using expression::Formula;
using expression::Node;
using expression::Program;

constexpr std::size_t variable_count = std::size(FieldLaw::variables);

template <class Visit, std::size_t... I>
void visit_list(std::uint32_t number, Visit visit, std::index_sequence<I...>) {
  ((number == I ? visit.template operator()<std::tuple_element_t<I, FieldLaws>>() : void()), ...);
}
template <class Visit>
void visit_list(std::uint32_t number, Visit visit) {
  visit_list(number, visit, std::make_index_sequence<field_law_count>{});
}

}  // namespace

FieldLaw::FieldLaw(std::uint32_t number) : number_(number), parameter_count_(field_law_parameters(number).size()) {}

FieldLaw::FieldLaw(std::string_view text, std::vector<std::string> parameters) : parameter_count_(parameters.size()) {
  std::vector<std::string> inputs(std::begin(variables), std::end(variables));
  inputs.insert(inputs.end(), parameters.begin(), parameters.end());
  Formula formula(std::move(inputs));
  const auto definitions = expression::parse(text, formula);
  std::array<Node, 3> force;
  force.fill(formula.constant(0));
  bool any = false;
  for (const auto& d : definitions)
    for (std::size_t k = 0; k < 3; ++k)
      if (d.name == std::array{"fx", "fy", "fz"}[k]) force[k] = d.node, any = true;
  if (!any)
    throw expression::ExpressionError("a field defines 'fx', 'fy' or 'fz' (N)", text, definitions.back().position);
  std::vector<bool> uniform(formula.inputs().size(), true);
  std::fill_n(uniform.begin(), variable_count - 1, false);  // all but t
  program_ = Program(formula, force, uniform);
}

void FieldLaw::evaluate(const ParticleArrays& a, std::size_t first, std::size_t count, double t, double h,
                        const double* parameters, double* out) const {
  if (number_ < field_law_count) {
    visit_list(number_, [&]<class Law>() {
      for (std::size_t i = 0; i < count; ++i) {
        const std::size_t j = first + i;
        const Vec3 f = Law::force({{a.x[j], a.y[j], a.z[j]}, {a.vx[j], a.vy[j], a.vz[j]}, a.m[j], t, h}, parameters);
        out[3 * i] = f.x, out[3 * i + 1] = f.y, out[3 * i + 2] = f.z;
      }
    });
    return;
  }
  static thread_local Program::Workspace workspace;
  std::array<double, variable_count + max_field_parameters> uniforms{};
  uniforms[variable_count - 1] = t;
  std::copy_n(parameters, parameter_count_, uniforms.begin() + variable_count);
  constexpr std::size_t block = Program::block;
  std::array<std::array<double, block>, 3> forces;
  double* const outputs[3] = {forces[0].data(), forces[1].data(), forces[2].data()};
  for (std::size_t start = 0; start < count; start += block) {
    const std::size_t n = std::min(block, count - start), j = first + start;
    const double* const lanes[variable_count + max_field_parameters] = {
        a.x.data() + j,  a.y.data() + j,  a.z.data() + j, a.vx.data() + j,
        a.vy.data() + j, a.vz.data() + j, a.m.data() + j};
    program_.run(n, lanes, uniforms.data(), outputs, workspace);
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t k = 0; k < 3; ++k) out[3 * (start + i) + k] = forces[k][i];
  }
}

std::uint32_t find_field_law(std::string_view name) {
  for (std::uint32_t i = 0; i < field_law_count; ++i)
    if (name == field_law_name(i)) return i;
  return field_law_count;
}
const char* field_law_name(std::uint32_t number) {
  const char* name = "";
  visit_list(number, [&]<class Law>() { name = Law::name; });
  return name;
}
std::span<const Parameter> field_law_parameters(std::uint32_t number) {
  std::span<const Parameter> list;
  visit_list(number, [&]<class Law>() { list = Law::parameters; });
  return list;
}

}  // namespace iota::laws
