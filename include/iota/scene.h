// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iota/constraints.h>
#include <iota/emitters.h>
#include <iota/ids.h>
#include <iota/reports.h>
#include <iota/shapes.h>

#include <cstdint>
#include <optional>
#include <vector>

/// What a viewer needs to know of a system beside poses: plain copies, safe to hand to another thread. Lengths in m. The
/// frame of a body is that of its pose.
namespace iota {

enum class BodyKind : std::uint8_t;  // of bodies.h

/// A solid that a body was given as.
struct DrawnSolid {
  Shape shape;  ///< a Mesh whose triangles are not known here is empty
  Vec3 position;
  Quaternion orientation;
};

/// A stretch between two points of a body.
struct DrawnLine {
  Vec3 center;
  Quaternion turn;  ///< turns the x axis into its direction
  double length = 0;
};

/// A particle of a body of several, with a radius.
struct DrawnBall {
  Vec3 center;
  double radius = 0;
  Color color;
};

struct DrawnBody {
  BodyId id;
  bool is_new = true;  ///< created since the last call: no body that was known in its slot
  BodyKind kind{};
  std::vector<DrawnSolid> solids;
  /// Its cosmetic bonds or, where it has none, from each of its particles to the next; empty for one particle.
  std::vector<DrawnLine> lines;
  std::uint32_t particles = 0;
  std::optional<ParticleAttributes> attributes;  ///< of a single particle that has some
  std::vector<DrawnBall> balls;                  ///< of particles that have a radius, if there are several
};

/// Which articulate a body belongs to.
struct Membership {
  std::uint32_t body = 0, articulate = 0;  ///< slots
};

/// A point of a body, in its frame, or of the world where the body is null.
struct Anchor {
  BodyId body;
  Vec3 point;
};

struct DrawnTie {
  /// Bonds and joints are tables of their own: a tie's slot tells which one it is of.
  static constexpr std::uint32_t slot_of_bond(std::uint32_t bond) { return 2 * bond; }
  static constexpr std::uint32_t slot_of_joint(std::uint32_t joint) { return 2 * joint + 1; }

  enum class Kind : std::uint8_t { spring, rope, rod };
  std::uint32_t slot = 0;  ///< of all ties: no two have the same at a time
  Kind kind = Kind::spring;
  double length = 0;  ///< of a spring at rest, a rope pulled taut, a rod
  Anchor a, b;
};

/// A constraint that is in force and is no tie.
struct DrawnJoint {
  std::uint32_t slot = 0;
  const char* kind = "";  ///< name
  Anchor a, b;
  Vec3 axis;  ///< unit vector, in the frame of a's body; zero for kinds without one
};

struct DrawnNail {
  std::uint32_t slot = 0;
  Anchor at;
};

struct DrawnParticleSet {
  std::uint32_t slot = 0;  ///< of the emitter
  bool active = true;
  std::uint32_t capacity = 0;
};

/// New and changed ones as they are now, and the slots of those that are gone (some of which were never drawn).
template <class Item>
struct Changes {
  std::vector<Item> set;
  std::vector<std::uint32_t> gone;
};

/// What has changed since the last call. Where it is whole, it lists everything: what it leaves out is gone.
struct SceneChanges {
  bool is_whole = true;
  double extent = 0;  ///< where whole: diagonal of the box around all particles
  Changes<DrawnBody> bodies;
  std::vector<Membership> memberships;  ///< of bodies whose articulate is another one now
  Changes<DrawnTie> ties;
  Changes<DrawnJoint> joints;
  Changes<DrawnNail> nails;
  Changes<DrawnParticleSet> particle_sets;
  std::vector<ViewEvent> events;
};

}  // namespace iota
