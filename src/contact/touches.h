// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "contact/corner_touches.h"
#include "contact/form_cache.h"
#include "contact/manifold.h"
#include "contact/mesh_edges.h"
#include "contact/outline.h"
#include "contact/ring_pairs.h"
#include "contact/round_touches.h"
#include "contact/touch.h"

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

namespace iota::contact {

/// Finds the touches of two outlines.
///   Convex parts   four points at most of each two: faces, edges and corners of both are looked at
///   Rings          with each other, with balls and rods: see RingToucher; with other convex parts: see add_touches_of_ring
///   Half-spaces, meshes that are open or not convex   corners, ends and rims of the other outline; and those of a mesh
///                  against a convex part or a ring; and the edges of meshes against convex parts, rings and each other
class TouchFinder {
 public:
  TouchFinder() = default;
  TouchFinder(const TouchFinder&) = delete;
  TouchFinder& operator=(const TouchFinder&) = delete;

  /// Derives what touches with the meshes of an outline need, so that the first of them does not take as long.
  void prepare(const Outline&);
  /// Appends those with gaps of at most `within`, m, in a fixed order. spin: of each body in half a step, rad. way: of the first
  /// relative to the second in the coming step, m, where known: see find_axis.
  void find(const Outline& first, const Vec3& spin_of_first, const Outline& second, const Vec3& spin_of_second,
            double within, std::vector<Touch>& found, const Vec3& way = {});
  /// Appends only touches with faces of the second outline along a normal, which points towards the first one.
  void find_on_faces(const Outline& first, const Vec3& spin_of_first, const Outline& second, const Vec3& spin_of_second,
                     const Vec3& normal, double within, std::vector<Touch>& found);

 private:
  struct Part {
    const Solid* solid = nullptr;  ///< or a line
    const Line* line = nullptr;
    geometry::Bounds box;
    enum Kind : std::uint8_t { rod = 1, body = 2, ring = 4, mesh = 8, open = 16 };  ///< body: another convex one
    Kind kind = body;
    bool is_placed = false;
    bool is_convex() const { return kind <= body; }
    bool is_met() const { return kind <= ring; }  ///< in pairs
    const Polytope* hull = nullptr;
    ConvexPart placed;
  };
  /// Kept for their capacity.
  struct Parts {
    std::vector<Part> parts;
    std::size_t count = 0;
    unsigned kinds = 0;  ///< bits
  };
  static Part::Kind kind_of(const Solid&, bool is_hull);
  void list(const Outline&, const Vec3& anchor, Parts&);
  Part& add(Parts&);
  const Polytope* hull_of(const std::shared_ptr<const Form>&);
  void find_corners(const Vec3& spin_of_first, const Vec3& spin_of_second, double within, std::vector<Touch>& found);
  /// Touches of convex parts and rings with the edges of meshes that are open or not convex: see MeshEdges.
  void find_on_edges(Parts& bodies, const Vec3& spin, const Parts& meshes, bool are_meshes_second, const Vec3& anchor,
                     double within, std::vector<Touch>& found);
  /// Touches of edges of meshes that are open or not convex with each other.
  void find_between_edges(const Vec3& anchor, double within, std::vector<Touch>& found);
  const MeshEdges& edges_of(const Solid&);
  /// Whether a body may touch an edge from a to b on its outer side. What is on the other side of one in a hollow meets its faces.
  static bool may_meet(const MeshEdges::Edge&, const Vec3& a, const Vec3& b, const Vec3& outwards, const Part& body,
                       const Vec3& anchor, double within);
  /// A touch of a body with an edge that is in it, pushed out along the normal of a face: the shorter way of both.
  void add_out_of_edge(const MeshEdges::Edge&, const Vec3& a, const Vec3& b, const Solid& mesh, const Part& body,
                       bool is_mesh_second, const Vec3& anchor, double within, std::vector<Touch>& found);
  /// How far it reaches along a unit vector, m.
  static double reach(const Part&, const Vec3& direction, const Vec3& anchor);
  void set_edge(const Solid&, std::uint32_t number, const Vec3& a, const Vec3& b);
  void place(Part&, const Vec3& spin, const Vec3& anchor);
  void find(Part& first, Part& second, const Vec3& anchor, double within, const Vec3& way, std::vector<Touch>& found);
  void find_on_face(const ConvexPart& first, const ConvexPart& second, const Vec3& normal, const Vec3& anchor,
                    double within, std::vector<Touch>& found);
  /// visit(first, second): convex parts and rings whose boxes are near each other, and where may_touch(first, second).
  template <class MayTouch, class Visit>
  void for_each_near(const Vec3& anchor, const Vec3& spin_of_first, const Vec3& spin_of_second, double within,
                     MayTouch may_touch, Visit visit);

  Parts first_, second_;
  Clipper clipper_;
  RoundToucher round_{clipper_};
  CornerFinder corners_;
  PartList listed_, other_listed_;
  FormCache<std::optional<Polytope>> hulls_;  ///< of meshes, if they are convex
  FormCache<MeshEdges> edges_;
  Part edge_;
  std::vector<Touch> on_edge_;
};

}  // namespace iota::contact
