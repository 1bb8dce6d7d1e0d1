// SPDX-License-Identifier: Apache-2.0
#include "contact/ring_sides.h"

#include "contact/ring_pairs.h"
#include "math/mat3.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace iota::contact {

RingSides::RingSides(const Solid& torus, const Solid& mesh) {
  const Ring ring = make_ring(torus, mesh.position);
  const Quaternion back = conjugate(mesh.turn);
  // Chords are nearer to the middle line than its tube.
  const double chords = 2 * std::numbers::pi * std::sqrt(ring.radius / ring.tube);
  const int count = static_cast<int>(std::clamp(chords, 24.0, 128.0));
  for (int k = 0; k < count; ++k) points_.push_back(ring.point(static_cast<double>(k) / count));
  char side = 0;
  for (std::size_t k = 0; k < points_.size(); ++k) {
    sides_.push_back(side);
    const Vec3 from = rotate(back, points_[k]), way = rotate(back, points_[(k + 1) % points_.size()]) - from;
    const double far = norm(way);
    if (far > 0 && mesh.form->mesh->ray(from, (1 / far) * way, far)) side = !side;
  }
  for (Vec3& point : points_) point += mesh.position;
  const auto others = std::ranges::count(sides_, char{1});
  // A ring that crosses it once goes around its border.
  if (side != 0 || others == 0) sides_.clear();
  other_side_ = 2 * static_cast<std::size_t>(others) < sides_.size() ? 1 : 0;
}

bool RingSides::is_through(const Vec3& place) const {
  if (sides_.empty()) return false;
  const auto nearest = std::ranges::min_element(points_, {}, [&](const Vec3& point) { return norm(point - place); });
  return sides_[static_cast<std::size_t>(nearest - points_.begin())] == other_side_;
}

}  // namespace iota::contact
