// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iota/ids.h>
#include <iota/materials.h>
#include <iota/options.h>
#include <iota/shapes.h>
#include <iota/vec3.h>
#include <iota/view.h>

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace iota {

struct BodyOptions {
  BodyKind kind = BodyKind::dynamic;
  double damping = 0;  ///< 1/s, adds to the system's
};

/// For bodies given as homogeneous solids.
struct SolidOptions {
  double density = 1000;                                   ///< kg/m^3
  double mass = std::numeric_limits<double>::quiet_NaN();  ///< kg; NaN: density times volume
  Vec3 position;                                           ///< of the shape's origin, m
  Quaternion orientation;                                  ///< of the shape's frame
  Vec3 velocity;                                           ///< of the center of mass, m/s
  Vec3 spin;                                               ///< angular velocity, world axes, rad/s
  std::vector<Vec3> attachments;                           ///< particles to hinge, nail or bond at; shape's frame, m
  BodyKind kind = BodyKind::dynamic;
  double damping = 0;  ///< 1/s
};

/// The energy of one body, J.
struct BodyEnergy {
  double kinetic = 0;
  double potential = 0;  ///< of its weight, and of bonds and joints that it is the first body of
  double total() const { return kinetic + potential; }
};

/// A solid of a body. A body that is combined from several has the solids of all.
struct SolidView {
  Shape shape;
  Vec3 position;           ///< of the shape's origin, world, m
  Quaternion orientation;  ///< of the shape's frame
};

/// Rigid bodies. A body is the rigid set of its particles. Bodies that are hinged to each other, directly or through
/// others, form an *articulate*.
class Bodies : public View {
 public:
  explicit Bodies(Core& core) : View(core) {}

  /// @name Making and destroying
  ///@{
  BodyId create(const BodyOptions& options = {});  ///< without particles yet: see Particles::create
  /// A body of four equal point masses that have exactly the mass, center and inertia of a solid, and one particle for
  /// each attachment. particles(): the four, then the attachments.
  BodyId create(const Shape& shape, const SolidOptions& options = {});
  /// A static body without particles: the ground, a wall, a table. Queries find it, and it is drawn and saved; but nothing
  /// can be tied to it, and masses, energies and articulates do not count it. The shape may be a mesh that is not closed,
  /// which then has two sides and no inside. position: of the shape's origin, m. `set_pose` moves it.
  BodyId create_obstacle(const Shape& shape, const Vec3& position = {}, const Quaternion& orientation = {});
  /// A further particle of a body made of solids, at any place (world, m); the body's mass, center, inertia and motion
  /// do not change. Throws std::invalid_argument for bodies without a solid, and if something is hinged to the solid's
  /// own four points, whose positions change.
  ParticleId create_attachment(BodyId, const Vec3& position);
  /// Gives a body of exactly two particles the mass and inertia of a solid cylinder between them, exact for all forces
  /// on its axis. It keeps the spin about its axis that set_angular_velocity gives it: no torque acts about that axis.
  /// This does not set its `radius`.
  /// Source: mass [A B; B A], A+B = m/2, A-B = 2 It/L^2.
  void set_rod(BodyId, double mass, double radius);
  /// Gives a body of shapes alone, without attachments yet, another mass (kg), center of mass (world, m) and inertia (about it, world
  /// axes, kg m^2) than a homogeneous one has: of a hollow shell, a loaded die, a robot's link with its motors. Its shapes stay
  /// where they are. Throws std::invalid_argument for an inertia that no body with a size along each axis has.
  void set_mass_properties(BodyId, double mass, const Vec3& center, const Matrix3& inertia);
  void destroy(BodyId);  ///< with its particles and their bonds
  bool contains(BodyId) const;
  /// The id that a retired one became (itself if alive), if it was absorbed within the last 65 536 retirements.
  std::optional<BodyId> survivor_of(BodyId) const;
  std::vector<BodyId> ids() const;        ///< in order of slots, without obstacles
  std::vector<BodyId> obstacles() const;  ///< in order of slots
  bool is_obstacle(BodyId) const;
  std::string name(BodyId) const;  ///< empty unless it was given one
  /// At most 63 bytes; need not be unique. A survivor keeps its own name.
  void set_name(BodyId, std::string_view);
  ///@}

  /// @name Structure
  ///@{
  std::vector<ParticleId> particles(BodyId) const;
  std::vector<ParticleId> particles(BodyId, BodyId part) const;
  /// The bodies that a body was combined from: ids of itself and of those it absorbed.
  std::vector<BodyId> parts(BodyId) const;
  std::vector<SolidView> solids(BodyId) const;  ///< empty for bodies of particles alone
  std::vector<ParticleId> attachments(
      BodyId) const;                       ///< its particles with mass, without the four points of its solids
  std::uint32_t articulate(BodyId) const;  ///< a number that the bodies of one articulate share
  std::vector<std::vector<BodyId>> articulates() const;
  std::vector<BodyId> articulate_of(BodyId) const;  ///< its bodies, in order of slots; none of an obstacle
  std::uint32_t articulate_count() const;
  ///@}

  /// @name Kind
  ///@{
  BodyKind kind(BodyId) const;
  void set_kind(BodyId, BodyKind);
  /// An inactive body is kept, but neither stepped nor drawn; its bonds do not act. Active again, it has its former
  /// kind, is at rest at its old place, and its hinges close.
  bool is_active(BodyId) const;
  void set_active(BodyId, bool);
  void set_articulate_active(BodyId, bool);  ///< all bodies of its articulate
  /// The radius of its lines, or of the ball of its only particle, m. The body is drawn and met by queries with it. It is the
  /// body's own if it was set (a single particle's own: its attribute), or else System::usual_radius, twice that for a
  /// single particle. 0 for a body given by shape.
  double radius(BodyId) const;
  /// Throws std::invalid_argument for a body given by shape.
  void set_radius(BodyId, double meters);
  /// 0xRRGGBB, in which viewers draw it; none: that of its look. Pieces that are split off have it too.
  std::optional<std::uint32_t> color(BodyId) const;
  void set_color(BodyId, std::optional<std::uint32_t> rgb);
  /// Its own. With a material its outline touches the outlines of static bodies that have one: it rests, slides and rolls on them.
  /// None: System::usual_material counts.
  std::optional<Material> material(BodyId) const;
  void set_material(BodyId, const std::optional<Material>&);
  /// The places where it touched others in the last step. All of them: Contacts::points.
  std::vector<ContactPoint> contacts(BodyId) const;
  double damping(BodyId) const;
  void set_damping(BodyId, double per_second);
  /// How many steps the island of the body takes at once: 1 (at first) to 16, 0: it is frozen, and keeps its velocities. Between
  /// its solutions places and velocities are interpolated, so that all that reads them sees the present time. Of bodies
  /// that are solved together the shortest one counts, and all get it. It is 1 again as soon as an edit, a hand or a force of
  /// the script touches the articulate. Free particles take every step unless they are frozen. Single steps are taken by what touches something, and
  /// where a body would turn by more than 0.7 rad at once.
  int stride(BodyId) const;
  void set_stride(BodyId, int steps);
  void set_articulate_stride(BodyId, int steps);  ///< of all bodies of its articulate
  ///@}

  /// @name Place and motion
  ///@{
  double mass(BodyId) const;
  /// Scales the masses of its particles, and its inertia with them; its shape, place and velocities stay.
  void set_mass(BodyId, double kg);
  Vec3 center_of_mass(BodyId) const;
  Matrix3 inertia(BodyId) const;         ///< about the center of mass, world axes, kg m^2 (thesis, Eq. 2.28)
  Quaternion orientation(BodyId) const;  ///< of the drawn frame: that of its first solid, or of its basis
  /// Moves the body, and its whole articulate rigidly with it, nails and velocities included. A scripted body moves
  /// during the next step. position: of the center of mass.
  void set_pose(BodyId, const Vec3& position, const Quaternion& orientation);
  Vec3 velocity(BodyId) const;  ///< of the center of mass, m/s
  void set_velocity(BodyId, const Vec3&);
  /// rad/s, world axes. Zero about an axis without inertia: any axis of a single point, or the line through all points
  /// of a body that is not a rod.
  Vec3 angular_velocity(BodyId) const;
  /// Throws std::invalid_argument for a component along such an axis.
  void set_angular_velocity(BodyId, const Vec3&);
  Vec3 angular_momentum(BodyId) const;  ///< about its center of mass, kg m^2/s
  BodyEnergy energy(BodyId) const;
  ///@}

  /// @name Forces during the next step only. They are distributed over the body's particles with the given sum and
  /// moment, in proportion to the rigid accelerations, so that they cause no load within the body. Throws
  /// std::invalid_argument for a moment about an axis without inertia (a point, or the line through all points).
  ///@{
  void apply_force(BodyId, const Vec3& newtons);                  ///< at the center of mass
  void apply_force(BodyId, const Vec3& newtons, const Vec3& at);  ///< world, m; need not be on the body
  void apply_torque(BodyId, const Vec3& newton_meters);
  ///@}

  /// @name Loads in the last step
  ///@{
  /// Sum of all forces from outside, and of their moments about the center of mass, N and N m: mass times acceleration.
  /// For a part of a combined body, this includes the forces of the other parts.
  Vec3 net_force(BodyId) const;
  Vec3 net_torque(BodyId) const;
  Vec3 net_force(BodyId, BodyId part) const;
  Vec3 net_torque(BodyId, BodyId part) const;
  /// On a part, from outside of the whole body, N, and their moments about the part's center of mass, N m. `net` minus
  /// `outside` is the load by the other parts: that of the rigid connection.
  Vec3 outside_force(BodyId, BodyId part) const;
  Vec3 outside_torque(BodyId, BodyId part) const;
  ///@}
};

}  // namespace iota
