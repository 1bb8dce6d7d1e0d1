// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "math/lanes.h"
#include "solver/heap_bodies.h"
#include "solver/heap_softness.h"
#include "solver/problem.h"

#include <array>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace iota::solver {

/// The contacts of a heap. In a sweep each is solved alone, with impulses that are kept from one sub-step to the next. Four of
/// different bodies are solved at once, in lanes. Those of one body keep their order, so that the results are those of
/// one after the other.
class HeapPoints {
 public:
  /// At the begin of a step in sub-steps of h seconds, with the impulses of the step before. The last of the motions is that
  /// of the world. rate: of the way of targets, 1/s.
  void load(const Problem&, const HeapBodies&, std::span<HeapMotion>, double h, double rate);
  /// Whether some carried nothing in the step before.
  bool are_new() const { return are_new_; }
  void warm(std::span<HeapMotion>) const;
  void sweep(std::span<HeapMotion>, const HeapSoftness&, double h);
  /// The impulse of an item of the pool in the present sub-step, N s, with that of a rebound if it met faster than this.
  double normal_impulse(std::uint32_t item, double least) const {
    const auto [pack, lane] = places_[item];
    if (pack == none) return 0;
    const PackBegin& begin = begins_[pack];
    return (begin.approach[lane] > least ? 1 + begin.restitution[lane] : 1) * packs_[pack].impulses[0][lane];
  }
  /// Gaps and directions at the places of the bodies, h seconds later.
  void refresh(const HeapBodies&, std::span<const HeapMotion>, double h);
  /// Ends a sub-step.
  void add_up();
  /// Bodies that met faster than this leave each other with a part of their speed.
  void rebound(std::span<HeapMotion>, double least);
  struct Report {
    double external_work = 0;  ///< of driven sides, J
    double depth = 0;          ///< largest overlap, m
  };
  /// Writes the multipliers: mean forces in h seconds.
  Report store(Problem&, double h) const;

 private:
  static constexpr std::uint32_t none = HeapBodies::none;

  /// A contact at the begin of a step.
  struct Point {
    std::uint32_t row = 0;
    std::uint32_t a = none, b = none;  ///< its bodies; the world is the last of the motions
    bool is_at_rest = false;           ///< one side does not move
    double friction = 0, restitution = 0, gap = 0, height = 0;
    Vec3 arm_a, arm_b;               ///< from the centers to the place
    Vec3 gap_a, gap_b;               ///< from the centers to the places that have the gap
    Vec3 drift;                      ///< velocity of driven sides, m/s
    std::array<Vec3, 3> ways;        ///< the normal, and two of friction
    std::array<double, 3> forces{};  ///< along them in the step before, N
  };
  /// Places that have no free body in common, with three directions in which each resists: the normal, and two of friction. Lanes without
  /// one are at the world. All of a sweep is in it, but for the motions.
  struct Pack {
    LaneNumbers a, b;     ///< bodies
    bool is_even = true;  ///< the inertia of all of them is the same in all directions: see HeapBody
    Lanes by_mass_a{}, by_mass_b{}, friction{}, gap{};
    Vec3Lanes arm_a, arm_b;  ///< from the centers to the place, now
    Vec3Lanes drift;         ///< rate by driven sides, m/s
    std::array<Vec3Lanes, 3> ways;
    Lanes masses[3]{}, impulses[3]{};  ///< kg; in a sub-step, N s
    Lanes by_normal[2]{};              ///< what a normal impulse adds to the rates of the two others, 1/kg
  };
  /// The rest of it, which sweeps do not need.
  struct PackBegin {
    int count = 0;
    LaneNumbers rows{};
    Vec3Lanes arm_a, arm_b, gap_a, gap_b;  ///< at the begin
    Vec3Lanes drifted;                     ///< the way of driven sides since the begin, m
    Lanes gap{};                           ///< at the begin, m
    Lanes half{};                          ///< 1/2, or 0 if one side does not move
    Lanes restitution{}, approach{};       ///< the latter at the begin, m/s
    Lanes sums[3]{};                       ///< impulses in the step, N s
  };
  /// The place of a body against that at the begin.
  struct alignas(32) Stand {
    Vec3 moved;
    double turn_w = 1;
    Mat3 turned = Mat3::diagonal(1);
    std::array<double, 3> filler{};  ///< it is gathered in fours
  };
  class Sides;

  bool load_point(const Problem&, const HeapBodies&, std::span<const HeapMotion>, std::size_t item, double rate,
                  const Vec3& up, Point&) const;
  void pack(const HeapBodies&, std::span<const HeapMotion>, double h);
  void turn(std::span<const HeapMotion>);
  static void weigh(Pack&, const HeapMotion*, const LaneMask& which);

  std::vector<Pack> packs_;
  std::vector<PackBegin> begins_;
  struct PlaceInPacks {
    std::uint32_t pack = none;
    int lane = 0;
  };
  std::vector<PlaceInPacks> places_;  // of each item of the pool
  bool are_new_ = false;
  // Scratch, kept for its capacity.
  std::vector<Point> points_;
  std::vector<std::pair<double, std::uint32_t>> by_height_;  // from above to below
  std::vector<std::uint32_t> next_of_body_, with_room_;      // packs
  std::vector<Stand> stands_;
};

}  // namespace iota::solver
