// SPDX-License-Identifier: Apache-2.0
#include "solver/heap_points.h"

#include <algorithm>
#include <cmath>

namespace iota::solver {

namespace {

constexpr double fastest_push = 1;  // m/s, with which an overlap ends

/// The sums over the points of both bodies of a contact of weight times f(node): of the first one, and of the second one,
/// whose weights are negative.
template <class Of>
std::pair<Vec3, Vec3> sums_of(const ContactConstraint& c, std::size_t arm, std::uint32_t of_first, Of of) {
  std::pair<Vec3, Vec3> sums;
  for (std::uint32_t i = 0; i < c.count; ++i)
    (i < of_first ? sums.first : sums.second) += (i < of_first ? 1 : -1) * c.weights[arm][i] * of(c.nodes[i]);
  return sums;
}

}  // namespace

/// The motions of both sides of a pack.
class HeapPoints::Sides {
 public:
  // The first four numbers of a motion are a velocity and a mass, the next four are a spin and one of the inertia.
  IOTA_ALWAYS_INLINE Sides(const Pack& pack, HeapMotion* motions)
      : pack_(pack),
        motions_(motions),
        velocity_a_(gather(motions, pack.a, 0)),
        spin_a_(gather(motions, pack.a, 1)),
        velocity_b_(gather(motions, pack.b, 0)),
        spin_b_(gather(motions, pack.b, 1)) {}
  IOTA_ALWAYS_INLINE void store() const {
    scatter(velocity_a_, motions_, pack_.a, 0), scatter(spin_a_, motions_, pack_.a, 1);
    scatter(velocity_b_, motions_, pack_.b, 0), scatter(spin_b_, motions_, pack_.b, 1);
  }
  IOTA_ALWAYS_INLINE Lanes rate(const Line& line) const {
    return line.drift + dot(line.way, velocity_a_.first_three() - velocity_b_.first_three()) +
           dot(line.turn_a, spin_a_.first_three()) - dot(line.turn_b, spin_b_.first_three());
  }
  IOTA_ALWAYS_INLINE void give(const Line& line, const Lanes& impulse) {
    add(velocity_a_, pack_.by_mass_a * impulse, line.way), add(spin_a_, impulse, line.spin_a);
    add(velocity_b_, -(pack_.by_mass_b * impulse), line.way), add(spin_b_, -impulse, line.spin_b);
  }

 private:
  IOTA_ALWAYS_INLINE static void add(FourLanes& four, const Lanes& factor, const Vec3Lanes& v) {
    four[0] += factor * v.x, four[1] += factor * v.y, four[2] += factor * v.z;
  }
  const Pack& pack_;
  HeapMotion* motions_;
  FourLanes velocity_a_, spin_a_, velocity_b_, spin_b_;
};

// False if nothing free touches.
bool HeapPoints::load_point(const Problem& problem, const HeapBodies& bodies, std::span<const HeapMotion> motions,
                            std::size_t item, double rate, const Vec3& up, Point& point) const {
  const ContactConstraint& c = problem.items_of<ContactConstraint>()[item];
  const Vec3* const x = problem.position.data();
  const auto is_free = [&](std::uint32_t body) { return body != none && motions[body].by_mass > 0; };
  double sum = 0;
  for (std::uint32_t k = 0; k < c.count; ++k) sum += c.weights[0][k];
  const bool has_world_point = c.first_side == 0 && sum < 0;
  const std::uint32_t of_first = c.first_side > 0 ? c.first_side : has_world_point ? 0 : c.count;
  const auto nodes = std::span(c.nodes).first(c.count);
  if (of_first > 0) point.a = bodies.with(nodes.first(of_first));
  if (of_first < c.count) point.b = bodies.with(nodes.subspan(of_first));
  if (!is_free(point.a) && !is_free(point.b)) return false;
  const auto place = [&](std::uint32_t node) -> const Vec3& { return x[node]; };
  auto [center, origin] = sums_of(c, 0, of_first, place);
  auto [touching, other] = sums_of(c, 1, of_first, place);
  if (has_world_point)
    center = c.constant[0], touching = c.constant_start[1];
  else if (point.b == none)
    origin = -1.0 * c.constant[0], other = -1.0 * c.constant_start[1];
  const Vec3 tangent = c.arm(3, x, 1), turned = c.arm(2, x, 1), way = center - origin;
  const Vec3 off = c.off(way, turned, tangent);
  const Vec3 normal = unit_or(c.is_round ? off : turned, up);
  const Vec3 first = unit_or(tangent - dot(tangent, normal) * normal, any_perpendicular(normal));
  point.ways = {normal, first, cross(normal, first)};
  point.gap = c.is_round ? norm(off) - c.radius : dot(normal, way) - c.radius;
  point.row = static_cast<std::uint32_t>(item), point.friction = c.friction, point.restitution = c.restitution;
  // The point that touches is that of the middle of the step: of what rolls, it is beside where the force acts now.
  const Vec3 at = center + dot(touching - center, normal) * normal;
  const Vec3 belt = rate * (c.constant[1] - c.constant_start[1]);
  point.drift = belt - dot(belt, normal) * normal;
  const auto velocity = [&](std::uint32_t node) { return problem.velocity[node]; };
  const auto [drift_a, drift_b] = sums_of(c, 1, of_first, velocity);
  const auto load_side = [&](std::uint32_t& b, const Vec3& gap_place, const Vec3& moving, double sign, Vec3& arm,
                             Vec3& gap_arm) {
    if (is_free(b)) {
      arm = at - bodies.all[b].center, gap_arm = gap_place - bodies.all[b].center;
      return;
    }
    if (b != none) point.drift += sign * moving;
    b = static_cast<std::uint32_t>(bodies.all.size()), point.is_at_rest = true;
  };
  load_side(point.a, center, drift_a, 1, point.arm_a, point.gap_a);
  load_side(point.b, origin, drift_b, -1, point.arm_b, point.gap_b);
  const double* const l = problem.pool_of<ContactConstraint>().multiplier(item);
  const Vec3 drag = -(l[1] * tangent + l[2] * c.arm(4, x, 1));
  point.forces = {-l[0], dot(drag, point.ways[1]), dot(drag, point.ways[2])};
  point.height = dot(at, up);
  return true;
}

void HeapPoints::load(const Problem& problem, const HeapBodies& bodies, std::span<HeapMotion> motions, double h,
                      double rate) {
  points_.clear(), by_height_.clear();
  are_new_ = false;
  const Vec3 up = unit_or(-1.0 * problem.gravity, {0, 1, 0});
  places_.assign(problem.items_of<ContactConstraint>().size(), {});
  for (std::size_t i = 0; i < places_.size(); ++i) {
    Point point;
    if (!load_point(problem, bodies, motions, i, rate, up, point)) continue;
    are_new_ = are_new_ || point.forces[0] == 0;
    by_height_.push_back({-point.height, static_cast<std::uint32_t>(points_.size())});
    points_.push_back(point);
  }
  // From above to below: a pyramid of 55 cubes creeps by 3e-6 m a second, in the other order by 4e-4 m.
  std::sort(by_height_.begin(), by_height_.end());
  pack(motions, h);
  stands_.assign(motions.size(), {});
  turn_lines(motions, true);
  for (std::size_t i = 0; i < packs_.size(); ++i)
    begins_[i].approach = -Sides(packs_[i], motions.data()).rate(packs_[i].normal);
}

// A point takes the first pack with room after those of its bodies.
void HeapPoints::pack(std::span<const HeapMotion> motions, double h) {
  packs_.clear(), begins_.clear(), with_room_.assign(1, 0);
  next_of_body_.assign(motions.size(), 0);
  const auto world = static_cast<std::uint32_t>(motions.size() - 1);
  const auto find_room = [&](std::uint32_t pack) {
    while (with_room_[pack] != pack) pack = with_room_[pack] = with_room_[with_room_[pack]];
    return pack;
  };
  for (const auto& [height, k] : by_height_) {
    const Point& point = points_[k];
    const std::uint32_t number = find_room(std::max(next_of_body_[point.a], next_of_body_[point.b]));
    if (number == packs_.size()) {
      packs_.emplace_back(), begins_.emplace_back();
      packs_.back().a.fill(world), packs_.back().b.fill(world);
      with_room_.push_back(number + 1);
    }
    for (const std::uint32_t body : {point.a, point.b})
      if (body != world) next_of_body_[body] = number + 1;
    Pack& pack = packs_[number];
    PackBegin& begin = begins_[number];
    const int lane = begin.count++;
    if (begin.count == lane_count) with_room_[number] = number + 1;
    pack.a[lane] = point.a, pack.b[lane] = point.b;
    pack.by_mass_a[lane] = motions[point.a].by_mass, pack.by_mass_b[lane] = motions[point.b].by_mass;
    pack.friction[lane] = point.friction, pack.gap[lane] = begin.gap[lane] = point.gap;
    Line* const lines[] = {&pack.normal, &pack.first, &pack.second};
    for (int r = 0; r < 3; ++r) {
      lines[r]->way.set(lane, point.ways[r]);
      lines[r]->drift[lane] = dot(point.drift, point.ways[r]), lines[r]->impulse[lane] = h * point.forces[r];
    }
    places_[point.row] = {number, lane};
    begin.rows[lane] = point.row, begin.half[lane] = point.is_at_rest ? 0 : 0.5;
    begin.restitution[lane] = point.restitution;
    begin.arm_a.set(lane, point.arm_a), begin.arm_b.set(lane, point.arm_b);
    begin.gap_a.set(lane, point.gap_a), begin.gap_b.set(lane, point.gap_b);
    begin.drift.set(lane, point.drift);
  }
}

IOTA_WIDER void HeapPoints::warm(std::span<HeapMotion> motions) const {
  for (const Pack& pack : packs_) {
    Sides sides(pack, motions.data());
    for (const Line* const line : {&pack.normal, &pack.first, &pack.second}) sides.give(*line, line->impulse);
    sides.store();
  }
}

IOTA_WIDER void HeapPoints::sweep(std::span<HeapMotion> motions, const HeapSoftness& soft, double h) {
  const Lanes zero = lanes_of(0), one = lanes_of(1);
  for (Pack& pack : packs_) {
    Sides sides(pack, motions.data());
    Line &normal = pack.normal, &first = pack.first, &second = pack.second;
    const LaneMask is_open = pack.gap > 0;
    const Lanes push = select(is_open, pack.gap / h, largest(soft.rate * pack.gap, lanes_of(-fastest_push)));
    const Lanes of_mass = select(is_open, one, lanes_of(soft.mass)),
                of_impulse = select(is_open, zero, lanes_of(soft.impulse));
    const Lanes before = normal.impulse;
    normal.impulse = largest(zero, before - normal.mass * of_mass * (sides.rate(normal) + push) - of_impulse * before);
    if (!any((normal.impulse != 0) | (before != 0))) continue;
    sides.give(normal, normal.impulse - before);
    const Lanes before_first = first.impulse, before_second = second.impulse;
    first.impulse -= first.mass * sides.rate(first), second.impulse -= second.mass * sides.rate(second);
    const Lanes most = pack.friction * normal.impulse,
                square = first.impulse * first.impulse + second.impulse * second.impulse;
    const LaneMask slips = square > most * most;
    if (any(slips)) {
      const Lanes part = select(slips, most / square_root(square), one);
      first.impulse *= part, second.impulse *= part;
    }
    sides.give(first, first.impulse - before_first), sides.give(second, second.impulse - before_second);
    sides.store();
  }
}

IOTA_WIDER void HeapPoints::rebound(std::span<HeapMotion> motions, double least) {
  for (std::size_t i = 0; i < packs_.size(); ++i) {
    PackBegin& begin = begins_[i];
    const LaneMask rebounds = (begin.restitution != 0) & (begin.approach > least) & (begin.sum != 0);
    if (!any(rebounds)) continue;
    Sides sides(packs_[i], motions.data());
    const Lanes missing = begin.restitution * begin.approach - sides.rate(packs_[i].normal);
    const Lanes impulse = select(rebounds, largest(lanes_of(0), packs_[i].normal.mass * missing), lanes_of(0));
    begin.sum += impulse;
    sides.give(packs_[i].normal, impulse);
    sides.store();
  }
}

// Both sides have the arms of forces at one place, so that angular momentum is kept. A thin rod that turns has another mass at the
// same place: with that of the begin its impulses grew without bound.
IOTA_WIDER void HeapPoints::turn_lines(std::span<const HeapMotion> motions, bool weighs_all) {
  constexpr double far = 0.1;  // rad
  for (std::size_t i = 0; i < packs_.size(); ++i) {
    Pack& pack = packs_[i];
    PackBegin& begin = begins_[i];
    struct Side {
      Vec3Lanes moved, gap;  ///< of the center; of the place that has the gap
      Lanes turn_w;
      Mat3Lanes by_inertia;
    };
    const auto side = [&](const LaneNumbers& bodies, const Vec3Lanes& arm) __attribute__((always_inline)) {
      const Stand* const stands = stands_.data();
      const FourLanes s0 = gather(stands, bodies, 0), s1 = gather(stands, bodies, 1), s2 = gather(stands, bodies, 2),
                      s3 = gather(stands, bodies, 3);
      const FourLanes m1 = gather(motions.data(), bodies, 1), m2 = gather(motions.data(), bodies, 2),
                      m3 = gather(motions.data(), bodies, 3);
      const Vec3Lanes moved = s0.first_three();
      const Mat3Lanes turned{{{s1[0], s1[1], s1[2]}, {s1[3], s2[0], s2[1]}, {s2[2], s2[3], s3[0]}}};
      return Side{moved, moved + turned * arm - arm, select(s0[3] < 0, -s0[3], s0[3]),
                  Mat3Lanes{{{m1[3], m2[0], m2[1]}, {m2[2], m2[3], m3[0]}, {m3[1], m3[2], m3[3]}}}};
    };
    const Side a = side(pack.a, begin.gap_a), b = side(pack.b, begin.gap_b);
    pack.gap = begin.gap + dot(pack.normal.way, begin.drifted + a.gap - b.gap);
    const Vec3Lanes apart = begin.half * (a.moved - b.moved);
    const Vec3Lanes arm_a = begin.arm_a - apart, arm_b = begin.arm_b + apart;
    const Lanes unturned = lanes_of(1 - far * far / 8);
    const LaneMask weighs = (a.turn_w < unturned) | (b.turn_w < unturned);
    for (Line* const line : {&pack.normal, &pack.first, &pack.second}) {
      line->turn_a = cross(arm_a, line->way), line->spin_a = a.by_inertia * line->turn_a;
      line->turn_b = cross(arm_b, line->way), line->spin_b = b.by_inertia * line->turn_b;
      if (!weighs_all && !any(weighs)) continue;
      const Lanes by_mass =
          pack.by_mass_a + dot(line->turn_a, line->spin_a) + pack.by_mass_b + dot(line->turn_b, line->spin_b);
      line->mass = weighs_all ? select(by_mass > 0, 1 / by_mass, lanes_of(0)) : select(weighs, 1 / by_mass, line->mass);
    }
  }
}

void HeapPoints::refresh(const HeapBodies& bodies, std::span<const HeapMotion> motions, double h) {
  for (std::size_t i = 0; i < bodies.all.size(); ++i) {
    const HeapBody& body = bodies.all[i];
    if (motions[i].by_mass > 0)
      stands_[i].moved = body.moved, stands_[i].turn_w = body.turn.w, stands_[i].turned = body.turned;
  }
  for (PackBegin& begin : begins_) begin.drifted = begin.drifted + lanes_of(h) * begin.drift;
  turn_lines(motions, false);
}

void HeapPoints::add_up() {
  for (std::size_t i = 0; i < packs_.size(); ++i) {
    begins_[i].sum += packs_[i].normal.impulse;
    begins_[i].sum_first += packs_[i].first.impulse, begins_[i].sum_second += packs_[i].second.impulse;
  }
}

HeapPoints::Report HeapPoints::store(Problem& problem, double h) const {
  Report report;
  auto& pool = problem.pool_of<ContactConstraint>();
  std::fill(pool.multipliers.begin(), pool.multipliers.end(), 0.0);
  for (std::size_t i = 0; i < packs_.size(); ++i)
    for (int lane = 0; lane < begins_[i].count; ++lane) {
      const Pack& pack = packs_[i];
      const PackBegin& begin = begins_[i];
      ContactConstraint& c = pool.items[begin.rows[lane]];
      double* const l = pool.multiplier(begin.rows[lane]);
      const Vec3 drag = (1 / h) * (begin.sum_first[lane] * pack.first.way.at(lane) +
                                   begin.sum_second[lane] * pack.second.way.at(lane));
      l[0] = -begin.sum[lane] / h;
      l[1] = -dot(drag, c.arm(3, problem.position.data(), 1)), l[2] = -dot(drag, c.arm(4, problem.position.data(), 1));
      c.is_of_sweeps = true, c.is_strained = false;
      for (int r = 0; r < ContactConstraint::rows; ++r) c.impulse[r] += h * l[r];
      report.external_work -= dot(begin.sum[lane] * pack.normal.way.at(lane) + h * drag, begin.drift.at(lane));
      report.depth = std::max(report.depth, -pack.gap[lane]);
    }
  return report;
}

}  // namespace iota::solver
