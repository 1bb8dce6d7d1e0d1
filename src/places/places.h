// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "geometry/box_tree.h"
#include "geometry/triangle_tree.h"

#include <iota/system.h>

#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace iota {

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

/// Questions about the places of bodies and of fixed shapes without physics: the exact shapes of solids, and lines from
/// particle to particle of the other bodies, as thick as `set_thickness` says. Sparks are not found, inactive bodies only
/// where they are named. A tree of boxes follows the motion: each question first compares the places of all bodies with
/// those of the last one (10 us for each 1000 bodies), and only a change costs more.
class Places {
 public:
  using Only = std::optional<std::span<const BodyId>>;  ///< nothing: all bodies and fixed shapes

  /// `system` must outlive it.
  explicit Places(System& system) : system_(system) {}
  Places(const Places&) = delete;
  Places& operator=(const Places&) = delete;

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

  /// Radius of the lines of a body, m.
  void set_thickness(BodyId, double radius);
  /// Sets the radius, m, of bodies that have none of their own: `line` for several particles, `ball` for a single one.
  void set_usual_thickness(double line, double ball) { usual_line_ = line, usual_ball_ = ball, has_moved_ = true; }

 private:
  using Tree = std::shared_ptr<const geometry::TriangleTree>;
  struct Solid {
    Shape shape;    ///< a mesh without its triangles
    Tree mesh;      ///< null for other shapes
    Tree outline;   ///< of a shape that is neither a mesh nor convex
    Vec3 position;  ///< in the frame of the body, m
    Quaternion turn;
  };
  struct Known {
    Found what;
    bool is_active = true;
    std::uint32_t first = 0, count = 0;  ///< particles, or solids
    std::uint32_t pose = none;           ///< of what consists of solids
    double reach = 0;                    ///< of its solids about its place, m; infinite without an end
  };
  struct Thickness {
    BodyId id;
    double radius = 0;
  };
  struct Near {
    double distance = std::numeric_limits<double>::infinity();
    Vec3 point;
  };
  static constexpr std::uint32_t none = Found::none, fixed_pose = none - 1;

  /// Brings everything up to date.
  void refresh();
  void describe_bodies();
  void describe_solids(Known&);
  void describe_fixed();
  std::uint32_t add(Solid);
  static Solid make_solid(Shape, const Vec3& position, const Quaternion& turn);
  void read_places();
  geometry::Bounds bounds(const Known&) const;
  double thickness(const Known&) const;
  /// The numbers of these bodies. Throws StaleIdError.
  std::vector<std::uint32_t> numbers(std::span<const BodyId> only) const;
  Near near(const Known&, const Vec3& place) const;
  std::optional<double> meet(const Known&, const Vec3& from, const Vec3& unit, double farthest) const;
  /// Whether a place in its frame is inside.
  static bool holds(const Solid&, const Vec3& local);
  static double reach_of(const Solid&);
  bool is_overlapped(const Known&, const Solid& probe) const;
  template <class Visit>
  void for_each_line(const Known&, Visit visit) const;
  template <class Visit>
  void for_each_solid(const Known&, Visit visit) const;
  /// visit(known) returns the new limit; nearer boxes come first.
  template <class Visit>
  void search_near(const Vec3& place, double within, Only only, Visit visit);
  template <class Visit>
  void search_along(const Vec3& from, const Vec3& unit, double within, Only only, Visit visit);

  System& system_;
  std::vector<Thickness> thickness_;  ///< by slot
  double usual_line_ = 0.01, usual_ball_ = 0.02;
  bool has_moved_ = true;

  std::uint32_t version_ = 0;  ///< of the described scene
  std::vector<Known> known_;
  std::vector<std::uint32_t> number_;  ///< in known_, by slot
  std::vector<ParticleId> particles_;
  std::vector<BodyId> posed_;
  std::vector<Solid> solids_;                ///< of bodies, then fixed ones
  std::vector<std::optional<Solid>> fixed_;  ///< by number
  bool is_fixed_changed_ = false;
  std::size_t body_count_ = 0, body_solids_ = 0;  ///< of known_ and solids_: those before the fixed ones
  std::vector<double> places_, before_;           ///< of the particles, then the poses; now, and in the tree
  std::vector<std::uint32_t> items_;              ///< of the tree: numbers of bodies
  std::vector<std::uint32_t> endless_;
  std::vector<geometry::Bounds> boxes_;
  geometry::BoxTree tree_;
};

}  // namespace iota
