// SPDX-License-Identifier: Apache-2.0
// Vectors in tests.
#pragma once

#include <iota/vec3.h>

#include <gtest/gtest.h>

namespace iota {

/// A cross product of its own, beside that of the engine.
inline Vec3 cross_of(const Vec3& a, const Vec3& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

inline void expect_near(const Vec3& a, const Vec3& b, double tolerance) {
  EXPECT_NEAR(a.x, b.x, tolerance);
  EXPECT_NEAR(a.y, b.y, tolerance);
  EXPECT_NEAR(a.z, b.z, tolerance);
}

}  // namespace iota
