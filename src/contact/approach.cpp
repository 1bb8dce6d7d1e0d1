// SPDX-License-Identifier: Apache-2.0
#include "contact/approach.h"

#include "math/mat3.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace iota::contact {

namespace {

/// Relative to the center of the second outline, so that places far from the origin keep their digits.
void place_at(const Outline& outline, const Motion& motion, const Vec3& origin, double t, Outline& moved) {
  const Quaternion turn = turn_by((t - motion.at) * motion.spin);
  const Vec3 center = motion.center - origin + (t - motion.at) * motion.velocity;
  const auto place = [&](const Vec3& x) { return center + rotate(turn, x - motion.center); };
  moved = outline;
  for (Solid& solid : moved.solids) solid.position = place(solid.position), solid.turn = multiply(turn, solid.turn);
  for (Line& line : moved.lines) line.a = place(line.a), line.b = place(line.b);
}

}  // namespace

double ApproachFinder::time(const Outline& first, const Motion& a, const Outline& second, const Motion& b, double close,
                            double latest) {
  constexpr int most = 24;
  constexpr double never = std::numeric_limits<double>::infinity();
  const Vec3 velocity = a.velocity - b.velocity;
  const double turning = norm(a.spin) * a.reach + norm(b.spin) * b.reach, more = a.more + b.more;
  const double fastest = norm(velocity) + turning + more;
  double t = 0;
  for (int round = 0; round < most; ++round) {
    place_at(first, a, b.center, t, moved_[0]), place_at(second, b, b.center, t, moved_[1]);
    found_.clear();
    touches_.find(moved_[0], {}, moved_[1], {}, close + fastest * (latest - t) + more * t, found_);
    double earliest = never;
    for (const Touch& touch : found_) {
      const double gap = touch.gap - more * t;
      if (gap <= close) return t;
      const double closing = -(touch.is_turned ? -1.0 : 1.0) * dot(touch.normal, velocity) + turning + more;
      if (closing > 0) earliest = std::min(earliest, (gap - close / 2) / closing);
    }
    t += earliest;
    if (!(t < latest)) return never;
  }
  return t;
}

}  // namespace iota::contact
