// SPDX-License-Identifier: Apache-2.0
#include "solver/spin.h"

#include "solver/pieces.h"

#include <algorithm>
#include <cmath>

namespace iota::solver {

namespace {

/// visit(mass, a, b): the entries of the mass matrix; those beside the diagonal twice.
template <class Visit>
void for_each_mass(const Problem& problem, Visit visit) {
  for (std::uint32_t i = 0; i < problem.size(); ++i) visit(problem.mass[i], i, i);
  for (const auto& c : problem.mass_couplings) visit(c.mass, c.a, c.b), visit(c.mass, c.b, c.a);
}

/// The largest share s <= 1 of a change of velocities, whose energy is first s + second s^2, with a gain up to a limit.
double largest_share(double first, double second, double limit) {
  if (!(first + second > limit)) return 1;
  return (std::sqrt(first * first + 4 * second * limit) - first) / (2 * second + 1e-300);
}

}  // namespace

// Structure is searched once, who holds a piece at each step, as nails move.
void Spin::find_holds(const Problem& problem, const Holds& all) {
  if (piece_of_.size() != problem.size()) pieces_.resize(find_pieces(problem, Connection::rows, piece_of_));
  for (Piece& piece : pieces_) piece.holds = {};
  if (pieces_.size() == 1)
    pieces_.front().holds = all;
  else
    problem.for_each_constraint_pool([&](const auto& pool) {
      for (const auto& c : pool.items) pieces_[piece_of_[pool.nodes_of(c).front()]].holds.add(c);
    });
  for (Piece& piece : pieces_) piece.is_kept = piece.holds.are_none() || piece.holds.pivot();
}

// The end-point rule gives sum m x1 x (v1 - v0) = h moment, that is L1 - L0 = h moment + h sum m v1 x v0.
bool Spin::find_losses(const Problem& problem, std::span<const Vec3> displacement, double h) {
  constexpr double round_off = 1e-13;
  const auto start_velocity = [&](std::uint32_t i) { return problem.velocity[i] - (1 / h) * displacement[i]; };
  for (Piece& piece : pieces_) {
    piece.mass = piece.kinetic = 0;
    piece.center = piece.momentum = piece.wanted_momentum = piece.lost = {};
  }
  const auto add = [&](Piece& piece, double mass, std::uint32_t i, const Vec3& start) {
    const Vec3& v = problem.velocity[i];
    piece.mass += mass;
    piece.center += mass * problem.position[i];
    piece.momentum += mass * v, piece.wanted_momentum += mass * start;
  };
  for (std::uint32_t i = 0; i < problem.size(); ++i) {
    Piece& piece = pieces_[piece_of_[i]];
    const Vec3 &v = problem.velocity[i], start = start_velocity(i);
    const double mass = problem.mass[i];
    add(piece, mass, i, start);
    piece.lost += (mass * h) * cross(v, start), piece.kinetic += mass * dot(v, v);
  }
  for (const auto& c : problem.mass_couplings) {
    Piece& piece = pieces_[piece_of_[c.a]];
    const Vec3 start_a = start_velocity(c.a), start_b = start_velocity(c.b);
    add(piece, c.mass, c.a, start_a), add(piece, c.mass, c.b, start_b);
    piece.lost += (c.mass * h) * (cross(problem.velocity[c.a], start_b) + cross(problem.velocity[c.b], start_a));
  }
  for (const GyroscopicForce& f :
       problem.items_of<GyroscopicForce>()) {  // its moment should be minus the change of the spin
    const auto start = [&](std::uint32_t i) { return problem.position[i] - h * problem.velocity[i]; };
    const Vec3 e1 = f.arm.value(problem.position.data()), e0 = start(f.arm.nodes[1]) - start(f.arm.nodes[0]);
    pieces_[piece_of_[f.arm.nodes[0]]].lost += cross(e1, h * f.force(e0, e1, {h, false, false})) + f.spin * (e1 - e0);
  }
  bool any = false;
  for (Piece& piece : pieces_) {
    piece.is_due = piece.is_kept && piece.mass > 0;
    if (!piece.is_due) continue;
    if (const auto pivot = piece.holds.pivot()) {
      piece.center = *pivot;
      const double g = dot(problem.gravity, problem.gravity);  // which changes the other components
      if (g > 0) piece.lost = (dot(piece.lost, problem.gravity) / g) * problem.gravity;
    } else {
      piece.center *= 1 / piece.mass;
      piece.lost -= (h / piece.mass) * cross(piece.momentum, piece.wanted_momentum);
    }
    piece.is_due = norm(piece.lost) > round_off * h * piece.kinetic;
    any = any || piece.is_due;
  }
  return any;
}

// Of pieces that are due.
void Spin::find_motions(const Problem& problem) {
  for (Piece& piece : pieces_) piece.kinetic = 0, piece.angular = {}, piece.inertia = {};
  for_each_mass(problem, [&](double mass, std::uint32_t a, std::uint32_t b) {
    Piece& piece = pieces_[piece_of_[a]];
    if (!piece.is_due) return;
    const Vec3 ra = problem.position[a] - piece.center, rb = problem.position[b] - piece.center, v = piece.velocity();
    const Vec3 va = problem.velocity[a] - v, vb = problem.velocity[b] - v;
    piece.kinetic += 0.5 * mass * dot(va, vb);
    piece.angular += mass * cross(ra, vb);
    piece.inertia += mass * (Mat3::diagonal(dot(ra, rb)) + -1.0 * Mat3::outer(rb, ra));
  });
}

// On a single point in gravity, about the direction of that.
Vec3 Spin::turning(const Piece& piece, const Vec3& angular, const Vec3& gravity) const {
  const double g = dot(gravity, gravity);
  if (piece.holds.count == 0 || g == 0) return solve_semidefinite(piece.inertia, angular, 1e-12);
  const double inertia = dot(gravity, piece.inertia * gravity);
  return inertia > 0 ? (dot(angular, gravity) / inertia) * gravity : Vec3{};
}

bool Spin::give_back(Problem& problem, std::span<const Vec3> displacement, double h, const Holds& all, double most_gain,
                     bool is_rigid) {
  find_holds(problem, all);
  if (!find_losses(problem, displacement, h)) return false;
  find_motions(problem);
  // What swings on a nail keeps its motion, which includes the fall along the chord of the step: its reactions depend on it.
  const auto gives = [&](const Piece& piece) { return piece.holds.count == 0 || problem.gravity == Vec3{}; };
  double first = 0, second = 0, rest = 0;
  for (Piece& piece : pieces_) {
    if (!piece.is_due) continue;
    piece.turn = turning(piece, -piece.lost, problem.gravity);
    first += dot(piece.turn, piece.angular), second += 0.5 * dot(piece.turn, piece.inertia * piece.turn);
    piece.velocity_change = turning(piece, piece.angular, problem.gravity);  // the rigid motion that is there
    if (gives(piece)) rest += piece.kinetic - 0.5 * dot(piece.velocity_change, piece.angular);
  }
  constexpr double little = 1e-9;  // a straight chain that begins to turn needs just all of the rest
  const double share = largest_share(first, second, most_gain + (1 + little) * rest);
  const double excess = share * (first + share * second) - most_gain;
  const double factor = is_rigid ? 0 : excess > 0 ? std::sqrt(std::max(0.0, 1 - excess / std::max(rest, 1e-300))) : 1;
  for (std::size_t i = 0; i < problem.size(); ++i) {
    const Piece& piece = pieces_[piece_of_[i]];
    if (!piece.is_due) continue;
    const Vec3 place = problem.position[i] - piece.center;
    const Vec3 shared = piece.velocity() + cross(piece.velocity_change, place);
    problem.velocity[i] =
        shared + (gives(piece) ? factor : 1) * (problem.velocity[i] - shared) + share * cross(piece.turn, place);
  }
  return true;
}

// Of pieces that are due: mass, center, momentum and angular momentum, with the spins of rods, about the origin or the pivot.
void Spin::add_momenta(const Problem& problem) {
  for (Piece& piece : pieces_) {
    piece.is_due = piece.is_kept;
    piece.mass = 0;
    piece.center = piece.momentum = piece.angular = {};
  }
  const auto about = [](const Piece& piece) { return piece.holds.pivot().value_or(Vec3{}); };
  for_each_mass(problem, [&](double mass, std::uint32_t a, std::uint32_t b) {
    Piece& piece = pieces_[piece_of_[a]];
    piece.mass += mass;
    piece.center += mass * problem.position[a];
    piece.momentum += mass * problem.velocity[a];
    piece.angular += mass * cross(problem.position[a] - about(piece), problem.velocity[b]);
  });
  for (const GyroscopicForce& f : problem.items_of<GyroscopicForce>())
    pieces_[piece_of_[f.arm.nodes[0]]].angular += f.spin * f.arm.value(problem.position.data());
}

void Spin::note(const Problem& problem, const Holds& all) {
  find_holds(problem, all);
  add_momenta(problem);
  for (Piece& piece : pieces_) piece.wanted_momentum = piece.momentum, piece.wanted_angular = piece.angular;
}

double Spin::restore(Problem& problem) {
  constexpr int passes = 2;  // the second removes the round-off of the first
  constexpr double most_gains[passes] = {
      100, 1e-9};  // of the kinetic energy: points almost in one place would spin extremely
  constexpr double tolerance = 1e-9;
  double most_lost = 0;
  for (const double most_gain : most_gains) {
    add_momenta(problem);
    for (Piece& piece : pieces_) {
      piece.is_due = piece.is_due && piece.mass > 0;
      if (!piece.is_due) continue;
      piece.lost = piece.wanted_angular - piece.angular;
      if (const auto pivot = piece.holds.pivot()) {
        piece.center = *pivot, piece.velocity_change = {};
      } else {
        const Vec3 push = piece.wanted_momentum - piece.momentum;
        piece.center *= 1 / piece.mass;
        piece.lost -= cross(piece.center, push), piece.velocity_change = (1 / piece.mass) * push;
      }
    }
    find_motions(problem);
    most_lost = 0;
    for (Piece& piece : pieces_) {
      if (!piece.is_due) continue;
      piece.turn = solve_semidefinite(piece.inertia, piece.lost, 1e-12);
      const double first = dot(piece.turn, piece.angular), second = 0.5 * dot(piece.turn, piece.inertia * piece.turn);
      piece.turn *= largest_share(first, second, most_gain * piece.kinetic);
      const double remains = norm(piece.lost - piece.inertia * piece.turn);
      if (remains > tolerance * norm(piece.wanted_angular)) most_lost = std::max(most_lost, remains);
    }
    for (std::size_t i = 0; i < problem.size(); ++i) {
      const Piece& piece = pieces_[piece_of_[i]];
      if (piece.is_due)
        problem.velocity[i] += piece.velocity_change + cross(piece.turn, problem.position[i] - piece.center);
    }
  }
  return most_lost;
}

}  // namespace iota::solver
