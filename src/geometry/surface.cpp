// SPDX-License-Identifier: Apache-2.0
#include "geometry/surface.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>
#include <string>

namespace iota::geometry {

namespace {

double positive(double v, const char* what) {
  if (!(v >= 1e-9 && v <= 1e9)) {
    std::ostringstream text;
    text << what << " must be between 1e-9 and 1e9 m, got " << v;
    throw std::invalid_argument(text.str());
  }
  return v;
}

}  // namespace

Plane::Plane(const Vec3& normal, double offset) : normal_(normal), offset_(offset) {
  const double size = norm(normal);
  if (!(size > 0 && std::isfinite(size) && std::isfinite(offset)))
    throw std::invalid_argument("a plane needs a normal that is not zero, and finite numbers");
  normal_ *= 1 / size;
}

SurfacePoint Plane::at(const Vec3& p) const { return {dot(normal_, p) - offset_, normal_, {}}; }

Ellipsoid::Ellipsoid(const Vec3& a) {
  for (const double v : {a.x, a.y, a.z}) positive(v, "a half axis of an ellipsoid");
  inverse2_ = {1 / (a.x * a.x), 1 / (a.y * a.y), 1 / (a.z * a.z)};
  least_ = std::min({a.x, a.y, a.z});
}

SurfacePoint Ellipsoid::at(const Vec3& p) const {
  const Vec3 g{least_ * inverse2_.x * p.x, least_ * inverse2_.y * p.y, least_ * inverse2_.z * p.z};
  return {(dot(g, p) - least_) / 2,
          g,
          {{{least_ * inverse2_.x, 0, 0}, {0, least_ * inverse2_.y, 0}, {0, 0, least_ * inverse2_.z}}}};
}

Capsule::Capsule(double radius, double half_length)
    : radius_(positive(radius, "the radius of a capsule")), half_length_(half_length) {
  if (!(half_length >= 0)) throw std::invalid_argument("a capsule's half length must be 0 or more");
}

SurfacePoint Capsule::at(const Vec3& p) const {
  const double beyond = p.y - std::clamp(p.y, -half_length_, half_length_);
  const Vec3 d{p.x, beyond, p.z};
  const double k = 1 / radius_;
  return {(dot(d, d) - radius_ * radius_) * k / 2, k * d, {{{k, 0, 0}, {0, beyond == 0 ? 0 : k, 0}, {0, 0, k}}}};
}

Torus::Torus(double ring_radius, double tube_radius)
    : ring_(positive(ring_radius, "the ring radius of a torus")),
      tube_(positive(tube_radius, "the tube radius of a torus")) {}

SurfacePoint Torus::at(const Vec3& p) const {
  const double rho = std::sqrt(p.x * p.x + p.z * p.z) + 1e-300;
  const Vec3 out{p.x / rho, 0, p.z / rho}, round{-out.z, 0, out.x};
  const double k = 1 / tube_, across = rho - ring_;
  SurfacePoint s;
  s.value = k / 2 * (across * across + p.y * p.y - tube_ * tube_);
  s.gradient = k * (across * out + Vec3{0, p.y, 0});
  s.hessian = k * Mat3::outer(out, out) + (k * across / rho) * Mat3::outer(round, round);
  s.hessian.m[1][1] += k;
  return s;
}

Box::Box(const Vec3& half, double rounding) {
  for (const double v : {half.x, half.y, half.z}) positive(v, "a half size of a box");
  const double least = std::min({half.x, half.y, half.z});
  rounding_ = std::min(rounding < 0 ? 0.1 * least : rounding, least);
  core_ = half - Vec3{rounding_, rounding_, rounding_};
  size_ = least;
}

SurfacePoint Box::at(const Vec3& p) const {
  const double position[3] = {p.x, p.y, p.z}, core[3] = {core_.x, core_.y, core_.z};
  double q[3], sign[3], length2 = 0;
  int largest = 0;
  for (int k = 0; k < 3; ++k) {
    sign[k] = position[k] < 0 ? -1 : 1;
    q[k] = std::abs(position[k]) - core[k];
    if (q[k] > q[largest]) largest = k;
    if (q[k] > 0) length2 += q[k] * q[k];
  }
  SurfacePoint s;
  double gradient[3] = {};
  if (length2 > 0) {
    const double length = std::sqrt(length2);
    for (int i = 0; i < 3; ++i) {
      if (!(q[i] > 0)) continue;
      gradient[i] = sign[i] * q[i] / length;
      for (int j = 0; j < 3; ++j)
        if (q[j] > 0) s.hessian.m[i][j] = ((i == j ? 1 : 0) - sign[i] * q[i] * sign[j] * q[j] / length2) / length;
    }
    s.value = length - rounding_;
  } else {
    gradient[largest] = sign[largest];
    s.value = q[largest] - rounding_;
  }
  s.gradient = {gradient[0], gradient[1], gradient[2]};
  return s;
}

FunctionSurface::FunctionSurface(std::function<double(const Vec3&)> phi, double size)
    : phi_(std::move(phi)), size_(positive(size, "the size of a surface")) {
  if (!phi_) failure_ = "has no function in this system";
}

SurfacePoint FunctionSurface::at(const Vec3& p) const {
  if (!failure_.empty()) return {};
  SurfacePoint s;
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
  return failure_.empty() ? s : SurfacePoint{};
}

SurfacePoint FunctionSurface::differentiate(const Vec3& p) const {
  const auto phi = [&](double x, double y, double z) { return phi_(p + Vec3{x, y, z}); };
  const double h = 1e-4 * size_;
  SurfacePoint s;
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

}  // namespace iota::geometry
