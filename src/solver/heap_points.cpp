// SPDX-License-Identifier: Apache-2.0
#include "solver/heap_points.h"

#include <algorithm>
#include <cmath>

namespace iota::solver {

namespace {

constexpr double fastest_push = 1;  // m/s, with which an overlap ends

/// The sums over the points of both bodies of a contact of weight times place: of the first one, and of the second one, whose weights
/// are negative; and its arms that turn.
struct PlacesOfContact {
  Vec3 center, origin, touching, other;
  std::array<Vec3, 3> turned;

  PlacesOfContact(const ContactConstraint& c, const Vec3* x, std::uint32_t of_first) {
    for (std::size_t k = 0; k < 3; ++k) turned[k] = c.constant[2 + k];
    for (std::uint32_t i = 0; i < c.count; ++i) {
      const Vec3& place = x[c.nodes[i]];
      if (i < of_first)
        center += c.weights[0][i] * place, touching += c.weights[1][i] * place;
      else
        origin -= c.weights[0][i] * place, other -= c.weights[1][i] * place;
      if (i < c.turning_begin || i >= c.turning_end) continue;
      for (std::size_t k = 0; k < 3; ++k) turned[k] += c.weights[2 + k][i] * place;
    }
  }
};

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
  /// The velocity of the first body against the second one at the place, m/s.
  IOTA_ALWAYS_INLINE Vec3Lanes rate() const {
    return velocity_a_.first_three() - velocity_b_.first_three() + cross(spin_a_.first_three(), pack_.arm_a) -
           cross(spin_b_.first_three(), pack_.arm_b) + pack_.drift;
  }
  /// The first body gets the impulse, N s, the second one the opposite at the same place, so that angular momentum is kept.
  IOTA_ALWAYS_INLINE void give(const Vec3Lanes& impulse) {
    const Vec3Lanes turn_a = cross(pack_.arm_a, impulse), turn_b = cross(pack_.arm_b, impulse);
    add(velocity_a_, pack_.by_mass_a * impulse), add(velocity_b_, lanes_of(0) - pack_.by_mass_b, impulse);
    if (pack_.is_even) return add(spin_a_, spin_a_[3], turn_a), add(spin_b_, lanes_of(0) - spin_b_[3], turn_b);
    add(spin_a_, by_inertia_of(pack_.a, spin_a_) * turn_a);
    add(spin_b_, lanes_of(-1), by_inertia_of(pack_.b, spin_b_) * turn_b);
  }
  IOTA_ALWAYS_INLINE Mat3Lanes by_inertia_of_a() const { return by_inertia_of(pack_.a, spin_a_); }
  IOTA_ALWAYS_INLINE Mat3Lanes by_inertia_of_b() const { return by_inertia_of(pack_.b, spin_b_); }

 private:
  IOTA_ALWAYS_INLINE Mat3Lanes by_inertia_of(const LaneNumbers& bodies, const FourLanes& spin) const {
    const FourLanes m2 = gather(motions_, bodies, 2), m3 = gather(motions_, bodies, 3);
    return {{{spin[3], m2[0], m2[1]}, {m2[2], m2[3], m3[0]}, {m3[1], m3[2], m3[3]}}};
  }
  IOTA_ALWAYS_INLINE static void add(FourLanes& four, const Vec3Lanes& v) {
    four[0] += v.x, four[1] += v.y, four[2] += v.z;
  }
  IOTA_ALWAYS_INLINE static void add(FourLanes& four, const Lanes& factor, const Vec3Lanes& v) {
    add(four, factor * v);
  }
  const Pack& pack_;
  HeapMotion* motions_;
  FourLanes velocity_a_, spin_a_, velocity_b_, spin_b_;
};

namespace {

IOTA_ALWAYS_INLINE Vec3Lanes sum_of(const Lanes (&parts)[3], const std::array<Vec3Lanes, 3>& ways) {
  return parts[0] * ways[0] + (parts[1] * ways[1] + parts[2] * ways[2]);
}

}  // namespace

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
  PlacesOfContact places(c, x, of_first);
  auto& [center, origin, touching, other, arms] = places;
  if (has_world_point)
    center = c.constant[0], touching = c.constant_start[1];
  else if (point.b == none)
    origin = -1.0 * c.constant[0], other = -1.0 * c.constant_start[1];
  const auto& [turned, tangent, second] = arms;
  const Vec3 way = center - origin, off = c.off(way, turned, tangent);
  const Vec3 normal = unit_or(c.is_round ? off : turned, up);
  const Vec3 first = unit_or(tangent - dot(tangent, normal) * normal, any_perpendicular(normal));
  point.ways = {normal, first, cross(normal, first)};
  point.gap = c.is_round ? norm(off) - c.radius : dot(normal, way) - c.radius;
  point.row = static_cast<std::uint32_t>(item), point.friction = c.friction, point.restitution = c.restitution;
  // The point that touches is that of the middle of the step: of what rolls, it is beside where the force acts now.
  const Vec3 at = center + dot(touching - center, normal) * normal;
  const Vec3 belt = rate * (c.constant[1] - c.constant_start[1]);
  point.drift = belt - dot(belt, normal) * normal;
  const auto velocity_of = [&](std::uint32_t begin, std::uint32_t end) {
    Vec3 velocity;
    for (std::uint32_t i = begin; i < end; ++i) velocity += c.weights[1][i] * problem.velocity[c.nodes[i]];
    return velocity;
  };
  const auto load_side = [&](std::uint32_t& b, const Vec3& gap_place, std::uint32_t begin, std::uint32_t end, Vec3& arm,
                             Vec3& gap_arm) {
    if (is_free(b)) {
      arm = at - bodies.all[b].center, gap_arm = gap_place - bodies.all[b].center;
      return;
    }
    if (b != none) point.drift += velocity_of(begin, end);
    b = static_cast<std::uint32_t>(bodies.all.size()), point.is_at_rest = true;
  };
  load_side(point.a, center, 0, of_first, point.arm_a, point.gap_a);
  load_side(point.b, origin, of_first, c.count, point.arm_b, point.gap_b);
  const double* const l = problem.pool_of<ContactConstraint>().multiplier(item);
  const Vec3 drag = -(l[1] * tangent + l[2] * second);
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
  pack(bodies, motions, h);
  stands_.assign(motions.size(), {});
  for (std::size_t i = 0; i < packs_.size(); ++i) {
    weigh(packs_[i], motions.data(), lanes_of(0) == lanes_of(0));
    begins_[i].approach = -dot(packs_[i].ways[0], Sides(packs_[i], motions.data()).rate());
  }
}

// A point takes the first pack with room after those of its bodies.
void HeapPoints::pack(const HeapBodies& bodies, std::span<const HeapMotion> motions, double h) {
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
    for (const std::uint32_t body : {point.a, point.b})
      pack.is_even = pack.is_even && (body == world || bodies.all[body].is_even);
    for (std::size_t r = 0; r < 3; ++r)
      pack.ways[r].set(lane, point.ways[r]), pack.impulses[r][lane] = h * point.forces[r];
    pack.drift.set(lane, point.drift), pack.arm_a.set(lane, point.arm_a), pack.arm_b.set(lane, point.arm_b);
    places_[point.row] = {number, lane};
    begin.rows[lane] = point.row, begin.half[lane] = point.is_at_rest ? 0 : 0.5;
    begin.restitution[lane] = point.restitution;
    begin.arm_a.set(lane, point.arm_a), begin.arm_b.set(lane, point.arm_b);
    begin.gap_a.set(lane, point.gap_a), begin.gap_b.set(lane, point.gap_b);
  }
}

IOTA_WIDER void HeapPoints::warm(std::span<HeapMotion> motions) const {
  for (const Pack& pack : packs_) {
    Sides sides(pack, motions.data());
    sides.give(sum_of(pack.impulses, pack.ways));
    sides.store();
  }
}

// Both directions of friction are solved by the rates that the normal impulse leaves, which by_normal tells.
IOTA_WIDER void HeapPoints::sweep(std::span<HeapMotion> motions, const HeapSoftness& soft, double h) {
  const Lanes zero = lanes_of(0), one = lanes_of(1);
  for (Pack& pack : packs_) {
    Sides sides(pack, motions.data());
    const Vec3Lanes rate = sides.rate();
    const LaneMask is_open = pack.gap > 0;
    const Lanes push = select(is_open, pack.gap / h, largest(soft.rate * pack.gap, lanes_of(-fastest_push)));
    const Lanes of_mass = select(is_open, one, lanes_of(soft.mass)),
                of_impulse = select(is_open, zero, lanes_of(soft.impulse));
    const Lanes before = pack.impulses[0];
    const Lanes normal =
        largest(zero, before - pack.masses[0] * of_mass * (dot(pack.ways[0], rate) + push) - of_impulse * before);
    if (!any((normal != 0) | (before != 0))) continue;
    const Lanes change = normal - before;
    Lanes first = pack.impulses[1] - pack.masses[1] * (dot(pack.ways[1], rate) + pack.by_normal[0] * change),
          second = pack.impulses[2] - pack.masses[2] * (dot(pack.ways[2], rate) + pack.by_normal[1] * change);
    const Lanes most = pack.friction * normal, square = first * first + second * second;
    const LaneMask slips = square > most * most;
    if (any(slips)) {
      const Lanes part = select(slips, most / square_root(square), one);
      first *= part, second *= part;
    }
    sides.give(sum_of({change, first - pack.impulses[1], second - pack.impulses[2]}, pack.ways));
    pack.impulses[0] = normal, pack.impulses[1] = first, pack.impulses[2] = second;
    sides.store();
  }
}

IOTA_WIDER void HeapPoints::rebound(std::span<HeapMotion> motions, double least) {
  for (std::size_t i = 0; i < packs_.size(); ++i) {
    PackBegin& begin = begins_[i];
    const Pack& pack = packs_[i];
    const LaneMask rebounds = (begin.restitution != 0) & (begin.approach > least) & (begin.sums[0] != 0);
    if (!any(rebounds)) continue;
    Sides sides(pack, motions.data());
    const Lanes missing = begin.restitution * begin.approach - dot(pack.ways[0], sides.rate());
    const Lanes impulse = select(rebounds, largest(lanes_of(0), pack.masses[0] * missing), lanes_of(0));
    begin.sums[0] += impulse;
    sides.give(impulse * pack.ways[0]);
    sides.store();
  }
}

IOTA_WIDER void HeapPoints::weigh(Pack& pack, const HeapMotion* motions, const LaneMask& which) {
  const Sides sides(pack, const_cast<HeapMotion*>(motions));
  const Mat3Lanes of_a = sides.by_inertia_of_a(), of_b = sides.by_inertia_of_b();
  std::array<Vec3Lanes, 3> turns_a, turns_b;
  for (std::size_t r = 0; r < 3; ++r)
    turns_a[r] = cross(pack.arm_a, pack.ways[r]), turns_b[r] = cross(pack.arm_b, pack.ways[r]);
  for (std::size_t r = 0; r < 3; ++r) {
    const Vec3Lanes spin_a = of_a * turns_a[r], spin_b = of_b * turns_b[r];
    const Lanes by_mass = pack.by_mass_a + dot(turns_a[r], spin_a) + pack.by_mass_b + dot(turns_b[r], spin_b);
    pack.masses[r] = select(which, select(by_mass > 0, 1 / by_mass, lanes_of(0)), pack.masses[r]);
    if (r > 0) continue;
    for (std::size_t k = 0; k < 2; ++k)
      pack.by_normal[k] = select(which, dot(turns_a[1 + k], spin_a) + dot(turns_b[1 + k], spin_b), pack.by_normal[k]);
  }
}

// Both sides have the arms of forces at one place, so that angular momentum is kept. A thin rod that turns has another mass at the
// same place: with that of the begin its impulses grew without bound.
IOTA_WIDER void HeapPoints::turn(std::span<const HeapMotion> motions) {
  constexpr double far = 0.1;  // rad
  const Lanes unturned = lanes_of(1 - far * far / 8);
  for (std::size_t i = 0; i < packs_.size(); ++i) {
    Pack& pack = packs_[i];
    const PackBegin& begin = begins_[i];
    struct Side {
      Vec3Lanes moved, gap;  ///< of the center; of the place that has the gap
      Lanes turn_w;
    };
    const auto side = [&](const LaneNumbers& bodies, const Vec3Lanes& arm) __attribute__((always_inline)) {
      const Stand* const stands = stands_.data();
      const FourLanes s0 = gather(stands, bodies, 0), s1 = gather(stands, bodies, 1), s2 = gather(stands, bodies, 2),
                      s3 = gather(stands, bodies, 3);
      const Vec3Lanes moved = s0.first_three();
      const Mat3Lanes turned{{{s1[0], s1[1], s1[2]}, {s1[3], s2[0], s2[1]}, {s2[2], s2[3], s3[0]}}};
      return Side{moved, moved + turned * arm - arm, select(s0[3] < 0, -s0[3], s0[3])};
    };
    const Side a = side(pack.a, begin.gap_a), b = side(pack.b, begin.gap_b);
    pack.gap = begin.gap + dot(pack.ways[0], begin.drifted + a.gap - b.gap);
    const Vec3Lanes apart = begin.half * (a.moved - b.moved);
    pack.arm_a = begin.arm_a - apart, pack.arm_b = begin.arm_b + apart;
    const LaneMask turns = (a.turn_w < unturned) | (b.turn_w < unturned);
    if (any(turns)) weigh(pack, motions.data(), turns);
  }
}

void HeapPoints::refresh(const HeapBodies& bodies, std::span<const HeapMotion> motions, double h) {
  for (std::size_t i = 0; i < bodies.all.size(); ++i) {
    const HeapBody& body = bodies.all[i];
    if (motions[i].by_mass > 0)
      stands_[i].moved = body.moved, stands_[i].turn_w = body.turn.w, stands_[i].turned = body.turned;
  }
  for (std::size_t i = 0; i < packs_.size(); ++i)
    begins_[i].drifted = begins_[i].drifted + lanes_of(h) * packs_[i].drift;
  turn(motions);
}

void HeapPoints::add_up() {
  for (std::size_t i = 0; i < packs_.size(); ++i)
    for (std::size_t r = 0; r < 3; ++r) begins_[i].sums[r] += packs_[i].impulses[r];
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
      const Vec3 drag =
          (1 / h) * (begin.sums[1][lane] * pack.ways[1].at(lane) + begin.sums[2][lane] * pack.ways[2].at(lane));
      l[0] = -begin.sums[0][lane] / h;
      l[1] = -dot(drag, c.arm(3, problem.position.data(), 1)), l[2] = -dot(drag, c.arm(4, problem.position.data(), 1));
      c.is_of_sweeps = true, c.is_strained = false;
      for (int r = 0; r < ContactConstraint::rows; ++r) c.impulse[r] += h * l[r];
      report.external_work -= dot(begin.sums[0][lane] * pack.ways[0].at(lane) + h * drag, pack.drift.at(lane));
      report.depth = std::max(report.depth, -pack.gap[lane]);
    }
  return report;
}

}  // namespace iota::solver
