// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iota/vec3.h>

#include <optional>

namespace iota {

/// Row-major 3 x 3 matrix.
struct Mat3 {
  double m[3][3] = {};

  static Mat3 diagonal(double s) { return {{{s, 0, 0}, {0, s, 0}, {0, 0, s}}}; }
  static Mat3 outer(const Vec3& a, const Vec3& b) {
    return {{{a.x * b.x, a.x * b.y, a.x * b.z}, {a.y * b.x, a.y * b.y, a.y * b.z}, {a.z * b.x, a.z * b.y, a.z * b.z}}};
  }
  /// [v]x: times w it is v x w.
  static Mat3 cross_matrix(const Vec3& v) { return {{{0, -v.z, v.y}, {v.z, 0, -v.x}, {-v.y, v.x, 0}}}; }
  Mat3 transposed() const {
    return {{{m[0][0], m[1][0], m[2][0]}, {m[0][1], m[1][1], m[2][1]}, {m[0][2], m[1][2], m[2][2]}}};
  }
  void set_column(int k, const Vec3& v) { m[0][k] = v.x, m[1][k] = v.y, m[2][k] = v.z; }
  double trace() const { return m[0][0] + m[1][1] + m[2][2]; }
  Mat3& operator+=(const Mat3& b) {
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) m[i][j] += b.m[i][j];
    return *this;
  }
  Mat3& operator*=(double s) {
    for (auto& row : m)
      for (double& v : row) v *= s;
    return *this;
  }
  friend Mat3 operator+(Mat3 a, const Mat3& b) { return a += b; }
  friend Mat3 operator*(double s, Mat3 a) { return a *= s; }
  Vec3 operator*(const Vec3& v) const {
    return {m[0][0] * v.x + m[0][1] * v.y + m[0][2] * v.z, m[1][0] * v.x + m[1][1] * v.y + m[1][2] * v.z,
            m[2][0] * v.x + m[2][1] * v.y + m[2][2] * v.z};
  }
  Mat3 operator*(const Mat3& b) const {
    Mat3 c;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) c.m[i][j] = m[i][0] * b.m[0][j] + m[i][1] * b.m[1][j] + m[i][2] * b.m[2][j];
    return c;
  }
};

/// The transposed matrix times a vector.
inline Vec3 transposed_times(const Mat3& a, const Vec3& v) {
  return {a.m[0][0] * v.x + a.m[1][0] * v.y + a.m[2][0] * v.z, a.m[0][1] * v.x + a.m[1][1] * v.y + a.m[2][1] * v.z,
          a.m[0][2] * v.x + a.m[1][2] * v.y + a.m[2][2] * v.z};
}

/// Moment of inertia about the origin of a mass that couples the velocities of points at p and q: m (p . q I - q p').
inline Mat3 coupled_inertia(double mass, const Vec3& p, const Vec3& q) {
  return mass * (Mat3::diagonal(dot(p, q)) + -1.0 * Mat3::outer(q, p));
}
/// The same of a point mass at r: m (|r|^2 I - r r').
inline Mat3 point_inertia(double mass, const Vec3& r) { return coupled_inertia(mass, r, r); }

/// The solution of A x = b by cofactors; not finite if A is singular.
inline Vec3 solve(const Mat3& a, const Vec3& b) {
  const Vec3 r0{a.m[0][0], a.m[0][1], a.m[0][2]}, r1{a.m[1][0], a.m[1][1], a.m[1][2]},
      r2{a.m[2][0], a.m[2][1], a.m[2][2]};
  const Vec3 c0 = cross(r1, r2);
  return (1 / dot(r0, c0)) * (b.x * c0 + b.y * cross(r2, r0) + b.z * cross(r0, r1));
}

/// Eigenvalues of a symmetric matrix and its unit eigenvectors, a right-handed set.
struct SymmetricEigen {
  double values[3];
  Vec3 axes[3];
};
SymmetricEigen symmetric_eigen(const Mat3& a);

/// Least-squares solution of A x = b for symmetric positive semi-definite A: x has no component in directions in which
/// A is (nearly) zero: eigenvalues below `tolerance` (1e-6 at most) times the largest.
Vec3 solve_semidefinite(const Mat3& a, const Vec3& b, double tolerance = 1e-10);
/// The same with known eigenvectors: for many right-hand sides.
Vec3 solve_semidefinite(const SymmetricEigen& a, const Vec3& b, double tolerance);

/// The rotation that takes vectors x nearest to vectors y in the sense of weighted least squares, from the sum of
/// weighted products y x' (Kabsch 1976, doi:10.1107/S0567739476001873). It never mirrors. Vectors on one line leave the
/// turn about this line open; no vectors give the identity.
Mat3 nearest_rotation(const Mat3& products);

// Quaternions.
Quaternion multiply(const Quaternion& a, const Quaternion& b);
Quaternion normalized(const Quaternion& q);
Quaternion conjugate(const Quaternion& q);  ///< the turn back
inline Vec3 rotate(const Quaternion& q, const Vec3& v) {
  const Vec3 u{q.x, q.y, q.z};
  const Vec3 t = 2 * cross(u, v);
  return v + q.w * t + cross(u, t);
}
/// The matrix of a rotation, by a unit quaternion.
inline Mat3 matrix_of(const Quaternion& q) {
  const double xx = 2 * q.x * q.x, yy = 2 * q.y * q.y, zz = 2 * q.z * q.z, xy = 2 * q.x * q.y, xz = 2 * q.x * q.z,
               yz = 2 * q.y * q.z, xw = 2 * q.x * q.w, yw = 2 * q.y * q.w, zw = 2 * q.z * q.w;
  return {{{1 - yy - zz, xy - zw, xz + yw}, {xy + zw, 1 - xx - zz, yz - xw}, {xz - yw, yz + xw, 1 - xx - yy}}};
}
Quaternion axis_angle(const Vec3& unit_axis, double angle);
/// The rotation about a vector by its length, rad.
Quaternion turn_by(const Vec3& v);
/// The smallest rotation from unit vector `from` to unit vector `to`.
Quaternion shortest_turn(const Vec3& from, const Vec3& to);
/// The rotation whose columns are the orthonormal, right-handed axes.
Quaternion from_axes(const Vec3& x, const Vec3& y, const Vec3& z);
/// Along axis 0 (x), 1 (y) or 2 (z).
inline Vec3 unit_vector(int axis) { return {axis == 0 ? 1.0 : 0, axis == 1 ? 1.0 : 0, axis == 2 ? 1.0 : 0}; }
/// The direction of v, or `other` if v is not longer than `least`.
inline Vec3 unit_or(const Vec3& v, const Vec3& other, double least = 0) {
  const double length = norm(v);
  return length > least ? (1 / length) * v : other;
}
/// A unit vector at right angles to unit vector v.
Vec3 any_perpendicular(const Vec3& v);

}  // namespace iota
