// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "math/mat3.h"
#include "solver/delassus_factor.h"
#include "solver/heap_bodies.h"
#include "solver/heap_softness.h"
#include "solver/problem.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace iota::solver {

/// The rows of a heap that are no contacts: joints, limits, motors, friction of joints, ropes and rods between bodies, resistance
/// against rolling, nails, and the copies of points that bodies share. In a sweep each is solved alone, with impulses
/// within its bounds. What the sweeps leave open of equations is projected at the end of the step, by a factor of
/// these rows alone, so that joints are exact.
class HeapTies {
 public:
  /// After a change of structure. False if a row is a cone but no contact, or if many equations act on one body.
  bool find(const Problem&, const HeapBodies&);
  bool are_none() const { return ties_.empty(); }
  /// visit(a, b): each pair of free bodies that a tie connects.
  template <class Visit>
  void for_each_pair(Visit visit) const {
    for (const Tie& tie : ties_)
      for (const Side& one : sides_of(tie))
        for (const Side& other : sides_of(tie))
          if (one.body < other.body) visit(one.body, other.body);
  }

  /// visit(body): each that a tie connects with the world or what is driven.
  template <class Visit>
  void for_each_held(Visit visit) const {
    for (const Tie& tie : ties_)
      if (tie.side_count == 1) visit(sides_of(tie).front().body);
  }

  /// At the begin of a step in sub-steps of h seconds, with the impulses of the step before. All their places are those of the problem.
  void begin(const Problem&, const HeapBodies&, double h);
  /// At the places of the bodies, for a sub-step from and to these fractions of the step's way of targets.
  void refresh(const Problem&, const HeapBodies&, std::span<const HeapMotion>, double h, double from, double to);
  /// The largest gap of an equation, m.
  double worst_gap() const;
  /// Whether a body has a copy of a shared point beside it, which would be a point of it in the next step.
  bool are_copies_apart() const;
  void warm(std::span<HeapMotion>);
  /// Resistance has the bounds of what its contacts carry: impulse_of(contact), along the normal in a sub-step of h seconds, N s.
  template <class ImpulseOf>
  void bound_resistances(const Problem& problem, ImpulseOf impulse_of, double h) {
    for (const std::uint32_t k : resistances_) {
      RowLaw& law = ties_[k].law[0];
      law.upper = problem.items_of<ResistanceConstraint>()[ties_[k].item].bound(impulse_of) / h, law.lower = -law.upper;
    }
  }
  void sweep(std::span<HeapMotion>, const HeapSoftness&, double h);
  /// Ends a sub-step. Returns the work of rows that drive, J.
  double add_up();
  /// Writes the multipliers: mean forces in h seconds.
  void store(Problem&, double h);
  /// Moves velocities, and bodies on request, by the least changes in the mass norm onto the equations of the ties, at the first of these
  /// fractions of the way of targets in the step. They reach the second one h seconds later. False, without a
  /// change, if there are no such places.
  bool project(const Problem&, HeapBodies&, std::span<HeapMotion>, double h, double at, double later, bool positions);
  /// After `project`: the same for velocities that have changed since.
  void close_rates(std::span<HeapMotion>);

 private:
  static constexpr std::uint32_t none = HeapBodies::none;
  static constexpr std::uint8_t of_copies = 0xff;
  /// A free body of a tie: the rate of each row by its velocity and spin, in a sub-step.
  struct Side {
    std::uint32_t body = none;
    std::array<Vec3, 3> way, turn;
  };
  struct Tie {
    std::uint32_t first_side = 0, side_count = 0;
    std::uint32_t item = 0;  ///< in its pool; of a copy, its number
    std::uint8_t pool = of_copies, rows = 1;
    bool are_equations = true;  ///< of all its rows
    bool moves = false;         ///< its value depends on time
    // In a sub-step, each of the rows.
    std::array<double, 3> value{}, drift{};  ///< drift: rate of the value by targets alone
    double size = 0;                         ///< length of reference of the value, m
    Mat3 mass;                               ///< of equations: the inverse of what an impulse changes
    std::array<double, 3> by_mass{};         ///< of a row alone
    std::array<double, 3> impulse{}, sum{};
    std::array<RowLaw, 3> law;
  };

  /// visit(tie, pool): each tie with a constraint. Returns how many they are.
  template <class P, class Visit>
  std::size_t visit_rows(P&, Visit);
  std::span<const Side> sides_of(const Tie& tie) const {
    return std::span(sides_).subspan(tie.first_side, tie.side_count);
  }
  std::span<Side> sides_of(const Tie& tie) { return std::span(sides_).subspan(tie.first_side, tie.side_count); }
  bool are_met() const;
  bool close(const Problem&, HeapBodies&, std::span<HeapMotion>, double h, double at, double later);
  void factorize(std::span<const HeapMotion>);
  /// The changes of all bodies by impulses that take this from each row: rows(tie, r). Changes have no masses.
  template <class Rows>
  void find_changes(std::span<const HeapMotion>, Rows);
  /// The change of the rate of row r by a unit impulse of row s, 1/kg.
  double by_mass_of(const Tie&, int r, int s, std::span<const HeapMotion>) const;
  void weigh(Tie&, std::span<const HeapMotion>) const;
  double rate_of(const Tie&, int row, std::span<const HeapMotion>) const;
  void give(Tie&, int row, double impulse, std::span<HeapMotion>);

  std::vector<Tie> ties_;                   // by pools, copies last
  std::vector<Side> sides_;                 // of the ties
  std::vector<std::uint32_t> resistances_;  // ties
  std::vector<Vec3> x_, x_next_;
  // The ties of equations, and the factor that projects onto them.
  std::vector<std::uint32_t> equations_;
  DelassusFactor factor_;
  std::vector<Vec3> answers_;
  std::vector<HeapBody> bodies_before_;
  std::vector<HeapMotion> motions_before_, changes_;
  double work_ = 0;  // of rows that drive, in a sub-step, J
};

}  // namespace iota::solver
