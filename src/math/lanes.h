// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/wider.h"

#include <iota/vec3.h>

#include <array>
#include <cmath>
#include <cstdint>

/// Four numbers side by side, with one operation for all of them: four places of a heap are solved in the time of one. Each lane
/// has the bits that a plain number would have.
namespace iota {

// How they are passed to functions depends on the machine: they are passed to inlined ones only.
#pragma GCC diagnostic ignored "-Wpsabi"

constexpr int lane_count = 4;
/// The alignment is said, since it would be that of the machine: a function that is compiled for wider registers took another one.
using Lanes __attribute__((vector_size(lane_count * sizeof(double)), aligned(lane_count * sizeof(double)))) = double;
using LaneMask = decltype(Lanes{} < Lanes{});  ///< a lane: all bits, or none

IOTA_ALWAYS_INLINE Lanes lanes_of(double a) { return Lanes{a, a, a, a}; }
IOTA_ALWAYS_INLINE Lanes select(const LaneMask& mask, const Lanes& a, const Lanes& b) { return mask ? a : b; }
IOTA_ALWAYS_INLINE Lanes largest(const Lanes& a, const Lanes& b) { return select(a < b, b, a); }
IOTA_ALWAYS_INLINE bool any(const LaneMask& mask) { return (mask[0] | mask[1] | mask[2] | mask[3]) != 0; }
IOTA_ALWAYS_INLINE Lanes square_root(const Lanes& a) {
  Lanes root;
  for (int k = 0; k < lane_count; ++k) root[k] = std::sqrt(a[k]);
  return root;
}

struct Vec3Lanes {
  Lanes x{}, y{}, z{};

  void set(int lane, const Vec3& v) { x[lane] = v.x, y[lane] = v.y, z[lane] = v.z; }
  Vec3 at(int lane) const { return {x[lane], y[lane], z[lane]}; }
};
IOTA_ALWAYS_INLINE Vec3Lanes operator+(const Vec3Lanes& a, const Vec3Lanes& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
IOTA_ALWAYS_INLINE Vec3Lanes operator-(const Vec3Lanes& a, const Vec3Lanes& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
IOTA_ALWAYS_INLINE Vec3Lanes operator*(const Lanes& s, const Vec3Lanes& a) { return {s * a.x, s * a.y, s * a.z}; }
IOTA_ALWAYS_INLINE Lanes dot(const Vec3Lanes& a, const Vec3Lanes& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
IOTA_ALWAYS_INLINE Vec3Lanes cross(const Vec3Lanes& a, const Vec3Lanes& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

struct Mat3Lanes {
  Vec3Lanes rows[3];
};
IOTA_ALWAYS_INLINE Vec3Lanes operator*(const Mat3Lanes& m, const Vec3Lanes& v) {
  return {dot(m.rows[0], v), dot(m.rows[1], v), dot(m.rows[2], v)};
}

/// Four rows of four numbers, one of each lane, and the same by columns: its own inverse.
struct FourLanes {
  Lanes row[lane_count];

  Lanes& operator[](int k) { return row[k]; }
  const Lanes& operator[](int k) const { return row[k]; }
  Vec3Lanes first_three() const { return {row[0], row[1], row[2]}; }
};
IOTA_ALWAYS_INLINE FourLanes transposed(const FourLanes& rows) {
  const Lanes a = __builtin_shufflevector(rows[0], rows[1], 0, 4, 2, 6),
              b = __builtin_shufflevector(rows[0], rows[1], 1, 5, 3, 7),
              c = __builtin_shufflevector(rows[2], rows[3], 0, 4, 2, 6),
              d = __builtin_shufflevector(rows[2], rows[3], 1, 5, 3, 7);
  return {{__builtin_shufflevector(a, c, 0, 1, 4, 5), __builtin_shufflevector(b, d, 0, 1, 4, 5),
           __builtin_shufflevector(a, c, 2, 3, 6, 7), __builtin_shufflevector(b, d, 2, 3, 6, 7)}};
}

/// Which record of an array each lane has.
using LaneNumbers = std::array<std::uint32_t, lane_count>;
/// Lanes that lie in a record: the copy of so many bytes would be made in halves.
using LanesInRecord
    __attribute__((vector_size(lane_count * sizeof(double)), aligned(lane_count * sizeof(double)), may_alias)) = double;
/// The numbers at 4 k to 4 k + 3 of records that are of numbers alone and aligned as lanes, by lanes.
template <class Record>
IOTA_ALWAYS_INLINE FourLanes gather(const Record* records, const LaneNumbers& numbers, int k) {
  static_assert(alignof(Record) == sizeof(Lanes));
  FourLanes rows;
  for (int lane = 0; lane < lane_count; ++lane)
    rows[lane] = reinterpret_cast<const LanesInRecord*>(records + numbers[lane])[k];
  return transposed(rows);
}
template <class Record>
IOTA_ALWAYS_INLINE void scatter(const FourLanes& columns, Record* records, const LaneNumbers& numbers, int k) {
  static_assert(alignof(Record) == sizeof(Lanes));
  const FourLanes rows = transposed(columns);
  for (int lane = 0; lane < lane_count; ++lane)
    reinterpret_cast<LanesInRecord*>(records + numbers[lane])[k] = rows[lane];
}

}  // namespace iota
