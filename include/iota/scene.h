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

/// Description of a system for viewers, besides poses: plain copies, safe to pass to another thread. Lengths in m. The
/// frame of a body is that of its pose.
namespace iota {

enum class BodyKind : std::uint8_t;  // of options.h

/// A solid of a body.
struct DrawnSolid {
  Shape shape;
  Vec3 position;
  Quaternion orientation;
};

/// A segment between two points of a body.
struct DrawnLine {
  Vec3 center;
  Quaternion turn;  ///< turns the x axis into its direction
  double length = 0;
};

/// A particle with a radius, in a body of several particles.
struct DrawnBall {
  Vec3 center;
  double radius = 0;
  Color color;
};

struct DrawnBody {
  BodyId id;
  bool is_new = true;  ///< created since the last call
  BodyKind kind{};
  std::vector<DrawnSolid> solids;
  /// Its cosmetic bonds; without these, from each of its particles to the next; empty for one particle.
  std::vector<DrawnLine> lines;
  std::uint32_t particles = 0;
  double radius = 0;                             ///< of its lines, or of its only particle; 0 for a body of solids
  std::optional<ParticleAttributes> attributes;  ///< of a body of one particle that has some
  std::optional<std::uint32_t> color;            ///< 0xRRGGBB, instead of that of its material
  std::vector<DrawnBall> balls;                  ///< particles with a radius, in a body of several
};

/// The usual radius of a system, from the lengths of its rods and its extent: 0.06 of their median length; without rods
/// 0.02 of the extent; 0.03 m without an extent.
double usual_radius_of(std::vector<double> rods, double extent);

/// The articulate of a body.
struct Membership {
  std::uint32_t body = 0, articulate = 0;  ///< slots
};

/// A point of a body, in its frame; if the body is null, of the world.
struct Anchor {
  BodyId body;
  Vec3 point;
};

struct DrawnTie {
  /// Bonds and joints are separate tables; a tie's slot identifies both the table and the row.
  static constexpr std::uint32_t slot_of_bond(std::uint32_t bond) { return 2 * bond; }
  static constexpr std::uint32_t slot_of_joint(std::uint32_t joint) { return 2 * joint + 1; }

  enum class Kind : std::uint8_t { spring, rope, rod };
  std::uint32_t slot = 0;  ///< unique among all ties at a time
  Kind kind = Kind::spring;
  double length = 0;  ///< of a relaxed spring, a taut rope, a rod
  Anchor a, b;
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

/// New and changed items in their present state, and the slots of destroyed ones (some of which were never drawn).
template <class Item>
struct Changes {
  std::vector<Item> set;
  std::vector<std::uint32_t> gone;
};

/// Changes since the last call. If `whole`, it lists everything: an item that is not in it no longer exists.
struct SceneChanges {
  bool is_whole = true;
  double extent = 0;           ///< if whole: diagonal of the box around all particles
  double usual_radius = 0.03;  ///< of lines of bodies without a radius of their own; whole if it is another one
  Changes<DrawnBody> bodies;
  std::vector<Membership> memberships;  ///< of bodies whose articulate has changed
  Changes<DrawnTie> ties;
  Changes<DrawnNail> nails;
  Changes<DrawnParticleSet> particle_sets;
  std::vector<ViewEvent> events;
};

}  // namespace iota
