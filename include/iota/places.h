// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iota/ids.h>
#include <iota/shapes.h>
#include <iota/vec3.h>
#include <iota/view.h>

#include <limits>
#include <optional>
#include <span>
#include <vector>

namespace iota {

/// A place on a surface. distance: along the ray, or from the asked place, negative inside, m.
struct Hit {
  BodyId body;
  Vec3 point;
  double distance = 0;
};

/// The distance of two bodies, m, 0 where they overlap, and the places of each that are nearest to the other.
struct Gap {
  double distance = 0;
  Vec3 point, other_point;
};

/// Questions about the outlines of bodies, with which they touch and are drawn: the exact shapes of solids; lines and
/// balls with Bodies::radius. Sparks are not found, inactive bodies only where they are named. Of equally near ones the
/// first slot is found. The system has one tree of boxes for all of its outlines. It follows the motion: the first
/// question after a step looks where the bodies are that are not asleep or static.
class Places : public View {
 public:
  using Only = std::optional<std::span<const BodyId>>;  ///< nothing: all bodies

  explicit Places(Core& core) : View(core) {}

  /// The first thing that a ray meets within `farthest`, m. Throws std::invalid_argument for a direction of zero, and for
  /// `farthest` below 0 or none.
  std::optional<Hit> ray(const Vec3& from, const Vec3& direction,
                         double farthest = std::numeric_limits<double>::infinity(), Only only = {});
  /// The thing whose surface is nearest.
  std::optional<Hit> nearest(const Vec3& place, Only only = {});
  /// The bodies of which a part is within a distance (m), in order of slots: those that a ball overlaps.
  std::vector<BodyId> within(const Vec3& place, double radius, Only only = {});
  /// The bodies that a convex shape at a place would overlap, in order of slots. A body whose shape is not convex, as a
  /// torus, is tested by its triangles. Throws std::invalid_argument for a shape that is endless or not convex.
  std::vector<BodyId> overlap(const Shape&, const Vec3& position, const Quaternion& orientation, Only only = {});
  /// The first body that a convex shape meets on a straight way of at most `farthest`, m, without turning: the place where they
  /// touch, and how far it has gone, 0 if it overlaps the body already. Throws std::invalid_argument for such shapes as
  /// `overlap`, and for a direction of zero.
  std::optional<Hit> cast(const Shape&, const Vec3& position, const Quaternion& orientation, const Vec3& direction,
                          double farthest = std::numeric_limits<double>::infinity(), Only only = {});
  /// The gap between two bodies, inactive ones too. Throws std::invalid_argument for one body with itself and for sparks,
  /// StaleIdError.
  Gap gap(BodyId body, BodyId other);

 private:
  /// search(tree, visit) calls visit(slot, outline), which returns the new limit; visit(body, outline) is told the body. Of
  /// all outlines, or of those of some bodies. Throws StaleIdError.
  template <class Search, class Visit>
  void for_each(const Only& only, Search search, Visit visit);
  /// The first body that a ball of a radius, `width`, or what is in it, meets: meet(outline, limit) tells where.
  template <class Meet>
  std::optional<Hit> find_first(const Only& only, const Vec3& from, const Vec3& unit, double width, double farthest,
                                Meet meet);
};

}  // namespace iota
