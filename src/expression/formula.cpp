// SPDX-License-Identifier: Apache-2.0
#include "expression/formula.h"

#include "expression/functions.h"

#include <algorithm>
#include <bit>
#include <numeric>

namespace iota::expression {

namespace {

int arity(Op op) {
  if (op < Op::negate) return 0;
  if (op < Op::add || op == Op::whole_power) return 1;
  return op == Op::select ? 3 : 2;
}

/// The same products as in a program, in the same order.
double positive_power(double a, unsigned exponent) {
  if (exponent == 1) return a;
  if (exponent & 1) return positive_power(a, exponent - 1) * a;
  const double half = positive_power(a, exponent / 2);
  return half * half;
}

double whole_power_of(double a, int exponent) {
  if (exponent == 0) return 1;
  return exponent < 0 ? 1 / positive_power(a, static_cast<unsigned>(-exponent))
                      : positive_power(a, static_cast<unsigned>(exponent));
}

}  // namespace

double apply(Op op, double a, double b, double c) {
  switch (op) {
    case Op::constant:
    case Op::input: return a;
    case Op::negate: return -a;
    case Op::square_root: return std::sqrt(a);
    case Op::exponential: return exp(a);
    case Op::logarithm: return log(a);
    case Op::sine: return sin(a);
    case Op::cosine: return cos(a);
    case Op::tangent: return tan(a);
    case Op::hyperbolic_tangent: return tanh(a);
    case Op::absolute: return std::abs(a);
    case Op::sign: return a > 0 ? 1 : (a < 0 ? -1 : a);
    case Op::floor: return std::floor(a);
    case Op::add: return a + b;
    case Op::subtract: return a - b;
    case Op::multiply: return a * b;
    case Op::divide: return a / b;
    case Op::power: return pow(a, b);
    case Op::whole_power: return whole_power_of(a, static_cast<int>(b));
    case Op::minimum: return a < b ? a : b;
    case Op::maximum: return a > b ? a : b;
    case Op::less: return a < b ? 1 : 0;
    case Op::less_equal: return a <= b ? 1 : 0;
    case Op::select: return a != 0 ? b : c;
  }
  return 0;
}

Node Formula::intern(const Entry& e) {
  const auto [found, is_new] =
      known_.try_emplace({e.op, e.a, e.b, e.c, std::bit_cast<std::uint64_t>(e.value)}, static_cast<Node>(size()));
  if (is_new) entries_.push_back(e);
  return found->second;
}

Node Formula::constant(double value) { return intern({Op::constant, 0, 0, 0, value}); }
Node Formula::input(std::uint32_t number) { return intern({Op::input, number, 0, 0, 0}); }

Node Formula::whole_power(Node a, int exponent) {
  if (exponent == 0) return constant(1);
  if (exponent == 1) return a;
  if (entries_[a].op == Op::constant) return constant(whole_power_of(entries_[a].value, exponent));
  return intern({Op::whole_power, a, 0, 0, static_cast<double>(exponent)});
}

Node Formula::make(Op op, Node a, Node b, Node c) {
  const int count = arity(op);
  const auto is = [&](Node node, double value) {
    return entries_[node].op == Op::constant && entries_[node].value == value;
  };
  const auto is_constant = [&](Node node) { return entries_[node].op == Op::constant; };
  if (op == Op::power && is_constant(b)) {
    const double e = entries_[b].value;
    if (e == std::floor(e) && std::abs(e) <= 64) return whole_power(a, static_cast<int>(e));
    if (e == 0.5) return make(Op::square_root, a);
    if (e == -0.5) return make(Op::divide, constant(1), make(Op::square_root, a));
  }
  if (is_constant(a) && (count < 2 || is_constant(b)) && (count < 3 || is_constant(c)))
    return constant(apply(op, entries_[a].value, count > 1 ? entries_[b].value : 0, count > 2 ? entries_[c].value : 0));
  switch (op) {
    case Op::negate:
      if (entries_[a].op == Op::negate) return entries_[a].a;
      break;
    case Op::add:
      if (is(a, 0)) return b;
      if (is(b, 0)) return a;
      if (entries_[b].op == Op::negate) return make(Op::subtract, a, entries_[b].a);
      break;
    case Op::subtract:
      if (is(b, 0)) return a;
      if (is(a, 0)) return make(Op::negate, b);
      break;
    case Op::multiply:
      if (is(a, 0) || is(b, 0)) return constant(0);
      if (is(a, 1)) return b;
      if (is(b, 1)) return a;
      if (is(a, -1)) return make(Op::negate, b);
      if (is(b, -1)) return make(Op::negate, a);
      break;
    case Op::divide:
      if (is(a, 0) && !is(b, 0)) return constant(0);
      if (is(b, 1)) return a;
      break;
    case Op::select:
      if (is_constant(a)) return entries_[a].value != 0 ? b : c;
      if (b == c) return b;
      break;
    default: break;
  }
  return intern({op, a, count > 1 ? b : 0, count > 2 ? c : 0, 0});
}

bool Formula::depends_on(Node node, std::uint32_t number) const {
  std::vector<std::uint8_t> depends(node + 1, 0);
  for (Node i = 0; i <= node; ++i) {
    const Entry& e = entries_[i];
    if (e.op == Op::input) depends[i] = e.a == number;
    if (const int count = arity(e.op); count > 0)
      depends[i] = depends[e.a] || (count > 1 && depends[e.b]) || (count > 2 && depends[e.c]);
  }
  return depends[node];
}

Node Formula::substitute(Node of, std::uint32_t number, Node by) {
  std::vector<Node> now(of + 1);
  for (Node i = 0; i <= of; ++i) {
    const Entry e = entries_[i];
    if (e.op == Op::constant || e.op == Op::input)
      now[i] = e.op == Op::input && e.a == number ? by : i;
    else if (e.op == Op::whole_power)
      now[i] = whole_power(now[e.a], static_cast<int>(e.value));
    else
      now[i] = make(e.op, now[e.a], arity(e.op) > 1 ? now[e.b] : 0, arity(e.op) > 2 ? now[e.c] : 0);
  }
  return now[of];
}

Node Formula::derivative(Node of, std::uint32_t number) {
  std::vector<Node> derivatives(of + 1);
  for (Node i = 0; i <= of; ++i) {
    const Entry e = entries_[i];
    if (e.op == Op::input)
      derivatives[i] = constant(e.a == number ? 1 : 0);
    else if (e.op == Op::constant)
      derivatives[i] = constant(0);
    else
      derivatives[i] = derive(e, derivatives);
  }
  return derivatives[of];
}

Node Formula::derive(const Entry& e, std::span<const Node> derivatives) {
  const Node zero = constant(0);
  const Node a = e.a, b = e.b, da = derivatives[a], db = arity(e.op) > 1 ? derivatives[b] : zero;
  const auto times = [&](Node x, Node y) { return make(Op::multiply, x, y); };
  const auto over = [&](Node x, Node y) { return make(Op::divide, x, y); };
  const auto again = [&](Op op) { return make(op, a); };
  switch (e.op) {
    case Op::negate: return make(Op::negate, da);
    case Op::square_root: return over(times(constant(0.5), da), again(Op::square_root));
    case Op::exponential: return times(again(Op::exponential), da);
    case Op::logarithm: return over(da, a);
    case Op::sine: return times(again(Op::cosine), da);
    case Op::cosine: return make(Op::negate, times(again(Op::sine), da));
    case Op::tangent: return times(make(Op::add, constant(1), whole_power(again(Op::tangent), 2)), da);
    case Op::hyperbolic_tangent:
      return times(make(Op::subtract, constant(1), whole_power(again(Op::hyperbolic_tangent), 2)), da);
    case Op::absolute: return times(again(Op::sign), da);
    case Op::add:
    case Op::subtract: return make(e.op, da, db);
    case Op::multiply: return make(Op::add, times(da, b), times(a, db));
    case Op::divide:  // (da - (a/b) db) / b
      return over(make(Op::subtract, da, times(over(a, b), db)), b);
    case Op::whole_power: {
      const int n = static_cast<int>(e.value);
      return times(times(constant(n), whole_power(a, n - 1)), da);
    }
    case Op::power: {
      // d a^b = b a^(b-1) da + a^b log(a) db; the second part only if the exponent varies.
      const Node first = times(times(b, make(Op::power, a, make(Op::subtract, b, constant(1)))), da);
      if (db == zero) return first;
      return make(Op::add, first, times(times(make(Op::power, a, b), again(Op::logarithm)), db));
    }
    case Op::minimum: return make(Op::select, make(Op::less, a, b), da, db);
    case Op::maximum: return make(Op::select, make(Op::less, b, a), da, db);
    case Op::select: return make(Op::select, a, db, derivatives[e.c]);
    default: return zero;  // steps are flat
  }
}

}  // namespace iota::expression
