// SPDX-License-Identifier: Apache-2.0
#include "solver/constraints/surface_pair.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace iota::solver {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

/// x of A x = b by elimination with row pivoting; zero if A is singular.
void solve4(double (&a)[4][5], double* x) {
  for (int k = 0; k < 4; ++k) {
    int p = k;
    for (int i = k + 1; i < 4; ++i)
      if (std::abs(a[i][k]) > std::abs(a[p][k])) p = i;
    if (p != k) std::swap(a[p], a[k]);
    if (!(std::abs(a[k][k]) > 1e-300)) {
      std::fill(x, x + 4, 0.0);
      return;
    }
    for (int i = k + 1; i < 4; ++i) {
      const double l = a[i][k] / a[k][k];
      for (int j = k; j < 5; ++j) a[i][j] -= l * a[k][j];
    }
  }
  for (int k = 3; k >= 0; --k) {
    x[k] = a[k][4];
    for (int j = k + 1; j < 4; ++j) x[k] -= a[k][j] * x[j];
    x[k] /= a[k][k];
  }
}

/// The transformation between A's and B's frames.
struct Relative {
  Vec3 t;     // origin of B in A
  Mat3 turn;  // columns: axes of B in A
  explicit Relative(const Vec3* e) {
    const Vec3 *a = e + 1, *b = e + 4;
    t = {dot(a[0], e[0]), dot(a[1], e[0]), dot(a[2], e[0])};
    for (int j = 0; j < 3; ++j)
      for (int k = 0; k < 3; ++k) turn.m[j][k] = dot(a[j], b[k]);
  }
  Vec3 into_b(const Vec3& p) const { return turn.transposed() * (p - t); }
};

/// phi, zero on a surface with normals: the surface itself, or a skin farther out.
shape::Level smooth_at(const shape::Surface& surface, const Vec3& p) {
  shape::Level level = surface.at(p);
  level.value -= surface.skin_level();
  return level;
}

/// Derivative of the unit vector along v, where v changes by `change` of its argument.
Mat3 unit_derivative(const Vec3& unit, double size, const Mat3& change) {
  return (Mat3::diagonal(1 / size) + (-1 / size) * Mat3::outer(unit, unit)) * change;
}

}  // namespace

// Unknowns p and gap g; with n = grad A / |grad A| at p, q = p + g n, m = grad B / |grad B| at q (all in A's frame):
//   A(p) = 0,  B(q) = 0,  two tangents . (n + m) = 0.
// For flat faces the tangential place is undefined; a small damping keeps it near its former place.
SurfacePairConstraint::Nearest SurfacePairConstraint::find(const Vec3* e, const Vec3& near) const {
  const Relative relative(e);
  const double size = std::min(surface_a->scale(), surface_b->scale());
  Vec3 p = near, start = near, dp;
  double gap = 0, start_gap = 0, dgap = 0, best = infinity, part = 1;
  bool first = true;
  Nearest nearest{};
  for (int iteration = 0; iteration < 60; ++iteration) {
    const shape::Level a = smooth_at(*surface_a, p);
    const double a_size = norm(a.gradient) + 1e-300;
    const Vec3 n = (1 / a_size) * a.gradient;
    if (first) {  // the gap that B's value at p suggests
      const shape::Level b = smooth_at(*surface_b, relative.into_b(p));
      gap = std::max(b.value / (norm(b.gradient) + 1e-300), -size);
      first = false;
    }
    const Vec3 q = p + gap * n, place = relative.into_b(q);
    const shape::Level b = smooth_at(*surface_b, place);
    const Vec3 b_gradient = relative.turn * b.gradient;
    const double b_size = norm(b_gradient) + 1e-300;
    const Vec3 m = (1 / b_size) * b_gradient;
    const double residual = std::abs(a.value) / size + std::abs(b.value) / size + norm(n + m);
    if (!(residual < best) && part > 0.01 && best > 1e-12) {  // kinks, as between face and edge: shorten the step
      part /= 2;
      p = start + part * dp, gap = start_gap + part * dgap;
      continue;
    }
    best = residual, part = 1;
    nearest = {p, q, n, gap + surface_a->skin() + surface_b->skin(), place, b.gradient};

    const Mat3 dn = unit_derivative(n, a_size, a.hessian);
    const Mat3 dm = unit_derivative(m, b_size, relative.turn * (b.hessian * relative.turn.transposed()));
    const Mat3 dq = Mat3::diagonal(1) + gap * dn;
    const Mat3 dmp = dm * dq;
    const Vec3 tangents[2] = {any_perpendicular(n), cross(n, any_perpendicular(n))};
    double system[4][5] = {{a.gradient.x, a.gradient.y, a.gradient.z, 0, -a.value}};
    const Vec3 bp = dq.transposed() * b_gradient;
    const double row1[5] = {bp.x, bp.y, bp.z, dot(b_gradient, n), -b.value};
    std::copy(row1, row1 + 5, system[1]);
    for (int i = 0; i < 2; ++i) {
      const Vec3& s = tangents[i];
      const Vec3 row = dn.transposed() * s + dmp.transposed() * s + (1e-7 / size) * s;
      const double values[5] = {row.x, row.y, row.z, dot(s, dm * n), -dot(s, n + m)};
      std::copy(values, values + 5, system[2 + i]);
    }
    double step[4];
    solve4(system, step);
    start = p, start_gap = gap;
    dp = {step[0], step[1], step[2]}, dgap = step[3];
    const double length = norm(dp), limit = 0.5 * size;
    if (length > limit) dp *= limit / length, dgap *= limit / length;
    p += dp, gap += dgap;
    if (!(length > 1e-15 * (size + norm(p))) && !(std::abs(step[3]) > 1e-15 * size)) break;
  }
  return nearest;
}

void SurfacePairConstraint::start(const Vec3* x, double fraction) {
  Vec3 e[7];
  for (int a = 0; a < 7; ++a) e[a] = arm(a, x, fraction);
  // A search on A's surface towards B's origin: the side that faces B.
  const Relative relative(e);
  Vec3 p = relative.t;
  for (int i = 0; i < 30; ++i) {
    const shape::Level a = smooth_at(*surface_a, p);
    const double slope2 = dot(a.gradient, a.gradient);
    if (slope2 > 0) p -= (a.value / slope2) * a.gradient;
  }
  nearest = find(e, p).p;
}

void SurfacePairConstraint::track(const Vec3* x, double fraction) {
  Vec3 e[7];
  for (int a = 0; a < 7; ++a) e[a] = arm(a, x, fraction);
  nearest = find(e, nearest).p;
}

void SurfacePairConstraint::calc_value(const Vec3* e, double /*fraction*/, double* g) const {
  g[0] = find(e, nearest).gap;
  if (is_nowhere()) g[0] = 0;
}

// With t_j = a_j.d and R_jk = a_j.b_k the gap's derivatives are n_j and grad B_k (q - t)_j / |R grad B|.
SurfacePairConstraint::ByRelative SurfacePairConstraint::by_relative(const Vec3* e, double* gap) const {
  const Nearest c = find(e, nearest);
  if (gap) *gap = c.gap;
  const Relative relative(e);
  const Vec3 u = c.q - relative.t;
  const double size = norm(relative.turn * c.gradient);
  const double n[3] = {c.normal.x, c.normal.y, c.normal.z}, us[3] = {u.x, u.y, u.z};
  const double gradient[3] = {c.gradient.x / size, c.gradient.y / size, c.gradient.z / size};
  ByRelative by{};
  for (int j = 0; j < 3; ++j) {
    by.by_place[j] = n[j];
    for (int k = 0; k < 3; ++k) by.by_turn[j][k] = gradient[k] * us[j];
  }
  return by;
}

void SurfacePairConstraint::by_arms(const Vec3* e, const ByRelative& by, Vec3* d) {
  std::fill(d, d + 7, Vec3{});
  for (int j = 0; j < 3; ++j) {
    d[0] += by.by_place[j] * e[1 + j];
    d[1 + j] += by.by_place[j] * e[0];
    for (int k = 0; k < 3; ++k) {
      d[1 + j] += by.by_turn[j][k] * e[4 + k];
      d[4 + k] += by.by_turn[j][k] * e[1 + j];
    }
  }
}

void SurfacePairConstraint::calc_gradient(const Vec3* e, Vec3 (*d)[7]) const {
  by_arms(e, by_relative(e, nullptr), d[0]);
  if (is_nowhere()) std::fill(d[0], d[0] + 7, Vec3{});
}

void SurfacePairConstraint::mean_gradients(const Vec3* x0, double start, const Vec3* x1, double end, Vec3* out) const {
  constexpr double least = 1e-6;  // of the size, and as a turn
  const auto e0 = arms(x0, start), e1 = arms(x1, end);
  double g0 = 0, g1 = 0;
  const ByRelative by0 = by_relative(e0.data(), &g0), by1 = by_relative(e1.data(), &g1);
  const Relative from(e0.data()), to(e1.data());
  const Vec3 moved = to.t - from.t;
  const double way[3] = {moved.x, moved.y, moved.z}, weight = 1 / (reference * reference);  // of places against turns
  ByRelative mean{};
  double given = 0, squared = least * least;
  for (int j = 0; j < 3; ++j) {
    mean.by_place[j] = 0.5 * (by0.by_place[j] + by1.by_place[j]);
    given += mean.by_place[j] * way[j], squared += weight * way[j] * way[j];
    for (int k = 0; k < 3; ++k) {
      const double turned = to.turn.m[j][k] - from.turn.m[j][k];
      mean.by_turn[j][k] = 0.5 * (by0.by_turn[j][k] + by1.by_turn[j][k]);
      given += mean.by_turn[j][k] * turned, squared += turned * turned;
    }
  }
  const double missing = (g1 - g0 - given) / squared;
  for (int j = 0; j < 3; ++j) {
    mean.by_place[j] += missing * weight * way[j];
    for (int k = 0; k < 3; ++k) mean.by_turn[j][k] += missing * (to.turn.m[j][k] - from.turn.m[j][k]);
  }
  Vec3 d[1][7];
  by_arms(mean_of(e0, e1).data(), mean, d[0]);
  if (is_nowhere()) std::fill(d[0], d[0] + 7, Vec3{});
  to_nodes(d, out);
}

// By a central difference of the gradient: its error is a millionth, as is that of round-off.
double SurfacePairConstraint::bend(const Vec3* x, const Vec3* v) const {
  constexpr double part = 1e-4;  // of the size, which the arms go
  if (is_nowhere()) return 0;
  const std::array<Vec3, 7> e = arms(x, 1);
  std::array<Vec3, 7> rates{};
  double fastest = 0;  // 1/s
  for (std::size_t a = 0; a < rates.size(); ++a) {
    for (std::uint32_t i = 0; i < count; ++i) rates[a] += weights[a][i] * v[nodes[i]];
    fastest = std::max(fastest, norm(rates[a]) / (a == 0 ? reference : 1));
  }
  if (!(fastest > 0)) return 0;
  const double time = part / fastest;
  const auto rate_after = [&](double s) {
    std::array<Vec3, 7> moved = e;
    for (std::size_t a = 0; a < moved.size(); ++a) moved[a] += s * rates[a];
    Vec3 d[1][7];
    calc_gradient(moved.data(), d);
    double rate = 0;
    for (std::size_t a = 0; a < moved.size(); ++a) rate += dot(d[0][a], rates[a]);
    return rate;
  };
  return (rate_after(time) - rate_after(-time)) / (2 * time);
}

}  // namespace iota::solver
