// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "solver/problem.h"
#include "solver/stage.h"

#include <span>
#include <vector>

namespace iota::solver {

/// The sides of rows with bounds (RowLaw): at a bound, or free. A primal-dual active set (Hintermueller, Ito, Kunisch
/// 2002): at each iteration a row is at the bound beyond which lambda + g / (natural compliance) lies, or free. All
/// rows change at once while that reduces the number of wrong ones. Otherwise friction and motors first yield, less and
/// less; then rows change one at a time, lowest first, which cannot cycle (Judice and Pires 1994). A cone switches as one row does,
/// between its own states; many of a heap do so all at once in any case, as one after the other takes as many iterations and may
/// cycle. States and multipliers are in the pools.
class ActiveSet {
 public:
  /// Sets sides from the multipliers of the last step; no other state is kept between steps. x: the guess of positions. Contacts
  /// of loose bodies that touch before and after it are closed. If each were open until others push it, a chain of 64 links that
  /// all fall alike would take 113 iterations in its first step.
  void begin(Problem&, const Stage&, const Vec3* x);
  /// Switches rows between bounds and free, by positions x and multipliers; returns whether any changed. Rows within
  /// the tolerance do not change.
  bool choose(Problem&, const Stage&, const Vec3* x);
  /// Undoes the changes of sides and multipliers by the last call of `choose`, of a problem with many cones.
  void take_back();
  /// Whether the last call of `choose` found a cone in a wrong state.
  bool has_changed_cones() const { return has_changed_cones_; }
  /// Whether cones change their states all at once in any case; not in machines, whose contacts are softened.
  bool has_many_cones() const { return has_many_cones_; }
  /// How many times its usual iterations a solve may take after the last call of `choose`.
  int times_for_sides(const Stage&) const;
  /// Gives the normals of contacts so many times their compliances, while a solution is sought.
  static void soften_cones(Problem&, double by);
  static constexpr int most_softenings = 6;
  /// Gives resistances the bounds of the present reactions; returns whether these differ from the former by more than a thousandth.
  /// Reactions hardly depend on such torques, so that it ends after one or two times; at most a few since `begin`.
  bool follow_reactions(Problem&, const Stage&);
  /// Number of rows that became free since `begin`.
  static int count_met(const Problem&);

  /// Selects bounded rows for a projection of velocities: those with one bound and no gap ...
  static void begin_impulses(Problem&);
  /// ... or those that the latest solve left free, including motors at their speed and sticking friction.
  static void begin_impulses_after_step(Problem&);
  /// Releases rows whose impulse, by unknown, has the wrong sign; returns whether there were any.
  static bool release_impulses(Problem&, std::span<const double> impulses);
  /// After a step of h seconds and late impulses: opens contacts that would pull by both, lets those stick whose friction
  /// would have reversed their slip, and those slip that would stick with more than their cone allows; returns whether there were any.
  static bool switch_impacts(Problem&, double h, std::span<const double> impulses);

  template <class C>
  static void set_cone(ConstraintPool<C>&, std::size_t item, ConeState);

  /// @name Sides in an explicit sub-step, which do not change in it (active_set_motion.cpp)
  ///@{
  struct Sides {
    bool can_follow = true;  ///< not if a stop is met, or with a cone
    bool are_new = false;    ///< other ones than before
    bool stop_any = false;   ///< a row became an equation
    bool jump_any = false;   ///< a motor or brake reaches its speed at once
  };
  /// Springs are forces, unless those that vibrate too fast for sub-steps obey their loads: then these are equations, whose values
  /// are what their loads stretch them by.
  enum class Springs : std::uint8_t { vibrate, obey_loads };
  /// By positions and velocities, in a step of h seconds: friction and motors slide or have their speed, stops are open or carry.
  static Sides begin_motion(Problem&, double h, Springs);
  /// For the springs that obey their loads: notes their multipliers at a time within a sub-step, ...
  static constexpr double inner_time = 0.8;  ///< of the sub-step
  static void note_loads(Problem&);
  /// ... and sets their stretch and its rate at the end of one of h seconds, by the multipliers there.
  static void stretch_by_loads(Problem&, double h);
  /// The largest vibration of one of them, by its multiplier, m.
  static double largest_vibration(const Problem&);
  /// Moves equations whose multipliers are beyond a bound to it; returns whether any.
  static bool release_motion(Problem&);
  /// The part of the sub-step after which a row has left its side, by interpolation; 1: none. A row that does so in
  /// less than `least` of it begins the next sub-step with its new side.
  static double find_change(Problem&, double h, double least);
  /// The longest sub-step in which springs of rows are not stiff, in a step of h seconds, s. Those that obey their loads do not count.
  static double longest_step(const Problem&, double h, Springs);
  ///@}

 private:
  template <class C>
  static void begin_cone(ConstraintPool<C>&, std::size_t item, const Problem&, const Stage&);
  template <class C>
  static ConeState choose_state(const ConstraintPool<C>&, std::size_t item, const Problem&, const Stage&,
                                const Vec3* x);

  static void close_touching(Problem&, const Stage&, const Vec3* x);
  void soften(Problem&, const Stage&, const Vec3* x);

  /// A row and its multiplier before it changed.
  struct Change {
    RowStates::Row* row;
    RowStates::Row row_before;
    double* multiplier;
    double multiplier_before;
  };
  /// Notes rows of an item, which are about to change, of a problem with many cones.
  template <class C>
  void note(ConstraintPool<C>&, std::size_t item, int first, int count);

  static constexpr std::size_t few_cones = 8;

  int fewest_wrong_ = 0, stalled_ = 0, followed_ = 0;
  double softening_ = 0;  // of rate rows, in their natural compliances
  bool has_softened_ = false, has_changed_cones_ = false, has_many_cones_ = false;
  std::vector<Change> changes_;  // by the last call of `choose`
};

}  // namespace iota::solver
