// SPDX-License-Identifier: Apache-2.0
// The distance of a point from a ring has a closed form, so that the nearest points of a curve and a ring are the minima of
// a function of one variable: by samples, and a golden section around each of them.
#include "contact/ring_pairs.h"

#include "contact/minima.h"
#include "contact/outline.h"
#include "math/mat3.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <variant>

namespace iota::contact {

namespace {

constexpr int ring_samples = 128, rod_samples = 64, side_by_side_samples = 6;
constexpr double side_by_side = 0.95;  ///< cosine
constexpr double lying_share = 1e-3;
constexpr double skew = 0.25, aside = 0.6;                            ///< cosine; of the distance of touching wires
constexpr std::uint32_t first_quarter = 0x100, first_sample = 0x200;  ///< numbers of features

/// A ring or a rod.
struct Wire {
  const Ring* ring;
  Vec3 a, along;  ///< of a rod
  double radius;

  Vec3 point(double share) const { return ring ? ring->point(share) : a + std::clamp(share, 0.0, 1.0) * along; }
  Vec3 bend(const Vec3& point) const { return ring ? ring->bend(point) : Vec3{}; }
  Vec3 tangent(const Vec3& point) const {
    if (ring) return ring->tangent(point);
    const double length = norm(along);
    return length > 0 ? (1 / length) * along : Vec3{};
  }
  int samples() const { return ring ? ring_samples : dot(along, along) > 0 ? rod_samples : 0; }
};

/// The two nearest minima of the distance of a curve's points from a ring.
int find_meetings(const Wire& curve, const Ring& ring, double limit, Minimum (&meetings)[2]) {
  const auto distance = [&](double share) {
    const Vec3 point = curve.point(share);
    return norm(point - ring.nearest(point));
  };
  if (curve.samples() == 0) {
    meetings[0] = {0, distance(0)};
    return 1;
  }
  return find_minima(distance, {curve.samples(), curve.ring != nullptr, limit, lying_share * ring.tube}, meetings);
}

}  // namespace

double Ring::length() const { return 2 * std::numbers::pi * radius + 4 * half_stretch; }

// From the middle of the half circle along the first axis, counter-clockwise.
Vec3 Ring::point(double share) const {
  const double whole = length(), quarter = 0.5 * std::numbers::pi * radius, straight = 2 * half_stretch;
  double s = (share - std::floor(share)) * whole, x = 0, y = 0;
  const auto arc = [&](double center, double from) {
    const double angle = s / radius + from;
    x = center + radius * std::cos(angle), y = radius * std::sin(angle);
  };
  if (s < quarter) {
    arc(half_stretch, 0);
  } else if ((s -= quarter) < straight) {
    x = half_stretch - s, y = radius;
  } else if ((s -= straight) < 2 * quarter) {
    arc(-half_stretch, 0.5 * std::numbers::pi);
  } else if ((s -= 2 * quarter) < straight) {
    x = -half_stretch + s, y = -radius;
  } else {
    s -= straight;
    arc(half_stretch, 1.5 * std::numbers::pi);
  }
  return middle + x * axes[0] + y * axes[1];
}

Vec3 Ring::nearest(const Vec3& place) const {
  const Vec3 off = place - middle;
  const double x = dot(off, axes[0]), y = dot(off, axes[1]), center = std::clamp(x, -half_stretch, half_stretch);
  const double u = x - center, rho = std::sqrt(u * u + y * y);
  if (!(rho > 0)) return middle + center * axes[0] + radius * axes[1];
  return middle + (center + radius * u / rho) * axes[0] + (radius * y / rho) * axes[1];
}

std::uint32_t Ring::quarter(const Vec3& point) const {
  const double x = dot(point - middle, axes[0]) / (radius + half_stretch), y = dot(point - middle, axes[1]) / radius;
  return std::abs(x) > std::abs(y) ? (x > 0 ? 0 : 1) : (y > 0 ? 2 : 3);
}

Vec3 Ring::tangent(const Vec3& point) const {
  const Vec3 off = point - middle;
  const double x = dot(off, axes[0]), y = dot(off, axes[1]), u = x - std::clamp(x, -half_stretch, half_stretch);
  const double rho = std::sqrt(u * u + y * y);
  return rho > 0 ? (-y / rho) * axes[0] + (u / rho) * axes[1] : axes[0];
}

Vec3 Ring::bend(const Vec3& point) const {
  const Vec3 off = point - middle;
  const double x = dot(off, axes[0]), y = dot(off, axes[1]), u = x - std::clamp(x, -half_stretch, half_stretch);
  if (half_stretch > 0 && u == 0) return {};
  return (-1 / (radius * radius)) * (u * axes[0] + y * axes[1]);
}

Ring make_ring(const Solid& torus, const Vec3& anchor) {
  const auto& t = std::get<Torus>(torus.form->shape);
  return {torus.position - anchor,
          {rotate(torus.turn, {1, 0, 0}), rotate(torus.turn, {0, 1, 0}), rotate(torus.turn, {0, 0, 1})},
          t.radius,
          0.5 * t.stretch,
          t.tube};
}

void RingToucher::add_touches(const Solid* first, const ConvexPart* first_rod, const Solid* second,
                              const ConvexPart* second_rod, const Vec3& anchor, double within,
                              std::vector<Touch>& found) {
  Ring rings[2];
  ConvexPart parts[2];  // no corners: they do not allocate
  const auto wire_of = [&](const Solid* solid, const ConvexPart* rod, int k) {
    if (rod) return Wire{nullptr, rod->corners.front(), rod->corners.back() - rod->corners.front(), rod->radius};
    rings[k] = make_ring(*solid, anchor);
    parts[k].radius = rings[k].tube, parts[k].number = solid->number;
    return Wire{&rings[k], {}, {}, rings[k].tube};
  };
  const Wire a = wire_of(first, first_rod, 0), b = wire_of(second, second_rod, 1);
  TouchWriter writer(first_rod ? *first_rod : parts[0], second_rod ? *second_rod : parts[1], anchor, within, found);
  const bool is_turned = !b.ring;  // the curve is that of the second
  const Wire &curve = is_turned ? b : a, &other = is_turned ? a : b;
  const Ring& ring = *other.ring;
  const double limit = within + a.radius + b.radius;
  const auto name_of = [&](const Solid* solid, const ConvexPart* rod, std::uint32_t feature) {
    return rod && rod->is_line ? rod->line : FeatureName{rod ? rod->number : solid->number, feature};
  };
  const auto write = [&](const Vec3& on_curve, const Vec3& on_ring, const Vec3& axis, bool is_round,
                         std::uint32_t feature) {
    const Vec3 &on_first = is_turned ? on_ring : on_curve, &on_second = is_turned ? on_curve : on_ring;
    FeatureName of_first = name_of(first, first_rod, feature), of_second = name_of(second, second_rod, feature);
    const double apart = norm(on_first - on_second);
    if (!(apart > 0)) return;
    if (is_round)
      writer.add_round(on_first, on_second, axis, of_first, of_second);
    else
      writer.add_wires(on_first, on_second, a.tangent(on_first), a.bend(on_first), b.tangent(on_second),
                       b.bend(on_second), of_first, of_second);
  };
  Minimum meetings[2];
  const int count = find_meetings(curve, ring, limit, meetings);
  std::uint32_t former = 0;
  for (int k = 0; k < count; ++k) {
    const Vec3 point = curve.point(meetings[k].share), on_ring = ring.nearest(point);
    // The end of a rod touches a round wire.
    const bool is_end = !curve.ring && !(meetings[k].share > 1e-6 && meetings[k].share < 1 - 1e-6);
    std::uint32_t feature = first_quarter + (curve.ring ? *curve.ring : ring).quarter(curve.ring ? point : on_ring);
    if (feature == former) feature += 8;
    former = feature;
    const Vec3 tangent = ring.tangent(on_ring);
    write(point, on_ring, tangent, is_end, feature);
    // Skew wires that bend around each other are as near aside: one place would jump between both sides.
    if (!curve.ring || std::abs(dot(curve.tangent(point), tangent)) < skew) continue;
    const double way = aside * (a.radius + b.radius) / curve.ring->length();
    for (const int side : {-1, 1}) {
      const Vec3 next = curve.point(meetings[k].share + side * way), there = ring.nearest(next);
      write(next, there, ring.tangent(there), true, feature + (side < 0 ? 16 : 32));
    }
  }
  if (!curve.ring) return;
  for (std::uint32_t k = 0; k < side_by_side_samples; ++k) {
    const Vec3 point = curve.point((k + 0.5) / side_by_side_samples), on_ring = ring.nearest(point);
    const Vec3 tangent = ring.tangent(on_ring);
    if (std::abs(dot(curve.tangent(point), tangent)) > side_by_side)
      write(point, on_ring, tangent, true, first_sample + k);
  }
}

}  // namespace iota::contact
