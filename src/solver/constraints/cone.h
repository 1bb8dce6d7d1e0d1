// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

namespace iota::solver {

/// The state of a constraint whose multipliers are in a cone, |lambda_t| <= mu |lambda_n|: its reaction and its
/// friction.
struct ConeState {
  enum class Mode : std::uint8_t {
    open,    ///< all multipliers are zero
    sticks,  ///< all rows are equations
    slips    ///< the multiplier of the tangent is at the edge of the cone
  };
  Mode mode = Mode::sticks;
  int direction = 0;  ///< the sign of the multiplier of a tangent that slips; 0: it slips without friction

  friend bool operator==(const ConeState&, const ConeState&) = default;
  bool slips() const { return mode == Mode::slips; }
};

/// Residuals r of the three rows of a cone, m, and their derivatives by the rows' values g and by the multipliers. In the
/// matrix
///   row r     sum_q by_value[r][q] dg_q/dx
///   column r  dg_r/dx: the force of a multiplier has its direction, whatever its row says. So the matrix is not
///             symmetric where a row slips
///   block     by_multiplier, which holds d(mu |lambda_n|)
struct ConeEquations {
  using Block = std::array<std::array<double, 3>, 3>;
  std::array<double, 3> value{};
  Block by_value{}, by_multiplier{};
};

}  // namespace iota::solver
