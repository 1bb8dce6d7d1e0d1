// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ingredient/island_nodes.h"
#include "ingredient/loads.h"
#include "ingredient/scope.h"
#include "model/audit.h"
#include "solver/diagnosis.h"
#include "solver/problem.h"

#include <concepts>
#include <string>
#include <tuple>
#include <type_traits>
#include <vector>

namespace iota::ingredient {

using solver::Problem;

/// The answers of a kind of thing that has nothing to say. An ingredient inherits them and hides those that it answers
/// itself. Static functions are about the whole model. The others are about one island: an ingredient object belongs to an
/// island and knows the places of its rows and forces in the island's problem.
struct NoAnswers {
  /// @name The model
  ///@{

  /// The tables of the ingredient, to and from bytes. The points, bodies and articulates are there already.
  template <class Archive>
  static void archive(Model&, Archive&) {}
  static void validate(const Model&, model::Audit&) {}
  /// Energy that the motion of points does not keep by itself, and momentum.
  static void add_energy(const Scope&, Energies&) {}
  static void add_momentum(const Scope&, Momenta&) {}
  /// The largest gap of its constraints, m.
  static double worst_gap(const Model&) { return 0; }
  /// What it did to the points of a body in the last step.
  static void add_loads(const LastStep&, std::uint32_t /*body*/, LoadReader&) {}
  /// Whether it keeps a particle that is a body by itself from flying freely.
  static bool holds(const Model&, std::uint32_t /*particle*/) { return false; }
  ///@}

  /// @name Building and stepping
  ///@{

  /// Adds masses, rows and forces to the problem, after those of the ingredients before it in the list.
  void build(const IslandMap&, Problem&) {}
  /// Parameters and warm multipliers go into the problem, for a step of h seconds (0: a projection). The problem has its
  /// positions and velocities already.
  void load(const Model&, const IslandNodes&, double /*h*/, Problem&) {}
  /// Changes what the scheme leaves alone, after its step of h seconds: damping, angles. Returns the energy that this
  /// takes away, J.
  double after_step(Model&, double /*h*/, Problem&) { return 0; }
  /// Multipliers and readings of a step of h seconds go back. The model has its new positions and velocities already.
  void store(Model&, const IslandNodes&, double /*h*/, const Problem&) const {}
  /// Brings what depends on positions up to date when they were not changed by a step but by a projection (`moved`: of
  /// positions too) or by an assignment.
  void refresh(Model&, const IslandNodes&, bool /*moved*/) const {}
  /// Whether rows are met that no step can change, since all their points are pinned.
  bool meets_pinned(const Model&) const { return true; }
  /// Kinetic energy in the problem that is not the model's, J.
  double virtual_energy(const Model&) const { return 0; }
  /// Says what a row of the problem is; empty for a row of another ingredient.
  std::string name_of_row(const Model&, const IslandNodes&, const solver::RowName&) const { return {}; }
  ///@}

  /// @name Points whose motion is prescribed
  ///@{

  /// Takes over where the script has put such points since the last step.
  void accept_assigned(Model&, const IslandNodes&) const {}
  bool prescribes_motion(const Model&, const IslandNodes&) const { return false; }
  /// The largest difference between a velocity in the problem and the prescribed one, m/s.
  double velocity_jump(const Problem&, double /*h*/) const { return 0; }
  void impose_velocities(Problem&, double /*h*/) const {}
  void impose_positions(Problem&) const {}
  ///@}

  /// @name Sleep
  ///@{
  bool wakes(const Model&, const IslandNodes&) const { return false; }  ///< an island that sleeps
  bool keeps_awake(const Problem&) const { return false; }              ///< an island that would fall asleep
  void put_to_rest(Model&) const {}
  ///@}

  /// @name An island that follows when its bodies are hinged otherwise
  ///@{
  bool can_follow() const { return true; }
  void renumber_node(std::uint32_t /*from*/, std::uint32_t /*to*/) {}
  ///@}
};

/// What is asked of every ingredient about the model.
template <class I>
concept ModelIngredient =
    requires(Model& model, const Model& seen, Writer& writer, Reader& reader, model::Audit& audit, const Scope& scope,
             Energies& energies, Momenta& momenta, const LastStep& step, LoadReader& loads, std::uint32_t slot) {
      I::archive(model, writer);
      I::archive(model, reader);
      I::validate(seen, audit);
      I::add_energy(scope, energies);
      I::add_momentum(scope, momenta);
      { I::worst_gap(seen) } -> std::same_as<double>;
      I::add_loads(step, slot, loads);
      { I::holds(seen, slot) } -> std::same_as<bool>;
    };

/// What the stages of a step ask of an ingredient of an island.
template <class I>
concept IslandIngredient = std::default_initializable<I> && std::movable<I> &&
                           requires(I& own, const I& fixed, Model& model, const Model& seen, const IslandNodes& nodes,
                                    const IslandMap& map, Problem& problem, const Problem& solved,
                                    const solver::RowName& row, double h, bool moved, std::uint32_t node) {
                             own.build(map, problem);
                             own.load(seen, nodes, h, problem);
                             { own.after_step(model, h, problem) } -> std::same_as<double>;
                             fixed.store(model, nodes, h, solved);
                             fixed.refresh(model, nodes, moved);
                             { fixed.meets_pinned(seen) } -> std::same_as<bool>;
                             { fixed.virtual_energy(seen) } -> std::same_as<double>;
                             { fixed.name_of_row(seen, nodes, row) } -> std::same_as<std::string>;
                             fixed.accept_assigned(model, nodes);
                             { fixed.prescribes_motion(seen, nodes) } -> std::same_as<bool>;
                             { fixed.velocity_jump(solved, h) } -> std::same_as<double>;
                             fixed.impose_velocities(problem, h);
                             fixed.impose_positions(problem);
                             { fixed.wakes(seen, nodes) } -> std::same_as<bool>;
                             { fixed.keeps_awake(solved) } -> std::same_as<bool>;
                             fixed.put_to_rest(model);
                             { fixed.can_follow() } -> std::same_as<bool>;
                             own.renumber_node(node, node);
                           };

/// The place of a constraint type in the list of the solver's types, as in `RowName::pool`.
template <class C, class List = solver::ConstraintPools<std::type_identity>>
inline constexpr std::size_t pool_index = 0;
template <class C, class... Rest>
inline constexpr std::size_t pool_index<C, std::tuple<std::type_identity<C>, Rest...>> = 0;
template <class C, class First, class... Rest>
inline constexpr std::size_t pool_index<C, std::tuple<First, Rest...>> = 1 + pool_index<C, std::tuple<Rest...>>;

/// The items of one type in a problem.
template <class C>
std::vector<C>& constraints_in(Problem& problem) {
  return std::get<solver::ConstraintPool<C>>(problem.constraints).items;
}
template <class F>
std::vector<F>& forces_in(Problem& problem) {
  return std::get<solver::ForcePool<F>>(problem.forces).items;
}
template <class F>
const std::vector<F>& forces_in(const Problem& problem) {
  return std::get<solver::ForcePool<F>>(problem.forces).items;
}

}  // namespace iota::ingredient
