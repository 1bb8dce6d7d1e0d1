// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shape/traits.h"

#include <functional>
#include <memory>
#include <string>
#include <string_view>

namespace iota::shape {

/// The surface phi(p) = 0 of a shape or of a function, as constraints hold points on it. See `Holding`.
class Surface {
 public:
  virtual ~Surface() = default;
  virtual Level at(const Vec3& p) const = 0;
  virtual double scale() const = 0;  ///< a length to measure violations by, m
  /// Where its edges are sharp it has no normals there: take phi(p) - skin_level() instead, a surface that is rounded and
  /// farther out by skin(), m. 0 where it is smooth.
  virtual double skin() const { return 0; }
  virtual double skin_level() const { return 0; }
  /// Why it is nowhere any more; empty while it is somewhere.
  virtual std::string_view failure() const { return {}; }
};

/// Throws std::invalid_argument for sizes that are out of range, and for shapes that cannot hold points on them.
std::shared_ptr<const Surface> make_surface(const Shape&);

/// phi given by a function; derivatives by central differences. Once the function has thrown, or was not finite, it is not
/// called again and the surface is nowhere: phi and its derivatives are zero, which holds nothing. (A phi that is not a
/// number would take Newton's method, and all that is solved together with it, down.)
class FunctionSurface final : public Surface {
 public:
  /// Without a function it has failed from the start. size: of what it describes, m.
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
