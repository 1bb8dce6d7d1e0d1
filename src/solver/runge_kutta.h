// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "solver/newton.h"

#include <array>
#include <vector>

namespace iota::solver {

/// Explicit steps of fifth order with an error estimate of fourth order (Dormand and Prince 1980), from the
/// accelerations that satisfy the constraints; each step ends with a projection of positions and velocities on them
/// (Hairer, Lubich, Wanner 2006, IV.4). For problems whose rows stay equations or at their bounds in a step.
class RungeKutta {
 public:
  /// Saves the state as the start of a step, with its accelerations.
  void begin(Newton&, Problem&);
  /// Takes a step of h seconds from there, which laws that depend on the time know as `start`, s. False if its end cannot be
  /// projected on the constraints.
  bool step(Newton&, Problem&, double h, double start = 0);
  /// The accelerations at the end; they must be known before `estimate_error` and `accept`.
  void end(Newton&, Problem&);
  /// Largest difference of the fourth-order and fifth-order positions, m, and velocities, m/s.
  struct Error {
    double position = 0, velocity = 0;
  };
  Error estimate_error(double h) const;
  void accept(const Problem&);
  void reject(Problem&) const;  ///< back to the start

  /// In the step, by explicit forces and by resistance, J.
  double external_work() const { return external_work_; }
  double dissipated() const { return dissipated_; }
  const std::vector<Vec3>& accelerations() const { return slopes_[0]; }  ///< at the start of the next step

  const std::vector<Vec3>& velocities() const { return velocity_; }  ///< the same

  static constexpr int solves = 8;  ///< linear ones with a new matrix, a step

 private:
  static constexpr int stages = 7;
  std::array<std::vector<Vec3>, stages> slopes_;  // accelerations
  std::vector<Vec3> position_, velocity_;         // at the start
  double external_work_ = 0, dissipated_ = 0;
};

}  // namespace iota::solver
