// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "solver/heap_bodies.h"
#include "solver/problem.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace iota::solver {

/// The implicit forces of a heap but grips: springs, drags, laws between points. In a sweep each gets the impulse that it has at the end of
/// the sub-step, by one step of Newton's method with the masses of its bodies: no stiffness is too large for that.
class HeapForces {
 public:
  /// After a change of structure.
  void find(const Problem&, const HeapBodies&);
  bool are_none() const { return items_.empty(); }
  /// How many act between bodies that are free.
  std::size_t count_between() const { return between_; }
  /// visit(a, b): each pair of free bodies with a force between them.
  template <class Visit>
  void for_each_pair(Visit visit) const {
    for (const Item& item : items_)
      for (std::uint32_t i = 0; i < item.count; ++i)
        for (std::uint32_t j = 0; j < i; ++j) visit(item.sides[i].body, item.sides[j].body);
  }

  /// At the begin of a step.
  void begin();
  /// At the begin of a sub-step of h seconds, from and to these fractions of the step's way of targets.
  void refresh(Problem&, const HeapBodies&, std::span<const HeapMotion>, double h, double from, double to);
  void warm(std::span<HeapMotion>) const;
  void sweep(const Problem&, std::span<HeapMotion>, double h);
  /// The work of forces from outside, where the bodies move like this in the sub-step, J.
  double work(const Problem&, std::span<const HeapMotion>) const;

 private:
  /// A body on which a force acts. Its points take parts of the force: the sum of these, and of arm times part.
  struct Side {
    std::uint32_t body = HeapBodies::none;
    double part = 0;
    Vec3 moment;  ///< m
  };
  struct Item {
    std::uint32_t number = 0;  ///< in its pool
    std::uint8_t pool = 0;
    std::uint32_t count = 0;
    std::array<Side, ForceArm::max_nodes> sides;
    Vec3 start;    ///< of the arm, in a sub-step, m
    Vec3 drift;    ///< rate of the arm by driven points, m/s
    Mat3 changes;  ///< of the rate of the arm by an impulse, 1/kg
    Vec3 impulse;  ///< N s
  };

  /// visit(item, force): each item.
  template <class P, class Items, class Visit>
  static void visit_forces(P&, Items&, Visit);
  static Vec3 rate_of(const Item&, std::span<const HeapMotion>);
  static void give(const Item&, const Vec3& impulse, std::span<HeapMotion>);

  std::vector<Item> items_;  // by pools
  std::size_t between_ = 0;
  std::vector<Vec3> x_, x_next_;
};

}  // namespace iota::solver
