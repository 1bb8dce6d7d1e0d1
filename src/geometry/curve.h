// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iota/vec3.h>

#include <array>
#include <cstddef>
#include <functional>
#include <span>
#include <vector>

namespace iota::geometry {

/// Position (m) and derivatives by the parameter.
struct CurvePoint {
  Vec3 position, d1, d2, d3;
};

/// A curve c(s), 0 <= s <= length: s is the arc length (m), to interpolation error for splines. Closed curves are
/// periodic in s; open ones continue straight beyond their ends. Immutable.
class Curve {
 public:
  virtual ~Curve() = default;

  double length() const { return length_; }
  bool closed() const { return closed_; }
  virtual CurvePoint at(double s) const = 0;
  /// The parameter of the foot of p, (p - c).c' = 0, reached downhill from `near`: continuous in p.
  double nearest(const Vec3& p, double near) const;
  /// The parameter of the globally nearest point, in [0, length].
  double nearest(const Vec3& p) const;

 protected:
  double length_ = 0;
  bool closed_ = false;
  std::size_t samples_ = 64;  ///< starting points of a global search
};

/// Straight pieces through the given points, corners rounded by circular arcs.
class Polyline final : public Curve {
 public:
  /// `rounding`: radius of the arcs, m; smaller where pieces are too short for it. Negative: arcs that begin a tenth of
  /// the shorter neighbor before the corner. Throws std::invalid_argument for fewer than two distinct points (closed:
  /// three), numbers that are not finite, and corners that turn back on themselves.
  explicit Polyline(std::span<const Vec3> points, bool closed = false, double rounding = -1);
  CurvePoint at(double s) const override;

 private:
  struct Piece {
    double start;  // parameter
    Vec3 origin;   // of a line, or center of an arc
    Vec3 direction,
        inward;     // of a line (inward 0); of an arc at its start: tangent, and unit vector from center to start
    double radius;  // 0: a line
  };
  std::vector<Piece> pieces_;
};

/// The cubic spline with two continuous derivatives through the given points (natural ends), or through samples of a
/// function.
class Spline final : public Curve {
 public:
  /// Throws std::invalid_argument as Polyline does.
  explicit Spline(std::span<const Vec3> points, bool closed = false);
  /// c(u), from <= u <= to, sampled at `samples` places; closed: c(from) = c(to).
  static Spline of_function(const std::function<Vec3(double)>& c, double from, double to, bool closed = false,
                            std::size_t samples = 256);
  CurvePoint at(double s) const override;

 private:
  void interpolate(std::vector<Vec3> points, std::vector<double> knots);

  std::vector<double> knots_;  // closed: one more than points
  std::vector<Vec3> points_, second_;
};

}  // namespace iota::geometry
