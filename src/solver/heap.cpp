// SPDX-License-Identifier: Apache-2.0
#include "solver/heap.h"

#include "base/disjoint_sets.h"
#include "base/sort_unique.h"
#include "math/mat3.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <span>

namespace iota::solver {

namespace {

/// Measured with towers, pyramids and heaps of 50 to 1000 bodies (docs/contact.md): with less a tower of ten sways or falls.
constexpr int sweeps = 2;
constexpr int first_sweeps = 8;  // where contacts begin

}  // namespace

bool Heap::find_bodies(const Problem& problem) {
  if (!problem.has_used<ContactConstraint>() || !found_.find(problem) || !ties_.find(problem, found_)) return false;
  forces_.find(problem, found_);
  if (forces_.count_between() > problem.items_of<ContactConstraint>().size()) return false;
  pairs_.clear();
  std::vector<std::uint8_t> is_grounded(found_.all.size(), 0);
  const auto is_free = [&](std::uint32_t body) { return body != none && !found_.all[body].is_driven; };
  const auto connect = [&](std::uint32_t a, std::uint32_t b) {
    if (is_free(a) && is_free(b) && a != b) {
      pairs_.push_back({std::min(a, b), std::max(a, b)});
    } else if (is_free(a) || is_free(b)) {
      is_grounded[is_free(a) ? a : b] = 1;
    }
  };
  for (const ContactConstraint& c : problem.items_of<ContactConstraint>()) {
    const auto nodes = std::span(c.nodes).first(c.count);
    connect(found_.with(nodes.first(c.first_side > 0 ? c.first_side : c.count)),
            found_.with(nodes.subspan(c.first_side)));
  }
  ties_.for_each_pair(connect), forces_.for_each_pair(connect);
  sort_unique(pairs_);
  constexpr double few_loops = 1.25;
  const auto free_bodies =
      std::count_if(found_.all.begin(), found_.all.end(), [](const Body& b) { return !b.is_driven; });
  const auto grounded = std::count(is_grounded.begin(), is_grounded.end(), 1);
  is_tree_ = static_cast<double>(pairs_.size()) + static_cast<double>(grounded) <=
             few_loops * static_cast<double>(free_bodies);
  find_least_cost();
  has_light_joints_ = find_light_joints(problem);
  return true;
}

bool Heap::find_light_joints(const Problem& problem) const {
  constexpr double light = 1.0 / 500;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> partners;
  DisjointSets connected(found_.all.size());
  ties_.for_each_pair([&](std::uint32_t a, std::uint32_t b) {
    partners.push_back({a, b}), partners.push_back({b, a});
    connected.join(a, b);
  });
  ties_.for_each_held([&](std::uint32_t body) { partners.push_back({body, none}); });
  if (partners.empty()) return false;
  sort_unique(partners);
  const std::vector<double> masses = found_.masses(problem);
  struct Machine {
    double heaviest = 0;
    std::size_t bodies = 0;
  };
  std::vector<Machine> machines(masses.size());
  for (std::uint32_t body = 0; body < masses.size(); ++body) {
    Machine& machine = machines[connected.root(body)];
    machine.heaviest = std::max(machine.heaviest, masses[body]), ++machine.bodies;
  }
  for (std::size_t k = 1; k < partners.size(); ++k) {
    const std::uint32_t body = partners[k].first;
    const Machine& machine = machines[connected.root(body)];
    if (partners[k - 1].first == body && 2 * machine.bodies > masses.size() && masses[body] < light * machine.heaviest)
      return true;
  }
  return false;
}

namespace {

/// Places and lengths.
double unknowns_of(const HeapBody& body) {
  const double points = body.count;
  return 3 * points + 0.5 * points * (points - 1);
}

}  // namespace

// Each pair is in the front of one of its bodies, and fill only adds to them: the squares of n numbers whose sum is s are s^2/n at
// least.
void Heap::find_least_cost() {
  double bodies = 0, fewest = std::numeric_limits<double>::infinity();
  for (const Body& body : found_.all)
    if (!body.is_driven) bodies += 1, fewest = std::min(fewest, unknowns_of(body));
  const double fronts = bodies + static_cast<double>(pairs_.size());
  least_cost_ = bodies > 0 ? fewest * fewest * fewest * fronts * fronts / bodies : 0;
}

// Eliminates bodies in the order of their degrees. A body costs its unknowns times the square of those of its front.
double Heap::cost_of_factor() const {
  constexpr double most = 1e9;
  const auto unknowns = [&](std::uint32_t body) { return unknowns_of(found_.all[body]); };
  std::vector<std::vector<std::uint32_t>> neighbors(found_.all.size());
  for (const auto& [a, b] : pairs_) neighbors[a].push_back(b), neighbors[b].push_back(a);
  std::vector<std::vector<std::uint32_t>> by_degree(1);
  const auto list = [&](std::uint32_t body) {
    const std::size_t degree = neighbors[body].size();
    if (by_degree.size() <= degree) by_degree.resize(degree + 1);
    by_degree[degree].push_back(body);
  };
  for (std::uint32_t i = static_cast<std::uint32_t>(found_.all.size()); i-- > 0;)
    if (!found_.all[i].is_driven) list(i);
  std::vector<std::uint8_t> is_gone(found_.all.size(), 0);
  std::vector<std::uint32_t> merged;
  double cost = 0;
  for (std::size_t degree = 0; degree < by_degree.size() && cost < most;) {
    if (by_degree[degree].empty()) {
      ++degree;
      continue;
    }
    const std::uint32_t body = by_degree[degree].back();
    by_degree[degree].pop_back();
    if (is_gone[body] || neighbors[body].size() != degree) continue;  // it is listed elsewhere
    is_gone[body] = 1;
    const std::vector<std::uint32_t> around = std::move(neighbors[body]);
    double front = unknowns(body);
    for (const std::uint32_t other : around) front += unknowns(other);
    cost += unknowns(body) * front * front;
    for (const std::uint32_t other : around) {
      std::vector<std::uint32_t>& list_of_other = neighbors[other];
      merged.clear();
      std::sort(list_of_other.begin(), list_of_other.end());
      std::set_union(list_of_other.begin(), list_of_other.end(), around.begin(), around.end(),
                     std::back_inserter(merged));
      std::erase_if(merged, [&](std::uint32_t n) { return n == body || n == other; });
      list_of_other = merged;
      list(other);
    }
    degree = 0;
  }
  return std::min(cost, most);
}

void Heap::load_bodies(const Problem& problem, double h) {
  std::vector<Vec3> momentum(found_.all.size());
  std::vector<double> mass(found_.all.size(), 0);
  motions_.assign(found_.all.size() + 1, {});
  for (Body& body : found_.all)
    body.center = {}, body.inertia = body.by_inertia_at_begin = {}, body.moved = {}, body.turn = {},
    body.turned = Mat3::diagonal(1);
  for (std::size_t b = 0; b < found_.all.size(); ++b)
    for (std::uint32_t k = 0; k < found_.all[b].count; ++k) {
      const std::uint32_t node = found_.all[b].nodes[k];
      const double part = found_.all[b].shares[k] * problem.mass[node];
      mass[b] += part;
      found_.all[b].center += part * problem.position[node];
      momentum[b] += part * problem.velocity[node];
    }
  for (const HeapBodies::Coupling& coupling : found_.couplings) {
    const auto& c = problem.mass_couplings[coupling.item];
    const std::uint32_t b = coupling.body;
    const double part = coupling.share * c.mass;
    mass[b] += 2 * part;
    found_.all[b].center += part * (problem.position[c.a] + problem.position[c.b]);
    momentum[b] += part * (problem.velocity[c.a] + problem.velocity[c.b]);
  }
  for (std::size_t i = 0; i < found_.all.size(); ++i) {
    if (found_.all[i].is_driven || !(mass[i] > 0)) continue;
    motions_[i].by_mass = 1 / mass[i];
    found_.all[i].center *= motions_[i].by_mass, motions_[i].velocity = motions_[i].by_mass * momentum[i];
  }
  std::vector<Vec3> angular(found_.all.size());
  const auto add = [&](std::size_t b, double m, std::uint32_t p, std::uint32_t q) {
    const Vec3 rp = problem.position[p] - found_.all[b].center, rq = problem.position[q] - found_.all[b].center;
    angular[b] += m * cross(rp, problem.velocity[q] - motions_[b].velocity);
    found_.all[b].inertia += coupled_inertia(m, rp, rq);
  };
  for (std::size_t b = 0; b < found_.all.size(); ++b)
    for (std::uint32_t k = 0; k < found_.all[b].count; ++k) {
      const std::uint32_t node = found_.all[b].nodes[k];
      add(b, found_.all[b].shares[k] * problem.mass[node], node, node);
    }
  for (const HeapBodies::Coupling& coupling : found_.couplings) {
    const auto& c = problem.mass_couplings[coupling.item];
    add(coupling.body, coupling.share * c.mass, c.a, c.b), add(coupling.body, coupling.share * c.mass, c.b, c.a);
  }
  for (std::size_t i = 0; i < found_.all.size(); ++i) {
    Body& body = found_.all[i];
    Motion& motion = motions_[i];
    body.gain = body.turning = {};
    if (motion.by_mass == 0) continue;
    for (std::uint32_t k = 0; k < body.count; ++k) body.arms[k] = problem.position[body.nodes[k]] - body.center;
    invert_inertia(body, motion);
    motion.spin = motion.by_inertia * angular[i];
    body.gain = h * problem.gravity;
    for (std::uint32_t k = 0; k < body.count && !problem.force.empty(); ++k) {
      const Vec3 force = body.shares[k] * problem.force[body.nodes[k]];
      body.gain += (h * motion.by_mass) * force, body.turning += h * cross(body.arms[k], force);
    }
  }
  for (const BodyTorque& t : problem.torques)
    found_.all[found_.with(std::span(t.nodes).first(t.count))].turning += h * t.torque;
}

void Heap::invert_inertia(Body& body, Motion& motion) {
  constexpr double thin = 1e-9, even = 1e-12;
  const auto& m = body.inertia.m;
  const double mean = body.inertia.trace() / 3, most = even * mean;
  body.is_even = body.count > 1 && std::abs(m[0][0] - mean) <= most && std::abs(m[1][1] - mean) <= most &&
                 std::abs(m[2][2] - mean) <= most && std::abs(m[0][1]) <= most && std::abs(m[0][2]) <= most &&
                 std::abs(m[1][2]) <= most;
  double reach = 0;
  for (std::uint32_t k = 0; k < body.count; ++k) reach = std::max(reach, norm(body.arms[k]));
  const double least = thin * reach * reach / motion.by_mass;
  body.is_even = body.is_even && mean > least;
  if (body.is_even) {
    body.by_inertia_at_begin = motion.by_inertia = Mat3::diagonal(1 / mean);
    return;
  }
  const SymmetricEigen eigen = symmetric_eigen(body.inertia);
  // Shared points may give a body all its mass at one place: its inertia is round-off then.
  const double largest = std::max({eigen.values[0], eigen.values[1], eigen.values[2], least});
  motion.by_inertia = {};
  for (int k = 0; k < 3; ++k)
    if (body.count > 1 && eigen.values[k] > thin * largest)  // that of a point is round-off
      motion.by_inertia += (1 / eigen.values[k]) * Mat3::outer(eigen.axes[k], eigen.axes[k]);
  body.by_inertia_at_begin = motion.by_inertia;
}

void Heap::load_grips(const Problem& problem) {
  grips_.clear();
  const std::span forces = problem.items_of<GripForce>();
  for (std::size_t i = 0; i < forces.size(); ++i) {
    const GripForce& force = forces[i];
    Grip grip{.body = found_.with(std::span(force.arm.nodes).first(force.arm.count)),
              .item = static_cast<std::uint32_t>(i)};
    if (!is_free(grip.body)) continue;
    grip.error = force.arm.value(problem.position.data());
    grip.arm = grip.error + force.arm.origin - found_.all[grip.body].center;
    grips_.push_back(grip);
  }
}

// Held forces, and grips by the end-point rule.
void Heap::push(double h, const Problem& problem, HeapReport& report) {
  for (std::size_t i = 0; i < found_.all.size(); ++i) {
    const Body& body = found_.all[i];
    Motion& motion = motions_[i];
    if (motion.by_mass == 0) continue;
    const Vec3 gained = body.gain - h * problem.gravity, turned = motion.by_inertia * body.turning;
    motion.velocity += 0.5 * body.gain, motion.spin += 0.5 * turned;
    report.external_work += dot(gained, motion.velocity) / motion.by_mass + dot(body.turning, motion.spin);
    motion.velocity += 0.5 * body.gain, motion.spin += 0.5 * turned;
  }
  const std::span forces = problem.items_of<GripForce>();
  for (const Grip& grip : grips_) {
    const Body& body = found_.all[grip.body];
    Motion& motion = motions_[grip.body];
    const GripForce& force = forces[grip.item];
    const Vec3 arm = rotate(body.turn, grip.arm), error = grip.error + body.moved + arm - grip.arm;
    const Vec3 velocity = motion.velocity + cross(motion.spin, arm);
    const double resistance = h * (force.damping + h * force.stiffness);
    Mat3 matrix;
    for (int k = 0; k < 3; ++k) {
      const Vec3 unit = unit_vector(k);
      matrix.set_column(k,
                        unit + resistance * (motion.by_mass * unit + cross(motion.by_inertia * cross(arm, unit), arm)));
    }
    const Vec3 impulse = solve(matrix, -(h * force.stiffness) * error - resistance * velocity);
    motion.velocity += motion.by_mass * impulse, motion.spin += motion.by_inertia * cross(arm, impulse);
    report.external_work += 0.5 * dot(impulse, velocity + motion.velocity + cross(motion.spin, arm));
  }
}

double Heap::power_of(const Vec3& gravity) const {
  double power = 0;
  for (std::size_t i = 0; i < found_.all.size(); ++i)
    if (motions_[i].by_mass > 0) power += dot(gravity, motions_[i].velocity) / motions_[i].by_mass;
  return power;
}

void Heap::sweep(const Problem& problem, double h, const HeapSoftness& soft, int times) {
  const double least = h * norm(problem.gravity);
  for (int k = 0; k < times; ++k) {
    ties_.bound_resistances(problem, [&](std::uint32_t contact) { return points_.normal_impulse(contact, least); }, h);
    ties_.sweep(motions_, soft, h);
    forces_.sweep(problem, motions_, h);
    points_.sweep(motions_, soft, h);
  }
}

void Heap::move(double h) {
  for (std::size_t i = 0; i < found_.all.size(); ++i)
    if (motions_[i].by_mass > 0) found_.all[i].move(h, motions_[i]);
}

// visit(node, body, motion, arm): each point of what moves by itself, once.
template <class Visit>
void Heap::for_each_own_point(Visit visit) const {
  for (std::size_t i = 0; i < found_.all.size(); ++i) {
    const Body& body = found_.all[i];
    const Motion& motion = motions_[i];
    if (motion.by_mass == 0) continue;
    for (std::uint32_t k = 0; k < body.count; ++k)
      if (found_.owner[body.nodes[k]] == i) visit(body.nodes[k], body, motion, rotate(body.turn, body.arms[k]));
  }
}

void Heap::store_velocities(Problem& problem) const {
  for_each_own_point([&](std::uint32_t node, const Body&, const Motion& motion, const Vec3& arm) {
    problem.velocity[node] = motion.velocity + cross(motion.spin, arm);
  });
}

void Heap::store_positions(Problem& problem) const {
  for_each_own_point([&](std::uint32_t node, const Body& body, const Motion&, const Vec3& arm) {
    problem.position[node] = body.center + body.moved + arm;
  });
}

void Heap::store(Problem& problem, double h, HeapReport& report) {
  store_positions(problem), store_velocities(problem);
  ties_.store(problem, h);
  const HeapPoints::Report points = points_.store(problem, h);
  report.external_work += points.external_work, report.depth = points.depth;
}

bool Heap::has_diverged(const Problem& problem, double h, double gap_before, double gap) const {
  constexpr double far = 10;
  double fastest = h * norm(problem.gravity), reach = 0;
  for (const Vec3& v : problem.velocity) fastest = std::max(fastest, norm(v));
  for (const HeapBody& body : found_.all)
    for (std::uint32_t k = 0; k < body.count; ++k) reach = std::max(reach, norm(body.arms[k]));
  const double most = far * (h * fastest + reach) + gap_before;
  return !(gap <= gap_before + reach) ||
         !std::ranges::all_of(found_.all, [&](const HeapBody& body) { return norm(body.moved) <= most; });
}

HeapReport Heap::advance(Problem& problem, double h, double from, double fraction, int sub_steps) {
  HeapReport report;
  const double part = h / sub_steps;
  const HeapSoftness pushing(0.25 / part, part), plain;
  load_bodies(problem, part);
  points_.load(problem, found_, motions_, part, (fraction - from) / h);
  ties_.begin(problem, found_, part);
  load_grips(problem), forces_.begin();
  const auto way_at = [&](int k) { return from + (fraction - from) * k / sub_steps; };
  ties_.refresh(problem, found_, motions_, part, way_at(0), way_at(1));
  forces_.refresh(problem, found_, motions_, part, way_at(0), way_at(1));
  const double gap_before = ties_.worst_gap();
  for (int k = 0; k < sub_steps; ++k) {
    push(part, problem, report);
    points_.warm(motions_);
    ties_.warm(motions_), forces_.warm(motions_);
    sweep(problem, part, pushing, k == 0 && points_.are_new() ? first_sweeps : sweeps);
    report.external_work += forces_.work(problem, motions_);
    move(part);
    report.lifted -= part * power_of(problem.gravity);
    points_.refresh(found_, motions_, part);
    ties_.refresh(problem, found_, motions_, part, way_at(k + 1), way_at(k + 2));
    sweep(problem, part, plain, sweeps);
    report.lifted += part * power_of(problem.gravity);
    points_.add_up();
    report.external_work += ties_.add_up();
    forces_.refresh(problem, found_, motions_, part, way_at(k + 1), way_at(k + 2));
  }
  points_.rebound(motions_, h * norm(problem.gravity));
  for (const AffineConstraint& c : problem.items_of<AffineConstraint>())
    problem.position[c.nodes[0]] = c.target_start + fraction * (c.target - c.target_start);
  const double gap = ties_.worst_gap();
  const bool are_copies_apart = ties_.are_copies_apart();
  report.are_joints_met =
      ties_.project(problem, found_, motions_, part, way_at(sub_steps), way_at(sub_steps + 1), true);
  if ((!report.are_joints_met && are_copies_apart) || has_diverged(problem, h, gap_before, gap))
    return {.are_joints_met = false, .has_diverged = true};
  store(problem, h, report);
  return report;
}

}  // namespace iota::solver
