// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iota/bodies.h>
#include <iota/forces.h>
#include <iota/ids.h>
#include <iota/reports.h>
#include <iota/vec3.h>
#include <iota/view.h>

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace iota {

/// Bodies of one particle each. Velocities and masses: one for each, one for all, or none (0; 1 kg).
struct PointRows {
  std::vector<Vec3> positions;   ///< m
  std::vector<Vec3> velocities;  ///< m/s
  std::vector<double> masses;    ///< kg
  BodyOptions body;
};

/// Bodies of two particles each. Masses and radii: one for each, one for all, or none (1 kg; 0).
struct RodRows {
  std::vector<Vec3> starts, ends;  ///< m
  std::vector<double> masses;      ///< of each body, kg
  std::vector<double> radii;       ///< m: a solid cylinder, see Bodies::set_rod; 0: half of the mass at each end
  BodyOptions body;
};

/// Bonds of one law, from p[i] to q[i].
struct BondRows {
  std::vector<ParticleId> p, q;
  SharedLaw law;  ///< its parameters apply to all bonds, except those in `columns`
  struct Column {
    std::string name;
    std::vector<double> values;  ///< one for each bond; NaN: the distance now
  };
  std::vector<Column> columns;
};

/// A quantity of bodies, particles, bonds or joints. The functions of Many list those of each kind.
enum class Quantity : std::uint8_t {
  position,          ///< 3: m
  orientation,       ///< 4: unit quaternion x y z w
  velocity,          ///< 3: m/s
  angular_velocity,  ///< 3: rad/s
  mass,              ///< 1: kg
  force,             ///< 3: N; read: in the last step; assigned: applied during the next one
  torque,            ///< 3: N m, the same
  length,            ///< 1: m
  value,             ///< 1: of a coordinate, rad or m
  speed,             ///< 1: rad/s or m/s
  effort,            ///< 1: N m or N
  pose,              ///< 7: position and orientation
  motion,            ///< 6: velocity and angular velocity
  work,  ///< 2: a measure of the work of the latest solution, points times iterations, of the body's articulate as
         ///< its share of its island; for how many steps that was, 0: it sleeps or is frozen
};
std::size_t width(Quantity);

/// Makes, reads or changes many things in one call, by arrays of float64 in C order with a row for each thing. A change
/// is one command: it is recorded as one, and if a part of it is refused, nothing is changed. Reading throws
/// std::invalid_argument for a quantity that the things do not have.
class Many : public View {
 public:
  explicit Many(Core& core) : View(core) {}

  std::vector<ParticleId> create_points(const PointRows&);
  std::vector<BodyId> create_rods(const RodRows&);
  std::vector<BondId> create_bonds(const BondRows&);
  /// Hinges p[i] with q[i], in order.
  RestructureReport combine(std::span<const ParticleId> p, std::span<const ParticleId> q);

  void read(Quantity, std::span<const ParticleId>, std::span<double> out) const;
  void read(Quantity, std::span<const BodyId>, std::span<double> out) const;
  /// force (on the first particle) and length (distance of the ends).
  void read(Quantity, std::span<const BondId>, std::span<double> out) const;
  /// value, speed and effort of one coordinate each.
  void read(Quantity, JointCoordinate, std::span<const ConstraintId>, std::span<double> out) const;
  /// A parameter of the bonds' laws.
  void read(std::string_view parameter, std::span<const BondId>, std::span<double> out) const;

  /// position, velocity, mass, force.
  void assign(Quantity, std::span<const ParticleId>, std::span<const double>);
  /// position, orientation, pose, velocity, angular_velocity, motion, mass, force (at the center of mass), torque. Each
  /// body moves independently: if the places of hinged bodies do not fit, the last one is used, and the next step
  /// closes the gap. Assign pose or motion to hinged bodies, not position and orientation one after the other.
  void assign(Quantity, std::span<const BodyId>, std::span<const double>);
  void assign(std::string_view parameter, std::span<const BondId>, std::span<const double>);
};

}  // namespace iota
