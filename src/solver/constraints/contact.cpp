// SPDX-License-Identifier: Apache-2.0
#include "solver/constraints/contact.h"

#include <algorithm>
#include <cmath>

namespace iota::solver {

namespace {

/// The friction that would hold the point at its present slip: z = lambda + (s - c_t lambda) / k.
struct TrialFriction {
  TrialFriction(const ContactConstraint& c, const double* multipliers, const double* g, const double* compliances)
      : natural(std::max(compliances[1], compliances[2])) {
    for (std::size_t i = 0; i < 2; ++i)
      force[i] = multipliers[1 + i] + (g[1 + i] - c.compliance * multipliers[1 + i]) / natural;
    size = std::hypot(force[0], force[1]);
  }
  double natural;  ///< k, m/N
  double force[2], size;
};

/// A body by four of its points.
class RigidPoints {
 public:
  RigidPoints(const std::uint32_t* nodes, const Vec3* x, const Vec3* v) : first_(x[nodes[0]]) {
    Vec3 edges[3];
    for (int k = 0; k < 3; ++k) edges[k] = x[nodes[k + 1]] - first_;
    const double volume = dot(edges[0], cross(edges[1], edges[2]));
    for (int k = 0; k < 3; ++k) {
      duals_[k] = (1 / volume) * cross(edges[(k + 1) % 3], edges[(k + 2) % 3]);
      spin_ += 0.5 * cross(duals_[k], v[nodes[k + 1]] - v[nodes[0]]);
    }
  }
  /// rad/s
  const Vec3& spin() const { return spin_; }
  /// Writes weight times those by which the points give a place.
  void weigh(const Vec3& place, double weight, double* weights) const {
    weights[0] = weight;
    for (int k = 0; k < 3; ++k) {
      weights[k + 1] = weight * dot(duals_[k], place - first_);
      weights[0] -= weights[k + 1];
    }
  }

 private:
  Vec3 first_, duals_[3], spin_;
};

constexpr ConeState slips{ConeState::Mode::slips, 1};

}  // namespace

// As ingredient::Contacts finds them for the whole step.
void ContactConstraint::begin_part(const Vec3* x, const Vec3* v, double start, double end, double h) {
  constexpr int center_arm = 0, place_arm = 1;
  const Vec3 d = arm(center_arm, x, start),
             across = is_round ? off(d, arm(2, x, start), arm(3, x, start)) : arm(2, x, start);
  const double length = norm(across);
  if (!(length > 0) || !(first_turns || second_turns)) return;
  const Vec3 normal = (1 / length) * across;
  const double gap = is_round ? length - radius : dot(normal, d) - radius;
  Vec3 center = of_first > 0 ? Vec3{} : constant[center_arm], closing;
  for (std::uint32_t i = 0; i < of_first; ++i) center += weights[center_arm][i] * x[nodes[i]];
  for (std::uint32_t i = 0; i < count; ++i) closing += weights[center_arm][i] * v[nodes[i]];
  const Vec3 along = closing - dot(closing, normal) * normal;
  const double other_ball = is_round ? radius - ball : 0;
  Vec3 turning, run = along;
  if (first_turns) {
    const RigidPoints first(nodes.data(), x, v);
    first.weigh(center + arm_before(0.5 * h * first.spin(), -ball * normal), 1, weights[place_arm].data());
    turning += first.spin();
  }
  if (second_turns) {
    const RigidPoints second(nodes.data() + of_first, x, v);
    Vec3 place = center - (ball + 0.5 * gap) * normal;
    if (is_round) {
      const Vec3 origin = center - d;
      place = origin + arm_before(0.5 * h * second.spin(), place - origin) + (0.5 * h * other_ball / radius) * along;
      run = (other_ball / radius) * along - other_ball * cross(second.spin(), normal);
    } else {
      place += 0.5 * h * along;
    }
    second.weigh(place, -1, weights[place_arm].data() + of_first);
    turning -= second.spin();
  }
  const Vec3 pivot = -0.5 * h * dot(turning, normal) * cross(normal, run);
  for (int k = 0; k < 2; ++k) pivots[k] = dot(pivot, arm(3 + k, x, start));
  from = start, to = end;
}

ConeState ContactConstraint::state_of(const double* multipliers) const {
  constexpr double at_edge = 1 - 1e-6;
  if (!(multipliers[0] < 0)) return {ConeState::Mode::open};
  if (never_slips) return {};
  const double size = std::hypot(multipliers[1], multipliers[2]);
  const double edge = largest_friction(multipliers);
  if (size < at_edge * edge) return {};
  // A place that slips has the friction of the edge. With more of it, it sticks, if static friction allows that at all.
  const bool holds = size > edge / at_edge || size == 0;
  return holds && static_friction > friction ? ConeState{} : slips;
}

// A contact that closes without a slip sticks: noise would be the direction of its friction.
ConeState ContactConstraint::switch_state(ConeState now, const double* multipliers, const double* g,
                                          const double* natural, double tolerance) const {
  if (now.mode == ConeState::Mode::open && !(g[0] < -tolerance)) return now;
  const double push = -multipliers[0];
  if (natural[0] * push - (g[0] + compliance_of(0) * push) < -tolerance) return {ConeState::Mode::open};
  if (never_slips) return {};
  const TrialFriction trial(*this, multipliers, g, natural);
  // Static friction may hold a place that comes to rest and would turn back. It came to rest within the step before, after which
  // friction and load moved it on: at most by the speed that these give in half a step.
  const bool turns = drag_before[0] * trial.force[0] + drag_before[1] * trial.force[1] < 0;
  const double hold = turns ? 2 * largest_hold(multipliers) + largest_friction(multipliers) : largest_hold(multipliers);
  if (now.slips())
    return trial.natural * (trial.size - (turns ? hold : largest_friction(multipliers))) < -tolerance ? ConeState{}
                                                                                                      : now;
  return trial.natural * (trial.size - hold) > tolerance ? slips : ConeState{};
}

ConeEquations ContactConstraint::equations(ConeState state, const double* multipliers, const double* g,
                                           const double* natural) const {
  ConeEquations e{.by_value = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}};
  for (std::size_t r = 0; r < 3; ++r) {
    const double soft = compliance_of(static_cast<int>(r));
    e.value[r] = g[r] - soft * multipliers[r], e.by_multiplier[r][r] = -soft;
  }
  if (!state.slips()) return e;
  const TrialFriction trial(*this, multipliers, g, natural);
  const double k = trial.natural;
  const double bound = state.direction == 0 ? 0 : largest_friction(multipliers);
  const double d[2] = {trial.size > 0 ? trial.force[0] / trial.size : 0,
                       trial.size > 0 ? trial.force[1] / trial.size : 0};
  // With a trial within the circle, which is about to stick, the step would turn too far.
  const double part = trial.size > 0 ? std::min(1.0, bound / trial.size) : 0;
  for (std::size_t i = 0; i < 2; ++i) {
    e.value[1 + i] = k * (bound * d[i] - multipliers[1 + i]);
    if (state.direction == 0)
      e.by_multiplier[1 + i][0] = k * drags[i];
    else
      e.by_multiplier[1 + i][0] = multipliers[0] < 0 ? -k * friction * d[i] : 0;
    for (std::size_t j = 0; j < 2; ++j) {
      const double across = part * ((i == j ? 1 : 0) - d[i] * d[j]);
      e.by_value[1 + i][1 + j] = across;
      e.by_multiplier[1 + i][1 + j] = (k - compliance) * across - (i == j ? k : 0);
    }
  }
  return e;
}

}  // namespace iota::solver
