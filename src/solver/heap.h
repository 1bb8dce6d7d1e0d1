// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "math/mat3.h"
#include "solver/heap_bodies.h"
#include "solver/heap_ties.h"
#include "solver/problem.h"

#include <array>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace iota::solver {

/// The result of a step by sweeps.
struct HeapReport {
  double external_work = 0;  ///< of held forces, torques, grips and driven bodies, J
  double depth = 0;          ///< largest overlap at the end, m
  double lifted = 0;         ///< potential energy by pushing overlaps apart, which is not motion, J
  bool are_joints_met = true;
};

/// A problem of rigid bodies that contacts and joints connect, beyond the size at which the equations of all contacts can be
/// solved at once. Its step is approximate: in short sub-steps each contact is solved alone, with impulses that are kept
/// from one sub-step to the next ("small steps": Macklin et al., Small Steps in Physics Simulation, 2019,
/// doi:10.1145/3309486.3340247; soft contacts and a pass that takes their push out of the velocities: E. Catto, Solver2D,
/// 2024). A body has six unknowns and turns as a rigid one, so that momentum and angular momentum are exact. Time is
/// linear in the number of contacts.
class Heap {
 public:
  /// After a change of structure: whether contacts, joints and other rows of two bodies connect rigid bodies, and no forces.
  bool find_bodies(const Problem&);
  bool has_joints() const { return !ties_.are_none(); }
  /// Estimates the multiplications of one factor of the equations of all contacts; not beyond 1e9.
  double cost_of_factor();
  static constexpr int most_sub_steps = 8;  ///< see heap.cpp
  /// A (sub-)step of h seconds, at whose end targets have gone this fraction of their way.
  HeapReport advance(Problem&, double h, double from, double fraction, int sub_steps = most_sub_steps);

 private:
  static constexpr std::uint32_t none = HeapBodies::none;
  using Body = HeapBody;
  using Motion = HeapMotion;

  /// One of the three directions in which a place resists. All of a sweep is in it, but for the motions of the bodies.
  struct Line {
    Vec3 way;
    Vec3 turn_a, turn_b;  ///< the rate of the way by the spins
    Vec3 spin_a, spin_b;  ///< what an impulse of 1 N s adds to the spins
    double drift = 0;     ///< rate by driven sides, m/s
    double mass = 0;      ///< kg
    double impulse = 0;   ///< in a sub-step, N s
  };
  /// A place where two bodies touch. Body `none` in the loading of it: the world, the last of the motions.
  struct Point {
    std::uint32_t a = none, b = none;
    double friction = 0;
    double gap = 0;  ///< m
    Line normal, first, second;
  };
  /// The rest of it, which sweeps do not need.
  struct PointBegin {
    std::uint32_t row = 0;
    bool is_at_rest = false;  ///< one side does not move
    double restitution = 0;
    double approach = 0;                            ///< at the begin, m/s
    Vec3 arm_a, arm_b;                              ///< at the begin
    Vec3 gap_a, gap_b;                              ///< from the centers to the places that have the gap, at the begin
    Vec3 drift, drifted;                            ///< velocity of driven sides, m/s; their way since the begin, m
    double gap = 0;                                 ///< at the begin, m
    double sum = 0, sum_first = 0, sum_second = 0;  ///< impulses in the step, N s
  };
  struct Grip {
    std::uint32_t body = none, item = 0;
    Vec3 arm, error;  ///< from the center to the held place; from its target, at the begin
  };

  void load_bodies(const Problem&, double h);
  void load_points(Problem&, double h, double rate);
  void load_grips(const Problem&);
  void push(double h, const Problem&, HeapReport&);
  void move(double h);
  void sweep(double h, const HeapSoftness&, int times);
  void solve_point(Point&, double h, const HeapSoftness&);
  void rebound(double least);
  void refresh_points(double h);
  void turn_lines(Point&, const Vec3& arm_a, const Vec3& arm_b) const;
  void weigh(Point&) const;
  bool is_free(std::uint32_t body) const { return body != none && motions_[body].by_mass > 0; }
  bool has_turned(std::uint32_t body) const;
  void give(const Point&, const Line&, double impulse);
  double rate_of(const Point&, const Line&) const;
  double power_of(const Vec3& gravity) const;  ///< W
  void store(Problem&, double h, HeapReport&);

  HeapBodies found_;
  HeapTies ties_;
  std::vector<Motion> motions_;  // of the bodies, and of the world
  std::vector<Point> points_;    // from above to below
  std::vector<PointBegin> begins_;
  std::vector<std::pair<double, std::uint32_t>> by_height_;
  std::vector<Point> sorted_points_;
  std::vector<PointBegin> sorted_begins_;
  bool has_new_points_ = false;  // that carried nothing in the step before
  std::vector<Grip> grips_;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs_;  // of free bodies that touch, or that a tie connects
};

}  // namespace iota::solver
