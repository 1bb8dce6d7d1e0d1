// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "contact/axis.h"
#include "contact/convex_part.h"
#include "contact/touch.h"

#include <vector>

namespace iota::contact {

/// Makes touches of two parts, in a fixed order: those with gaps of at most `within`. They are at most four.
class TouchWriter {
 public:
  TouchWriter(const ConvexPart& first, const ConvexPart& second, const Vec3& anchor, double within,
              std::vector<Touch>& found)
      : first_(first), second_(second), anchor_(anchor), within_(within), found_(found) {}

  /// A ball of the one part against a plane of the other. apart: of its center, from the plane of the core.
  void add_face(bool is_turned, const Vec3& center, double radius, const Vec3& normal, double apart,
                const FeatureName& of_point, const FeatureName& of_plane, const std::optional<Rim>& = {});
  /// Two edges that cross, with their points that are nearest to each other.
  void add_edges(const Vec3& on_first, const Vec3& on_second, const Vec3& normal, const FeatureName& of_first,
                 const FeatureName& of_second);
  /// Two corners, or a corner and an edge; axis: along the edge, or zero.
  /// Two wires that cross, each with its tangent and the vector to its center of curvature by the square of its radius.
  void add_wires(const Vec3& on_first, const Vec3& on_second, const Vec3& along_first, const Vec3& bend_of_first,
                 const Vec3& along_second, const Vec3& bend_of_second, const FeatureName& of_first,
                 const FeatureName& of_second);
  void add_round(const Vec3& on_first, const Vec3& on_second, const Vec3& axis, const FeatureName& of_first,
                 const FeatureName& of_second);

  const ConvexPart& first() const { return first_; }
  const ConvexPart& second() const { return second_; }
  const Vec3& anchor() const { return anchor_; }
  double within() const { return within_; }

 private:
  const ConvexPart &first_, &second_;
  const Vec3& anchor_;
  double within_;
  std::vector<Touch>& found_;
};

/// A point of a face, an edge or a corner that is near a face of another part.
struct FacePoint {
  Vec3 place;  ///< of the core
  double apart = 0;
  FeatureName of_point, of_plane;
};

/// Clips what is nearest to a face of a part by the sides of this face: Sutherland, Hodgman 1974.
class Clipper {
 public:
  /// The touches of two parts that are apart along an axis: at most so many.
  void add_touches(const Axis&, TouchWriter&, std::size_t most);
  /// An end of a rod.
  struct End {
    Vec3 center;
    double radius;
    FeatureName name;
  };
  /// The touches of a rod whose radius changes along it with a face. False: the rod is beside the face.
  static bool add_rod(const Axis&, const End& a, const End& b, const FeatureName& between, TouchWriter&);

 private:
  struct Corner {
    Vec3 place;
    FeatureName of_point, of_plane;
    std::uint32_t edge = 0;  ///< of the way to the next one: of the part, or beyond those a side of the face
  };
  static void add_edge_touch(const Axis::Edges&, TouchWriter&);
  void add_face_touches(const Axis&, TouchWriter&, std::size_t most);
  void start_with_nearest(const ConvexPart& owner, std::uint32_t face, const ConvexPart& other);
  void clip(const ConvexPart& owner, std::uint32_t face, const ConvexPart& other);
  void clip_by(const ConvexPart& owner, std::uint32_t face, std::uint32_t side, const ConvexPart& other,
               const Vec3& outward, double tolerance);
  FeatureName name_of_point(const ConvexPart& other, std::uint32_t edge) const;
  void keep(std::size_t most, double size);

  // Scratch, kept for its capacity.
  std::vector<Corner> polygon_, clipped_;
  std::vector<FacePoint> points_;
  std::uint32_t incident_ = Polytope::none;
  bool is_clipped_ = false;
};

}  // namespace iota::contact
