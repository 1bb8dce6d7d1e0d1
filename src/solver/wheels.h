// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/function_ref.h"
#include "solver/problem.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace iota::solver {

/// The largest share s <= 1 of a change of velocities, whose energy is first s + second s^2, with a gain up to a limit.
double largest_share(double first, double second, double limit);

/// Balanced bodies that share exactly two points with the rest, and so can turn about the line through these: wheels.
/// No row notices that motion, e_i = n x (x_i - a) of each own point i, so its momentum p = sum M_ij v_j . e_i changes
/// only by the moment of forces, as the center of mass is on the line.
class Wheels {
 public:
  Wheels();
  ~Wheels();

  /// After a change of structure, or of what acts.
  void forget() { is_known_ = false; }
  /// After a change of masses.
  void forget_masses() { is_known_ = is_known_ && !depends_on_masses_; }

  /// Calculates how much of p a step of the end-point rule has lost, for Spin::give_back. The rule evaluates moments at the
  /// end of the step, sum M_ij (v1 - v0)_j . e1_i = h moment, and so loses sum M_ij (v1 - v0)_j . (e1 - e0)_i. Velocities
  /// are those after the step, v1 = (x1 - x0)/h = v0 + displacement/h. Returns whether any wheel has lost something.
  bool find_losses(const Problem&, std::span<const Vec3> displacement, double h);

  /// Returns it to the wheels with is_due(own points), and calls given(own points, angular momentum) for each. The energy
  /// rises by `most_gain` at most, J. Returns by how much.
  double turn(Problem&, double most_gain, FunctionRef<bool(std::span<const std::uint32_t>)> is_due,
              FunctionRef<void(std::span<const std::uint32_t>, const Vec3&)> given);

  /// visit(axis, own points): each wheel that the latest `turn` has turned.
  template <class Visit>
  void for_each_turned(Visit visit) const {
    for (const Wheel& wheel : wheels_)
      if (wheel.turn != 0) visit(wheel.axis, wheel.points());
  }

 private:
  static constexpr std::size_t most_nodes = 8;  // of a body: four that carry it, and some markers
  struct Wheel {
    std::array<std::uint32_t, 2> axis;
    std::array<std::uint32_t, most_nodes> own;
    std::uint32_t own_count = 0;
    std::span<const std::uint32_t> couplings;  // of its own points' masses, in Problem::mass_couplings
    std::array<Vec3, most_nodes> turning;      // e at the end of the step
    double lost = 0;                           // kg m^2/s
    double inertia = 0;                        // kg m^2
    double turn = 0;                           // rad/s

    std::span<const std::uint32_t> points() const { return {own.data(), own_count}; }
    /// Among its own points; `own_count` or more if it is another one.
    std::size_t place_of(std::uint32_t node) const {
      return static_cast<std::size_t>(std::find(own.begin(), own.begin() + own_count, node) - own.begin());
    }
  };
  class Neighbors;
  void find(const Problem&);
  bool may_have_wheels(const Problem&);
  void add_losses_of_fields(const Problem&, double h);
  template <class Visit>
  static void for_each_mass(const Problem&, const Wheel&, Visit);

  bool is_known_ = false;
  bool depends_on_masses_ = false;  // whether there are any
  std::vector<Wheel> wheels_;
  std::vector<std::uint32_t> couplings_;  // of the wheels, one after the other
  std::vector<std::uint32_t> wheel_of_;   // each node, as an own point; their number if it is none
  // Room to find them.
  std::unique_ptr<Neighbors> neighbors_;
  std::vector<std::uint8_t> is_own_;
  std::vector<std::uint32_t> end_of_couplings_;
  std::vector<double> row_masses_;
};

}  // namespace iota::solver
