// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "math/mat3.h"

#include <functional>
#include <string>
#include <string_view>

namespace iota::geometry {

/// phi and its derivatives at a point.
struct SurfacePoint {
  double value = 0;  ///< m
  Vec3 gradient;
  Mat3 hessian;
};

/// The surface phi(p) = 0 in a frame of its own: phi is negative inside, in meters, with a gradient near 1 at the surface,
/// but not the distance elsewhere: where a quadratic does it is one, which the energy-keeping scheme then follows exactly.
class Surface {
 public:
  virtual ~Surface() = default;
  virtual SurfacePoint at(const Vec3& p) const = 0;
  virtual double size() const = 0;  ///< a length to measure violations by, m
  /// Why it is nowhere any more; empty while it is somewhere.
  virtual std::string_view failure() const { return {}; }
};

/// phi = n.p - offset.
class Plane final : public Surface {
 public:
  explicit Plane(const Vec3& normal = {0, 1, 0}, double offset = 0);
  SurfacePoint at(const Vec3& p) const override;
  double size() const override { return 1; }

 private:
  Vec3 normal_;
  double offset_;
};

/// phi = (sum (p_k / a_k)^2 - 1) a / 2, a the least half axis; a sphere for three equal ones.
class Ellipsoid final : public Surface {
 public:
  explicit Ellipsoid(const Vec3& half_axes);
  explicit Ellipsoid(double radius) : Ellipsoid(Vec3{radius, radius, radius}) {}
  SurfacePoint at(const Vec3& p) const override;
  double size() const override { return least_; }

 private:
  Vec3 inverse2_;
  double least_;
};

/// All points at `radius` from a segment of the y axis, -half_length ... half_length (infinite: a cylinder; 0: a sphere):
/// phi = (d^2 - r^2) / 2r.
class Capsule final : public Surface {
 public:
  Capsule(double radius, double half_length);
  SurfacePoint at(const Vec3& p) const override;
  double size() const override { return radius_; }

 private:
  double radius_, half_length_;
};

/// A ring around the y axis: phi = ((sqrt(x^2 + z^2) - R)^2 + y^2 - r^2) / 2r.
class Torus final : public Surface {
 public:
  Torus(double ring_radius, double tube_radius);
  SurfacePoint at(const Vec3& p) const override;
  double size() const override { return tube_; }

 private:
  double ring_, tube_;
};

/// A box with rounded edges: phi = |max(q, 0)| + min(max_k q_k, 0) - rounding, q_k = |p_k| - (half_k - rounding).
class Box final : public Surface {
 public:
  /// `rounding`: radius of the edges, m; negative: a tenth of the least half size.
  explicit Box(const Vec3& half_sizes, double rounding = -1);
  SurfacePoint at(const Vec3& p) const override;
  double size() const override { return size_; }

 private:
  Vec3 core_;
  double rounding_, size_;
};

/// phi given by a function; derivatives by central differences. Once the function has thrown, or was not finite, it is not
/// called again and the surface is nowhere: phi and its derivatives are zero, which holds nothing. (A phi that is not a
/// number would take Newton's method, and all that is solved together with it, down.)
class FunctionSurface final : public Surface {
 public:
  /// Without a function it has failed from the start.
  FunctionSurface(std::function<double(const Vec3&)> phi, double size);
  SurfacePoint at(const Vec3& p) const override;
  double size() const override { return size_; }
  std::string_view failure() const override { return failure_; }

 private:
  SurfacePoint differentiate(const Vec3& p) const;

  mutable std::string failure_;
  std::function<double(const Vec3&)> phi_;
  double size_;
};

}  // namespace iota::geometry
