// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "scenes/dice.h"

#include <iota/system.h>

#include <vector>

namespace iota::scenes {

struct MeasuredSceneOptions {
  bool gravity = true, nailed = true, springs = true;
  bool swapped = false;  ///< all pairs of arguments
};

/// A random scene of hinged rigid bodies with springs, with a length and a mass over six decades. Energy and momenta are
/// calculated from places and velocities of particles and the masses that were given; nothing is asked of the system's own
/// books.
class MeasuredScene {
 public:
  /// What the bodies are joined to.
  enum class Kind : std::uint8_t {
    tree,    ///< of bodies of two to four particles, each hinged to one before
    ring,    ///< of such bodies, closed
    net,     ///< of links, with many closed loops
    solids,  ///< a tree of boxes that are hinged at their corners
    count
  };
  MeasuredScene(std::uint64_t seed, IntegrationMode, const MeasuredSceneOptions& = {});

  StepReport step() { return system.step(dt); }

  Vec3 place(std::size_t i) const { return system.particles().position(particles[i]); }
  Vec3 velocity(std::size_t i) const { return system.particles().velocity(particles[i]); }
  /// Distances of all pairs of a body's particles, m, and how fast these grow, m/s.
  std::vector<double> lengths(const std::vector<std::size_t>& body) const;
  std::vector<double> stretch_rates(const std::vector<std::size_t>& body) const;
  double kinetic() const;
  double potential() const;
  double total_mass() const;
  /// An energy of the scene, for tolerances, J.
  double size() const { return kinetic() + total_mass() * gravity * length; }
  Vec3 momentum() const;
  Vec3 angular_momentum() const;  ///< about the origin
  double speed() const;           ///< of the fastest particle, m/s
  double extent() const;          ///< distance of the farthest particle from the origin, m

  static constexpr double gravity = 9.81;  ///< m/s^2, along -y

 private:
  Dice dice_;

 public:
  double length, mass, time;  ///< sizes of the scene, m, kg, s
  double dt;                  ///< s
  IntegrationMode mode;
  System system;
  std::vector<ParticleId> particles;
  std::vector<double> masses;                    ///< of them; 0: a point of a body that others have the mass of
  std::vector<std::vector<std::size_t>> bodies;  ///< their particles

 private:
  struct Spring {
    std::size_t p, q;
    double stiffness, length;
  };

  void add_tree();
  void add_ring();
  void add_net();
  void add_solids();
  void add_body(const std::vector<Vec3>& corners);
  void add_box(const Vec3& hinge);
  void add_springs();
  std::size_t any_particle() { return dice_.below(static_cast<std::uint32_t>(particles.size())); }
  Vec3 any_direction();
  Vec3 any_velocity(const Vec3& at) { return drift_ + cross(turning_, at) + dice_.point(length / time); }
  void combine(std::size_t p, std::size_t q);

  MeasuredSceneOptions options_;
  Vec3 drift_, turning_;
  std::vector<Spring> springs_;
};

}  // namespace iota::scenes
