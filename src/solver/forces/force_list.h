// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "solver/forces/dashpot.h"
#include "solver/forces/force_arm.h"
#include "solver/forces/gyroscopic.h"
#include "solver/forces/radial.h"
#include "solver/forces/velocity_force.h"

#include <array>
#include <cmath>
#include <concepts>
#include <cstdint>
#include <tuple>

namespace iota::solver {

/// F = -k (|e| - L) e/|e| - c n n.(e1 - e0)/h, n as Dashpot says. Mid-point: the discrete gradient of k/2 (|e|-L)^2, which
/// is -k (1 - 2L/(|e0|+|e1|)) (e0+e1)/2, so that F.(e1-e0) is exactly minus the change of energy.
struct SpringForce {
  static constexpr bool is_external = false;
  ForceArm arm;
  double stiffness = 0, damping = 0, length = 0;

  static constexpr bool keeps_angular_momentum() { return true; }
  static Vec3 direction(const Vec3& e) { return (1 / (norm(e) + 1e-300)) * e; }
  double energy(const Vec3& e) const {
    const double stretch = norm(e) - length;
    return 0.5 * stiffness * stretch * stretch;
  }
  Vec3 force(const Vec3& e0, const Vec3& e1, const ForceStage& s) const {
    const double r = s.midpoint ? (norm(e0) + norm(e1)) / 2 : norm(e1);
    const Vec3 e = s.midpoint ? 0.5 * (e0 + e1) : e1;
    const Vec3 elastic = (-stiffness * factor(r)) * e;
    return has_dashpot() ? elastic + dashpot_force(e0, e1, s) : elastic;
  }
  bool has_dashpot() const { return damping > 0; }
  Vec3 dashpot_force(const Vec3& e0, const Vec3& e1, const ForceStage& s) const {
    const Dashpot dashpot(e0, e1, s, length == 0);
    return (-damping / s.h * dashpot.along) * dashpot.n;
  }
  /// Forces that an end-point step takes along the line at its start, and not at its end, where it takes moments.
  bool may_act_across() const { return has_dashpot(); }
  Vec3 force_across(const Vec3& e0, const Vec3& e1, const ForceStage& s) const { return dashpot_force(e0, e1, s); }
  double dissipation(const Vec3& e0, const Vec3& e1, const ForceStage& s) const {
    if (!has_dashpot()) return 0;
    const double along = Dashpot(e0, e1, s, length == 0).along;
    return damping / s.h * along * along;
  }
  Mat3 stiffness_matrix(const Vec3& e0, const Vec3& e1, const ForceStage& s) const {
    const Vec3 n1 = direction(e1);
    Mat3 k;
    if (has_dashpot()) {
      const Dashpot dashpot(e0, e1, s, length == 0);
      k = dashpot.stiffness_matrix(e1, damping / s.h, damping / s.h * dashpot.along, s);
    }
    if (s.midpoint) {
      const double r = (norm(e0) + norm(e1)) / 2;
      double across = factor(r);
      if (s.clamp && across < 0) across = 0;
      k += Mat3::diagonal(0.5 * stiffness * across);
      k += (stiffness * length / (2 * r * r + 1e-300)) * Mat3::outer(0.5 * (e0 + e1), n1);
    } else {
      double across = factor(norm(e1));
      if (s.clamp && across < 0) across = 0;
      k += Mat3::diagonal(stiffness * across);
      k += (stiffness * (1 - across)) * Mat3::outer(n1, n1);
    }
    return k;
  }

 private:
  double factor(double r) const { return length == 0 ? 1 : 1 - length / (r + 1e-300); }
};

/// F = -c (e1 - e0)/h: viscous drag.
struct DragForce {
  static constexpr bool is_external = false;
  ForceArm arm;
  double damping = 0;

  static constexpr bool keeps_angular_momentum() { return false; }
  double energy(const Vec3&) const { return 0; }
  Vec3 force(const Vec3& e0, const Vec3& e1, const ForceStage& s) const { return (-damping / s.h) * (e1 - e0); }
  double dissipation(const Vec3& e0, const Vec3& e1, const ForceStage& s) const {
    return damping / s.h * dot(e1 - e0, e1 - e0);
  }
  Mat3 stiffness_matrix(const Vec3&, const Vec3&, const ForceStage& s) const { return Mat3::diagonal(damping / s.h); }
};

/// A grip: F = -k e - c (e1 - e0)/h towards the arm's origin.
struct GripForce {
  static constexpr bool is_external = true;
  ForceArm arm;
  double stiffness = 0, damping = 0;

  static constexpr bool keeps_angular_momentum() { return false; }
  double energy(const Vec3& e) const { return 0.5 * stiffness * dot(e, e); }
  Vec3 force(const Vec3& e0, const Vec3& e1, const ForceStage& s) const {
    return -stiffness * (s.midpoint ? 0.5 * (e0 + e1) : e1) - (damping / s.h) * (e1 - e0);
  }
  double dissipation(const Vec3&, const Vec3&, const ForceStage&) const { return 0; }  // all of its work is external
  Mat3 stiffness_matrix(const Vec3&, const Vec3&, const ForceStage& s) const {
    return Mat3::diagonal((s.midpoint ? 0.5 : 1) * stiffness + damping / s.h);
  }
};

template <class F>
concept ImplicitForce = requires(const F& f, const Vec3& e, const ForceStage& stage) {
  { F::is_external } -> std::convertible_to<bool>;
  { f.arm } -> std::convertible_to<ForceArm>;
  { f.keeps_angular_momentum() } -> std::convertible_to<bool>;  ///< of its points, if it is between them
  { f.energy(e) } -> std::convertible_to<double>;
  { f.force(e, e, stage) } -> std::convertible_to<Vec3>;
  { f.dissipation(e, e, stage) } -> std::convertible_to<double>;  // between e0 and e1, J
  { f.stiffness_matrix(e, e, stage) } -> std::convertible_to<Mat3>;
};

/// The list of implicit forces.
template <template <class> class Pool>
using ForcePools = std::tuple<Pool<SpringForce>, Pool<DragForce>, Pool<GripForce>, Pool<RadialForce>,
                              Pool<GyroscopicForce>, Pool<VelocityForce>>;

static_assert(ImplicitForce<SpringForce> && ImplicitForce<DragForce> && ImplicitForce<GripForce> &&
              ImplicitForce<RadialForce> && ImplicitForce<GyroscopicForce> && ImplicitForce<VelocityForce>);

}  // namespace iota::solver
