// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iota/attributes.h>
#include <iota/ids.h>
#include <iota/vec3.h>
#include <iota/view.h>

#include <optional>
#include <span>
#include <vector>

namespace iota {

/// Particles: the points of bodies. Particles of different bodies that are hinged to each other form a *ring*: they share
/// one position and one velocity, and each has its own share of the mass.
class Particles : public View {
 public:
  explicit Particles(Core& core) : View(core) {}

  /// @name Making and destroying
  ///@{
  /// A new particle of `body`; mass in kg. A massless one (a marker) must be an affine combination of the massive ones:
  /// at any place if four of them are not in a plane, in the plane of a flat body, on the line of a thin one. Its
  /// velocity follows from the body's.
  ParticleId create(BodyId body, const Vec3& position, double mass = 1, const Vec3& velocity = {});
  void destroy(ParticleId);  ///< with its bonds; its body too if it was the last one
  bool contains(ParticleId) const;
  /// The id that a retired one became (itself if alive), if it was absorbed within the last 65 536 retirements.
  std::optional<ParticleId> survivor_of(ParticleId) const;
  std::vector<ParticleId> ids() const;  ///< in order of slots
  BodyId body(ParticleId) const;
  std::vector<ParticleId> ring(ParticleId) const;  ///< all particles hinged with it, and itself
  ///@}

  /// @name Place and motion
  ///@{
  Vec3 position(ParticleId) const;
  void set_position(ParticleId, const Vec3&);  ///< moves the whole ring; changes the rigid distances of its bodies
  Vec3 velocity(ParticleId) const;
  void set_velocity(ParticleId, const Vec3&);
  double mass(ParticleId) const;  ///< its own share
  void set_mass(ParticleId, double);
  /// Bonds of an inactive particle do not act, and only a millionth of its mass counts (2^-20, so that its body keeps
  /// its shape); its hinges and nails still act.
  bool is_active(ParticleId) const;
  void set_active(ParticleId, bool);
  /// (n, 3) in the order of ids(); out.size() == 3 n.
  void read_positions(std::span<double> out) const;
  void read_velocities(std::span<double> out) const;
  ///@}

  /// @name Nails
  ///@{
  void nail(ParticleId);                        ///< where it is
  void nail(ParticleId, const Vec3& position);  ///< at this position; calling it again moves the nail
  void release(ParticleId);
  bool is_nailed(ParticleId) const;
  Vec3 nail_force(ParticleId) const;  ///< by the nail on the particle in the last step, N
  ///@}

  /// @name Forces
  ///@{
  void apply_force(ParticleId, const Vec3&);  ///< added during the next step only, N
  Vec3 net_force(ParticleId) const;           ///< sum of all forces on its share of mass in the last step, N
  /// On the particle's body by everything that shares or nails its place, in the last step, N: the load on the hinge. A
  /// force applied to the shared particle itself is distributed equally over its bodies.
  Vec3 hinge_force(ParticleId) const;
  /// Above this `hinge_force` the particle leaves its ring, or its nail, at the end of a step (StepReport::broken).
  void set_break_force(ParticleId, double newtons);
  double break_force(ParticleId) const;  ///< N; infinite: never
  ///@}

  /// @name Optional attributes
  ///@{
  bool has_attributes(ParticleId) const;
  /// Age, lifetime, radius and color; radius and color of an emitted particle are those of its emitter's curve.
  ParticleAttributes attributes(ParticleId) const;
  /// A particle with a lifetime is destroyed, with its bonds, in the step in which its age reaches it.
  void set_attributes(ParticleId, const ParticleAttributes&);
  ///@}

  /// @name Oriented particles (surfels; Szeliski and Tonnesen 1992). They rotate like free balls, independently of
  /// their body; their local z is their preferred direction or normal. All functions except is_oriented and
  /// set_orientation throw std::invalid_argument for particles without an orientation.
  ///@{
  bool is_oriented(ParticleId) const;
  Quaternion orientation(ParticleId) const;
  /// Makes it oriented, with the moment of inertia of a ball of its radius (0.05 m if it has none).
  void set_orientation(ParticleId, const Quaternion&);
  Vec3 normal(ParticleId) const;  ///< its local z in the world frame
  Vec3 spin(ParticleId) const;    ///< rad/s, world; constant in free flight, to the last bit
  void set_spin(ParticleId, const Vec3&);
  double moment(ParticleId) const;  ///< of inertia, kg m^2
  void set_moment(ParticleId, double);
  void set_spin_damping(ParticleId, double per_second);
  void apply_torque(ParticleId, const Vec3&);  ///< during the next step only, N m
  /// Turns its normal to a direction: torque stiffness (normal x direction) - damping spin, N m; stiffness 0: none.
  void align(ParticleId, const Vec3& direction, double stiffness, double damping);
  ///@}
};

}  // namespace iota
