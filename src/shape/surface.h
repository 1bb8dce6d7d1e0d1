// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shape/level.h"

#include <functional>
#include <string>
#include <string_view>

namespace iota::shape {

/// The surface phi(p) = 0 of a shape or of a function, for constraints on points. See `Holding`.
class Surface {
 public:
  virtual ~Surface() = default;
  virtual Level at(const Vec3& p) const = 0;
  virtual double scale() const = 0;  ///< a length to measure violations by, m
  /// A sharp edge has no normals: use phi(p) - skin_level() instead, a rounded surface that is farther out by skin(),
  /// m. 0 if it is smooth.
  virtual double skin() const { return 0; }
  virtual double skin_level() const { return 0; }
  /// The reason why the surface failed; empty if it has not.
  virtual std::string_view failure() const { return {}; }
};

/// phi given by a function; derivatives by central differences. Once the function has thrown, or was not finite, it is
/// not called again: phi and its derivatives are then zero, which constrains nothing. (A phi that is not a number would
/// make Newton's method fail for the whole island.)
class FunctionSurface final : public Surface {
 public:
  /// Without a function it has failed from the start. size: of the surface, m.
  FunctionSurface(std::function<double(const Vec3&)> phi, double size);
  Level at(const Vec3& p) const override;
  double scale() const override { return size_; }
  std::string_view failure() const override { return failure_; }

 private:
  Level differentiate(const Vec3& p) const;

  mutable std::string failure_;
  std::function<double(const Vec3&)> phi_;
  double size_;
};

}  // namespace iota::shape
