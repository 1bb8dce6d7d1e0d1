// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shape/traits.h"

#include <cmath>

namespace iota::shape {

/// A point in the half plane through it and the x axis: its place along the axis and distance from it. Shapes of
/// revolution about the x axis are plane figures there.
struct Meridian {
  double x, rho;
  Vec3 out, round;  ///< unit vectors away from the axis and around it

  explicit Meridian(const Vec3& p) : x(p.x), rho(std::sqrt(p.y * p.y + p.z * p.z)) {
    out = rho > 0 ? Vec3{0, p.y / rho, p.z / rho} : Vec3{0, 1, 0};
    round = {0, -out.z, out.y};
  }
  Vec3 at(double along, double away) const { return Vec3{along, 0, 0} + away * out; }

  /// Derivatives in space of a function with these derivatives by (x, rho). On the axis the radial slope is taken as 0.
  Level level(double value, double by_x, double by_rho, double by_xx, double by_xrho, double by_rho_rho) const {
    const Vec3 axis{1, 0, 0};
    Level l{value, by_x * axis + by_rho * out, {}};
    l.hessian = by_xx * Mat3::outer(axis, axis) + by_rho_rho * Mat3::outer(out, out) +
                by_xrho * (Mat3::outer(axis, out) + Mat3::outer(out, axis));
    if (rho > 0) l.hessian += (by_rho / rho) * Mat3::outer(round, round);
    return l;
  }
  /// The level that is the distance from a sharp edge, the circle of radius `away` at `along`. Nearer than `blunt` the
  /// curvature is constant, so that Newton's matrix stays finite at the edge.
  Level edge(double along, double away, double blunt) const {
    const double u = x - along, v = rho - away, distance = std::sqrt(u * u + v * v);
    const double a = u / distance, b = v / distance, bend = 1 / std::max(distance, blunt);
    return level(distance, a, b, b * b * bend, -a * b * bend, a * a * bend);
  }
};

/// Relative to a shape's scale: within this distance the curvature at sharp edges is bounded; level sets at that
/// distance replace a sharp surface where a normal is needed (see surface_pair.h).
inline constexpr double edge_bluntness = 0.01, edge_skin = 0.1;

/// f(d) = d + d^2 / 2r of a level d: what makes the distance from a curve or an axis quadratic.
inline Level bent(const Level& d, double r) {
  const double slope = 1 + d.value / r;
  return {d.value * (1 + d.value / (2 * r)), slope * d.gradient,
          slope * d.hessian + (1 / r) * Mat3::outer(d.gradient, d.gradient)};
}

}  // namespace iota::shape
