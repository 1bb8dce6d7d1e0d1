// SPDX-License-Identifier: Apache-2.0
#include "expression/program.h"

#include "expression/functions.h"

#include <algorithm>
#include <cmath>

namespace iota::expression {

namespace {

Node expanded_power(Formula& formula, Node a, unsigned exponent) {
  if (exponent == 1) return a;
  if (exponent & 1) return formula.make(Op::multiply, expanded_power(formula, a, exponent - 1), a);
  const Node half = expanded_power(formula, a, exponent / 2);
  return formula.make(Op::multiply, half, half);
}

/// The same formula without whole powers: squares are shared among them.
std::vector<Node> expand_powers(Formula& formula, std::span<const Node> outputs) {
  const Node last = *std::max_element(outputs.begin(), outputs.end());
  std::vector<Node> now(last + 1);
  for (Node i = 0; i <= last; ++i) {
    const Formula::Entry e = formula[i];
    if (e.op == Op::constant || e.op == Op::input) {
      now[i] = i;
    } else if (e.op == Op::whole_power) {
      const int n = static_cast<int>(e.value);
      const Node power = expanded_power(formula, now[e.a], static_cast<unsigned>(std::abs(n)));
      now[i] = n > 0 ? power : formula.make(Op::divide, formula.constant(1), power);
    } else {
      now[i] = formula.make(e.op, now[e.a], now[e.b], now[e.c]);
    }
  }
  std::vector<Node> result;
  for (const Node o : outputs) result.push_back(now[o]);
  return result;
}

int operand_count(Op op) { return op < Op::negate ? 0 : (op < Op::add ? 1 : (op == Op::select ? 3 : 2)); }

}  // namespace

Program::Program(Formula& formula, std::span<const Node> wanted, const std::vector<bool>& is_uniform) {
  const std::vector<Node> results = expand_powers(formula, wanted);
  const Node last = *std::max_element(results.begin(), results.end());

  // The needed nodes, their last uses, and whether they vary from lane to lane.
  std::vector<std::uint8_t> needed(last + 1, 0), varies(last + 1, 0);
  std::vector<Node> last_use(last + 1, 0);
  for (const Node r : results) needed[r] = 1, last_use[r] = last + 1;
  for (Node i = last + 1; i-- > 0;) {
    if (!needed[i]) continue;
    const Formula::Entry& e = formula[i];
    const Node operands[3] = {e.a, e.b, e.c};
    for (int k = 0; k < operand_count(e.op); ++k) {
      needed[operands[k]] = 1;
      last_use[operands[k]] = std::max(last_use[operands[k]], i);
    }
  }

  std::vector<Operand> place(last + 1);
  const auto new_uniform = [&](double start) {
    uniform_start_.push_back(start);
    return Operand{static_cast<std::uint32_t>(uniform_start_.size() - 1), Where::uniform};
  };
  for (Node i = 0; i <= last; ++i)  // inputs first, so that run() can fill them in one loop
    if (needed[i] && formula[i].op == Op::input && is_uniform[formula[i].a]) {
      place[i] = new_uniform(0);
      uniform_inputs_.push_back(formula[i].a);
    }
  std::vector<std::uint32_t> free;
  std::vector<std::pair<Node, std::uint32_t>> busy;  // last use, register
  for (Node i = 0; i <= last; ++i) {
    if (!needed[i]) continue;
    const Formula::Entry& e = formula[i];
    if (e.op == Op::constant) {
      place[i] = new_uniform(e.value);
      continue;
    }
    if (e.op == Op::input) {
      if (!is_uniform[e.a]) place[i] = {e.a, Where::lane_input}, varies[i] = 1;
      continue;
    }
    Operation operation;
    operation.op = e.op;
    const Node nodes[3] = {e.a, e.b, e.c};
    Operand* const operands[3] = {&operation.a, &operation.b, &operation.c};
    for (int k = 0; k < operand_count(e.op); ++k) {
      *operands[k] = place[nodes[k]];
      varies[i] |= varies[nodes[k]];
    }
    if (!varies[i]) {
      place[i] = new_uniform(0);
      operation.out = place[i].index;
      uniform_.push_back(operation);
      continue;
    }
    std::erase_if(busy, [&](const auto& b) {
      if (b.first < i) free.push_back(b.second);
      return b.first < i;
    });
    if (free.empty()) free.push_back(static_cast<std::uint32_t>(register_count_++));
    place[i] = {free.back(), Where::lane};
    free.pop_back();
    busy.push_back({last_use[i], place[i].index});
    operation.out = place[i].index;
    lane_.push_back(operation);
  }
  for (const Node r : results) outputs_.push_back(place[r]);
}

namespace {

/// One number for each lane, or one for all.
struct Lanes {
  const double* values;
  bool one;
};

template <class F>
IOTA_ALWAYS_INLINE void map(std::size_t n, double* out, const Lanes& a, F f) {
  const double* const x = a.values;
  for (std::size_t i = 0; i < n; ++i) out[i] = f(x[i]);
}

template <class F>
IOTA_ALWAYS_INLINE void map(std::size_t n, double* out, const Lanes& a, const Lanes& b, F f) {
  const double* const x = a.values;
  const double* const y = b.values;
  if (a.one) {
    const double u = *x;
    for (std::size_t i = 0; i < n; ++i) out[i] = f(u, y[i]);
  } else if (b.one) {
    const double v = *y;
    for (std::size_t i = 0; i < n; ++i) out[i] = f(x[i], v);
  } else {
    for (std::size_t i = 0; i < n; ++i) out[i] = f(x[i], y[i]);
  }
}

IOTA_WIDER void run_operation(Op op, std::size_t n, double* out, Lanes a, Lanes b, Lanes c) {
  switch (op) {
    case Op::constant:
    case Op::input:
    case Op::whole_power: break;  // never compiled
    case Op::negate: map(n, out, a, [](double x) { return -x; }); break;
    case Op::square_root: map(n, out, a, [](double x) { return std::sqrt(x); }); break;
    case Op::exponential: map(n, out, a, [](double x) { return exp(x); }); break;
    case Op::logarithm: map(n, out, a, [](double x) { return log(x); }); break;
    case Op::sine: map(n, out, a, [](double x) { return sin(x); }); break;
    case Op::cosine: map(n, out, a, [](double x) { return cos(x); }); break;
    case Op::tangent: map(n, out, a, [](double x) { return tan(x); }); break;
    case Op::hyperbolic_tangent: map(n, out, a, [](double x) { return tanh(x); }); break;
    case Op::absolute: map(n, out, a, [](double x) { return std::abs(x); }); break;
    case Op::sign: map(n, out, a, [](double x) { return x > 0 ? 1.0 : (x < 0 ? -1.0 : x); }); break;
    case Op::floor: map(n, out, a, [](double x) { return std::floor(x); }); break;
    case Op::add: map(n, out, a, b, [](double x, double y) { return x + y; }); break;
    case Op::subtract: map(n, out, a, b, [](double x, double y) { return x - y; }); break;
    case Op::multiply: map(n, out, a, b, [](double x, double y) { return x * y; }); break;
    case Op::divide: map(n, out, a, b, [](double x, double y) { return x / y; }); break;
    case Op::power: map(n, out, a, b, [](double x, double y) { return pow(x, y); }); break;
    case Op::minimum: map(n, out, a, b, [](double x, double y) { return x < y ? x : y; }); break;
    case Op::maximum: map(n, out, a, b, [](double x, double y) { return x > y ? x : y; }); break;
    case Op::less: map(n, out, a, b, [](double x, double y) { return x < y ? 1.0 : 0.0; }); break;
    case Op::less_equal: map(n, out, a, b, [](double x, double y) { return x <= y ? 1.0 : 0.0; }); break;
    case Op::select:
      for (std::size_t i = 0; i < n; ++i) {
        const double yes = b.values[b.one ? 0 : i], no = c.values[c.one ? 0 : i];
        out[i] = a.values[a.one ? 0 : i] != 0 ? yes : no;
      }
      break;
  }
}

}  // namespace

void Program::run_block(std::size_t count, const double* const* lanes, std::size_t first, const double* uniforms,
                        double* registers) const {
  const auto find = [&](const Operand& o) -> Lanes {
    if (o.where == Where::uniform) return {uniforms + o.index, true};
    if (o.where == Where::lane_input) return {lanes[o.index] + first, false};
    return {registers + o.index * block, false};
  };
  for (const Operation& o : lane_)
    run_operation(o.op, count, registers + o.out * block, find(o.a), find(o.b), find(o.c));
}

void Program::run(std::size_t count, const double* const* lanes, const double* uniform_inputs, double* const* outputs,
                  Workspace& workspace) const {
  const std::size_t needed = uniform_start_.size() + register_count_ * block;
  if (workspace.size() < needed) workspace.resize(needed);
  double* const uniforms = workspace.data();
  double* const registers = uniforms + uniform_start_.size();
  std::copy(uniform_start_.begin(), uniform_start_.end(), uniforms);
  for (std::size_t i = 0; i < uniform_inputs_.size(); ++i) uniforms[i] = uniform_inputs[uniform_inputs_[i]];
  for (const Operation& o : uniform_)
    uniforms[o.out] = apply(o.op, uniforms[o.a.index], uniforms[o.b.index], uniforms[o.c.index]);

  for (std::size_t first = 0; first < count; first += block) {
    const std::size_t n = std::min(block, count - first);
    run_block(n, lanes, first, uniforms, registers);
    for (std::size_t k = 0; k < outputs_.size(); ++k) {
      const Operand& o = outputs_[k];
      double* const out = outputs[k] + first;
      if (o.where == Where::uniform)
        std::fill_n(out, n, uniforms[o.index]);
      else
        std::copy_n(o.where == Where::lane ? registers + o.index * block : lanes[o.index] + first, n, out);
    }
  }
}

void Program::run_one(const double* inputs, double* outputs, Workspace& workspace) const {
  const std::size_t needed = uniform_start_.size() + register_count_;
  if (workspace.size() < needed) workspace.resize(needed);
  double* const uniforms = workspace.data();
  double* const registers = uniforms + uniform_start_.size();
  std::copy(uniform_start_.begin(), uniform_start_.end(), uniforms);
  for (std::size_t i = 0; i < uniform_inputs_.size(); ++i) uniforms[i] = inputs[uniform_inputs_[i]];
  const auto find = [&](const Operand& o) {
    if (o.where == Where::uniform) return uniforms[o.index];
    return o.where == Where::lane_input ? inputs[o.index] : registers[o.index];
  };
  for (const Operation& o : uniform_)
    uniforms[o.out] = apply(o.op, uniforms[o.a.index], uniforms[o.b.index], uniforms[o.c.index]);
  for (const Operation& o : lane_) registers[o.out] = apply(o.op, find(o.a), find(o.b), find(o.c));
  for (std::size_t k = 0; k < outputs_.size(); ++k) outputs[k] = find(outputs_[k]);
}

}  // namespace iota::expression
