// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "contact/touches.h"
#include "math/mat3.h"
#include "shape/shape.h"

#include <algorithm>
#include <array>
#include <random>
#include <variant>
#include <vector>

/// Outlines for tests of contact, and distances that do not use its sources.
namespace iota::contact {

inline Outline placed(const Shape& shape, const Vec3& position, const Quaternion& turn = {}, std::uint32_t number = 7) {
  Outline outline;
  outline.solids.push_back({make_form(shape), number, position, turn});
  return outline;
}

/// An L of two boxes as one mesh: a step of height 1 at x = 0.
inline Mesh step_mesh() {
  const std::vector<Vec3> front{{-1, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}, {0, 2, 1}, {-1, 2, 1}};
  Mesh mesh;
  mesh.vertices = front;
  for (Vec3 place : front) place.z = -1, mesh.vertices.push_back(place);
  for (const auto& [a, b, c] : {std::array{0u, 1u, 2u}, {0u, 2u, 3u}, {0u, 3u, 5u}, {3u, 4u, 5u}}) {
    mesh.triangles.push_back({a, b, c});
    mesh.triangles.push_back({a + 6, c + 6, b + 6});
  }
  for (std::uint32_t k = 0; k < 6; ++k) {
    const std::uint32_t next = (k + 1) % 6;
    mesh.triangles.push_back({k, k + 6, next}), mesh.triangles.push_back({next, k + 6, next + 6});
  }
  return mesh;
}

inline std::vector<Touch> touches_of(const Outline& first, const Outline& second, double within, const Vec3& way = {}) {
  TouchFinder finder;
  std::vector<Touch> found;
  finder.find(first, {}, second, {}, within, found, way);
  return found;
}

inline double least_gap_of(const std::vector<Touch>& found) {
  double least = 1e300;
  for (const Touch& touch : found) least = std::min(least, touch.gap);
  return least;
}

/// The farthest point of a solid in a direction of the world.
inline Vec3 farthest_of(const Solid& solid, const Vec3& direction) {
  const Vec3 local = rotate(conjugate(solid.turn), direction);
  if (!solid.form->mesh) return solid.position + rotate(solid.turn, shape::support(solid.form->shape, local));
  Vec3 best = solid.form->mesh->vertices().front();
  for (const Vec3& corner : solid.form->mesh->vertices())
    if (dot(corner, local) > dot(best, local)) best = corner;
  return solid.position + rotate(solid.turn, best);
}

/// An upper bound of the distance of two solids: alternating projections, from the first one's middle.
inline double upper_distance(const Solid& a, const Solid& b, int rounds = 200) {
  const auto project = [](const Solid& solid, const Vec3& place) {
    const Vec3 local = rotate(conjugate(solid.turn), place - solid.position);
    return is_within(*solid.form, local) ? place : solid.position + rotate(solid.turn, closest(*solid.form, local));
  };
  Vec3 on_a = a.position;
  double distance = 1e300;
  for (int k = 0; k < rounds; ++k) {
    const Vec3 on_b = project(b, on_a);
    on_a = project(a, on_b);
    if (k > 5 && norm(on_a - on_b) > distance * (1 - 1e-14)) break;
    distance = norm(on_a - on_b);
  }
  return distance;
}

/// Random convex shapes of a size.
class RandomShapes {
 public:
  static constexpr int kinds = 9;
  explicit RandomShapes(unsigned seed) : random_(seed) {}
  double number(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }
  Vec3 vector(double size) { return {number(-size, size), number(-size, size), number(-size, size)}; }
  Quaternion turn() { return normalized({number(-1, 1), number(-1, 1), number(-1, 1), number(-1, 1)}); }
  Shape make(int kind, double size) {
    const auto part = [&](double low, double high) { return size * number(low, high); };
    switch (kind) {
      case 0: return Sphere{part(0.2, 1)};
      case 1: return Box{{part(0.2, 2), part(0.2, 2), part(0.2, 2)}};
      case 2: return Box{{part(0.4, 2), part(0.4, 2), part(0.4, 2)}, part(0.02, 0.2)};
      case 3: return Capsule{part(0.1, 0.6), part(0.1, 3)};
      case 4: return Cylinder{part(0.2, 1), part(0.2, 2)};
      case 5: return Cylinder{part(0.3, 1), part(0.4, 2), part(0.02, 0.2)};
      case 6: return Cone{part(0.2, 1), part(0.2, 2)};
      case 7: return Ellipsoid{{part(0.5, 2), part(0.5, 2), part(0.5, 2)}};
      default: {
        std::vector<Vec3> places;
        for (int k = 0; k < 10; ++k) places.push_back(vector(size));
        return convex_hull(places);
      }
    }
  }

 private:
  std::mt19937 random_;
};

}  // namespace iota::contact
