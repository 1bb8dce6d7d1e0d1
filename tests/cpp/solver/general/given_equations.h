// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iota/solver.h>

#include <cstddef>
#include <functional>
#include <span>
#include <utility>

namespace iota {

using Equations = std::function<void(std::span<const double>, std::span<double>)>;

struct Given : NonlinearProblem {
  Given(std::size_t n, Equations f, Equations j = nullptr) : n(n), f(std::move(f)), j(std::move(j)) {}
  std::size_t size() const override { return n; }
  void evaluate(std::span<const double> x, std::span<double> out) override { f(x, out); }
  bool jacobian(std::span<const double> x, std::span<double> out) override {
    if (j) j(x, out);
    return static_cast<bool>(j);
  }
  std::size_t n;
  Equations f, j;
};

inline Given rosenbrock() {
  return {2, [](auto x, auto f) { f[0] = 10 * (x[1] - x[0] * x[0]), f[1] = 1 - x[0]; },
          [](auto x, auto j) { j[0] = -20 * x[0], j[1] = 10, j[2] = -1, j[3] = 0; }};
}

inline Given cube_roots_of_one() {
  return {2, [](auto x, auto f) {
            f[0] = x[0] * x[0] * x[0] - 3 * x[0] * x[1] * x[1] - 1, f[1] = 3 * x[0] * x[0] * x[1] - x[1] * x[1] * x[1];
          }};
}

}  // namespace iota
