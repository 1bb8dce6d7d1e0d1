// SPDX-License-Identifier: Apache-2.0
#include "math/mat3.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace iota {

SymmetricEigen symmetric_eigen(const Mat3& a) {
  // Jacobi rotations: for 3 x 3 simple and exact to round-off, with reliable ranks. What a rotation removes is zero from
  // then on: the round-off that it leaves would be rotated again and again (80 % of the step of a pendulum of two points).
  constexpr double negligible = 1e-20;  // beside the largest entry; the rotations themselves are exact to 1e-16
  constexpr int max_sweeps = 12;        // four or five are usual
  double s[3][3], v[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, largest = 0;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) s[i][j] = a.m[i][j], largest = std::max(largest, std::abs(s[i][j]));
  bool is_diagonal = false;
  for (int sweep = 0; sweep < max_sweeps && !is_diagonal; ++sweep) {
    is_diagonal = true;
    for (int p = 0; p < 2; ++p)
      for (int q = p + 1; q < 3; ++q) {
        if (std::abs(s[p][q]) <= negligible * largest) continue;
        is_diagonal = false;
        const double theta = (s[q][q] - s[p][p]) / (2 * s[p][q]);
        const double t = (theta >= 0 ? 1 : -1) / (std::abs(theta) + std::sqrt(theta * theta + 1));
        const double c = 1 / std::sqrt(t * t + 1), sine = t * c;
        const int k = 3 - p - q;
        const double kp = s[k][p], kq = s[k][q];
        s[p][p] -= t * s[p][q], s[q][q] += t * s[p][q];
        s[p][q] = s[q][p] = 0;
        s[k][p] = s[p][k] = c * kp - sine * kq, s[k][q] = s[q][k] = sine * kp + c * kq;
        for (auto& row : v) {
          const double vp = row[p], vq = row[q];
          row[p] = c * vp - sine * vq, row[q] = sine * vp + c * vq;
        }
      }
  }
  // A rotation from the identity, so right-handed.
  return {{s[0][0], s[1][1], s[2][2]},
          {{v[0][0], v[1][0], v[2][0]}, {v[0][1], v[1][1], v[2][1]}, {v[0][2], v[1][2], v[2][2]}}};
}

namespace {

/// By elimination, where no pivot is small beside the largest entry: then no eigenvalue is within a tolerance of zero.
std::optional<Vec3> eliminate(const Mat3& a, const Vec3& b) {
  constexpr double smallest = 1e-2;
  const auto& m = a.m;
  const double least = smallest * std::max({m[0][0], m[1][1], m[2][2]});
  const double l1 = m[1][0] / m[0][0], l2 = m[2][0] / m[0][0];
  const double pivot1 = m[1][1] - l1 * m[1][0], below = m[2][1] - l2 * m[1][0];
  const double l = below / pivot1, pivot2 = m[2][2] - l2 * m[2][0] - l * below;
  if (!(m[0][0] > least && pivot1 > least && pivot2 > least)) return {};
  const double forward = b.y - l1 * b.x;
  const double z = (b.z - l2 * b.x - l * forward) / pivot2, y = forward / pivot1 - l * z;
  return Vec3{b.x / m[0][0] - l1 * y - l2 * z, y, z};
}

}  // namespace

Vec3 solve_semidefinite(const Mat3& a, const Vec3& b, double tolerance) {
  if (const std::optional<Vec3> x = eliminate(a, b)) return *x;
  return solve_semidefinite(symmetric_eigen(a), b, tolerance);
}

Vec3 solve_semidefinite(const SymmetricEigen& e, const Vec3& b, double tolerance) {
  const double largest = std::max({e.values[0], e.values[1], e.values[2]});
  Vec3 x;
  for (int k = 0; k < 3; ++k)
    if (e.values[k] > tolerance * largest) x += (dot(e.axes[k], b) / e.values[k]) * e.axes[k];
  return x;
}

Mat3 nearest_rotation(const Mat3& products) {
  const Mat3 back = products.transposed();
  Mat3 squares;
  for (int i = 0; i < 3; ++i) {
    const Vec3 column = back * Vec3{products.m[0][i], products.m[1][i], products.m[2][i]};
    squares.m[0][i] = column.x, squares.m[1][i] = column.y, squares.m[2][i] = column.z;
  }
  const SymmetricEigen eigen = symmetric_eigen(squares);
  std::array<int, 3> order{0, 1, 2};
  std::sort(order.begin(), order.end(), [&](int i, int j) { return eigen.values[i] > eigen.values[j]; });
  const Vec3 x1 = eigen.axes[order[0]], x2 = eigen.axes[order[1]];
  Vec3 y1 = products * x1, y2 = products * x2;
  if (!(norm(y1) > 0)) return Mat3::diagonal(1);
  y1 = (1 / norm(y1)) * y1;
  y2 = y2 - dot(y1, y2) * y1;
  y2 = norm(y2) > 0 ? (1 / norm(y2)) * y2 : any_perpendicular(y1);
  return Mat3::outer(y1, x1) + Mat3::outer(y2, x2) + Mat3::outer(cross(y1, y2), cross(x1, x2));
}

Quaternion conjugate(const Quaternion& q) { return {-q.x, -q.y, -q.z, q.w}; }

Quaternion multiply(const Quaternion& a, const Quaternion& b) {
  return {a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y, a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x,
          a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w, a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z};
}

Quaternion normalized(const Quaternion& q) {
  const double n = std::sqrt(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w);
  if (!(n > 0)) return {};
  return {q.x / n, q.y / n, q.z / n, q.w / n};
}

Quaternion axis_angle(const Vec3& axis, double angle) {
  const double s = std::sin(angle / 2);
  return {s * axis.x, s * axis.y, s * axis.z, std::cos(angle / 2)};
}

Quaternion turn_by(const Vec3& v) {
  const double angle = norm(v);
  return angle > 0 ? axis_angle((1 / angle) * v, angle) : Quaternion{};
}

Quaternion shortest_turn(const Vec3& from, const Vec3& to) {
  const double cosine = dot(from, to);
  if (cosine < -1 + 1e-12) {
    const Vec3 axis = any_perpendicular(from);
    return {axis.x, axis.y, axis.z, 0};
  }
  const Vec3 c = cross(from, to);
  return normalized({c.x, c.y, c.z, 1 + cosine});
}

Quaternion from_axes(const Vec3& x, const Vec3& y, const Vec3& z) {
  const double trace = x.x + y.y + z.z;
  if (trace > 0) return normalized({y.z - z.y, z.x - x.z, x.y - y.x, 1 + trace});
  if (x.x > y.y && x.x > z.z) return normalized({1 + x.x - y.y - z.z, y.x + x.y, z.x + x.z, y.z - z.y});
  if (y.y > z.z) return normalized({y.x + x.y, 1 + y.y - x.x - z.z, z.y + y.z, z.x - x.z});
  return normalized({z.x + x.z, z.y + y.z, 1 + z.z - x.x - y.y, x.y - y.x});
}

Vec3 any_perpendicular(const Vec3& v) {
  const Vec3 other = std::abs(v.x) < 0.6 ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
  const Vec3 p = cross(v, other);
  return (1 / norm(p)) * p;
}

}  // namespace iota
