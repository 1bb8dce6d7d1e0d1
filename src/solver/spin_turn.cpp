// SPDX-License-Identifier: Apache-2.0
// The rest of the angle that a step of the end-point rule has not turned.
#include "solver/spin.h"

#include <algorithm>
#include <cmath>
#include <type_traits>

namespace iota::solver {

namespace {

/// Points that turn about an axis: the angle of its points in the step, and the one that their velocities say.
class Turning {
 public:
  Turning(const Vec3& axis, const Vec3& center, const Vec3& velocity, const Vec3& chord, double h)
      : axis_(axis), center_(center), velocity_(velocity), chord_(chord), h_(h) {}

  void add(double weight, const Vec3& place, const Vec3& velocity, const Vec3& chord) {
    const Vec3 now = place - center_, before = now - h_ * (chord - chord_);
    const auto across = [&](const Vec3& a, const Vec3& b) { return dot(a, b) - dot(axis_, a) * dot(axis_, b); };
    sine_ += weight * dot(axis_, cross(before, now)), cosine_ += weight * across(before, now);
    moment_ += weight * dot(axis_, cross(now, velocity - velocity_)), inertia_ += weight * across(now, now);
  }
  /// The angle that is missing, rad; 0 if it is little, or so large that the points are at one place but for round-off: masses on
  /// ropes that are slack turned by 1e9 rad, in parts of a radian.
  double rest() const {
    constexpr double little = 1e-6, most = 1e3;
    const double said = h_ * moment_ / inertia_, turned = std::atan2(sine_, cosine_), rest = said - turned;
    return said * turned > 0 && rest * said > 0 && std::abs(rest) > little && std::abs(rest) < most ? rest : 0;
  }
  void turn(double angle, Vec3& place, Vec3& velocity) const {
    const double s = std::sin(angle), c = 1 - std::cos(angle);
    const auto by = [&](const Vec3& r) {
      const Vec3 side = cross(axis_, r);
      return r + s * side + c * cross(axis_, side);
    };
    place = center_ + by(place - center_), velocity = velocity_ + by(velocity - velocity_);
  }

 private:
  Vec3 axis_, center_, velocity_, chord_;
  double h_, sine_ = 0, cosine_ = 0, moment_ = 0, inertia_ = 0;
};

/// Turns points by an angle, in parts of at most a radian.
template <class Nodes>
void turn_points(Problem& problem, const Turning& turning, const Nodes& nodes, FunctionRef<void()> turned) {
  const double rest = turning.rest();
  const int parts = static_cast<int>(std::ceil(std::abs(rest)));
  for (int part = 0; part < parts; ++part) {
    nodes([&](std::uint32_t i) { turning.turn(rest / parts, problem.position[i], problem.velocity[i]); });
    turned();
  }
}

}  // namespace

void Spin::find_pushed(const Problem& problem) {
  is_pushed_.assign(problem.size(), 0);
  problem.for_each_force_pool([&]<class F>(const ForcePool<F>& pool) {
    if constexpr (!std::is_same_v<F, GyroscopicForce>)
      for (const auto& f : pool.items)
        for (std::uint32_t i = 0; i < f.arm.count; ++i) is_pushed_[f.arm.nodes[i]] = 1;
  });
}

void Spin::turn_on(Problem& problem, std::span<const Vec3> chords, double h, FunctionRef<void()> turned) {
  find_pushed(problem);
  const auto turn = [&](const Vec3& axis, const Vec3& center, const Vec3& velocity, const Vec3& chord,
                        const auto& nodes) {
    bool is_pushed = false;
    Turning turning(axis, center, velocity, chord, h);
    nodes([&](std::uint32_t i) {
      is_pushed = is_pushed || is_pushed_[i];
      turning.add(problem.mass[i], problem.position[i], problem.velocity[i], chords[i]);
    });
    if (!is_pushed) turn_points(problem, turning, nodes, turned);
  };
  const auto turn_part = [&](const Parts& parts, std::uint32_t k, const Vec3& axis) {
    const Part& part = parts.parts[k];
    const auto nodes = [&](auto visit) {
      for (std::uint32_t i = 0; i < problem.size(); ++i)
        if (parts.connected.of[i] == k) visit(i);
    };
    turn(axis, part.center, part.velocity(), part.chord, nodes);
  };
  const auto unit = [](const Vec3& v) { return norm(v) > 0 ? (1 / norm(v)) * v : Vec3{}; };
  find_velocities(problem, pieces_);
  // A piece that turns as one body, about its angular momentum, which stays so.
  constexpr double same = 1e-9;
  for (std::uint32_t k = 0; k < pieces_.parts.size(); ++k) {
    Part& piece = pieces_.parts[k];
    piece.is_turned = false;
    if (!piece.is_due || piece.touches) continue;  // an edge would turn into what it touches
    const Vec3 spin = turning(piece, piece.angular, problem.gravity);
    piece.is_turned = piece.kinetic - 0.5 * dot(spin, piece.angular) <= same * piece.kinetic;
    if (piece.is_turned) turn_part(pieces_, k, unit(piece.only_about(problem.gravity).value_or(piece.angular)));
  }
  // Bodies that turn about an axle at rest, its center of mass on it. It keeps the angular momentum of a free piece only if this is
  // along the axle.
  if (are_members_due_) find_velocities(problem, members_);
  for (std::uint32_t k = 0; k < members_.parts.size() && are_members_due_; ++k) {
    const Part& member = members_.parts[k];
    if (!member.is_due || supports_[k].count != 5) continue;
    const double size = dot(member.turn, member.inertia * member.turn);
    const Vec3 axis = unit(member.turn), angular = member.angular, spin = supports_[k].by_inertia * angular;
    const Part& piece = pieces_.parts[piece_of_[k]];
    const bool is_free = piece.is_free();
    if (piece.axle && piece.is_turned) continue;
    if (member.mass * dot(member.velocity_change, member.velocity_change) <= same * same * size &&
        norm(cross(spin, axis)) <= same * norm(spin) &&
        (!is_free || norm(cross(angular, axis)) <= same * norm(angular)))
      turn_part(members_, k, axis);
  }
  if (are_wheels_due_)
    wheels_.for_each_turned([&](const std::array<std::uint32_t, 2>& ends, std::span<const std::uint32_t> own) {
      const Vec3 &start = problem.position[ends[0]], &velocity = problem.velocity[ends[0]];
      const Part& piece = pieces_.of(ends[0]);
      if (piece.is_free() || piece.is_turned || !(velocity == Vec3{} && problem.velocity[ends[1]] == Vec3{})) return;
      const auto nodes = [&](auto visit) {
        for (const std::uint32_t i : own) visit(i);
      };
      turn(unit(problem.position[ends[1]] - start), start, velocity, chords[ends[0]], nodes);
    });
}

}  // namespace iota::solver
