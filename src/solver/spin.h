// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/function_ref.h"
#include "math/mat3.h"
#include "solver/holds.h"
#include "solver/node_vectors.h"
#include "solver/pieces.h"
#include "solver/problem.h"
#include "solver/rigid_modes.h"
#include "solver/rigid_motion.h"
#include "solver/wheels.h"

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace iota::solver {

/// The angular momentum of the pieces of a problem, and of its clusters: a piece is what rows connect, a cluster what rows and
/// forces connect. Nothing within them changes their momentum and angular momentum. If outside holds one at a single point,
/// that is the angular momentum about this point; if outside lets one only turn about a line, the one about this line. The members of a piece, which only lengths connect, have their own spin as far
/// as no other row notices: a wheel on an axle.
/// Changes by a scheme or a projection are compensated by velocities of a rigid motion, which no row notices.
class Spin {
 public:
  /// After a change of structure.
  void forget() {
    for (Parts* parts : {&pieces_, &touching_, &clusters_, &members_, &noted_}) parts->connected.of.clear();
    wheels_.forget();
  }
  /// After a change of masses alone.
  void forget_masses() { wheels_.forget_masses(); }

  /// Returns what a step of the end-point rule has lost: it takes moments where the step ends, and so counts the angular
  /// momentum of x1 - x0 with M v0 as lost (a ball at 30 rad/s kept 13 % of its own for 2 s at 60 Hz), and its dashpots act
  /// along the line at the start. Members and wheels get theirs first, then pieces, what touches and clusters the remainder. Velocities are those after
  /// the step, v1 = (x1 - x0)/h = v0 + displacement/h. The energy rises by `most_gain` at most, J; beyond that, pieces and
  /// clusters take it from the rest of their motion, and members and wheels do without. `unbalanced`: forces that the solution leaves over at the points, N:
  /// its moment is lost, too. Returns whether velocities have changed.
  bool give_back(Problem&, std::span<const Vec3> displacement, const NodeVectors& unbalanced, double h,
                 const Holds& all, double most_gain);

  /// The end-point rule turns a body by atan(h w) where its velocity, with what `give_back` has returned, says h w: turns
  /// positions and velocities of the same pieces, members and wheels by the rest, each about an axis that no row and no
  /// force notices. `chords`: the velocities (x1 - x0)/h. Calls `turned` after each radian.
  void turn_on(Problem&, std::span<const Vec3> chords, double h, FunctionRef<void()> turned);

  /// Notes momentum and angular momentum of pieces, or of clusters, before positions are moved ...
  void note(const Problem&, const Holds& all, Connection = Connection::rows);
  /// ... adds what gravity and held forces give in h seconds while the points are at `places` ...
  void expect(const Problem&, std::span<const Vec3> places, double h);
  /// ... and restores both by the least change of kinetic energy. Returns the largest angular momentum that a piece cannot
  /// carry any more, kg m^2/s: its points are almost in one place.
  double restore(Problem&);

  /// Moves each cluster that nothing or a single point at rest holds as a rigid body: this needs no solve, changes no row, and
  /// keeps momentum and angular momentum. Half of its other motion remains. What is held otherwise stays and keeps half of
  /// its velocity. Held forces and gravity act; returns the work of the former, J.
  double move_rigidly(Problem&, double h, const Holds& all);

 private:
  /// Sums over the points of a part.
  struct Sums {
    double mass = 0, kinetic = 0;  ///< of the motion relative to the center
    Vec3 center;                   ///< of mass, or the point that holds the part, m
    Vec3 momentum;                 ///< about the center
    Vec3 wanted_momentum;          ///< about the origin, or the point that holds the part
    Vec3 lost;                     ///< angular momentum about the center, kg m^2/s
    Vec3 unbalanced;               ///< momentum that the solution leaves over, kg m/s
  };
  struct Part : Sums {  // a piece, a cluster or a member
    Holds holds;
    bool touches = false;        ///< by a contact that acts, of pieces
    bool is_kept = false;        ///< nothing holds it, or a single point at rest, or an axle
    std::optional<Axle> axle;    ///< about which alone the world lets it turn
    bool is_turned = false;      ///< by `turn_on`, as a whole
    bool is_rigid = false;       ///< a free body alone, whose motion has no rest
    bool is_due = false;         ///< it has lost something
    Vec3 angular;                ///< about the center
    Vec3 lost_momentum;          ///< by fields that turn velocities, kg m/s
    Vec3 lost_of_center;         ///< by the motion of the center of mass
    Vec3 given;                  ///< back of what is lost, to it and to its members
    Mat3 inertia;                ///< about the center
    Vec3 wanted_angular;         ///< about the origin, or the point that holds it
    Vec3 velocity_change, turn;  ///< m/s, rad/s
    Vec3 chord;                  ///< of the center of mass in the step, m/s
    Vec3 velocity() const { return holds.count > 0 ? Vec3{} : (1 / mass) * momentum; }
    bool is_free() const { return is_kept && !axle; }
    std::optional<Vec3> fixed_point() const { return axle ? axle->place : holds.pivot(); }
    /// The direction about which alone it keeps its angular momentum, of any length.
    std::optional<Vec3> only_about(const Vec3& gravity) const {
      if (axle) return axle->direction;
      return holds.count > 0 && gravity != Vec3{} ? std::optional(gravity) : std::nullopt;
    }
  };
  struct Parts {
    std::vector<Part> parts;
    Pieces connected;
    std::optional<Vec3> nail;  ///< on which all hangs, when it was found last
    Part& of(std::uint32_t node) { return parts[connected.of[node]]; }
  };
  /// A force and a torque about the center, or what a row makes of a multiplier of 1.
  struct Wrench {
    Vec3 force, torque;
  };
  /// The rows that notice a member's rigid motion: orthonormal, in the norm of the motion that a wrench causes.
  struct Support {
    std::array<Wrench, 6> wrenches;
    int count = 0;
    Mat3 by_inertia;  ///< inverse of the member's inertia, 1/(kg m^2)
  };
  void begin(const Problem&);
  void find_rigid_pieces(const Problem&);
  void find_parts(const Problem&, Connection, const Holds& all, Parts&);
  void find_axles(const Problem&, Noticed, Parts&);
  bool find_members(const Problem&);
  void find_supports(const Problem&);
  double turn_members(Problem&, double most_gain);
  bool find_touching(const Problem&, const Holds& all);
  static void add_given(const Parts& finer, Parts& coarser);
  bool find_clusters(const Problem&, const Holds& all);
  void find_free_clusters(const Problem&, const Holds& all, Parts&);
  static void drop_turned(const Problem&, Parts&);
  enum class Supported : std::uint8_t { no, yes };  // by rows of joints, as members
  static bool find_losses(const Problem&, std::span<const Vec3> displacement, const NodeVectors& unbalanced, double h,
                          Supported, Parts&);
  static void add_losses_of_fields(const Problem&, std::span<const Vec3> displacement, double h, Supported, Parts&);
  static void find_motions(const Problem&, Parts&);
  static void find_velocities(const Problem&, Parts&);
  static double turn_parts(Problem&, double most_gain, Parts&);
  static Vec3 turning(const Part&, const Vec3& angular, const Vec3& gravity);
  void find_pushed(const Problem&);
  static void add_momenta(const Problem&, Parts&);

  std::uint64_t acting_version_ = 0;              // of the problem, when the parts were found
  Parts pieces_, touching_, clusters_, members_;  // connected by joints, by rows, by rows and forces, by lengths
  Parts noted_;
  Connection noted_connection_ = Connection::rows;
  Wheels wheels_;
  // One entry for each member.
  std::vector<Support> supports_;
  std::vector<std::uint32_t> piece_of_, nodes_of_, rows_of_;
  std::vector<std::uint8_t> may_turn_;
  std::vector<std::uint8_t> is_pushed_;  // each node, by a force
  // Whether the latest `give_back` found any.
  bool are_members_due_ = false, are_wheels_due_ = false;
  struct Count {
    std::uint32_t nodes = 0, rods = 0;
  };
  std::vector<Count> counts_;  // of each piece
  RoomForPieces room_for_pieces_;
  std::vector<TurningBody> turning_bodies_;
  // Each node and each part has an index among the parts that may have an axle: see find_axles.
  std::vector<std::uint32_t> hung_of_node_, hung_of_part_;
  std::vector<RigidModes> noticed_;
};

}  // namespace iota::solver
