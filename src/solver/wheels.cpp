// SPDX-License-Identifier: Apache-2.0
#include "solver/wheels.h"

#include "solver/holds.h"
#include "solver/row_masses.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace iota::solver {

/// The nodes that rows connect with each node, while they are few.
class Wheels::Neighbors {
 public:
  static constexpr std::uint8_t most = 8;

  void find(const Problem& problem) {
    lists_.assign(problem.size(), {});
    problem.for_each_acting([&](const auto& pool, std::size_t item) {
      const auto& c = pool.items[item];
      const auto nodes = pool.nodes_of(c);
      const bool is_held = !c.is_internal() || holds_direction(c);
      for (const std::uint32_t i : nodes) {
        lists_[i].is_held = lists_[i].is_held || is_held;
        for (const std::uint32_t j : nodes)
          if (i != j) lists_[i].add(j);
      }
    });
    for (const auto& c : problem.mass_couplings) lists_[c.a].add(c.b), lists_[c.b].add(c.a);
  }

  bool are_few(std::uint32_t node) const { return lists_[node].count <= most; }
  bool is_held(std::uint32_t node) const { return lists_[node].is_held; }
  std::span<const std::uint32_t> of(std::uint32_t node) const {
    return {lists_[node].nodes.data(), lists_[node].count};
  }

 private:
  struct List {
    std::array<std::uint32_t, most> nodes;
    std::uint8_t count = 0;
    bool is_held = false;  ///< by something outside

    void add(std::uint32_t node) {
      if (count > most || std::find(nodes.begin(), nodes.begin() + count, node) != nodes.begin() + count) return;
      if (count < most) nodes[count] = node;
      ++count;
    }
  };
  std::vector<List> lists_;
};

Wheels::Wheels() = default;
Wheels::~Wheels() = default;

/// Whether any node may be a wheel's own point: it has two other own points beside it, or a mass that is balanced by those of
/// the points on the axis. Of chains none is, which costs less than to find neighbors.
bool Wheels::may_have_wheels(const Problem& problem) {
  std::vector<std::uint8_t>& rows = is_own_;  // not yet needed
  rows.assign(problem.size(), 0);
  problem.for_each_acting([&](const auto& pool, std::size_t item) {
    for (const std::uint32_t i : pool.nodes_of(pool.items[item])) rows[i] = std::min(rows[i] + 1, 3);
  });
  if (std::any_of(rows.begin(), rows.end(), [](std::uint8_t count) { return count >= 3; })) return true;
  depends_on_masses_ = !problem.mass_couplings.empty();
  if (!depends_on_masses_) return false;
  std::vector<double>& sum = row_masses_;
  sum_row_masses(problem, sum);
  for (std::size_t i = 0; i < sum.size(); ++i)
    if (rows[i] == 2 && sum[i] <= 1e-6 * problem.mass[i]) return true;
  return false;
}

double largest_share(double first, double second, double limit) {
  if (!(first + second > limit)) return 1;
  const double root = std::sqrt(std::max(0.0, first * first + 4 * second * limit));  // a limit may be -0 with round-off
  return std::max(0.0, root - first) / (2 * second + 1e-300);
}

// The nodes of a body that shares two are all neighbors of any own one that carries it.
void Wheels::find(const Problem& problem) {
  wheels_.clear(), couplings_.clear();
  is_known_ = true, depends_on_masses_ = false;
  if (!may_have_wheels(problem)) return;
  if (!neighbors_) neighbors_ = std::make_unique<Neighbors>();
  Neighbors& neighbors = *neighbors_;
  neighbors.find(problem);
  std::vector<std::uint8_t>& is_own = is_own_;
  is_own.assign(problem.size(), 0);
  for (std::uint32_t node = 0; node < problem.size(); ++node) {
    if (is_own[node] || !neighbors.are_few(node) || neighbors.is_held(node)) continue;
    std::array<std::uint32_t, Neighbors::most + 1> body;
    const auto around = neighbors.of(node);
    std::copy(around.begin(), around.end(), body.begin());
    body[around.size()] = node;
    const auto end = body.begin() + static_cast<std::ptrdiff_t>(around.size()) + 1;
    const auto is_shared = [&](std::uint32_t i) {
      const auto others = neighbors.of(i);
      return neighbors.is_held(i) || !neighbors.are_few(i) ||
             std::any_of(others.begin(), others.end(),
                         [&](std::uint32_t j) { return std::find(body.begin(), end, j) == end; });
    };
    const auto own = std::partition(body.begin(), end, is_shared);
    if (own - body.begin() != 2 || end - own > static_cast<std::ptrdiff_t>(most_nodes)) continue;
    Wheel wheel;
    wheel.axis = {body[0], body[1]};
    wheel.own_count = static_cast<std::uint32_t>(std::copy(own, end, wheel.own.begin()) - wheel.own.begin());
    for (const std::uint32_t i : wheel.points()) is_own[i] = 1;
    wheels_.push_back(wheel);
  }
  if (wheels_.empty()) return;
  wheel_of_.assign(problem.size(), static_cast<std::uint32_t>(wheels_.size()));
  for (std::uint32_t k = 0; k < wheels_.size(); ++k)
    for (const std::uint32_t i : wheels_[k].points()) wheel_of_[i] = k;
  // Counted before they are placed: in a chain with a loop nearly every rod is a wheel, and to sort the list took longer
  // than to find the wheels.
  const auto wheel_with = [&](const auto& c) { return std::min(wheel_of_[c.a], wheel_of_[c.b]); };
  std::vector<std::uint32_t>& end = end_of_couplings_;
  end.assign(wheels_.size() + 1, 0);
  for (const auto& c : problem.mass_couplings) ++end[wheel_with(c)];  // the last counts those of no wheel
  end.back() = 0;
  std::exclusive_scan(end.begin(), end.end(), end.begin(), 0U);
  couplings_.resize(end.back());
  for (std::uint32_t k = 0; k < problem.mass_couplings.size(); ++k)
    if (const std::uint32_t wheel = wheel_with(problem.mass_couplings[k]); wheel < wheels_.size())
      couplings_[end[wheel]++] = k;
  auto next = couplings_.cbegin();
  for (std::uint32_t k = 0; k < wheels_.size(); ++k) {
    const auto first = std::exchange(next, couplings_.cbegin() + end[k]);
    wheels_[k].couplings = {first, next};
  }
}

/// visit(mass, i, node): the entries of the mass matrix in the row of each own point, the i-th.
template <class Visit>
void Wheels::for_each_mass(const Problem& problem, const Wheel& wheel, Visit visit) {
  for (std::size_t i = 0; i < wheel.own_count; ++i) visit(problem.mass[wheel.own[i]], i, wheel.own[i]);
  for (const std::uint32_t k : wheel.couplings) {
    const auto& c = problem.mass_couplings[k];
    if (const std::size_t i = wheel.place_of(c.a); i < wheel.own_count) visit(c.mass, i, c.b);
    if (const std::size_t i = wheel.place_of(c.b); i < wheel.own_count) visit(c.mass, i, c.a);
  }
}

namespace {

struct Axle {
  Vec3 origin, line;
  double length = norm(line);

  /// How a point moves if its wheel turns by 1 rad/s.
  Vec3 turning(const Vec3& point) const { return length > 0 ? (1 / length) * cross(line, point - origin) : Vec3{}; }
};

/// place(node)
template <class Place>
Axle axle_at(const std::array<std::uint32_t, 2>& axis, Place place) {
  const Vec3 origin = place(axis[0]);
  return {origin, place(axis[1]) - origin};
}

}  // namespace

// A field that turns velocities does no work along the chord of the step, but turns or brakes a wheel where the step ends.
void Wheels::add_losses_of_fields(const Problem& problem, double h) {
  for (const VelocityForce& f : problem.items_of<VelocityForce>()) {
    if (!f.part.turns) continue;
    const Vec3 rate = f.arm.rate(problem.velocity.data());
    const Vec3 acts = f.part.turn(0.5 * (f.start + rate)), wanted = f.part.turn(rate);
    for (std::uint32_t i = 0; i < f.arm.count; ++i) {
      const std::uint32_t node = f.arm.nodes[i], k = wheel_of_[node];
      if (k == wheels_.size()) continue;
      const auto end = [&](std::uint32_t j) { return problem.position[j]; };
      const auto start = [&](std::uint32_t j) { return problem.position[j] - h * problem.velocity[j]; };
      const Vec3 after = axle_at(wheels_[k].axis, end).turning(end(node));
      const Vec3 before = axle_at(wheels_[k].axis, start).turning(start(node));
      wheels_[k].lost -= h * f.arm.weights[i] * (dot(acts, after) - 0.5 * dot(wanted, before + after));
    }
  }
}

bool Wheels::find_losses(const Problem& problem, std::span<const Vec3> displacement, double h) {
  if (!is_known_) find(problem);
  if (wheels_.empty()) return false;
  constexpr double balanced = 1e-9;  // distance of the center of mass from the axis, of the radius
  constexpr double round_off = 1e-13;
  for (Wheel& wheel : wheels_) wheel.lost = 0;
  add_losses_of_fields(problem, h);
  bool any = false;
  for (Wheel& wheel : wheels_) {
    const auto find_turning = [&](const auto& place, std::array<Vec3, most_nodes>& turning) {
      const Axle axle = axle_at(wheel.axis, place);
      for (std::size_t i = 0; i < wheel.own_count; ++i) turning[i] = axle.turning(place(wheel.own[i]));
    };
    std::array<Vec3, most_nodes> before;
    find_turning([&](std::uint32_t i) { return problem.position[i] - h * problem.velocity[i]; }, before);
    find_turning([&](std::uint32_t i) { return problem.position[i]; }, wheel.turning);
    double size = 0, kinetic = 0;
    Vec3 moment;  // of mass: zero if it is balanced
    wheel.inertia = 0;
    for_each_mass(problem, wheel, [&](double mass, std::size_t i, std::uint32_t node) {
      const Vec3& e = wheel.turning[i];
      moment += mass * e, size += std::abs(mass) * norm(e);
      wheel.lost += (mass / h) * dot(displacement[node], e - before[i]);
      kinetic += std::abs(mass) * dot(problem.velocity[node], problem.velocity[node]);
      if (const std::size_t other = wheel.place_of(node); other < wheel.own_count)
        wheel.inertia += mass * dot(e, wheel.turning[other]);
    });
    const bool is_due =
        wheel.inertia > 0 && norm(moment) <= balanced * size && std::abs(wheel.lost) > round_off * h * kinetic;
    if (!is_due) wheel.lost = 0;
    any = any || is_due;
  }
  return any;
}

double Wheels::turn(Problem& problem, double most_gain, FunctionRef<bool(std::span<const std::uint32_t>)> is_due,
                    FunctionRef<void(std::span<const std::uint32_t>, const Vec3&)> given) {
  double first = 0, second = 0;
  for (Wheel& wheel : wheels_) {
    wheel.turn = wheel.lost != 0 && is_due(wheel.points()) ? wheel.lost / wheel.inertia : 0;
    if (wheel.turn == 0) continue;
    for_each_mass(problem, wheel, [&](double mass, std::size_t i, std::uint32_t node) {
      first += wheel.turn * mass * dot(problem.velocity[node], wheel.turning[i]);
    });
    second += 0.5 * wheel.turn * wheel.turn * wheel.inertia;
  }
  const double share = largest_share(first, second, most_gain);
  for (const Wheel& wheel : wheels_) {
    if (wheel.turn == 0) continue;
    Vec3 angular;  // about any place, since the momentum of this motion is zero
    for_each_mass(problem, wheel, [&](double mass, std::size_t i, std::uint32_t node) {
      angular += (share * wheel.turn * mass) * cross(problem.position[node], wheel.turning[i]);
    });
    for (std::size_t i = 0; i < wheel.own_count; ++i)
      problem.velocity[wheel.own[i]] += (share * wheel.turn) * wheel.turning[i];
    given(wheel.points(), angular);
  }
  return share * (first + share * second);
}

}  // namespace iota::solver
