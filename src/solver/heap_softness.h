// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <numbers>

namespace iota::solver {

/// How a row of a heap answers to what is open: by an impulse that closes it with a frequency and damping that no sub-step
/// overshoots, or not at all.
struct HeapSoftness {
  double rate = 0, mass = 1, impulse = 0;

  HeapSoftness() = default;
  HeapSoftness(double frequency, double h) {
    constexpr double damping = 10;  // of the critical one
    const double omega = 2 * std::numbers::pi * frequency, a1 = 2 * damping + h * omega, a2 = h * omega * a1;
    rate = omega / a1, mass = a2 / (1 + a2), impulse = 1 / (1 + a2);
  }
};

}  // namespace iota::solver
