// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "solver/constraints/arms.h"

namespace iota::solver {

/// Constraints on the place of a point in a frame fixed in a body or in the world: functions of
///   xi_k = a_k . e;  arms 0: e = point - origin of the frame, 1 ... 3: its axes a_k (orthonormal; the basis of the body)
/// `Derived` has, as functions of xi,
///   void calc_place_value(const Vec3& xi, double fraction, double* g) const
///   void calc_place_gradient(const Vec3& xi, Vec3* d) const
///   Mat3 calc_place_hessian(const Vec3& xi, const double* lambda) const         sum_r lambda_r Hess(g_r), symmetric
/// Clamped, all curvature is left out, as eigenvalues for its positive part would cost too much.
template <class Derived, int Rows>
struct PlaceConstraint : ArmConstraint<Derived, Rows, 4> {
  /// The frame is the world's, with this origin. (Otherwise `add` the weights of origin and axes.)
  void set_world_frame(const Vec3& origin) {
    this->set_constant(0, -1.0 * origin);
    this->set_constant(1, {1, 0, 0}), this->set_constant(2, {0, 1, 0}), this->set_constant(3, {0, 0, 1});
  }
  Vec3 place(const Vec3* x, double fraction) const {
    const Vec3 e = this->arm(0, x, fraction);
    return {dot(this->arm(1, x, fraction), e), dot(this->arm(2, x, fraction), e), dot(this->arm(3, x, fraction), e)};
  }

  void calc_value(const Vec3* e, double fraction, double* g) const {
    derived().calc_place_value(place_of(e), fraction, g);
  }
  void calc_gradient(const Vec3* e, Vec3 (*d)[4]) const {
    Vec3 phi[Rows];
    derived().calc_place_gradient(place_of(e), phi);
    for (int r = 0; r < Rows; ++r) by_arms(e, phi[r], d[r]);
  }
  /// For the mid-point rule: the mean of the gradients by xi at both ends, with a part along the way of xi that gives the exact
  /// change of g (Gonzalez 1996), times the gradients of xi at the mean arms, which are exact and of which the forces keep
  /// angular momentum. On ways below `least` less of that part, as it is a ratio of small differences.
  void mean_gradients(const Vec3* x0, double start, const Vec3* x1, double end, Vec3* out) const {
    constexpr double least = 1e-6;  // of the reference length
    const auto e0 = this->arms(x0, start), e1 = this->arms(x1, end);
    const Vec3 from = place_of(e0.data()), to = place_of(e1.data()), way = to - from;
    double g0[Rows], g1[Rows];
    Vec3 phi0[Rows], phi1[Rows], d[Rows][4];
    derived().calc_place_value(from, 0, g0), derived().calc_place_value(to, 0, g1);
    derived().calc_place_gradient(from, phi0), derived().calc_place_gradient(to, phi1);
    const double shortest = least * derived().reference_length();
    const auto middle = this->mean_of(e0, e1);
    for (int r = 0; r < Rows; ++r) {
      Vec3 phi = 0.5 * (phi0[r] + phi1[r]);
      phi += (g1[r] - g0[r] - dot(phi, way)) / (dot(way, way) + shortest * shortest) * way;
      by_arms(middle.data(), phi, d[r]);
    }
    this->to_nodes(d, out);
  }
  void calc_hessian(const Vec3* e, const double* lambda, bool clamp, Mat3 (*h)[4]) const {
    for (int a = 0; a < 4; ++a)
      for (int b = a; b < 4; ++b) h[a][b] = {};
    if (clamp) return;
    const Vec3 xi = place_of(e);
    Vec3 phi[Rows], sum;
    derived().calc_place_gradient(xi, phi);
    for (int r = 0; r < Rows; ++r) sum += lambda[r] * phi[r];
    const double first[3] = {sum.x, sum.y, sum.z};
    const Mat3 second = derived().calc_place_hessian(xi, lambda);
    for (int k = 0; k < 3; ++k) {
      Vec3 column;  // sum_l second_lk a_l
      for (int l = 0; l < 3; ++l) column += second.m[l][k] * e[1 + l];
      h[0][0] += Mat3::outer(column, e[1 + k]);
      h[0][1 + k] = Mat3::diagonal(first[k]) + Mat3::outer(column, e[0]);
      for (int l = k; l < 3; ++l) h[1 + k][1 + l] = second.m[k][l] * Mat3::outer(e[0], e[0]);
    }
  }

 private:
  const Derived& derived() const { return static_cast<const Derived&>(*this); }
  /// The gradient phi by xi becomes one by the arms.
  static void by_arms(const Vec3* e, const Vec3& phi, Vec3* d) {
    d[0] = phi.x * e[1] + phi.y * e[2] + phi.z * e[3];
    d[1] = phi.x * e[0], d[2] = phi.y * e[0], d[3] = phi.z * e[0];
  }
  static Vec3 place_of(const Vec3* e) { return {dot(e[1], e[0]), dot(e[2], e[0]), dot(e[3], e[0])}; }
};

}  // namespace iota::solver
