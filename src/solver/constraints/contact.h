// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "solver/constraints/arms.h"
#include "solver/constraints/cone.h"

#include <algorithm>

namespace iota::solver {

/// The arm now of a point that will be at `arm` when its body has turned, by less than a radian or so. turn: rad. It is a little
/// longer, so that its chord is as long as the way that the body rolls in this time: else what rolls slips by turn^2/2 of it.
inline Vec3 arm_before(const Vec3& turn, const Vec3& arm) { return arm - cross(turn, arm); }

/// A place of a body against a plane of another body or of the world, or two round things, with Coulomb friction.
///   arms        0: center of what touches - origin of the plane;  1: point that touches - the other body's point there;
///               2: normal, towards the first body; of round things the unit axis along which they may slide, or zero
///               3, 4: tangents
///   constraint  g_0 = normal . arm 0 - radius,  of round things (|d|^2 - (axis . d)^2 - radius^2) / (2 radius),  d arm 0;
///               of wires that cross (|d|^2 - k_2 (axis . d)^2 - k_3 (arm 3 . d)^2 - radius^2) / (2 radius)
///               g_k = tangent_k . arm 1,  k = 1, 2   (m)
///   cone        N = -lambda_0 >= 0,  |(lambda_1, lambda_2)| <= mu N   (N)
///     open      all multipliers are zero, g_0 >= 0
///     sticks    g_0 = c_n lambda_0,  s_k = c_t lambda_k,  s_k the slip since it began to stick; up to |lambda_t| = mu_s N
///     slips     (lambda_1, lambda_2) = mu N z / |z|,  z = lambda + s / k the trial force, k its natural compliance
/// The center and the point differ for what is round: the ball's center keeps its height while the point turns under it.
/// All rows are quadratic in the points, so that the mid-point rule counts the work of friction exactly; but for an axis
/// that turns, where axis . d is small. Arms that turn with a body keep angular momentum.
/// Newton's matrix has the column of mu N, and the curvature of the circle |z|: Alart and Curnier, A mixed formulation for
/// frictional contact problems, 1991. c_n makes the forces of a box on four corners unique, c_t keeps Newton's method from
/// cycling between them. Impacts: src/solver/integrator_impacts.cpp. The solver measures the slip from the start of the (sub-)step less the strain c_t lambda with which
/// that began, so that a contact that sticks does not creep.
struct ContactConstraint : ArmConstraint<ContactConstraint, 3, 5> {
  double radius = 0;                             ///< m
  double floor = 0;                              ///< g_0 that an impact leaves at the end of the step, m
  double restitution = 0;                        ///< e: the normal speed after an impact, of that before
  double friction = 0;                           ///< mu, of what slips
  double static_friction = 0;                    ///< mu_s, of what sticks, if that is above mu
  double drag_before[2] = {};                    ///< friction of the step before if it slipped and mu_s is above mu, N
  double normal_compliance = 0, compliance = 0;  ///< c_n, c_t, m/N
  double softening = 1;                          ///< of c_n, while a solution is searched
  bool never_slips = false;                      ///< while a solution is searched
  double share = 1;                              ///< of the step, for which the compliances are
  bool is_steady = false;  ///< its force hardly changes: in longer parts it keeps the compliance, too
  double reference = 1;
  double pivots[2] = {};       ///< rates of the tangential rows that stick at the end of a (sub-)step, see rate_of, m/s
  double from = 0, to = 1;     ///< that (sub-)step, as fractions of the step: see begin_part
  double ball = 0;             ///< how far the point of the first body is from the center, against the normal, m
  std::uint32_t of_first = 0;  ///< the number of nodes of the first body
  bool first_turns = false, second_turns = false;  ///< four nodes that move by themselves
  std::uint32_t turning_begin = 0,
                turning_end = max_nodes;  ///< the nodes with which arms 2 to 4 turn; see find_turning
  std::array<double, 3> impulse{};  ///< of the rows in the step so far, with that of the velocities at its end, N s
  double rebound = 0;               ///< the normal speed at which an impact ends, while impacts are solved, m/s
  double drags[2] = {};         ///< friction of an impulse along the tangents, in parts of its normal one, meanwhile
  bool stays_slipping = false;  ///< meanwhile: to stick needs more than its cone has
  bool is_of_sweeps = false;    ///< its overlap was left by sweeps: see Heap
  bool is_strained = true;      ///< its compliance stores energy. Forces of sweeps are impulses: see Heap
  bool is_round = false;        ///< the radius is that of both together, above zero
  bool has_wires = false;       ///< round: two wires that cross, one along arm 2, one along arm 3
  double bends[2] = {1, 0};     ///< k_2, k_3
  bool meets = false;           ///< in this (sub-)step, by the velocities with which it begins
  double unstored = 0;          ///< of the strain that the step before has left: other compliances store less, J
  bool leaves = false;          ///< at its end after an impact, so that its rows store nothing

  /// Arms 2 to 4, which do not turn with a body.
  void set_directions(const std::array<Vec3, 3>& of) {
    for (int k = 0; k < 3; ++k) set_constant(2 + k, of[static_cast<std::size_t>(k)]);
  }

  /// After the weights are set.
  void find_turning() {
    const auto turns = [&](std::uint32_t i) { return weights[2][i] != 0 || weights[3][i] != 0 || weights[4][i] != 0; };
    turning_begin = 0, turning_end = count;
    while (turning_begin < turning_end && !turns(turning_begin)) ++turning_begin;
    while (turning_end > turning_begin && !turns(turning_end - 1)) --turning_end;
  }

  double reference_length() const { return reference; }
  /// d without its parts along which the distance does not grow.
  Vec3 off(const Vec3& d, const Vec3& axis, const Vec3& side) const {
    if (!has_wires) return d - dot(axis, d) * axis;
    return d - bends[0] * dot(axis, d) * axis - bends[1] * dot(side, d) * side;
  }
  void value(const Vec3* x, double fraction, double* g) const { calc_value(arms(x, fraction).data(), fraction, g); }
  void calc_value(const Vec3* e, double /*fraction*/, double* g) const {
    g[0] = (is_round ? (dot(off(e[0], e[2], e[3]), e[0]) / radius - radius) / 2 : dot(e[2], e[0]) - radius) - floor;
    g[1] = dot(e[3], e[1]), g[2] = dot(e[4], e[1]);
  }
  /// d g_0 by arms 0, 2 and 3, and d g_k by arm 1 and by arm 2 + k, which is `place`.
  struct ByArms {
    Vec3 center, turn, side, first, second, place;
  };
  ByArms by_arms(const std::array<Vec3, 5>& e) const { return by_arms(e, dot(e[2], e[0]), dot(e[3], e[0])); }
  std::array<Vec3, 5> arms(const Vec3* x, double fraction) const {
    std::array<Vec3, 5> e;
    for (std::size_t a = 0; a < 5; ++a) e[a] = constant_start[a] + fraction * (constant[a] - constant_start[a]);
    for (std::uint32_t i = 0; i < count; ++i) {
      const Vec3 place = x[nodes[i]];
      e[0] += weights[0][i] * place, e[1] += weights[1][i] * place;
      for (std::size_t a = 2; a < 5 && turns(i); ++a) e[a] += weights[a][i] * place;
    }
    return e;
  }
  /// They are exact (J. C. Simo, N. Tarnow and K. K. Wong, 1992) and make no torque: by the arms in the middle, and for
  /// (axis . d)^2 by the mean of axis . d.
  ByArms mean_by_arms(const std::array<Vec3, 5>& first, const std::array<Vec3, 5>& last) const {
    const double along = (dot(first[2], first[0]) + dot(last[2], last[0])) / 2,
                 beside = (dot(first[3], first[0]) + dot(last[3], last[0])) / 2;
    std::array<Vec3, 5> middle;
    for (std::size_t a = 0; a < 5; ++a) middle[a] = 0.5 * (first[a] + last[a]);
    return by_arms(middle, along, beside);
  }
  void gradient(const ByArms& by, int node, Vec3* out) const {
    const auto i = static_cast<std::uint32_t>(node);
    out[0] = weights[0][i] * by.center, out[1] = weights[1][i] * by.first, out[2] = weights[1][i] * by.second;
    if (!turns(i)) return;
    out[0] += weights[2][i] * by.turn, out[1] += weights[3][i] * by.place, out[2] += weights[4][i] * by.place;
    if (has_wires) out[0] += weights[3][i] * by.side;
  }
  /// The gradients of all nodes, which the solver takes one by one: see Gradients.
  void gradients(const Vec3* x, double fraction, Vec3* out) const {
    const ByArms by = by_arms(arms(x, fraction));
    for (int i = 0; i < node_count(); ++i) gradient(by, i, out + 3 * i);
  }
  void curvature(const Vec3* x, double /*fraction*/, const double* lambda, bool clamp, Mat3* blocks) const {
    const double pull = is_round ? (clamp ? std::max(0.0, lambda[0]) : lambda[0]) / radius : 0;
    const double of_normal = is_round || clamp ? 0 : lambda[0], of_first = clamp ? 0 : lambda[1],
                 of_second = clamp ? 0 : lambda[2];
    Mat3 by_centers, by_both, by_turns;  // of g_0 by arms 0 and 2
    Mat3 by_both_sides, by_sides;        // by arms 0 and 3
    if (pull != 0) {
      const Vec3 d = arm(0, x, 1), axis = arm(2, x, 1);
      const double of_axis = bends[0] * pull;
      by_centers = Mat3::diagonal(pull) + -of_axis * Mat3::outer(axis, axis);
      by_both = Mat3::diagonal(-of_axis * dot(axis, d)) + -of_axis * Mat3::outer(axis, d);
      by_turns = -of_axis * Mat3::outer(d, d);
      if (has_wires) {
        const Vec3 side = arm(3, x, 1);
        const double of_side = bends[1] * pull;
        by_centers += -of_side * Mat3::outer(side, side);
        by_both_sides = Mat3::diagonal(-of_side * dot(side, d)) + -of_side * Mat3::outer(side, d);
        by_sides = -of_side * Mat3::outer(d, d);
      }
    }
    const Mat3 by_both_back = by_both.transposed(), by_both_sides_back = by_both_sides.transposed();
    for (std::uint32_t i = 0; i < count; ++i)
      for (std::uint32_t j = i; j < count; ++j, ++blocks) {
        const auto product = [&](std::size_t a, std::size_t b) { return weights[a][i] * weights[b][j]; };
        const auto mixed = [&](std::size_t a, std::size_t b) { return product(a, b) + product(b, a); };
        *blocks = Mat3::diagonal(of_normal * mixed(0, 2) + of_first * mixed(1, 3) + of_second * mixed(1, 4));
        if (pull == 0) continue;
        *blocks += product(0, 0) * by_centers + product(0, 2) * by_both + product(2, 0) * by_both_back +
                   product(2, 2) * by_turns;
        if (has_wires)
          *blocks += product(0, 3) * by_both_sides + product(3, 0) * by_both_sides_back + product(3, 3) * by_sides;
      }
  }

  /// For a (sub-)step that is a part of the step. A place would yield in a short one by more than it moves in that, and hold
  /// what slides. In a longer one it keeps its strain, in a shorter one its force: so its energy never rises.
  void fit(double part, double* multipliers) {
    const double ratio = part * part / (share * share);
    if (ratio == 1 || (ratio > 1 && is_steady)) return;
    normal_compliance *= ratio, compliance *= ratio, share = part;
    for (int r = 0; r < 3 && ratio > 1; ++r) multipliers[r] /= ratio;
  }

  static constexpr bool is_tangent(int r) { return r > 0; }
  static constexpr bool is_one_sided(int r) { return r == 0; }
  double compliance_of(int r) const { return r == 0 ? softening * normal_compliance : compliance; }
  /// The rate of a row that sticks, at a fraction of the step, m/s. The point that touches in the middle of the step does not
  /// rest before and after it if the bodies turn about their normal while they roll: a coin in a circle, or a tilted disk.
  double rate_of(int r, double fraction) const {
    return is_tangent(r) ? (2 * fraction - from - to) / (to - from) * pivots[r - 1] : 0;
  }
  /// For a part of the step, of h seconds, with the nodes at x and their velocities v at its start: the points that touch in its
  /// middle, of bodies that turn.
  void begin_part(const Vec3* x, const Vec3* v, double start, double end, double h);
  /// The friction of what slips, N.
  double largest_friction(const double* multipliers) const { return friction * std::max(0.0, -multipliers[0]); }
  /// The friction beyond which what sticks begins to slip, N.
  double largest_hold(const double* multipliers) const {
    return std::max(friction, static_friction) * std::max(0.0, -multipliers[0]);
  }

  /// The state in which multipliers would be a solution.
  ConeState state_of(const double* multipliers) const;
  /// Another state, if the multipliers and values do not fit the present one. Tangential values are slips; `natural`:
  /// compliance of each row at the points, m/N; gaps up to `tolerance` change nothing.
  ConeState switch_state(ConeState now, const double* multipliers, const double* g, const double* natural,
                         double tolerance) const;
  /// A state with direction 0 slips without friction, but for the drags of an impulse.
  ConeEquations equations(ConeState, const double* multipliers, const double* g, const double* natural) const;

 private:
  bool turns(std::uint32_t node) const { return node >= turning_begin && node < turning_end; }
  /// along, beside: of d with arms 2 and 3
  ByArms by_arms(const std::array<Vec3, 5>& e, double along, double beside) const {
    along *= bends[0], beside *= bends[1];
    ByArms by{is_round ? (1 / radius) * (e[0] - along * e[2]) : e[2],
              is_round ? (-along / radius) * e[0] : e[0],
              {},
              e[3],
              e[4],
              e[1]};
    if (has_wires) by.center -= (beside / radius) * e[3], by.side = (-beside / radius) * e[0];
    return by;
  }
};

}  // namespace iota::solver
