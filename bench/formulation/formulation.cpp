// SPDX-License-Identifier: Apache-2.0
// Which unknowns should the engine solve for? A chain of N links hangs by one end and is released horizontally; two
// formulations of the SAME discrete equation advance it, with the same Newton, line search, tolerance and elimination:
//
//   natural   the hinge points are the unknowns, one distance constraint per link: 3 + 1 unknowns per link
//   natural4  the same with four points and six distances per link, as a body without symmetry needs: 9 + 6
//   body      one position and one rotation per link, three ball-joint rows between neighbors: 6 + 3
//
// Backward Euler as a minimum:  min over x of  a/2 |x - (x0 + h v0)|_M^2 - f.x  subject to g(x) = 0,  a = 1/h^2,
// v1 = (x1 - x0)/h. A rotation R is inertial the same way: a/2 tr((R - R0 - h R0') J (R - R0 - h R0')^T) with the body's
// second moments J (Ferguson et al., "Intersection-free rigid body dynamics", 2021), which is exactly the natural
// coordinates' kinetic energy for a rod without spin. So all three must follow the same motion, and do (see "check").
//
// Newton: the KKT system [K G'; G -eps] with exact second derivatives (inertia, geometric stiffness). Links are
// eliminated from the free end: each link is one front [own unknowns | multipliers | neighbor's unknowns].
//
// Build:  g++ -O3 -std=c++20 -ffp-contract=off formulation.cpp -o formulation && ./formulation
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <string>
#include <vector>

namespace {

// ---------------------------------------------------------------------------------------------------------- vectors
struct Vec3 {
  double x = 0, y = 0, z = 0;
  double& operator[](int i) { return (&x)[i]; }
  double operator[](int i) const { return (&x)[i]; }
};
Vec3 operator+(Vec3 a, Vec3 b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
Vec3 operator-(Vec3 a, Vec3 b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
Vec3 operator*(double s, Vec3 a) { return {s * a.x, s * a.y, s * a.z}; }
Vec3& operator+=(Vec3& a, Vec3 b) { return a = a + b; }
double dot(Vec3 a, Vec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
Vec3 cross(Vec3 a, Vec3 b) { return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x}; }
double norm(Vec3 a) { return std::sqrt(dot(a, a)); }

struct Rotation {  // columns: the body's axes in world coordinates
  std::array<Vec3, 3> column{Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}};
};
struct Quaternion {
  double w = 1, x = 0, y = 0, z = 0;
};
Quaternion turned(Quaternion q, Vec3 t) {  // exp(t) q, normalized
  const double angle = norm(t);
  const double s = angle > 1e-8 ? std::sin(angle / 2) / angle : 0.5 - angle * angle / 48, c = std::cos(angle / 2);
  const Vec3 u = s * t, v{q.x, q.y, q.z}, w = c * v + q.w * u + cross(u, v);
  const double ww = c * q.w - dot(u, v), k = 1 / std::sqrt(ww * ww + dot(w, w));
  return {k * ww, k * w.x, k * w.y, k * w.z};
}
Rotation rotation_of(Quaternion q) {
  return {Vec3{1 - 2 * (q.y * q.y + q.z * q.z), 2 * (q.x * q.y + q.w * q.z), 2 * (q.x * q.z - q.w * q.y)},
          Vec3{2 * (q.x * q.y - q.w * q.z), 1 - 2 * (q.x * q.x + q.z * q.z), 2 * (q.y * q.z + q.w * q.x)},
          Vec3{2 * (q.x * q.z + q.w * q.y), 2 * (q.y * q.z - q.w * q.x), 1 - 2 * (q.x * q.x + q.y * q.y)}};
}

// ------------------------------------------------------------------------------------------------------ shared parts
constexpr double length = 0.1, mass = 0.1, radius = 0.005, gravity = -9.81, tolerance = 1e-9 * length;
constexpr double compliance = 1e-12;  // of each constraint, in units of 1/(a m): far below the tolerance
enum class Link { two_point, rod };   // two equal masses at the ends; a solid cylinder

/// Upper triangle of one link's symmetric front with the right-hand side as last column. P own unknowns, C
/// multipliers, B unknowns of the neighbor. LDL^T without pivoting: the order makes P positive and C negative.
template <int P, int C, int B, bool coupled>  // coupled: own unknowns also touch the neighbor's directly
struct Front {
  static constexpr int own = P + C, n = P + C + B;
  double a[n][n + 1];
  struct Eliminated {  // what the back substitution needs
    double row[own][n + 1];
  };
  bool factor(Eliminated& kept) {
    bool right_signs = true;
#pragma GCC unroll 9  // unrolling matters: 1.5 times for either
    for (int k = 0; k < own; ++k) {
      const double d = a[k][k], inverse = 1 / d;
      right_signs &= k < P ? d > 0 : d < 0;
      const int reach = !coupled && k < P ? own : n;
#pragma GCC unroll 8
      for (int i = k + 1; i < reach; ++i) {
        const double l = a[k][i] * inverse;
        for (int j = i; j < reach; ++j) a[i][j] -= l * a[k][j];
        a[i][n] -= l * a[k][n];
      }
      kept.row[k][k] = inverse;
      for (int j = k + 1; j < reach; ++j) kept.row[k][j] = a[k][j];
      kept.row[k][n] = a[k][n];
    }
    return right_signs;
  }
  static void solve(const Eliminated& kept, const double* neighbor, double* x) {  // x: own unknowns, multipliers
#pragma GCC unroll 9
    for (int k = own - 1; k >= 0; --k) {
      double s = kept.row[k][n];
      if (coupled || k >= P)
        for (int j = 0; j < B; ++j) s -= kept.row[k][own + j] * neighbor[j];
      for (int j = own - 1; j > k; --j) s -= kept.row[k][j] * x[j];  // the newest last: shortest chain of waits
      x[k] = s * kept.row[k][k];
    }
  }
  /// Zero, except for what eliminating the link below left on this link's own unknowns.
  void start(const Front* below) {
#pragma GCC unroll 16
    for (int i = 0; i < n; ++i)
      for (int j = i; j <= n; ++j) a[i][j] = 0;
    if (below)
#pragma GCC unroll 8
      for (int i = 0; i < B; ++i) {
        for (int j = i; j < B; ++j) a[i][j] = below->a[own + i][own + j];
        a[i][n] = below->a[own + i][n];
      }
  }
};
template <class F>
void add_block(F& f, int row, int column, double diagonal) {
  for (int k = 0; k < 3; ++k) f.a[row + k][column + k] += diagonal;
}

struct Residual {
  double worst = 0, squares = 0, energy = 0, violation = 0;  // scaled to meters; l1 of the constraints
  void add(double r) {
    if (!(std::abs(r) <= worst)) worst = std::abs(r);  // written so that a NaN is kept
    squares += r * r;
  }
};
struct Iterations {
  int count = 0;
  bool converged = false;
};

/// One time step by Newton with line search: accepts when the residual or the l1 merit falls; exact Hessian while full
/// steps halve the residual and the pivots have the right signs, otherwise clamped to positive semi-definite.
template <class Chain>
Iterations newton(Chain& chain) {
  Residual now = chain.evaluate();
  bool clamp = false;
  for (int i = 0; i < 60; ++i) {
    if (now.worst <= tolerance) return {i, true};
    if (!chain.factor(clamp) && !clamp) chain.factor(true);
    const double mu = 1.5 * chain.solve();
    Residual next;
    double step = 1;
    for (int halving = 0; halving < 16; ++halving, step /= 2) {
      chain.move(step);
      next = chain.evaluate();
      if (next.squares < now.squares * (1 - 1e-4 * step)) break;
      if (next.energy + mu * next.violation < now.energy + mu * now.violation) break;
    }
    clamp = !(step == 1 && next.squares <= 0.25 * now.squares);
    now = next;
    if (!std::isfinite(now.squares)) return {i + 1, false};
  }
  return {60, now.worst <= tolerance};
}

struct Measure {
  double kinetic = 0, potential = 0, gap = 0;
};

// ------------------------------------------------------------------------------------------------ natural coordinates
/// Points are the unknowns. Basis of link i: [left hinge, right hinge, extra points]; the left hinge is the right hinge
/// of link i - 1 (the nail for link 0). A rod's two-point mass is [A B; B A], A + B = m/2, A - B = 2 It / L^2, exact
/// for a cylinder without spin; four points hold any body. All distances of the basis are constraints
/// g = (|d|^2 - l^2) / 2l, with gradient d/l and Hessian 1/l: quadratic.
template <int extra>
class NaturalChain {
  static constexpr int basis = 2 + extra, points = 1 + extra, P = 3 * points, C = basis * (basis - 1) / 2;
  using F = Front<P, C, 3, true>;
  struct State {
    Vec3 x[points];
    double lambda[C];
  };
  std::vector<State> now_, tried_;
  std::vector<std::array<Vec3, points>> start_, velocity_, ahead_;
  std::vector<typename F::Eliminated> eliminated_;
  std::vector<std::array<double, P + C>> residual_, delta_;
  double M_[basis][basis], rest_[C], gather_[basis], h_, a_;
  int pair_[C][2];

  Vec3 point(const std::vector<State>& s, std::size_t link, int k) const {
    return k > 0 ? s[link].x[k - 1] : link > 0 ? s[link - 1].x[0] : Vec3{};
  }

 public:
  NaturalChain(int links, Link kind, double h) : h_(h), a_(1 / (h * h)) {
    const double across = mass * radius * radius / (4 * length * length);  // extra points one length off the axis
    const double along = kind == Link::rod ? mass / 3 : mass / 2;
    double moment[4][4] = {{mass, mass / 2, 0, 0}, {mass / 2, along, 0, 0}, {0, 0, across, 0}, {0, 0, 0, across}};
    double shape[4][4] = {{1, -1, extra ? -1. : 0., extra ? -1. : 0.}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}};
    for (int i = 0; i < basis; ++i) {
      gather_[i] = 0;
      for (int j = 0; j < basis; ++j) {
        M_[i][j] = 0;
        for (int k = 0; k < 4; ++k)
          for (int l = 0; l < 4; ++l) M_[i][j] += shape[i][k] * moment[k][l] * shape[j][l];
        gather_[i] += M_[i][j];
      }
    }
    if (!extra && kind == Link::rod) {  // same energy, but the cylinder's transverse inertia in place of the thin rod's
      const double It = mass * (3 * radius * radius + length * length) / 12, sum = mass / 2;
      M_[0][0] = M_[1][1] = (sum + 2 * It / (length * length)) / 2, M_[0][1] = M_[1][0] = sum - M_[0][0];
    }
    for (int i = 0, c = 0; i < basis; ++i)
      for (int j = i + 1; j < basis; ++j, ++c) pair_[c][0] = i, pair_[c][1] = j;
    const Vec3 corner[4] = {{0, 0, 0}, {length, 0, 0}, {0, length, 0}, {0, 0, length}};
    for (int c = 0; c < C; ++c) rest_[c] = norm(corner[pair_[c][1]] - corner[pair_[c][0]]);
    now_.resize(links), start_.resize(links), velocity_.resize(links), ahead_.resize(links);
    eliminated_.resize(links), residual_.resize(links), delta_.resize(links);
    for (int i = 0; i < links; ++i) {
      now_[i] = State{};
      for (int k = 0; k < points; ++k) now_[i].x[k] = Vec3{i * length, 0, 0} + corner[k + 1];
    }
  }
  std::size_t size() const { return now_.size(); }

  Iterations advance() {
    for (std::size_t i = 0; i < size(); ++i)
      for (int k = 0; k < points; ++k) {
        start_[i][k] = now_[i].x[k];
        now_[i].x[k] = ahead_[i][k] = now_[i].x[k] + h_ * velocity_[i][k];
      }
    tried_ = now_;
    const Iterations result = newton(*this);
    now_ = tried_;
    for (std::size_t i = 0; i < size(); ++i)
      for (int k = 0; k < points; ++k) velocity_[i][k] = (1 / h_) * (now_[i].x[k] - start_[i][k]);
    return result;
  }

  Residual evaluate() {
    Residual sum;
    for (auto& r : residual_) r.fill(0);
    double scale[points];
    for (std::size_t i = 0; i < size(); ++i) {
      Vec3 x[basis], y[basis], force[basis];
      for (int k = 0; k < basis; ++k) {
        x[k] = point(tried_, i, k);
        y[k] = k > 0 ? x[k] - ahead_[i][k - 1] : i > 0 ? x[0] - ahead_[i - 1][0] : Vec3{};
      }
      for (int k = 0; k < basis; ++k) {
        for (int l = 0; l < basis; ++l) force[k] += (a_ * M_[k][l]) * y[l];
        sum.energy += 0.5 * dot(force[k], y[k]) - gather_[k] * gravity * x[k].y;
        force[k].y -= gather_[k] * gravity;
      }
      for (int c = 0; c < C; ++c) {
        const Vec3 d = x[pair_[c][1]] - x[pair_[c][0]];
        const double lambda = tried_[i].lambda[c];
        const double g = (dot(d, d) - rest_[c] * rest_[c]) / (2 * rest_[c]) - compliance / (a_ * mass) * lambda;
        force[pair_[c][1]] += (lambda / rest_[c]) * d;
        force[pair_[c][0]] += (-lambda / rest_[c]) * d;
        residual_[i][P + c] = g;
        sum.add(g);
        sum.violation += std::abs(g);
      }
      for (int k = 1; k < basis; ++k)
        for (int j = 0; j < 3; ++j) residual_[i][3 * (k - 1) + j] += force[k][j];
      if (i > 0)
        for (int j = 0; j < 3; ++j) residual_[i - 1][j] += force[0][j];
    }
    for (int k = 0; k < points; ++k) scale[k] = 1 / (a_ * (M_[k + 1][k + 1] + (k == 0 ? M_[0][0] : 0)));
    for (const auto& r : residual_)
      for (int j = 0; j < P; ++j) sum.add(r[j] * scale[j / 3]);
    return sum;
  }

  bool factor(bool clamp) {
    bool right_signs = true;
    F front[2];
    for (std::size_t i = size(); i-- > 0;) {
      F& f = front[i % 2];
      f.start(i + 1 < size() ? &front[(i + 1) % 2] : nullptr);
      const auto slot = [](int k) { return k == 0 ? P + C : 3 * (k - 1); };
      Vec3 x[basis];
      for (int k = 0; k < basis; ++k) x[k] = point(tried_, i, k);
      for (int k = 0; k < basis; ++k)
        for (int l = k; l < basis; ++l) {
          const int r = std::min(slot(k), slot(l)), c = std::max(slot(k), slot(l));
          add_block(f, r, c, a_ * M_[k][l]);
        }
      for (int c = 0; c < C; ++c) {
        const int p = slot(pair_[c][0]), q = slot(pair_[c][1]);
        const double lambda = tried_[i].lambda[c], k = (clamp ? std::max(0.0, lambda) : lambda) / rest_[c];
        add_block(f, p, p, k), add_block(f, q, q, k), add_block(f, std::min(p, q), std::max(p, q), -k);
        const Vec3 n = (1 / rest_[c]) * (x[pair_[c][1]] - x[pair_[c][0]]);
        for (int j = 0; j < 3; ++j) {
          f.a[q + j][P + c] = n[j];
          if (p < P)
            f.a[p + j][P + c] = -n[j];
          else
            f.a[P + c][p + j] = -n[j];
        }
        f.a[P + c][P + c] = -compliance / (a_ * mass);
      }
      for (int j = 0; j < P + C; ++j) f.a[j][F::n] -= residual_[i][j];
      right_signs &= f.factor(eliminated_[i]);
    }
    return right_signs;
  }
  double solve() {  // returns the largest multiplier the step leads to
    double largest = 0;
    const double nail[3] = {0, 0, 0};
    for (std::size_t i = 0; i < size(); ++i) {
      F::solve(eliminated_[i], i > 0 ? delta_[i - 1].data() : nail, delta_[i].data());
      for (int c = 0; c < C; ++c) largest = std::max(largest, std::abs(tried_[i].lambda[c] + delta_[i][P + c]));
    }
    now_ = tried_;
    return largest;
  }
  void move(double step) {  // from the last accepted state
    for (std::size_t i = 0; i < size(); ++i) {
      for (int k = 0; k < points; ++k)
        for (int j = 0; j < 3; ++j) tried_[i].x[k][j] = now_[i].x[k][j] + step * delta_[i][3 * k + j];
      for (int c = 0; c < C; ++c) tried_[i].lambda[c] = now_[i].lambda[c] + step * delta_[i][P + c];
    }
  }

  Measure measure() const {
    Measure m;
    for (std::size_t i = 0; i < size(); ++i)
      for (int k = 0; k < basis; ++k) {
        const auto speed = [&](int l) { return l > 0 ? velocity_[i][l - 1] : i > 0 ? velocity_[i - 1][0] : Vec3{}; };
        for (int l = 0; l < basis; ++l) m.kinetic += 0.5 * M_[k][l] * dot(speed(k), speed(l));
        m.potential -= gather_[k] * gravity * point(now_, i, k).y;
        for (int c = 0; c < C; ++c)
          m.gap = std::max(m.gap, std::abs(norm(point(now_, i, pair_[c][1]) - point(now_, i, pair_[c][0])) - rest_[c]));
      }
    return m;
  }
  Vec3 hinge(std::size_t i) const { return now_[i].x[0]; }
};

// ------------------------------------------------------------------------------------- six-degree-of-freedom bodies
/// Unknowns of link i: its center and a rotation exp(t) R about the current iterate; joint i (three rows) ties its left
/// end to the right end of link i - 1, or to the nail. J = diag(m L^2/12, m r^2/4, m r^2/4) are a cylinder's second
/// moments. A two-point link has J = diag(m L^2/4, 0, 0): nothing resists its spin and the matrix is singular; `spin`
/// times the transverse inertia is added to that pivot of the matrix only, so the answer is untouched.
class BodyChain {
  static constexpr int P = 6, C = 3;
  using F = Front<P, C, 6, false>;
  struct State {
    Vec3 x;
    Quaternion q;
    Rotation R;
    Vec3 lambda;
  };
  struct Motion {
    Vec3 x;
    std::array<Vec3, 3> R;
  };
  std::vector<State> now_, tried_;
  std::vector<Motion> start_, velocity_, ahead_;
  std::vector<F::Eliminated> eliminated_;
  std::vector<std::array<double, P + C>> residual_, delta_;
  double J_[3], h_, a_, spin_;

  Vec3 arm(const State& s) const { return (length / 2) * s.R.column[0]; }

  /// Second derivative of force . exp(t) u at t = 0, optionally its positive semi-definite part.
  static void add_geometric(double (&H)[3][3], Vec3 force, Vec3 u, bool clamp) {
    const double f = norm(force), s = norm(u), fu = dot(force, u);
    if (!clamp) {
      for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) H[i][j] += 0.5 * (force[i] * u[j] + u[i] * force[j]);
        H[i][i] -= fu;
      }
    } else if (f * s > 0) {  // eigenvalues (|f||u| - f.u)/2, -f.u and one never positive; vectors f^+u^, f x u, f^-u^
      const Vec3 v = (1 / f) * force + (1 / s) * u, n = cross(force, u);
      const double vv = dot(v, v), nn = dot(n, n), plus = (f * s - fu) / 2, side = std::max(0.0, -fu);
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) {
          if (vv > 1e-20) H[i][j] += plus * v[i] * v[j] / vv;
          if (nn > 1e-20 * f * f * s * s) H[i][j] += side * n[i] * n[j] / nn;
        }
    }
  }

 public:
  BodyChain(int links, Link kind, double h, double spin = 1) : h_(h), a_(1 / (h * h)), spin_(spin) {
    const bool rod = kind == Link::rod;
    J_[0] = mass * length * length / (rod ? 12 : 4);
    J_[1] = J_[2] = rod ? mass * radius * radius / 4 : 0;
    if (rod) spin_ = 0;
    now_.resize(links), start_.resize(links), ahead_.resize(links), velocity_.resize(links);
    eliminated_.resize(links), residual_.resize(links), delta_.resize(links);
    for (int i = 0; i < links; ++i) now_[i].x = {(i + 0.5) * length, 0, 0};
  }
  std::size_t size() const { return now_.size(); }

  Iterations advance() {
    for (std::size_t i = 0; i < size(); ++i) {
      State& s = now_[i];
      start_[i] = {s.x, s.R.column};
      ahead_[i].x = s.x + h_ * velocity_[i].x;
      Vec3 turn;
      for (int k = 0; k < 3; ++k) {
        ahead_[i].R[k] = s.R.column[k] + h_ * velocity_[i].R[k];
        turn += 0.5 * h_ * cross(s.R.column[k], velocity_[i].R[k]);
      }
      s.x = ahead_[i].x;
      s.q = turned(s.q, turn);
      s.R = rotation_of(s.q);
    }
    tried_ = now_;
    const Iterations result = newton(*this);
    now_ = tried_;
    for (std::size_t i = 0; i < size(); ++i) {
      velocity_[i].x = (1 / h_) * (now_[i].x - start_[i].x);
      for (int k = 0; k < 3; ++k) velocity_[i].R[k] = (1 / h_) * (now_[i].R.column[k] - start_[i].R[k]);
    }
    return result;
  }

  Residual evaluate() {
    Residual sum;
    const double force_scale = 1 / (a_ * mass), torque_scale = length / (2 * a_ * (J_[0] + J_[1]));
    for (std::size_t i = 0; i < size(); ++i) {
      const State& s = tried_[i];
      const Vec3 y = s.x - ahead_[i].x, r = arm(s);
      Vec3 force = (a_ * mass) * y, torque;
      sum.energy += 0.5 * dot(force, y) - mass * gravity * s.x.y;
      force.y -= mass * gravity;
      for (int k = 0; k < 3; ++k) {
        const Vec3 apart = s.R.column[k] - ahead_[i].R[k];
        sum.energy += 0.5 * a_ * J_[k] * dot(apart, apart);
        torque += (-a_ * J_[k]) * cross(s.R.column[k], ahead_[i].R[k]);
      }
      Vec3 g = Vec3{} - (s.x - r) - (compliance / (a_ * mass)) * s.lambda;
      if (i > 0) g += tried_[i - 1].x + arm(tried_[i - 1]);
      force += -1 * s.lambda;
      torque += cross(r, s.lambda);  // acts at the arm -r with -lambda
      if (i + 1 < size()) {
        force += tried_[i + 1].lambda;
        torque += cross(r, tried_[i + 1].lambda);
      }
      for (int k = 0; k < 3; ++k) {
        residual_[i][k] = force[k], residual_[i][3 + k] = torque[k], residual_[i][P + k] = g[k];
        sum.add(force_scale * force[k]), sum.add(torque_scale * torque[k]), sum.add(g[k]);
        sum.violation += std::abs(g[k]);
      }
    }
    return sum;
  }

  bool factor(bool clamp) {
    bool right_signs = true;
    F front[2];
    for (std::size_t i = size(); i-- > 0;) {
      F& f = front[i % 2];
      f.start(i + 1 < size() ? &front[(i + 1) % 2] : nullptr);
      const State& s = tried_[i];
      const Vec3 r = arm(s);
      add_block(f, 0, 0, a_ * mass);
      // Inertia: a (tr(Q) I - sym(Q)) with Q = (R0 + h R0') J R'; equals a times the world inertia where R is ahead.
      double H[3][3] = {};
      for (int k = 0; k < 3; ++k) {
        const Vec3 p = clamp ? s.R.column[k] : ahead_[i].R[k];
        add_geometric(H, (-a_ * J_[k]) * p, s.R.column[k], false);
      }
      add_geometric(H, -1 * s.lambda, -1 * r, clamp);
      if (i + 1 < size()) add_geometric(H, tried_[i + 1].lambda, r, clamp);
      for (int j = 0; j < 3; ++j)
        for (int k = 0; k < 3; ++k) H[j][k] += a_ * spin_ * (J_[0] + J_[1]) * s.R.column[0][j] * s.R.column[0][k];
      for (int j = 0; j < 3; ++j)
        for (int k = j; k < 3; ++k) f.a[3 + j][3 + k] += H[j][k];
      // Rows of joint i: left neighbor's end (I, -[r]x) minus our left end (I, +[r]x), since our arm is -r.
      const auto cross_matrix = [](Vec3 v, int j, int k) {  // [v]x
        return j == k ? 0.0 : (k - j + 3) % 3 == 1 ? -v[3 - j - k] : v[3 - j - k];
      };
      for (int j = 0; j < 3; ++j) {
        f.a[j][P + j] = -1;
        for (int k = 0; k < 3; ++k) f.a[3 + k][P + j] = -cross_matrix(r, j, k);
        f.a[P + j][P + j] = -compliance / (a_ * mass);
        if (i > 0) {
          f.a[P + j][P + C + j] = 1;
          const Vec3 l = arm(tried_[i - 1]);
          for (int k = 0; k < 3; ++k) f.a[P + j][P + C + 3 + k] = -cross_matrix(l, j, k);
        }
      }
      for (int j = 0; j < P + C; ++j) f.a[j][F::n] -= residual_[i][j];
      right_signs &= f.factor(eliminated_[i]);
    }
    return right_signs;
  }
  double solve() {
    double largest = 0;
    const double nail[6] = {};
    for (std::size_t i = 0; i < size(); ++i) {
      F::solve(eliminated_[i], i > 0 ? delta_[i - 1].data() : nail, delta_[i].data());
      for (int k = 0; k < 3; ++k) largest = std::max(largest, std::abs(tried_[i].lambda[k] + delta_[i][P + k]));
    }
    now_ = tried_;
    return largest;
  }
  void move(double step) {
    for (std::size_t i = 0; i < size(); ++i) {
      const auto& d = delta_[i];
      tried_[i].x = now_[i].x + step * Vec3{d[0], d[1], d[2]};
      tried_[i].lambda = now_[i].lambda + step * Vec3{d[6], d[7], d[8]};
      tried_[i].q = turned(now_[i].q, step * Vec3{d[3], d[4], d[5]});
      tried_[i].R = rotation_of(tried_[i].q);
    }
  }

  Measure measure() const {
    Measure m;
    for (std::size_t i = 0; i < size(); ++i) {
      m.kinetic += 0.5 * mass * dot(velocity_[i].x, velocity_[i].x);
      for (int k = 0; k < 3; ++k) m.kinetic += 0.5 * J_[k] * dot(velocity_[i].R[k], velocity_[i].R[k]);
      m.potential -= mass * gravity * now_[i].x.y;
      const Vec3 tie = i > 0 ? now_[i - 1].x + arm(now_[i - 1]) : Vec3{};
      m.gap = std::max(m.gap, norm(now_[i].x - arm(now_[i]) - tie));
    }
    return m;
  }
  Vec3 hinge(std::size_t i) const { return now_[i].x + arm(now_[i]); }
};

// ------------------------------------------------------------------------------------------------------ the comparison
struct Row {
  double us_per_link_step = 1e300, iterations_mean = 0, gap = 0, energy_change = 0, energy_gain = 0;
  int iterations_max = 0, failures = 0;
};
template <class Chain>
Row diagnose(Chain chain, int steps) {  // untimed, every step looked at
  Row row;
  const Measure first = chain.measure();
  const double start = first.kinetic + first.potential;
  double largest_kinetic = 0, highest = start, end = start;
  for (int i = 0; i < steps; ++i) {
    const Iterations it = chain.advance();
    row.iterations_mean += static_cast<double>(it.count) / steps;
    row.iterations_max = std::max(row.iterations_max, it.count);
    row.failures += !it.converged;
    const Measure m = chain.measure();
    if (!std::isfinite(m.kinetic)) break;
    end = m.kinetic + m.potential;
    highest = std::max(highest, end);
    largest_kinetic = std::max(largest_kinetic, m.kinetic);
    row.gap = std::max(row.gap, m.gap);
  }
  row.energy_change = (end - start) / largest_kinetic;
  row.energy_gain = (highest - start) / largest_kinetic;
  return row;
}
template <class Chain>
double timed(Chain chain, int steps) {  // processor time, so that other work on the machine does not count
  const std::clock_t begin = std::clock();
  for (int i = 0; i < steps; ++i) chain.advance();
  return 1e6 * static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC / (static_cast<double>(steps) * chain.size());
}
void print(const char* kind, const char* name, int links, int hertz, double seconds, const Row& r, double base) {
  std::printf("%-9s %-8s %5d 1/%-3d %5.1f | %7.3f %6.2f | %5.2f %3d | %8.1e | %9.2e %8.1e | %d\n", kind, name, links,
              hertz, seconds, r.us_per_link_step, r.us_per_link_step / base, r.iterations_mean, r.iterations_max, r.gap,
              r.energy_change, r.energy_gain, r.failures);
}
void compare(Link kind, int links, int hertz, double seconds, int repeats) {
  const int steps = static_cast<int>(std::lround(seconds * hertz));
  const double h = 1.0 / hertz;
  const char* name = kind == Link::rod ? "rod" : "two-point";
  const NaturalChain<0> natural(links, kind, h);
  const NaturalChain<2> natural4(links, Link::rod, h);
  const BodyChain body(links, kind, h);
  const bool general = kind == Link::rod && links <= 512;
  Row a = diagnose(natural, steps), b = diagnose(body, steps), c = general ? diagnose(natural4, steps) : Row{};
  for (int r = 0; r < repeats; ++r) {  // interleaved: a slow moment of the machine meets all alike
    a.us_per_link_step = std::min(a.us_per_link_step, timed(natural, steps));
    b.us_per_link_step = std::min(b.us_per_link_step, timed(body, steps));
    if (general && r < 2) c.us_per_link_step = std::min(c.us_per_link_step, timed(natural4, steps));
  }
  print(name, "natural", links, hertz, seconds, a, a.us_per_link_step);
  print(name, "body", links, hertz, seconds, b, a.us_per_link_step);
  if (general) print(name, "natural4", links, hertz, seconds, c, a.us_per_link_step);
}
template <class One, class Two>
double apart(One one, Two two, int steps) {  // largest distance between the same hinge in two chains
  double worst = 0;
  for (int i = 0; i < steps; ++i) {
    one.advance(), two.advance();
    for (std::size_t k = 0; k < one.size(); ++k) worst = std::max(worst, norm(one.hinge(k) - two.hinge(k)));
  }
  return worst;
}
}  // namespace

int main() {
  const double h = 1.0 / 120;
  std::printf("check: largest distance between the same hinge in two formulations, 8 links, first 0.5 s\n");
  std::printf("  two-point: natural - body %.1e m;  rod: natural - body %.1e m, natural - natural4 %.1e m\n",
              apart(NaturalChain<0>(8, Link::two_point, h), BodyChain(8, Link::two_point, h), 60),
              apart(NaturalChain<0>(8, Link::rod, h), BodyChain(8, Link::rod, h), 60),
              apart(NaturalChain<0>(8, Link::rod, h), NaturalChain<2>(8, Link::rod, h), 60));
  std::printf(
      "two-point links as bodies: inertia lent to the axis, as a fraction of the transverse one (64 links, 2 s)\n");
  for (double spin : {0.0, 1e-15, 1e-12, 1e-9, 1e-6, 1e-3, 1.0}) {
    const Row r = diagnose(BodyChain(64, Link::two_point, h, spin), 240);
    std::printf("  %-6.0e Newton %5.2f mean %2d max, gap %.1e m, failures %d of 240\n", spin, r.iterations_mean,
                r.iterations_max, r.gap, r.failures);
  }
  std::printf("\n%-9s %-8s %5s %-5s %5s | %7s %6s | %5s %3s | %8s | %9s %8s | %s\n", "links", "unknowns", "N", "h", "s",
              "us/l/s", "ratio", "Newt", "max", "gap m", "dE/KEmax", "gain", "failed");
  for (const Link kind : {Link::two_point, Link::rod})
    for (const int hertz : {120, 60}) {
      compare(kind, 8, hertz, 10, 20);
      compare(kind, 64, hertz, 10, 8);
      compare(kind, 512, hertz, 10, 3);
      compare(kind, 4096, hertz, 2, 4);
    }
}
