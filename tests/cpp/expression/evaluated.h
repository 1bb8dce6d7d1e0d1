// SPDX-License-Identifier: Apache-2.0
// Formulas and their slow twin: values from a walk over the graph.
#pragma once

#include "expression/functions.h"
#include "expression/program.h"

#include <random>
#include <string>
#include <vector>

namespace iota::expression {

inline const std::vector<std::string> inputs{"r", "v", "k", "length"};

/// Slow twin: walks the graph node by node.
inline double walk(const Formula& f, Node node, const std::vector<double>& at) {
  const Formula::Entry& e = f[node];
  if (e.op == Op::constant) return e.value;
  if (e.op == Op::input) return at[e.a];
  if (e.op == Op::whole_power) return apply(e.op, walk(f, e.a, at), e.value, 0);
  const double a = walk(f, e.a, at);
  const double b = e.op >= Op::add ? walk(f, e.b, at) : 0;
  const double c = e.op == Op::select ? walk(f, e.c, at) : 0;
  return apply(e.op, a, b, c);
}

inline double value_of(const std::string& text, const std::vector<double>& at = {2, 3, 5, 7}) {
  Formula f(inputs);
  return walk(f, parse("y = " + text, f).front().node, at);
}

/// A random text over the grammar; `depth` levels.
inline std::string random_text(std::mt19937& random, int depth) {
  const auto pick = [&](auto... words) {
    const std::vector<std::string> list{words...};
    return list[random() % list.size()];
  };
  if (depth == 0) return pick("r", "v", "k", "length", "0", "1", "2.5", "0.5", "pi");
  const auto part = [&] { return random_text(random, depth - 1); };
  switch (random() % 8) {
    case 0: return "(" + part() + pick(" + ", " - ", "*", "/") + part() + ")";
    case 1: return "(" + part() + ")^" + pick("2", "-3", "12", "0.5", "(r)");
    case 2:
      return pick("sqrt", "exp", "log", "sin", "cos", "tan", "tanh", "abs", "sign", "floor", "step") + "(" + part() +
             ")";
    case 3: return pick("min", "max", "pow") + "(" + part() + ", " + part() + ")";
    case 4: return "where(" + part() + " < " + part() + ", " + part() + ", " + part() + ")";
    case 5: return "-" + part();
    default: return part() + pick(" + ", " - ", "*", "/") + part();
  }
}

}  // namespace iota::expression
