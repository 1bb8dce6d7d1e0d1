// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shape/traits.h"

namespace iota::shape {

/// The volume within a closed surface of triangles; from outside each triangle is counter-clockwise. Any other surface has no
/// volume. Its origin is arbitrary. Its numbers are not sizes: a system keeps them once, under a key.
template <>
struct Traits<Mesh> {
  static constexpr std::string_view name = "mesh", doc = "What a closed surface of triangles encloses.";
  static constexpr std::tuple<> sizes{};
  static void check(const Mesh&) {}  ///< `mass` and `check_triangles` do it
  static std::uint64_t key(const Mesh&);
  static double scale(const Mesh&);  ///< of the enclosing sphere about its origin
  /// Throws unless each triangle has three finite vertices that are there.
  static void check_triangles(const Mesh&);
  static bool has_volume(const Mesh&);  ///< it is closed, and not inside out or flat

  static MassProperties mass(const Mesh&);  ///< throws unless the surface is closed, see mass_properties
  static bool is_within(const Mesh&, const Vec3& p);
  static Vec3 closest(const Mesh&, const Vec3& p);
  static Vec3 support(const Mesh&, const Vec3& d);
  static Mesh triangulate(const Mesh& mesh, std::uint32_t) { return mesh; }
};

}  // namespace iota::shape
