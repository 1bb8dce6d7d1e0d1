// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "solver/constraints/arms.h"

#include <algorithm>
#include <numbers>

namespace iota::solver {

/// The angle about an axis n from a direction r of one body to a direction d of another: limits, motors, friction and
/// torsion springs of hinges.
///   constraint  g(x) = theta - target(fraction)   (rad);   theta = atan2(S, C) + 2 pi k
///               S = |n| n.(r x d),  C = |n|^2 r.d - (n.r)(n.d);  k brings theta within half a turn of `near`
///   gradient    dtheta = (C dS - S dC) / (S^2 + C^2)
/// Arms: 0 = n, 1 = r, 2 = d; of any lengths, r and d not along n. The multiplier is the torque in N m that turns d
/// back towards r. `track` unwraps further angles near the present one, so that turns are counted.
struct AngleConstraint : ArmConstraint<AngleConstraint, 1, 3> {
  double target_start = 0, target = 0;  ///< rad
  double near = 0;                      ///< rad

  static constexpr double reference_length() { return 1; }
  bool is_moving() const { return target != target_start || Arms::is_moving(); }
  void track(const Vec3* x, double fraction) { near = angle(x, fraction); }
  double angle(const Vec3* x, double fraction) const {
    double g = 0;
    value(x, fraction, &g);
    return g + target_at(fraction);
  }

  void calc_value(const Vec3* e, double fraction, double* g) const {
    const Vec3 &n = e[0], &r = e[1], &d = e[2];
    const double theta = std::atan2(norm(n) * dot(n, cross(r, d)), dot(n, n) * dot(r, d) - dot(n, r) * dot(n, d));
    constexpr double turn = 2 * std::numbers::pi;
    g[0] = theta + turn * std::floor((near - theta) / turn + 0.5) - target_at(fraction);
  }
  void calc_gradient(const Vec3* e, Vec3 (*out)[3]) const {
    const First f(e);
    for (int a = 0; a < 3; ++a) out[0][a] = (1 / f.size2()) * (f.c * f.ds[a] - f.s * f.dc[a]);
  }
  /// For the mid-point rule: the gradient at the mean arms, of which the torques on both bodies are equal and opposite, times a
  /// factor that gives the exact change of the angle. If an angle changes by less than `least` while its axis turns fast,
  /// part of the factor is left out, as it is a ratio of small differences.
  void mean_gradients(const Vec3* x0, double start, const Vec3* x1, double end, Vec3* out) const {
    constexpr double least = 1e-3;  // rad
    Vec3 d[1][3];
    calc_gradient(mean_of(arms(x0, start), arms(x1, end)).data(), d);
    to_nodes(d, out);
    double given = 0;
    for (std::uint32_t i = 0; i < count; ++i) given += dot(out[i], x1[nodes[i]] - x0[nodes[i]]);
    const double change = angle(x1, end) - angle(x0, start);
    const double squared = given * given, floor = least * least * least * least;
    const double factor = (change * given * squared + floor) / (squared * squared + floor);
    for (std::uint32_t i = 0; i < count; ++i) out[i] = std::clamp(factor, 0.5, 2.0) * out[i];
  }
  void calc_hessian(const Vec3* e, const double* lambda, bool clamp, Mat3 (*h)[3]) const {
    if (clamp) {
      for (int a = 0; a < 3; ++a)
        for (int b = a; b < 3; ++b) h[a][b] = {};
      return;
    }
    const First f(e);
    const Vec3 &n = e[0], &r = e[1], &d = e[2];
    const double nu = norm(n), t = f.s / nu;
    const Vec3 tn = cross(r, d), tr = cross(d, n), td = cross(n, r);
    // Second derivatives of S and of C.
    Mat3 ss[3][3], cc[3][3];
    ss[0][0] = (1 / nu) * (Mat3::outer(n, tn) + Mat3::outer(tn, n)) +
               t * (Mat3::diagonal(1 / nu) + (-1 / (nu * nu * nu)) * Mat3::outer(n, n));
    ss[0][1] = -nu * Mat3::cross_matrix(d) + (1 / nu) * Mat3::outer(n, tr);
    ss[0][2] = nu * Mat3::cross_matrix(r) + (1 / nu) * Mat3::outer(n, td);
    ss[1][2] = -nu * Mat3::cross_matrix(n);
    cc[0][0] = Mat3::diagonal(2 * dot(r, d)) + -1.0 * (Mat3::outer(r, d) + Mat3::outer(d, r));
    cc[0][1] = 2.0 * Mat3::outer(n, d) + -1.0 * Mat3::outer(d, n) + Mat3::diagonal(-dot(n, d));
    cc[0][2] = 2.0 * Mat3::outer(n, r) + -1.0 * Mat3::outer(r, n) + Mat3::diagonal(-dot(n, r));
    cc[1][2] = Mat3::diagonal(nu * nu) + -1.0 * Mat3::outer(n, n);
    const double inverse = 1 / f.size2();
    for (int a = 0; a < 3; ++a)
      for (int b = a; b < 3; ++b) {
        const Vec3 numerator = f.c * f.ds[a] - f.s * f.dc[a];
        h[a][b] =
            lambda[0] * inverse *
            (f.c * ss[a][b] + -f.s * cc[a][b] + Mat3::outer(f.ds[a], f.dc[b]) + -1.0 * Mat3::outer(f.dc[a], f.ds[b]) +
             (-2 * inverse) * Mat3::outer(numerator, f.s * f.ds[b] + f.c * f.dc[b]));
      }
  }

 private:
  double target_at(double fraction) const { return target_start + fraction * (target - target_start); }
  /// S, C and their first derivatives by the arms.
  struct First {
    double s, c;
    Vec3 ds[3], dc[3];
    explicit First(const Vec3* e) {
      const Vec3 &n = e[0], &r = e[1], &d = e[2];
      const double nu = norm(n), t = dot(n, cross(r, d));
      s = nu * t, c = nu * nu * dot(r, d) - dot(n, r) * dot(n, d);
      ds[0] = nu * cross(r, d) + (t / nu) * n, ds[1] = nu * cross(d, n), ds[2] = nu * cross(n, r);
      dc[0] = 2 * dot(r, d) * n - dot(n, d) * r - dot(n, r) * d;
      dc[1] = nu * nu * d - dot(n, d) * n, dc[2] = nu * nu * r - dot(n, r) * n;
    }
    double size2() const { return s * s + c * c; }
  };
};

}  // namespace iota::solver
