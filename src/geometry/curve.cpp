// SPDX-License-Identifier: Apache-2.0
#include "geometry/curve.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace iota::geometry {

namespace {

/// The points without repetitions; throws if there are too few.
std::vector<Vec3> distinct(std::span<const Vec3> points, bool closed) {
  std::vector<Vec3> kept;
  for (const Vec3& p : points) {
    if (!is_finite(p)) throw std::invalid_argument("a curve's points must be finite numbers");
    if (kept.empty() || norm(p - kept.back()) > 1e-9 * (norm(p) + norm(kept.back()))) kept.push_back(p);
  }
  while (closed && kept.size() > 1 && norm(kept.front() - kept.back()) <= 1e-9 * (norm(kept[0]) + norm(kept[1])))
    kept.pop_back();
  const std::size_t least = closed ? 3 : 2;
  if (kept.size() < least)
    throw std::invalid_argument("a " + std::string(closed ? "closed " : "") + "curve needs " + std::to_string(least) +
                                " distinct points or more, got " + std::to_string(kept.size()));
  return kept;
}

double wrapped(double s, double length) { return s - length * std::floor(s / length); }

}  // namespace

// The distance has the derivative -F, F = (p - c).c'. Newton's method on F, bracketed between places of positive and
// negative F once both are known.
double Curve::nearest(const Vec3& p, double near) const {
  double s = near, low = 0, high = 0;
  bool has_low = false, has_high = false;
  for (int i = 0; i < 60; ++i) {
    const CurvePoint c = at(s);
    const Vec3 w = p - c.position;
    const double f = dot(w, c.d1), speed2 = dot(c.d1, c.d1);
    if (f == 0) break;
    f > 0 ? (low = s, has_low = true) : (high = s, has_high = true);
    const double slope = speed2 - dot(w, c.d2);
    const bool downhill = slope > 0.05 * speed2;
    double next = s + f / (downhill ? slope : speed2);
    const double reach = 0.1 * length_;
    next = std::clamp(next, s - reach, s + reach);
    if (has_low && has_high && !(next > std::min(low, high) && next < std::max(low, high))) next = (low + high) / 2;
    const double moved = std::abs(next - s);
    s = next;
    if (moved <= 2e-16 * (std::abs(s) + length_)) break;
  }
  return s;
}

double Curve::nearest(const Vec3& p) const {
  // A coarse search, and refinement of all candidates for the minimum.
  const auto place = [&](std::size_t i) { return length_ * static_cast<double>(i) / static_cast<double>(samples_); };
  const auto distance = [&](double s) { return norm(p - at(s).position); };
  const double step = length_ / static_cast<double>(samples_);
  double least = distance(0), best = 0;
  for (std::size_t i = 1; i <= samples_; ++i)
    if (const double d = distance(place(i)); d < least) least = d, best = place(i);
  for (std::size_t i = 0; i <= samples_; ++i) {
    if (distance(place(i)) > least + step) continue;
    double s = nearest(p, place(i));
    s = closed_ ? wrapped(s, length_) : std::clamp(s, 0.0, length_);
    if (const double d = distance(s); d < least) least = d, best = s;
  }
  return best;
}

Polyline::Polyline(std::span<const Vec3> given, bool closed, double rounding) {
  const std::vector<Vec3> points = distinct(given, closed);
  const std::size_t n = points.size(), segments = closed ? n : n - 1;
  closed_ = closed;
  const auto point = [&](std::size_t i) { return points[i % n]; };
  std::vector<Vec3> direction(segments);
  std::vector<double> extent(segments);
  for (std::size_t i = 0; i < segments; ++i) {
    const Vec3 d = point(i + 1) - points[i];
    extent[i] = norm(d);
    direction[i] = (1 / extent[i]) * d;
  }
  // The corner at point i + 1: the length of either neighbor that its arc takes, and its radius.
  std::vector<double> cut(segments, 0), radius(segments, 0);
  for (std::size_t i = 0; i < segments; ++i) {
    if (!closed && i + 1 == segments) continue;
    const std::size_t next = (i + 1) % segments;
    const double cosine = dot(direction[i], direction[next]);
    if (cosine < -0.996)
      throw std::invalid_argument("a polyline may not turn back on itself, as it does at point " +
                                  std::to_string((i + 1) % n));
    const double tangent = std::sqrt((1 - cosine) / (1 + cosine));  // of half the turn
    if (!(tangent > 1e-9)) continue;
    const double shorter = std::min(extent[i], extent[next]);
    cut[i] = rounding < 0 ? 0.1 * shorter : std::min(std::max(rounding, 1e-6 * shorter) * tangent, 0.45 * shorter);
    radius[i] = cut[i] / tangent;
  }
  double s = 0;
  for (std::size_t i = 0; i < segments; ++i) {
    const double before = closed || i > 0 ? cut[(i + segments - 1) % segments] : 0;
    pieces_.push_back({s, points[i] + before * direction[i], direction[i], {}, 0});
    s += extent[i] - before - cut[i];
    if (radius[i] == 0) continue;
    const std::size_t next = (i + 1) % segments;
    const Vec3 start = point(i + 1) - cut[i] * direction[i];
    const double cosine = dot(direction[i], direction[next]);
    Vec3 side = direction[next] - cosine * direction[i];
    side *= 1 / norm(side);
    pieces_.push_back({s, start + radius[i] * side, direction[i], -side, radius[i]});
    s += radius[i] * 2 * std::atan(cut[i] / radius[i]);
  }
  length_ = s;
  samples_ = std::max<std::size_t>(64, 8 * n);
}

CurvePoint Polyline::at(double s) const {
  if (closed_) s = wrapped(s, length_);
  auto piece =
      std::upper_bound(pieces_.begin(), pieces_.end(), s, [](double v, const Piece& p) { return v < p.start; });
  if (piece != pieces_.begin()) --piece;
  const double t = s - piece->start;
  if (piece->radius == 0) return {piece->origin + t * piece->direction, piece->direction, {}, {}};
  const double r = piece->radius, c = std::cos(t / r), q = std::sin(t / r);
  const Vec3 out = c * piece->inward + q * piece->direction, along = c * piece->direction - q * piece->inward;
  return {piece->origin + r * out, along, (-1 / r) * out, (-1 / (r * r)) * along};
}

Spline::Spline(std::span<const Vec3> given, bool closed) {
  std::vector<Vec3> points = distinct(given, closed);
  closed_ = closed;
  const std::size_t spans = closed ? points.size() : points.size() - 1;
  std::vector<double> knots(1, 0.0);
  for (std::size_t i = 0; i < spans; ++i)
    knots.push_back(knots.back() + norm(points[(i + 1) % points.size()] - points[i]));
  interpolate(points, knots);

  // A second spline through samples at equal arc lengths, so that the parameter is the arc length.
  constexpr std::size_t parts = 8, fine = 64;
  std::vector<Vec3> samples;
  std::vector<double> arc(1, 0.0);
  for (std::size_t i = 0; i < spans; ++i) {
    std::array<double, fine + 1> table{};
    const double from = knots_[i], step = (knots_[i + 1] - from) / fine;
    for (std::size_t k = 0; k < fine; ++k) {  // Simpson
      const double u = from + static_cast<double>(k) * step;
      table[k + 1] = table[k] + step / 6 * (norm(at(u).d1) + 4 * norm(at(u + step / 2).d1) + norm(at(u + step).d1));
    }
    const double start = arc.back();
    for (std::size_t part = 0; part < parts; ++part) {
      const double wanted = table[fine] * static_cast<double>(part) / parts;
      std::size_t k = 0;
      while (k + 1 < fine && table[k + 1] < wanted) ++k;
      const double u = from + step * (static_cast<double>(k) + (wanted - table[k]) / (table[k + 1] - table[k]));
      samples.push_back(at(u).position);
      arc.push_back(start + table[fine] * static_cast<double>(part + 1) / parts);
    }
  }
  if (!closed) samples.push_back(points.back());
  interpolate(std::move(samples), std::move(arc));
  samples_ = std::max<std::size_t>(64, 8 * spans);
}

Spline Spline::of_function(const std::function<Vec3(double)>& c, double from, double to, bool closed,
                           std::size_t samples) {
  if (samples < 3 || !(to > from))
    throw std::invalid_argument("a curve of a function needs from < to and 3 samples or more");
  std::vector<Vec3> points;
  const std::size_t last = closed ? samples : samples - 1;
  for (std::size_t i = 0; i < samples; ++i)
    points.push_back(c(from + (to - from) * static_cast<double>(i) / static_cast<double>(last)));
  return Spline(points, closed);
}

// Second derivatives m_i from h_{i-1} m_{i-1} + 2 (h_{i-1} + h_i) m_i + h_i m_{i+1} = 6 (slope_i - slope_{i-1}); cyclic
// systems by the rank-one correction of Sherman and Morrison.
void Spline::interpolate(std::vector<Vec3> points, std::vector<double> knots) {
  knots_ = std::move(knots);
  points_ = std::move(points);
  length_ = knots_.back();
  const std::size_t n = points_.size();
  second_.assign(n, {});
  const auto h = [&](std::size_t i) { return knots_[i + 1] - knots_[i]; };
  const auto slope = [&](std::size_t i) { return (1 / h(i)) * (points_[(i + 1) % n] - points_[i]); };
  std::vector<double> diagonal(n), correction(n, 0.0);
  std::vector<Vec3> right(n);
  const std::size_t first = closed_ ? 0 : 1, last = closed_ ? n : n - 1;
  if (last <= first) return;
  for (std::size_t i = first; i < last; ++i) {
    const std::size_t before = (i + n - 1) % n;
    diagonal[i] = 2 * (h(before) + h(i));
    right[i] = 6.0 * (slope(i) - slope(before));
  }
  const double corner = closed_ ? h(n - 1) : 0, gamma = -diagonal[first];
  if (closed_) {
    diagonal[0] -= gamma, diagonal[n - 1] -= corner * corner / gamma;
    correction[0] = gamma, correction[n - 1] = corner;
  }
  for (std::size_t i = first + 1; i < last; ++i) {
    const double l = h(i - 1) / diagonal[i - 1];
    diagonal[i] -= l * h(i - 1);
    right[i] -= l * right[i - 1];
    correction[i] -= l * correction[i - 1];
  }
  for (std::size_t i = last; i-- > first;) {
    if (i + 1 < last) right[i] -= h(i) * right[i + 1], correction[i] -= h(i) * correction[i + 1];
    right[i] *= 1 / diagonal[i], correction[i] /= diagonal[i];
  }
  if (closed_) {
    const double ratio = corner / gamma;
    const Vec3 factor = (1 / (1 + correction[0] + ratio * correction[n - 1])) * (right[0] + ratio * right[n - 1]);
    for (std::size_t i = 0; i < n; ++i) right[i] -= correction[i] * factor;
  }
  for (std::size_t i = first; i < last; ++i) second_[i] = right[i];
}

CurvePoint Spline::at(double s) const {
  if (closed_) s = wrapped(s, length_);
  const double inside = std::clamp(s, 0.0, length_), beyond = s - inside;
  const auto after = std::upper_bound(knots_.begin() + 1, knots_.end() - 1, inside);
  const auto i = static_cast<std::size_t>(after - knots_.begin()) - 1, j = (i + 1) % points_.size();
  const double h = knots_[i + 1] - knots_[i], b = (inside - knots_[i]) / h, a = 1 - b;
  CurvePoint c;
  c.position =
      a * points_[i] + b * points_[j] + (h * h / 6) * ((a * a * a - a) * second_[i] + (b * b * b - b) * second_[j]);
  c.d1 = (1 / h) * (points_[j] - points_[i]) + (h / 6) * ((3 * b * b - 1) * second_[j] - (3 * a * a - 1) * second_[i]);
  if (beyond != 0) {
    c.position += beyond * c.d1;
    return c;
  }
  c.d2 = a * second_[i] + b * second_[j];
  c.d3 = (1 / h) * (second_[j] - second_[i]);
  return c;
}

}  // namespace iota::geometry
