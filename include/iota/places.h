// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iota/ids.h>
#include <iota/shapes.h>
#include <iota/vec3.h>
#include <iota/view.h>

#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace iota {

namespace contact {
class OutlineTree;
}

/// A body, or a fixed shape by its number.
struct Found {
  static constexpr std::uint32_t none = 0xffffffff;
  BodyId body;
  std::uint32_t fixed = none;  ///< none: it is the body
  bool operator==(const Found&) const = default;
};

/// A place on a surface. distance: along the ray, or from the asked place, negative inside, m.
struct Hit {
  Found what;
  Vec3 point;
  double distance = 0;
};

/// Questions about the outlines of bodies, with which they touch and are drawn: the exact shapes of solids; lines and
/// balls with Bodies::radius. Sparks are not found, inactive bodies only where they are named. Of equally near ones the
/// first slot is found. The system has one tree of boxes for all of its outlines. It follows the motion: the first
/// question after a step looks where the bodies are that are not asleep or static.
///
/// Such an object also has fixed shapes without physics, which only its own questions find.
class Places : public View {
 public:
  using Only = std::optional<std::span<const BodyId>>;  ///< nothing: all bodies and fixed shapes

  explicit Places(Core& core);
  ~Places();

  /// The first thing that a ray meets within `farthest`, m. Throws std::invalid_argument for a direction of zero.
  std::optional<Hit> ray(const Vec3& from, const Vec3& direction,
                         double farthest = std::numeric_limits<double>::infinity(), Only only = {});
  /// The thing whose surface is nearest.
  std::optional<Hit> nearest(const Vec3& place, Only only = {});
  /// The bodies of which a part is within a distance (m), in order of slots: those that a ball overlaps.
  std::vector<BodyId> within(const Vec3& place, double radius, Only only = {});
  /// Finds everything that a convex shape at a place would overlap: bodies in order of slots, then fixed shapes. A shape
  /// that is not convex itself, as a torus, is tested by its triangles. Throws std::invalid_argument for a shape that is
  /// endless or not convex.
  std::vector<Found> overlap(const Shape&, const Vec3& position, const Quaternion& orientation, Only only = {});

  /// A fixed shape without physics; returns its number. Places and turns are of the world.
  std::uint32_t add_fixed(const Shape&, const Vec3& position, const Quaternion& orientation);
  /// A surface that need not be closed: it has no inside. Throws std::invalid_argument for a vertex that is not there.
  std::uint32_t add_fixed_surface(Mesh, const Vec3& position, const Quaternion& orientation);
  void remove_fixed(std::uint32_t number);

 private:
  /// search(tree, visit) calls visit(number, outline), which returns the new limit; visit(what, outline) is told what it
  /// is. Of all outlines, or of those of some bodies. Throws StaleIdError.
  template <class Search, class Visit>
  void for_each(const Only& only, Search search, Visit visit);

  std::unique_ptr<contact::OutlineTree> fixed_;
};

}  // namespace iota
