// SPDX-License-Identifier: Apache-2.0
#include "solver/heap.h"

#include "solver/pieces.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <type_traits>

namespace iota::solver {

namespace {

/// Measured with towers, pyramids and heaps of 50 to 1000 bodies (docs/contact.md): with less a tower of ten sways or falls.
constexpr int sweeps = 2;
constexpr int first_sweeps = 8;     // where contacts begin
constexpr double fastest_push = 1;  // m/s, with which an overlap ends

Vec3 unit_vector(int k) { return {k == 0 ? 1.0 : 0, k == 1 ? 1.0 : 0, k == 2 ? 1.0 : 0}; }

}  // namespace

bool Heap::find_bodies(const Problem& problem) {
  bool is_heap = problem.has_used<ContactConstraint>();
  problem.for_each_force_pool([&]<class F>(const ForcePool<F>& pool) {
    is_heap = is_heap && (std::is_same_v<F, GripForce> || pool.items.empty());
  });
  if (!is_heap || !found_.find(problem) || !ties_.find(problem, found_)) return false;
  pairs_.clear();
  const auto connect = [&](std::uint32_t a, std::uint32_t b) {
    if (a != b && a != none && b != none && !found_.all[a].is_driven && !found_.all[b].is_driven)
      pairs_.push_back({std::min(a, b), std::max(a, b)});
  };
  for (const ContactConstraint& c : problem.items_of<ContactConstraint>()) {
    const auto nodes = std::span(c.nodes).first(c.count);
    connect(found_.with(nodes.first(c.first_side > 0 ? c.first_side : c.count)),
            found_.with(nodes.subspan(c.first_side)));
  }
  ties_.for_each_pair(connect);
  std::sort(pairs_.begin(), pairs_.end());
  pairs_.erase(std::unique(pairs_.begin(), pairs_.end()), pairs_.end());
  return true;
}

// Eliminates bodies in the order of their degrees. A body costs its unknowns times the square of those of its front.
double Heap::cost_of_factor() {
  constexpr double most = 1e9;
  const auto unknowns = [&](std::uint32_t body) {  // places and lengths
    const double points = found_.all[body].count;
    return 3 * points + 0.5 * points * (points - 1);
  };
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
    found_.all[b].inertia += m * (Mat3::diagonal(dot(rp, rq)) + -1.0 * Mat3::outer(rq, rp));
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
    const SymmetricEigen eigen = symmetric_eigen(body.inertia);
    constexpr double thin = 1e-9;
    double reach = 0;
    for (std::uint32_t k = 0; k < body.count; ++k)
      reach = std::max(reach, norm(problem.position[body.nodes[k]] - body.center));
    // Shared points may give a body all its mass at one place: its inertia is round-off then.
    const double largest =
        std::max({eigen.values[0], eigen.values[1], eigen.values[2], thin * reach * reach / motion.by_mass});
    for (int k = 0; k < 3; ++k)
      if (body.count > 1 && eigen.values[k] > thin * largest)  // that of a point is round-off
        motion.by_inertia += (1 / eigen.values[k]) * Mat3::outer(eigen.axes[k], eigen.axes[k]);
    body.by_inertia_at_begin = motion.by_inertia;
    motion.spin = motion.by_inertia * angular[i];
    body.gain = h * problem.gravity;
    for (std::uint32_t k = 0; k < body.count; ++k) {
      body.arms[k] = problem.position[body.nodes[k]] - body.center;
      if (problem.force.empty()) continue;
      const Vec3 force = body.shares[k] * problem.force[body.nodes[k]];
      body.gain += (h * motion.by_mass) * force, body.turning += h * cross(body.arms[k], force);
    }
  }
  for (const BodyTorque& t : problem.torques)
    found_.all[found_.with(std::span(t.nodes).first(t.count))].turning += h * t.torque;
}

namespace {

/// The sums over the points of both bodies of a contact of weight times f(node): of the first one, and of the second one,
/// whose weights are negative.
template <class Of>
std::pair<Vec3, Vec3> sums_of(const ContactConstraint& c, std::size_t arm, std::uint32_t of_first, Of of) {
  std::pair<Vec3, Vec3> sums;
  for (std::uint32_t i = 0; i < c.count; ++i)
    (i < of_first ? sums.first : sums.second) += (i < of_first ? 1 : -1) * c.weights[arm][i] * of(c.nodes[i]);
  return sums;
}

/// A unit vector, or another one.
Vec3 unit_or(const Vec3& v, const Vec3& other) {
  const double length = norm(v);
  return length > 0 ? (1 / length) * v : other;
}

}  // namespace

void Heap::load_points(Problem& problem, double h, double rate) {
  points_.clear(), begins_.clear(), by_height_.clear();
  has_new_points_ = false;
  auto& pool = problem.pool_of<ContactConstraint>();
  const Vec3 up = unit_or(-1.0 * problem.gravity, {0, 1, 0});
  const Vec3* const x = problem.position.data();
  for (std::size_t i = 0; i < pool.items.size(); ++i) {
    const ContactConstraint& c = pool.items[i];
    Point point;
    PointBegin begin{.row = static_cast<std::uint32_t>(i), .restitution = c.restitution};
    double sum = 0;
    for (std::uint32_t k = 0; k < c.count; ++k) sum += c.weights[0][k];
    const bool has_world_point = c.first_side == 0 && sum < 0;
    const std::uint32_t of_first = c.first_side > 0 ? c.first_side : has_world_point ? 0 : c.count;
    const auto nodes = std::span(c.nodes).first(c.count);
    if (of_first > 0) point.a = found_.with(nodes.first(of_first));
    if (of_first < c.count) point.b = found_.with(nodes.subspan(of_first));
    if (!is_free(point.a) && !is_free(point.b)) continue;
    const auto place = [&](std::uint32_t node) -> const Vec3& { return x[node]; };
    auto [center, origin] = sums_of(c, 0, of_first, place);
    auto [touching, other] = sums_of(c, 1, of_first, place);
    if (has_world_point)
      center = c.constant[0], touching = c.constant_start[1];
    else if (point.b == none)
      origin = -1.0 * c.constant[0], other = -1.0 * c.constant_start[1];
    const Vec3 tangent = c.arm(3, x, 1), turned = c.arm(2, x, 1), way = center - origin;
    const Vec3 off = c.off(way, turned, tangent);
    const Vec3 normal = point.normal.way = unit_or(c.is_round ? off : turned, up);
    point.first.way = unit_or(tangent - dot(tangent, normal) * normal, any_perpendicular(normal));
    point.second.way = cross(normal, point.first.way);
    point.gap = begin.gap = c.is_round ? norm(off) - c.radius : dot(normal, way) - c.radius;
    point.friction = c.friction;
    // The point that touches is that of the middle of the step: of what rolls, it is beside where the force acts now.
    const Vec3 at = center + dot(touching - center, normal) * normal;
    const Vec3 belt = rate * (c.constant[1] - c.constant_start[1]);
    begin.drift = belt - dot(belt, normal) * normal;
    const auto drift = [&](std::uint32_t node) { return problem.velocity[node]; };
    const auto [drift_a, drift_b] = sums_of(c, 1, of_first, drift);
    const auto load_side = [&](std::uint32_t& b, const Vec3& gap_place, const Vec3& moving, double sign, Vec3& arm,
                               Vec3& gap_arm) {
      if (is_free(b)) {
        arm = at - found_.all[b].center, gap_arm = gap_place - found_.all[b].center;
        return;
      }
      if (b != none) begin.drift += sign * moving;
      b = static_cast<std::uint32_t>(found_.all.size()), begin.is_at_rest = true;
    };
    load_side(point.a, center, drift_a, 1, begin.arm_a, begin.gap_a);
    load_side(point.b, origin, drift_b, -1, begin.arm_b, begin.gap_b);
    for (Line* const line : {&point.normal, &point.first, &point.second}) line->drift = dot(begin.drift, line->way);
    turn_lines(point, begin.arm_a, begin.arm_b);
    weigh(point);
    const double* const l = pool.multiplier(i);
    const Vec3 old = -(l[1] * tangent + l[2] * c.arm(4, x, 1));
    point.normal.impulse = -h * l[0];
    point.first.impulse = h * dot(old, point.first.way), point.second.impulse = h * dot(old, point.second.way);
    begin.approach = -rate_of(point, point.normal);
    has_new_points_ = has_new_points_ || l[0] == 0;
    by_height_.push_back({-dot(at, up), static_cast<std::uint32_t>(points_.size())});
    points_.push_back(point), begins_.push_back(begin);
  }
  // From above to below: a pyramid of 55 cubes creeps by 3e-6 m a second, in the other order by 4e-4 m.
  std::sort(by_height_.begin(), by_height_.end());
  const auto order = [&](auto& items, auto& sorted) {
    sorted.clear();
    for (const auto& [height, k] : by_height_) sorted.push_back(items[k]);
    std::swap(items, sorted);
  };
  order(points_, sorted_points_), order(begins_, sorted_begins_);
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

void Heap::give(const Point& point, const Line& line, double impulse) {
  Motion &a = motions_[point.a], &b = motions_[point.b];
  a.velocity += (a.by_mass * impulse) * line.way, a.spin += impulse * line.spin_a;
  b.velocity -= (b.by_mass * impulse) * line.way, b.spin -= impulse * line.spin_b;
}

double Heap::rate_of(const Point& point, const Line& line) const {
  const Motion &a = motions_[point.a], &b = motions_[point.b];
  return line.drift + dot(line.way, a.velocity - b.velocity) + dot(line.turn_a, a.spin) - dot(line.turn_b, b.spin);
}

double Heap::power_of(const Vec3& gravity) const {
  double power = 0;
  for (std::size_t i = 0; i < found_.all.size(); ++i)
    if (motions_[i].by_mass > 0) power += dot(gravity, motions_[i].velocity) / motions_[i].by_mass;
  return power;
}

void Heap::sweep(double h, const HeapSoftness& soft, int times) {
  for (int k = 0; k < times; ++k) {
    ties_.sweep(motions_, soft, h);
    for (Point& point : points_) solve_point(point, h, soft);
  }
}

// All of it works on copies of four vectors: most of the time of a sweep is that of loads and stores.
void Heap::solve_point(Point& point, double h, const HeapSoftness& soft) {
  Motion &a = motions_[point.a], &b = motions_[point.b];
  Vec3 velocity_a = a.velocity, spin_a = a.spin, velocity_b = b.velocity, spin_b = b.spin;
  const auto rate_of = [&](const Line& line) {
    return line.drift + dot(line.way, velocity_a - velocity_b) + dot(line.turn_a, spin_a) - dot(line.turn_b, spin_b);
  };
  const auto give = [&](const Line& line, double impulse) {
    velocity_a += (a.by_mass * impulse) * line.way, spin_a += impulse * line.spin_a;
    velocity_b -= (b.by_mass * impulse) * line.way, spin_b -= impulse * line.spin_b;
  };
  Line &normal = point.normal, &first = point.first, &second = point.second;
  const double before = normal.impulse;
  double push = point.gap / h, of_mass = 1, of_impulse = 0;
  if (point.gap <= 0)
    push = std::max(soft.rate * point.gap, -fastest_push), of_mass = soft.mass, of_impulse = soft.impulse;
  normal.impulse = std::max(0.0, before - normal.mass * of_mass * (rate_of(normal) + push) - of_impulse * before);
  if (normal.impulse == 0 && before == 0) return;
  give(normal, normal.impulse - before);
  if (point.friction > 0) {
    const double before_first = first.impulse, before_second = second.impulse;
    first.impulse -= first.mass * rate_of(first), second.impulse -= second.mass * rate_of(second);
    const double most = point.friction * normal.impulse,
                 square = first.impulse * first.impulse + second.impulse * second.impulse;
    if (square > most * most) {
      const double part = most / std::sqrt(square);
      first.impulse *= part, second.impulse *= part;
    }
    give(first, first.impulse - before_first), give(second, second.impulse - before_second);
  }
  a.velocity = velocity_a, a.spin = spin_a, b.velocity = velocity_b, b.spin = spin_b;
}

// Bodies that met leave each other with a part of their speed, unless that is what gravity gives in a step.
void Heap::rebound(double least) {
  for (std::size_t i = 0; i < points_.size(); ++i) {
    const Point& point = points_[i];
    PointBegin& begin = begins_[i];
    if (begin.restitution == 0 || begin.approach <= least || begin.sum == 0) continue;
    const double missing = begin.restitution * begin.approach - rate_of(point, point.normal);
    const double impulse = std::max(0.0, point.normal.mass * missing);
    begin.sum += impulse;
    give(point, point.normal, impulse);
  }
}

// The rates of its lines by spins, and what impulses add to these, with bodies that are turned as now.
void Heap::turn_lines(Point& point, const Vec3& arm_a, const Vec3& arm_b) const {
  const Motion &a = motions_[point.a], &b = motions_[point.b];
  for (Line* const line : {&point.normal, &point.first, &point.second}) {
    if (a.by_mass > 0) line->turn_a = cross(arm_a, line->way), line->spin_a = a.by_inertia * line->turn_a;
    if (b.by_mass > 0) line->turn_b = cross(arm_b, line->way), line->spin_b = b.by_inertia * line->turn_b;
  }
}

// The masses against which its impulses act.
void Heap::weigh(Point& point) const {
  const Motion &a = motions_[point.a], &b = motions_[point.b];
  for (Line* const line : {&point.normal, &point.first, &point.second})
    line->mass = 1 / (a.by_mass + dot(line->turn_a, line->spin_a) + b.by_mass + dot(line->turn_b, line->spin_b));
}

// A thin rod that turns has another mass at the same place: with that of the begin its impulses grew without bound.
bool Heap::has_turned(std::uint32_t body) const {
  constexpr double far = 0.1;  // rad
  return body < found_.all.size() && std::abs(found_.all[body].turn.w) < 1 - far * far / 8;
}

// Gaps, and the arms of forces: both sides have theirs at one place, so that angular momentum is kept.
void Heap::refresh_points(double h) {
  const std::size_t world = found_.all.size();
  for (std::size_t i = 0; i < points_.size(); ++i) {
    Point& point = points_[i];
    PointBegin& begin = begins_[i];
    begin.drifted += h * begin.drift;
    Vec3 closing = begin.drifted;
    const auto moved = [&](std::uint32_t b, const Vec3& arm) {
      return found_.all[b].moved + found_.all[b].turned * arm - arm;
    };
    if (point.a < world) closing += moved(point.a, begin.gap_a);
    if (point.b < world) closing -= moved(point.b, begin.gap_b);
    point.gap = begin.gap + dot(point.normal.way, closing);
    const Vec3 apart = begin.is_at_rest ? Vec3{} : 0.5 * (found_.all[point.a].moved - found_.all[point.b].moved);
    turn_lines(point, begin.arm_a - apart, begin.arm_b + apart);
    if (has_turned(point.a) || has_turned(point.b)) weigh(point);
  }
}

void Heap::move(double h) {
  for (std::size_t i = 0; i < found_.all.size(); ++i) {
    Body& body = found_.all[i];
    Motion& motion = motions_[i];
    if (motion.by_mass == 0) continue;
    body.moved += h * motion.velocity;
    const Vec3 angular = body.angular_momentum(motion.spin);
    const Quaternion half = multiply(turn_by((0.5 * h) * motion.spin), body.turn);
    body.turn_to(normalized(multiply(turn_by(h * body.spin_of(angular, half)), body.turn)), angular, motion);
  }
}

void Heap::store(Problem& problem, double h, HeapReport& report) {
  for (std::size_t i = 0; i < found_.all.size(); ++i) {
    const Body& body = found_.all[i];
    const Motion& motion = motions_[i];
    if (motion.by_mass == 0) continue;
    for (std::uint32_t k = 0; k < body.count; ++k) {
      if (found_.owner[body.nodes[k]] != i) continue;
      const Vec3 arm = rotate(body.turn, body.arms[k]);
      problem.position[body.nodes[k]] = body.center + body.moved + arm;
      problem.velocity[body.nodes[k]] = motion.velocity + cross(motion.spin, arm);
    }
  }
  ties_.store(problem, h);
  auto& pool = problem.pool_of<ContactConstraint>();
  std::fill(pool.multipliers.begin(), pool.multipliers.end(), 0.0);
  for (std::size_t i = 0; i < points_.size(); ++i) {
    const Point& point = points_[i];
    const PointBegin& begin = begins_[i];
    ContactConstraint& c = pool.items[begin.row];
    double* const l = pool.multiplier(begin.row);
    const Vec3 drag = (1 / h) * (begin.sum_first * point.first.way + begin.sum_second * point.second.way);
    l[0] = -begin.sum / h;
    l[1] = -dot(drag, c.arm(3, problem.position.data(), 1)), l[2] = -dot(drag, c.arm(4, problem.position.data(), 1));
    c.is_of_sweeps = true;
    for (int r = 0; r < ContactConstraint::rows; ++r) c.impulse[r] += h * l[r];
    report.external_work -= dot(begin.sum * point.normal.way + h * drag, begin.drift);
    report.depth = std::max(report.depth, -point.gap);
  }
}

HeapReport Heap::advance(Problem& problem, double h, double from, double fraction, int sub_steps) {
  HeapReport report;
  const double part = h / sub_steps;
  const HeapSoftness pushing(0.25 / part, part), plain;
  load_bodies(problem, part);
  load_points(problem, part, (fraction - from) / h);
  ties_.begin(problem, found_, part);
  load_grips(problem);
  const auto way_at = [&](int k) { return from + (fraction - from) * k / sub_steps; };
  ties_.refresh(problem, found_, motions_, part, way_at(0), way_at(1));
  for (int k = 0; k < sub_steps; ++k) {
    push(part, problem, report);
    for (const Point& point : points_)
      for (const Line* const line : {&point.normal, &point.first, &point.second}) give(point, *line, line->impulse);
    ties_.warm(motions_);
    sweep(part, pushing, k == 0 && has_new_points_ ? first_sweeps : sweeps);
    move(part);
    report.lifted -= part * power_of(problem.gravity);
    refresh_points(part);
    ties_.refresh(problem, found_, motions_, part, way_at(k + 1), way_at(k + 2));
    sweep(part, plain, sweeps);
    report.lifted += part * power_of(problem.gravity);
    for (std::size_t i = 0; i < points_.size(); ++i) {
      begins_[i].sum += points_[i].normal.impulse;
      begins_[i].sum_first += points_[i].first.impulse, begins_[i].sum_second += points_[i].second.impulse;
    }
    report.external_work += ties_.add_up();
  }
  rebound(h * norm(problem.gravity));
  for (const AffineConstraint& c : problem.items_of<AffineConstraint>())
    problem.position[c.nodes[0]] = c.target_start + fraction * (c.target - c.target_start);
  report.are_joints_met = ties_.project(problem, found_, motions_, part, way_at(sub_steps), way_at(sub_steps + 1));
  store(problem, h, report);
  return report;
}

}  // namespace iota::solver
