// SPDX-License-Identifier: Apache-2.0
#include "shape/surface.h"

#include "shape/shape.h"
#include "shape/shape_list.h"

#include <cmath>

namespace iota::shape {

namespace {

template <class S>
class ShapeSurface final : public Surface {
 public:
  explicit ShapeSurface(const S& shape) : shape_(shape) {}
  Level at(const Vec3& p) const override { return Traits<S>::level(shape_, p); }
  double scale() const override { return Traits<S>::scale(shape_); }
  double skin() const override {
    if constexpr (Edged<S>) return Traits<S>::skin(shape_);
    return 0;
  }
  double skin_level() const override {
    if constexpr (Edged<S>) return Traits<S>::skin_level(shape_);
    return 0;
  }

 private:
  S shape_;
};

}  // namespace

std::shared_ptr<const Surface> make_surface(const Shape& any) {
  check(any);
  return std::visit(
      []<class S>(const S& s) -> std::shared_ptr<const Surface> {
        if constexpr (Holding<S>) return std::make_shared<ShapeSurface<S>>(s);
        refuse(spoken<S>(), " has no smooth surface that a constraint could hold a point on");
      },
      any);
}

FunctionSurface::FunctionSurface(std::function<double(const Vec3&)> phi, double size)
    : phi_(std::move(phi)), size_(size) {
  if (!(size >= shortest && size <= longest))
    refuse("the size of a surface must be between ", shortest, " and ", longest, " m, got ", size);
  if (!phi_) failure_ = "has no function in this system";
}

Level FunctionSurface::at(const Vec3& p) const {
  if (!failure_.empty()) return {};
  Level s;
  try {
    s = differentiate(p);
  } catch (const std::exception& error) {
    failure_ = std::string("raised: ") + error.what();
  } catch (...) {
    failure_ = "raised";
  }
  double sum = s.value;
  for (const auto& row : s.hessian.m) sum += row[0] + row[1] + row[2];
  if (failure_.empty() && !(std::isfinite(sum) && is_finite(s.gradient))) failure_ = "is not finite";
  return failure_.empty() ? s : Level{};
}

Level FunctionSurface::differentiate(const Vec3& p) const {
  const auto phi = [&](double x, double y, double z) { return phi_(p + Vec3{x, y, z}); };
  const double h = 1e-4 * size_;
  Level s;
  s.value = phi(0, 0, 0);
  const double px = phi(h, 0, 0), mx = phi(-h, 0, 0), py = phi(0, h, 0), my = phi(0, -h, 0), pz = phi(0, 0, h),
               mz = phi(0, 0, -h);
  s.gradient = (0.5 / h) * Vec3{px - mx, py - my, pz - mz};
  const double inverse = 1 / (h * h);
  const double xy = (phi(h, h, 0) - phi(h, -h, 0) - phi(-h, h, 0) + phi(-h, -h, 0)) * inverse / 4;
  const double xz = (phi(h, 0, h) - phi(h, 0, -h) - phi(-h, 0, h) + phi(-h, 0, -h)) * inverse / 4;
  const double yz = (phi(0, h, h) - phi(0, h, -h) - phi(0, -h, h) + phi(0, -h, -h)) * inverse / 4;
  s.hessian = {{{(px - 2 * s.value + mx) * inverse, xy, xz},
                {xy, (py - 2 * s.value + my) * inverse, yz},
                {xz, yz, (pz - 2 * s.value + mz) * inverse}}};
  return s;
}

}  // namespace iota::shape
