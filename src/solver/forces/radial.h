// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "laws/pair_law.h"
#include "solver/forces/dashpot.h"
#include "solver/forces/force_arm.h"

#include <algorithm>
#include <array>

namespace iota::solver {

/// Any law between two points. With r = |e|, n = e/r, T = U'(r) - push(r) the pull, D the damping and c the drag:
///   end point: F = -T(r1) n1 + D(r0, n.(e1-e0)/h) n - c(r0) (e1-e0)/h, n as Dashpot says; with -T(r0) n0, held at the start, where
///   that attracts and U''(r0) < 0. At the end of a step an attracting pole has a second root beside the pole, in which Newton's
///   method caught two bodies for good.
///   mid-point: D and c are those of (r0+r1)/2; T(r1) n1 becomes T* (e0+e1)/(r0+r1), with T* = (U(r1)-U(r0))/(r1-r0) - push((r0+r1)/2), so that the work
///   of the elastic part is exactly minus the change of energy (Gonzalez 1996). Of a law that depends on the time T* is the mean
///   for both times, and the others are taken in the middle; the energy is that at the end, so that the difference is external work.
/// If r1 is near r0 the quotient would be round-off: U' at the two Gauss points has the same value to (r1-r0)^4.
struct RadialForce {
  static constexpr bool is_external = false;
  ForceArm arm;
  const laws::PairLaw* law = nullptr;
  std::array<double, laws::max_parameters> parameters{};
  double time = 0, time_before = 0;  ///< at the end of the step and at its start, s; the same at an instant
  double m_p = 1, m_q = 1;           ///< kg

  bool keeps_angular_momentum() const { return !law->has_drag(); }
  double energy(const Vec3& e) const { return law->elastic(at(norm(e)), parameters.data()).energy; }

  Vec3 force(const Vec3& e0, const Vec3& e1, const ForceStage& s) const {
    const double r1 = norm(e1), r0 = s.instant ? r1 : norm(e0);
    Vec3 f;
    if (s.midpoint)
      f = (-pull_between(r0, r1, s).value / (r0 + r1 + tiny)) * (e0 + e1);
    else
      f = !s.instant && attracts_more_nearby(r0) ? (-pull(r0).value / (r0 + tiny)) * e0
                                                 : (-pull(r1).value / (r1 + tiny)) * e1;
    if (has_dashpot()) f += dashpot_force(e0, e1, s);
    if (law->has_drag()) f -= (law->drag(acting(distance(e0, e1, s), s), parameters.data()) / s.h) * (e1 - e0);
    return f;
  }

  bool has_dashpot() const { return law->has_damping(); }
  Vec3 dashpot_force(const Vec3& e0, const Vec3& e1, const ForceStage& s) const {
    const Dashpot dashpot(e0, e1, s);
    const laws::PairState state = acting(distance(e0, e1, s), s, dashpot.along / s.h);
    return law->damping(state, parameters.data()).value * dashpot.n;
  }

  /// See SpringForce.
  bool may_act_across() const { return has_dashpot() || law->has_energy(); }
  Vec3 force_across(const Vec3& e0, const Vec3& e1, const ForceStage& s) const {
    Vec3 f = has_dashpot() ? dashpot_force(e0, e1, s) : Vec3{};
    if (const double r0 = norm(e0); attracts_more_nearby(r0)) f -= (pull(r0).value / (r0 + tiny)) * e0;
    return f;
  }

  double dissipation(const Vec3& e0, const Vec3& e1, const ForceStage& s) const {
    if (!law->has_damping() && !law->has_drag()) return 0;
    const double r = distance(e0, e1, s), along = Dashpot(e0, e1, s).along;
    double taken = 0;
    if (law->has_damping()) taken -= law->damping(acting(r, s, along / s.h), parameters.data()).value * along;
    if (law->has_drag()) taken += law->drag(acting(r, s), parameters.data()) / s.h * dot(e1 - e0, e1 - e0);
    return taken;
  }

  Mat3 stiffness_matrix(const Vec3& e0, const Vec3& e1, const ForceStage& s) const {
    const double r0 = norm(e0), r1 = norm(e1);
    const Vec3 n1 = (1 / (r1 + tiny)) * e1;
    const Slope p = s.midpoint ? pull_between(r0, r1, s) : attracts_more_nearby(r0) ? Slope{} : pull(r1);
    const double length = s.midpoint ? r0 + r1 + tiny : r1 + tiny;
    double along = p.slope, across = p.value / length;
    if (s.clamp) along = std::max(along, 0.0), across = std::max(across, 0.0);
    Mat3 k = Mat3::diagonal(across);
    k += (along - across) * Mat3::outer(s.midpoint ? (1 / length) * (e0 + e1) : n1, n1);
    const double r = distance(e0, e1, s);
    // In the middle of the step the distance is half of that at its end.
    const bool follows = s.midpoint && !s.clamp && law->damping_depends_on_distance();
    const auto slope_of_distance = [&](auto value) {
      const double step = 1e-6 * r + tiny;
      return follows ? (value(r + step) - value(r - step)) / (4 * step) : 0.0;
    };
    if (law->has_damping()) {
      const Dashpot dashpot(e0, e1, s);
      const auto damping = [&](double at) {
        return law->damping(acting(at, s, dashpot.along / s.h), parameters.data());
      };
      const Slope now = damping(r);
      const double rate = -now.slope / s.h;
      k += dashpot.stiffness_matrix(e1, s.clamp ? std::max(rate, 0.0) : rate, -now.value, s);
      k += -slope_of_distance([&](double at) { return damping(at).value; }) * Mat3::outer(dashpot.n, n1);
    }
    if (law->has_drag()) {
      const auto drag = [&](double at) { return law->drag(acting(at, s), parameters.data()) / s.h; };
      k += Mat3::diagonal(drag(r)) + slope_of_distance(drag) * Mat3::outer(e1 - e0, n1);
    }
    return k;
  }

  bool attracts_more_nearby(double r) const {
    const laws::Elastic u = law->elastic(at(r), parameters.data());
    return u.curvature < 0 && u.slope > 0;
  }
  /// The difference of the work of a force that is held at the start of a step from the change of its energy, J.
  double held_force_error(const Vec3& e0, const Vec3& e1, const ForceStage& s) const {
    const double r0 = norm(e0);
    if (s.midpoint || s.instant || !attracts_more_nearby(r0)) return 0;
    return energy(e1) - energy(e0) - law->elastic(at(r0), parameters.data()).slope / (r0 + tiny) * dot(e0, e1 - e0);
  }

  /// By which its energy changes in time, W, from the energies up to 2 dt seconds before and after.
  double power_of_time(const Vec3& e, double dt) const {
    if (!law->depends_on_time() || !law->has_energy()) return 0;
    const double r = norm(e);
    const auto energy_after = [&](double t) {
      return law->elastic({r, 0, time + t, m_p, m_q}, parameters.data()).energy;
    };
    return (8 * (energy_after(dt) - energy_after(-dt)) - (energy_after(2 * dt) - energy_after(-2 * dt))) / (12 * dt);
  }
  /// Whether it may do work that its energy does not tell.
  bool does_external_work() const { return law->has_push() || law->depends_on_time(); }
  /// The work that its energy does not tell, J.
  double external_work(const Vec3& e0, const Vec3& e1, const ForceStage& s) const {
    if (!does_external_work()) return 0;
    const double r0 = norm(e0), r1 = norm(e1);
    if (s.midpoint) {
      const double by_push = law->push(acting((r0 + r1) / 2, s), parameters.data()).value * (r1 - r0);
      return law->depends_on_time()
                 ? by_push + (elastic_between(r0, r1, time).value - elastic_between(r0, r1).value) * (r1 - r0)
                 : by_push;
    }
    if (!s.instant && attracts_more_nearby(r0))
      return law->push(at(r0), parameters.data()).value / (r0 + tiny) * dot(e0, e1 - e0);
    return law->push(at(r1), parameters.data()).value / (r1 + tiny) * dot(e1, e1 - e0);
  }

 private:
  static constexpr double tiny = 1e-300;
  using Slope = laws::PairLaw::Slope;

  /// At which the parts without an energy are taken: in the middle of a step for its second order, at the start of an end-point step.
  static double distance(const Vec3& e0, const Vec3& e1, const ForceStage& s) {
    return s.instant ? norm(e1) : s.midpoint ? 0.5 * (norm(e0) + norm(e1)) : norm(e0);
  }
  laws::PairState at(double r, double v = 0) const { return {r, v, time, m_p, m_q}; }
  /// The state for the parts without an energy.
  laws::PairState acting(double r, const ForceStage& s, double v = 0) const {
    return {r, v, s.midpoint ? 0.5 * (time_before + time) : time, m_p, m_q};
  }

  Slope pull(double r) const {
    const laws::Elastic u = law->elastic(at(r), parameters.data());
    const Slope push = law->push(at(r), parameters.data());
    return {u.slope - push.value, u.curvature - push.slope};
  }

  /// T* and its derivative by r1, without the push.
  Slope elastic_between(double r0, double r1) const {
    if (!law->has_energy()) return {};
    const Slope at_end = elastic_between(r0, r1, time);
    if (time_before == time || !law->depends_on_time()) return at_end;
    const Slope before = elastic_between(r0, r1, time_before);
    return {0.5 * (before.value + at_end.value), 0.5 * (before.slope + at_end.slope)};
  }
  Slope elastic_between(double r0, double r1, double t) const {
    const double change = r1 - r0;
    const auto elastic = [&](double r) { return law->elastic({r, 0, t, m_p, m_q}, parameters.data()); };
    if (std::abs(change) > 3e-4 * (r0 + r1)) {
      const laws::Elastic a = elastic(r0), b = elastic(r1);
      const double pull = (b.energy - a.energy) / change;
      return {pull, (b.slope - pull) / change};
    }
    constexpr double low = 0.21132486540518713, high = 1 - low;
    const laws::Elastic a = elastic(r0 + low * change), b = elastic(r0 + high * change);
    return {0.5 * (a.slope + b.slope), 0.5 * (low * a.curvature + high * b.curvature)};
  }
  Slope pull_between(double r0, double r1, const ForceStage& s) const {
    const Slope t = elastic_between(r0, r1), push = law->push(acting((r0 + r1) / 2, s), parameters.data());
    return {t.value - push.value, t.slope - 0.5 * push.slope};
  }
};

}  // namespace iota::solver
