// SPDX-License-Identifier: Apache-2.0
#include "laws/pair_law.h"

#include "laws/law_list.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace iota::laws {

namespace {

using expression::Definition;
using expression::Formula;
using expression::Node;
using expression::Op;
using expression::Program;

enum Variable : std::uint32_t {
  var_r,
  var_v,
  var_t,
  var_m_p,
  var_m_q,
  var_cos_p,
  var_cos_q,
  var_cos_pq,
  variable_count
};
constexpr std::array cosines = {var_cos_p, var_cos_q, var_cos_pq};

/// One for each thread, as islands are solved in parallel.
Program::Workspace& workspace() {
  static thread_local Program::Workspace space;
  return space;
}

using PairLawList = LawList<PairLaws>;

std::array<double, variable_count + max_parameters> inputs_of(const PairState& s, const double* parameters,
                                                              std::size_t count) {
  std::array<double, variable_count + max_parameters> inputs{s.r, s.v, s.t, s.m_p, s.m_q};
  std::copy_n(parameters, count, inputs.begin() + variable_count);
  return inputs;
}

template <class Law>
constexpr std::size_t parameter_count = std::size(Law::parameters);

}  // namespace

PairLaw::PairLaw(std::uint32_t number) : number_(number) {
  PairLawList::visit(number_, [&]<class Law>() {
    has_energy_ = Law::has_energy, has_damping_ = Law::has_dashpot, has_drag_ = Law::has_drag;
    depends_on_mass_ = Law::needs_mass;
    parameter_count_ = parameter_count<Law>;
  });
}

PairLaw::PairLaw(std::string_view text, std::vector<std::string> parameters) : parameter_count_(parameters.size()) {
  std::vector<std::string> inputs(std::begin(variables), std::end(variables));
  inputs.insert(inputs.end(), parameters.begin(), parameters.end());
  std::vector<std::string> of_normals;
  for (const Variable cosine : cosines) of_normals.emplace_back(variables[cosine]);
  Formula formula(std::move(inputs), std::move(of_normals));
  std::vector<Definition> definitions;
  try {
    definitions = expression::parse(text, formula);
  } catch (const expression::ExpressionError& error) {
    if (text.find('=') != std::string_view::npos) throw;
    throw expression::ExpressionError("write 'energy = ...' (J) or 'force = ...' (N, positive pushes apart)", text, 0);
  }

  expression::require_mentioned(text, std::span(formula.inputs()).subspan(variable_count));

  const Node zero = formula.constant(0);
  Node energy = zero, force = zero, drag = zero;
  bool any = false;
  for (const Definition& d : definitions) {
    if (d.name == "energy") {
      energy = d.node, any = true;
      if (formula.depends_on(energy, var_v))
        throw expression::ExpressionError("an energy cannot depend on v; put damping into 'force = ...'", text,
                                          d.position);
    } else if (d.name == "force") {
      force = d.node, any = true;
    } else if (d.name == "drag") {
      drag = d.node, any = true;
      if (formula.depends_on(drag, var_v))
        throw expression::ExpressionError("a drag cannot depend on v; it is multiplied by the velocity", text,
                                          d.position);
    }
  }
  if (!any)
    throw expression::ExpressionError("a law between two particles defines 'energy', 'force' or 'drag'", text,
                                      definitions.back().position);

  const Node push = formula.substitute(force, var_v, zero);
  const Node damping = formula.make(Op::subtract, force, push);
  has_energy_ = energy != zero, has_push_ = push != zero, has_drag_ = drag != zero;
  has_damping_ = formula.depends_on(damping, var_v);
  damping_depends_on_distance_ = formula.depends_on(damping, var_r) || formula.depends_on(drag, var_r);
  const auto sees_normals = [&](Node part) {
    return std::ranges::any_of(cosines, [&](Variable cosine) { return formula.depends_on(part, cosine); });
  };
  if (sees_normals(force) || sees_normals(drag))
    throw expression::ExpressionError("only an energy may depend on cos_p, cos_q and cos_pq", text,
                                      definitions.back().position);
  depends_on_normals_ = sees_normals(energy);
  for (const Node part : {energy, force, drag}) {
    depends_on_time_ = depends_on_time_ || formula.depends_on(part, var_t);
    depends_on_mass_ = depends_on_mass_ || formula.depends_on(part, var_m_p) || formula.depends_on(part, var_m_q);
  }

  std::vector<bool> each(formula.inputs().size(), false), shared = each;
  each[var_t] = shared[var_t] = true;
  for (std::size_t i = variable_count; i < shared.size(); ++i) shared[i] = true;
  const Node slope = formula.derivative(energy, var_r), curvature = formula.derivative(slope, var_r);
  const Node push_slope = formula.derivative(push, var_r), damping_slope = formula.derivative(damping, var_v);
  elastic_ = Program(formula, std::array{energy, slope, curvature}, each);
  push_ = Program(formula, std::array{push, push_slope}, each);
  damping_ = Program(formula, std::array{damping, damping_slope}, each);
  drag_ = Program(formula, std::array{drag}, each);
  std::vector<Node> wanted{formula.make(Op::subtract, force, slope)};
  if (has_drag_) wanted.push_back(drag);
  if (depends_on_normals_)
    for (const Variable cosine : cosines) wanted.push_back(formula.derivative(energy, cosine));
  bonds_ = Program(formula, wanted, each);
  pairs_ = Program(formula, wanted, shared);
  bond_energies_ = Program(formula, std::array{energy}, each);
  pair_energies_ = Program(formula, std::array{energy}, shared);
}

Elastic PairLaw::elastic(const PairState& state, const double* parameters) const {
  Elastic result;
  if (!has_energy_) return result;
  if (number_ < pair_law_count) {
    PairLawList::visit(number_, [&]<class Law>() { result = Law::elastic(state, parameters); });
    return result;
  }
  double out[3];
  elastic_.run_one(inputs_of(state, parameters, parameter_count_).data(), out, workspace());
  return {out[0], out[1], out[2]};
}

PairLaw::Slope PairLaw::push(const PairState& state, const double* parameters) const {
  if (!has_push_) return {};
  double out[2];
  push_.run_one(inputs_of(state, parameters, parameter_count_).data(), out, workspace());
  return {out[0], out[1]};
}

PairLaw::Slope PairLaw::damping(const PairState& state, const double* parameters) const {
  if (!has_damping_) return {};
  if (number_ < pair_law_count) {
    double c = 0;
    PairLawList::visit(number_, [&]<class Law>() { c = Law::dashpot(parameters); });
    return {-c * state.v, -c};
  }
  double out[2];
  damping_.run_one(inputs_of(state, parameters, parameter_count_).data(), out, workspace());
  return {out[0], out[1]};
}

double PairLaw::drag(const PairState& state, const double* parameters) const {
  double result = 0;
  if (!has_drag_) return result;
  if (number_ < pair_law_count)
    PairLawList::visit(number_, [&]<class Law>() { result = Law::drag(parameters); });
  else
    drag_.run_one(inputs_of(state, parameters, parameter_count_).data(), &result, workspace());
  return result;
}

namespace {

template <class Law>
IOTA_ALWAYS_INLINE void fill(const PairBatch& b, const auto& parameters_of) {
  for (std::size_t i = 0; i < b.count; ++i) {
    const auto p = parameters_of(i);
    const PairState s{b.r[i], b.v[i], b.t, b.m_p[i], b.m_q[i]};
    double f = 0;
    if constexpr (Law::has_energy) f -= Law::elastic(s, p.data()).slope;
    if constexpr (Law::has_dashpot) f -= Law::dashpot(p.data()) * s.v;
    b.force[i] = f;
    if constexpr (Law::has_drag) b.drag[i] = Law::drag(p.data());
  }
}

template <class Law>
IOTA_ALWAYS_INLINE void fill_energies(const PairBatch& b, const auto& parameters_of) {
  for (std::size_t i = 0; i < b.count; ++i)
    b.energy[i] = Law::elastic({b.r[i], 0, b.t, b.m_p[i], b.m_q[i]}, parameters_of(i).data()).energy;
}

template <class Law>
IOTA_WIDER void evaluate_list(const PairBatch& b, bool energies) {
  constexpr std::size_t n = parameter_count<Law>;
  std::array<double, n> same;
  std::array<const double*, n> each;
  for (std::size_t k = 0; k < n; ++k) same[k] = *b.parameters[k], each[k] = b.parameters[k];
  const auto same_of = [&](std::size_t) { return same; };
  const auto each_of = [&](std::size_t i) {
    std::array<double, n> p;
    for (std::size_t k = 0; k < n; ++k) p[k] = each[k][i];
    return p;
  };
  if (energies)
    b.same_parameters ? fill_energies<Law>(b, same_of) : fill_energies<Law>(b, each_of);
  else
    b.same_parameters ? fill<Law>(b, same_of) : fill<Law>(b, each_of);
}

}  // namespace

void PairLaw::evaluate(const PairBatch& b) const {
  if (b.count == 0) return;
  if (number_ < pair_law_count) {
    PairLawList::visit(number_, [&]<class Law>() { evaluate_list<Law>(b, false); });
  } else {
    std::array<double*, 5> outputs{b.force};
    std::size_t count = 1;
    if (has_drag_) outputs[count++] = b.drag;
    for (double* const slope : b.slopes) outputs[count++] = slope;
    run(bonds_, pairs_, b, outputs.data());
  }
}

void PairLaw::energies(const PairBatch& b) const {
  if (b.count == 0) return;
  if (number_ < pair_law_count)
    PairLawList::visit(number_, [&]<class Law>() { evaluate_list<Law>(b, true); });
  else
    run(bond_energies_, pair_energies_, b, &b.energy);
}

void PairLaw::run(const Program& of_bonds, const Program& of_pairs, const PairBatch& b, double* const* outputs) const {
  std::array<const double*, variable_count + max_parameters> lanes{b.r,   b.v,     nullptr, b.m_p,
                                                                   b.m_q, b.cos_p, b.cos_q, b.cos_pq};
  std::array<double, variable_count + max_parameters> uniforms{};
  uniforms[var_t] = b.t;
  for (std::size_t k = 0; k < parameter_count_; ++k) {
    lanes[variable_count + k] = b.parameters[k];
    uniforms[variable_count + k] = *b.parameters[k];
  }
  (b.same_parameters ? of_pairs : of_bonds).run(b.count, lanes.data(), uniforms.data(), outputs, workspace());
}

std::uint32_t find_pair_law(std::string_view name) { return PairLawList::find(name); }
const char* pair_law_name(std::uint32_t number) { return PairLawList::name(number); }
std::span<const Parameter> pair_law_parameters(std::uint32_t number) { return PairLawList::parameters(number); }
const char* pair_law_text(std::uint32_t number) {
  const char* text = "";
  PairLawList::visit(number, [&]<class Law>() { text = Law::text; });
  return text;
}

}  // namespace iota::laws
