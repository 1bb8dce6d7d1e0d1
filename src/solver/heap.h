// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "solver/heap_bodies.h"
#include "solver/heap_forces.h"
#include "solver/heap_points.h"
#include "solver/heap_ties.h"
#include "solver/problem.h"

#include <cstdint>
#include <utility>
#include <vector>

namespace iota::solver {

/// The result of a step by sweeps.
struct HeapReport {
  double external_work = 0;  ///< of held forces, torques, grips and driven bodies, J
  double depth = 0;          ///< largest overlap at the end, m
  double lifted = 0;         ///< potential energy by pushing overlaps apart, which is not motion, J
  bool are_joints_met = true;
  bool has_diverged = false;  ///< joints that cannot be met drove the sweeps without bound: it has not moved anything
};

/// A problem of rigid bodies that contacts and joints connect, beyond the size at which the equations of all contacts can be
/// solved at once. Its step is approximate: in short sub-steps each contact is solved alone, with impulses that are kept
/// from one sub-step to the next ("small steps": Macklin et al., Small Steps in Physics Simulation, 2019,
/// doi:10.1145/3309486.3340247; soft contacts and a pass that takes their push out of the velocities: E. Catto, Solver2D,
/// 2024). A body has six unknowns and turns as a rigid one, so that momentum and angular momentum are exact. Time is
/// linear in the number of contacts.
class Heap {
 public:
  /// After a change of structure: whether contacts, joints and other rows connect rigid bodies, and fewer forces than contacts: by
  /// sweeps nets and soft bodies would stretch.
  bool find_bodies(const Problem&);
  bool has_joints() const { return !ties_.are_none(); }
  /// Whether joints connect most of its bodies, and one that they connect with two others, or with one and the world, is far lighter than
  /// another one of them: sweeps do not hold what hangs on light links.
  bool has_light_joints() const { return has_light_joints_; }
  /// Whether hardly more pairs touch than there are bodies, as in chains and columns: where each link hangs on the one before,
  /// sweeps would need as many as the square of their number, and let it go.
  bool is_tree() const { return is_tree_; }
  bool has_forces() const { return !forces_.are_none(); }
  /// Estimates the multiplications of one factor of the equations of all contacts; not beyond 1e9.
  double cost_of_factor() const;
  /// At least, in no time.
  double least_cost_of_factor() const { return least_cost_; }
  /// A projection is about this.
  struct Projection {
    double h = 0;                         ///< s, in which targets go their way; 0: they rest
    std::span<const Vec3> impulses = {};  ///< of the points before, N s; or none
    bool positions = false;               ///< of both, not of velocities alone
  };
  /// Moves velocities, and positions on request, by the least changes in the mass norm onto the bodies and the equations between them.
  /// Contacts and other bounded rows are left to the sweeps of the next step, but for contacts of what targets drive by joints. False if
  /// no places meet these: it moves velocities alone.
  bool project(Problem&, const Projection&);
  static constexpr int most_sub_steps = 8;  ///< see heap.cpp
  /// A (sub-)step of h seconds, at whose end targets have gone this fraction of their way.
  HeapReport advance(Problem&, double h, double from, double fraction, int sub_steps = most_sub_steps);

 private:
  static constexpr std::uint32_t none = HeapBodies::none;
  using Body = HeapBody;
  using Motion = HeapMotion;

  struct Grip {
    std::uint32_t body = none, item = 0;
    Vec3 arm, error;  ///< from the center to the held place; from its target, at the begin
  };
  bool is_free(std::uint32_t body) const { return body != none && motions_[body].by_mass > 0; }
  template <class Visit>
  void for_each_own_point(Visit visit) const;
  void load_grips(const Problem&);
  void find_least_cost();
  bool find_light_joints(const Problem&) const;
  void load_bodies(const Problem&, double h);
  static void invert_inertia(Body&, Motion&);
  struct Length {
    std::uint32_t body, item;  ///< of the pool of lengths
  };
  void restore_shapes(const Problem&);
  void restore_shape(const Problem&, std::uint32_t body, std::span<const Length>);
  void push(double h, const Problem&, HeapReport&);
  void move(double h);
  void sweep(const Problem&, double h, const HeapSoftness&, int times);
  double power_of(const Vec3& gravity) const;  ///< W
  void store(Problem&, double h, HeapReport&);
  void store_velocities(Problem&) const;
  void store_positions(Problem&) const;
  /// Whether a joint has opened by more than the size of a body, from a gap of so many m, or a body has gone much further than it
  /// could by the motions of all and to close it.
  bool has_diverged(const Problem&, double h, double gap_before, double gap) const;

  HeapBodies found_;
  HeapTies ties_;
  HeapForces forces_;
  std::vector<Motion> motions_;  // of the bodies, and of the world
  HeapPoints points_;
  std::vector<Grip> grips_;
  bool has_light_joints_ = false, is_tree_ = false;
  double least_cost_ = 0;                                       // of a factor
  std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs_;  // of free bodies that touch, or that a tie connects
};

}  // namespace iota::solver
