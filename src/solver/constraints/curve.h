// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "geometry/curve.h"
#include "solver/constraints/place.h"

namespace iota::solver {

/// The foot of a point on a curve, (p - c(s)).c'(s) = 0, with derivatives of s by p:
///   grad s = c' / (|c'|^2 - w.c''),   w = p - c
///   Hess s = (c'' grad s' + grad s c''' + (w.c''' - 3 c'.c'') grad s grad s') / (|c'|^2 - w.c'')
struct CurveFoot {
  double s = 0;
  geometry::CurvePoint c;
  Vec3 offset;    ///< w
  Vec3 gradient;  ///< of s

  CurveFoot(const geometry::Curve& curve, const Vec3& p, double near)
      : s(curve.nearest(p, near)), c(curve.at(s)), offset(p - c.position) {
    slope_ = dot(c.d1, c.d1) - dot(offset, c.d2);
    gradient = (1 / slope_) * c.d1;
  }
  Mat3 hessian() const {
    return (1 / slope_) * (Mat3::outer(c.d2, gradient) + Mat3::outer(gradient, c.d2) +
                           (dot(offset, c.d3) - 3 * dot(c.d1, c.d2)) * Mat3::outer(gradient, gradient));
  }

 private:
  double slope_;
};

/// A point on a curve fixed in a body or in the world.
///   constraint  g_k = n_k(s).(p - c(s)),  k = 1, 2   (m);   s the foot of p
///   gradient    n_k + (n_k'.w) grad s
/// n_k = N_k - (N_k.t) / (1 + t0.t) (t0 + t): the normals N_k at the foot where `track` was last called, turned with
/// the tangent by the smallest rotation (parallel transport; Bishop 1975), so that multipliers, the forces along them
/// in N, are continuous. Valid for turns of the tangent up to half a turn between calls.
struct CurveConstraint : PlaceConstraint<CurveConstraint, 2> {
  const geometry::Curve* curve = nullptr;
  double parameter = 0;      ///< of the point at the last `track`, m
  Vec3 tangent, normals[2];  ///< there, in the curve's frame
  double reference = 1;

  double reference_length() const { return reference; }
  /// Starts at parameter s, with a force (N, in the curve's frame) as multipliers.
  void start(double s, const Vec3& force, double* multipliers) {
    parameter = s;
    const geometry::CurvePoint c = curve->at(s);
    tangent = (1 / norm(c.d1)) * c.d1;
    normals[0] = any_perpendicular(tangent), normals[1] = cross(tangent, normals[0]);
    multipliers[0] = dot(force, normals[0]), multipliers[1] = dot(force, normals[1]);
  }
  /// The force of multipliers, for `start`; the force on the point is the opposite.
  Vec3 force(const double* multipliers) const { return multipliers[0] * normals[0] + multipliers[1] * normals[1]; }
  void track(const Vec3* x, double fraction) {
    const CurveFoot foot(*curve, place(x, fraction), parameter);
    const Frame frame(*this, foot.c);
    parameter = foot.s, tangent = frame.t;
    normals[0] = frame.n[0], normals[1] = frame.n[1];
  }

  void calc_place_value(const Vec3& xi, double /*fraction*/, double* g) const {
    const CurveFoot foot(*curve, xi, parameter);
    const Frame frame(*this, foot.c);
    for (int k = 0; k < 2; ++k) g[k] = dot(frame.n[k], foot.offset);
  }
  void calc_place_gradient(const Vec3& xi, Vec3* d) const {
    const CurveFoot foot(*curve, xi, parameter);
    const Frame frame(*this, foot.c);
    for (int k = 0; k < 2; ++k) d[k] = frame.n[k] + dot(frame.dn[k], foot.offset) * foot.gradient;
  }
  Mat3 calc_place_hessian(const Vec3& xi, const double* lambda) const {
    const CurveFoot foot(*curve, xi, parameter);
    const Frame frame(*this, foot.c);
    Mat3 sum;
    for (int k = 0; k < 2; ++k)
      sum += lambda[k] * (Mat3::outer(frame.dn[k], foot.gradient) + Mat3::outer(foot.gradient, frame.dn[k]) +
                          (dot(frame.ddn[k], foot.offset) - dot(frame.dn[k], foot.c.d1)) *
                              Mat3::outer(foot.gradient, foot.gradient) +
                          dot(frame.dn[k], foot.offset) * foot.hessian());
    return sum;
  }

 private:
  /// Tangent and normals at a foot, and the normals' derivatives by s.
  struct Frame {
    Vec3 t, n[2], dn[2], ddn[2];
    Frame(const CurveConstraint& k, const geometry::CurvePoint& c) {
      const double v = norm(c.d1);
      t = (1 / v) * c.d1;
      const Vec3 across = c.d2 - dot(t, c.d2) * t, dt = (1 / v) * across;
      const Vec3 d_across = c.d3 - dot(t, c.d2) * dt - (dot(dt, c.d2) + dot(t, c.d3)) * t;
      const Vec3 ddt = (1 / v) * d_across - (dot(t, c.d2) / (v * v)) * across;
      const double b = 1 + dot(k.tangent, t), db = dot(k.tangent, dt), ddb = dot(k.tangent, ddt);
      const Vec3 middle = k.tangent + t;
      for (int i = 0; i < 2; ++i) {
        const Vec3& start = k.normals[i];
        const double a = dot(start, t) / b;
        const double da = (dot(start, dt) - a * db) / b, dda = (dot(start, ddt) - 2 * da * db - a * ddb) / b;
        n[i] = start - a * middle;
        dn[i] = -da * middle - a * dt;
        ddn[i] = -dda * middle - 2 * da * dt - a * ddt;
      }
    }
  };
};

/// The arc length of a point's foot on a curve: ends, motors, friction and springs of beads.
///   constraint  g = s - target(fraction)   (m);   the multiplier is the force along the curve, N
/// On closed curves s is counted through full turns, from the parameter at the last `track`.
struct StationConstraint : PlaceConstraint<StationConstraint, 1> {
  const geometry::Curve* curve = nullptr;
  double parameter = 0;  ///< m
  double target_start = 0, target = 0;
  double reference = 1;

  double reference_length() const { return reference; }
  bool is_moving() const { return target != target_start || Arms::is_moving(); }
  void track(const Vec3* x, double fraction) { parameter = CurveFoot(*curve, place(x, fraction), parameter).s; }

  void calc_place_value(const Vec3& xi, double fraction, double* g) const {
    g[0] = curve->nearest(xi, parameter) - (target_start + fraction * (target - target_start));
  }
  void calc_place_gradient(const Vec3& xi, Vec3* d) const { d[0] = CurveFoot(*curve, xi, parameter).gradient; }
  Mat3 calc_place_hessian(const Vec3& xi, const double* lambda) const {
    return lambda[0] * CurveFoot(*curve, xi, parameter).hessian();
  }
};

}  // namespace iota::solver
