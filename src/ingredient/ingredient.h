// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ingredient/island_nodes.h"
#include "ingredient/loads.h"
#include "ingredient/scene_view.h"
#include "ingredient/scope.h"
#include "model/audit.h"
#include "model/end_table.h"
#include "solver/diagnosis.h"
#include "solver/problem.h"

#include <concepts>
#include <span>
#include <string>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <vector>

namespace iota {
struct DrawnBody;
struct SceneChanges;
}  // namespace iota

namespace iota::ingredient {

using model::Structure;
using solver::Problem;
using Visit = Structure::Visit;
struct Outcome;

/// The command that destroys the object of an id.
template <class IdType>
struct Destroy {
  static constexpr std::string_view queued_as = "destroy";
  IdType id;
};

/// The default functions of an ingredient, which do nothing. An ingredient inherits them and hides those that it
/// defines. Static functions are for the whole model. The others are for one island: an ingredient object belongs to an
/// island and has the indices of its rows and forces in the island's problem.
struct NoAnswers {
  /// Marks the ingredient's items in the problem; the island numbers its ingredients.
  std::uint8_t owner = 0;

  /// @name The model
  ///@{

  /// Its data. `Model` inherits the tables of all ingredients, so that members are found by their names.
  struct Tables {
    /// To and from bytes. The structure exists already.
    template <class Archive>
    void archive(Archive&, const Structure&) {}
  };
  /// The commands that change its tables and nothing else, each with a function `apply(Model&, const C&)`. The other
  /// commands are in src/edit.
  using Commands = std::tuple<>;
  /// Moves data that are not saved from the replaced model, and rebuilds data that are derived from tables.
  static void take_over(Model& /*restored*/, Model& /*before*/) {}
  static void validate(const Model&, model::Audit&) {}
  /// Checks its tables before any code follows their slots: see `Audit::check_links`.
  static void check_links(const Model&, model::Audit&) {}
  /// Adds its kinetic and potential energy, and its momentum.
  static void add_energy(const Scope&, Energies&) {}
  static void add_momentum(const Scope&, Momenta&) {}
  /// The largest gap of its constraints, m.
  static double worst_gap(const Scope&) { return 0; }
  /// Its forces on the points of a body in the last step.
  static void add_loads(const LastStep&, std::uint32_t /*body*/, LoadReader&) {}
  /// Whether it holds a particle or ties it to others: its body is then not free.
  static bool holds(const Model&, std::uint32_t /*particle*/) { return false; }

  /// Whether it refers to a particle.
  static bool uses(const Model&, std::uint32_t /*particle*/) { return false; }
  /// Whether one of its forces replaces gravity.
  static bool replaces_gravity(const Model&) { return false; }
  /// Angular momentum of a body beside that of its points, kg m^2/s.
  static Vec3 inner_momentum(const Model&, std::uint32_t /*body*/) { return {}; }
  ///@}

  /// @name Connections
  ///@{

  /// visit(body): of the bodies that it joins with a particle's body in one articulate, as hinges do.
  static void visit_joined(const Model&, std::uint32_t /*particle*/, Visit) {}
  /// visit(body): of the bodies that must be solved together with a particle's body, by constraints or by forces.
  static constexpr bool ties_rigidly = false, ties_by_contact = false;
  static void visit_tied(const Model&, std::uint32_t /*particle*/, Visit) {}
  static bool ties_any(const Model&) { return false; }
  static bool ties_to_world(const Model&, std::uint32_t /*body*/) { return false; }  ///< by a constraint
  /// visit(particle): of the particles that stay with a particle when its body is split.
  static void visit_companions(const Model&, std::uint32_t /*particle*/, Visit) {}
  ///@}

  /// @name Outlines
  ///@{

  /// visit(p, q): of the lines between particles of a body.
  static void visit_lines(const Model&, std::uint32_t /*body*/, Structure::VisitLine) {}
  /// The radius that it gives to a particle instead of its attributes, m; 0: none.
  static double ball_radius(const Model&, std::uint32_t /*particle*/) { return 0; }
  ///@}

  /// @name Edits
  ///@{

  /// Particle p replaces q: references to q become references to p, or end.
  static void absorb(Model&, std::uint32_t /*q*/, std::uint32_t /*p*/) {}
  /// A particle will be destroyed: ends all references to it.
  static void drop(Model&, std::uint32_t /*particle*/) {}
  static void forget_particle(Model&, std::uint32_t /*particle*/) {}  ///< it was destroyed
  static void forget_body(Model&, std::uint32_t /*body*/) {}
  /// The first particle of a ring has changed, or the empty ring was destroyed.
  static void ring_changed(Model&, std::uint32_t /*ring*/) {}
  /// A ring is merged into another one; `replaces`: the pin of `from` now holds `into`.
  static void ring_merged(Model&, std::uint32_t /*into*/, std::uint32_t /*from*/, bool /*replaces*/) {}
  static void inertia_changed(Model&, std::uint32_t /*body*/) {}     ///< the basis or the inertia pairs of a body
  static void acting_changed(Model&, std::uint32_t /*particle*/) {}  ///< see Structure::acts
  /// Ends the closing of two particles. False if there is none.
  static bool call_off(Model&, std::uint32_t /*p*/, std::uint32_t /*q*/) { return false; }
  /// Destroys items that an edit of some bodies (all alive) has made meaningless, with notes.
  static void clean_up(Model&, std::span<const std::uint32_t> /*bodies*/, std::vector<std::string>& /*notes*/) {}
  /// Saves the state before an edit of some bodies that `reattach` needs.
  struct Memory {};
  static Memory remember(const Model&, std::span<const std::uint32_t> /*bodies*/) { return {}; }
  /// Since then particles may have been absorbed, bodies joined, split or destroyed.
  static void reattach(Model&, const Memory&) {}
  /// Before an island with the body is built or follows a change: the body may have another basis, in the same place. Adds
  /// rows to tables that islands will write from several threads.
  static void prepare(Model&, std::uint32_t /*body*/) {}
  ///@}

  /// @name Viewers
  ///@{

  /// Items that have changed or were destroyed without a change of a body; null: none.
  static model::ChangedSlots* scene_log(Model&) { return nullptr; }
  /// Describes the items of the view.
  static void describe(const SceneView&, SceneChanges&) {}
  /// Its part of the drawing of a body.
  static void draw(const SceneView&, std::uint32_t /*body*/, DrawnBody&) {}
  ///@}

  /// @name After a step
  ///@{

  /// Its changes by a step of h seconds that no island makes: ages, orientations of balls, forces that end.
  static void end_step(Model&, double /*h*/) {}
  /// Tells what the step has led to: overloads, stops, births, deaths, ends. It makes no edit, since others read loads
  /// after it. It is asked in each step: keep it cheap if nothing can happen.
  static void tell(Model&, Outcome&) {}
  ///@}

  /// @name Building and stepping
  ///@{

  /// Adds the masses, rows and forces of the map's bodies, after those of the ingredients before it in the list. When an
  /// island follows a change, the map has the bodies at the nodes that changed, and the problem refuses items at other
  /// nodes, which it has already. An item's key identifies it without a parallel list.
  void build(const IslandMap&, Problem&) {}
  /// Takes the map's bodies out of the lists of `build`, except of the items of the problem ...
  void leave(const IslandMap&) {}
  /// ... or all.
  void clear() {}
  /// Replaces the island's transient forces, which couple only points that are coupled anyway.
  void renew_pulls(const IslandMap&, Problem&) {}
  /// Loads parameters and warm multipliers into the problem, for a step of h seconds (0: a projection), after positions
  /// and velocities. The same model loads the same problem, as a step may be tried several times.
  void load(const Model&, const IslandNodes&, double /*h*/, Problem&) {}
  /// Changes by a step of h seconds that is being stored: spins, strains. Returns the dissipated energy, J.
  double after_step(Model&, double /*h*/, Problem&) { return 0; }
  /// Stores multipliers and readings of a step of h seconds, after the model's positions and velocities.
  void store(Model&, const IslandNodes&, double /*h*/, const Problem&) const {}
  /// Updates data that depend on positions after a projection (`moved`: of positions too) or an assignment, without a
  /// step.
  void refresh(Model&, const IslandNodes&, bool /*moved*/) const {}
  /// Whether rows with only pinned points, which no step can change, are satisfied.
  bool meets_pinned(const Model&) const { return true; }
  /// Kinetic energy of the problem that the model does not have, J.
  double virtual_energy(const Model&) const { return 0; }
  /// Names one of its rows.
  std::string name_of_row(const Model&, solver::ItemKey) const { return {}; }
  ///@}

  /// @name Points whose motion is prescribed
  ///@{

  /// Reads the places that the script has assigned to such points since the last step.
  void accept_assigned(Model&, const IslandNodes&) const {}
  bool prescribes_motion(const Model&, const IslandNodes&) const { return false; }
  /// The largest difference between a velocity in the problem and the prescribed one, m/s.
  double velocity_jump(const Problem&, double /*h*/) const { return 0; }
  /// The largest change of the speed at which a row's target moves, from the last step to this one, m/s.
  double rate_jump() const { return 0; }
  void impose_velocities(Problem&, double /*h*/) const {}
  void impose_positions(Problem&) const {}
  ///@}

  /// @name Sleep
  ///@{
  /// visit(ring): of what the next step, of h seconds, moves or pushes anew without an edit. This wakes, as edits do, and
  /// begins the time before sleep again.
  static void visit_stirred(const Model&, double /*h*/, Visit) {}
  bool keeps_awake(const Model&, const Problem&) const { return false; }  ///< an island that is slow
  void put_to_rest(Model&, const Problem&) const {}
  ///@}
};

/// The functions of every ingredient for the model.
template <class I>
concept ModelIngredient = requires(
    Model& model, const Model& seen, model::Audit& audit, const Scope& scope, Energies& energies, Momenta& momenta,
    const LastStep& step, LoadReader& loads, std::uint32_t slot, std::span<const std::uint32_t> bodies,
    std::vector<std::string>& notes, Visit visit, Structure::VisitLine visit_line, const SceneView& view,
    SceneChanges& changes, DrawnBody& drawn, double h, Outcome& outcome) {
  typename I::Tables;
  typename I::Commands;
  I::take_over(model, model);
  I::validate(seen, audit);
  I::check_links(seen, audit);
  I::add_energy(scope, energies);
  I::add_momentum(scope, momenta);
  { I::worst_gap(scope) } -> std::same_as<double>;
  I::add_loads(step, slot, loads);
  { I::holds(seen, slot) } -> std::same_as<bool>;
  { I::uses(seen, slot) } -> std::same_as<bool>;
  { I::replaces_gravity(seen) } -> std::same_as<bool>;
  { I::inner_momentum(seen, slot) } -> std::same_as<Vec3>;
  I::visit_joined(seen, slot, visit);
  { I::ties_rigidly } -> std::convertible_to<bool>;
  { I::ties_by_contact } -> std::convertible_to<bool>;
  I::visit_tied(seen, slot, visit);
  { I::ties_any(seen) } -> std::same_as<bool>;
  { I::ties_to_world(seen, slot) } -> std::same_as<bool>;
  I::visit_companions(seen, slot, visit);
  I::visit_lines(seen, slot, visit_line);
  { I::ball_radius(seen, slot) } -> std::same_as<double>;
  I::absorb(model, slot, slot);
  I::drop(model, slot);
  I::forget_particle(model, slot);
  I::forget_body(model, slot);
  I::ring_changed(model, slot);
  I::ring_merged(model, slot, slot, true);
  I::inertia_changed(model, slot);
  I::acting_changed(model, slot);
  { I::call_off(model, slot, slot) } -> std::same_as<bool>;
  I::clean_up(model, bodies, notes);
  { I::remember(seen, bodies) } -> std::same_as<typename I::Memory>;
  I::reattach(model, I::remember(seen, bodies));
  I::prepare(model, slot);
  { I::scene_log(model) } -> std::same_as<model::ChangedSlots*>;
  I::describe(view, changes);
  I::draw(view, slot, drawn);
  I::end_step(model, h);
  I::tell(model, outcome);
};

/// The functions of every ingredient for the stages of a step of an island.
template <class I>
concept IslandIngredient =
    std::default_initializable<I> && std::movable<I> &&
    requires(I& own, const I& fixed, Model& model, const Model& seen, const IslandNodes& nodes, const IslandMap& map,
             Problem& problem, const Problem& solved, solver::ItemKey key, double h, bool moved) {
      own.build(map, problem);
      own.leave(map);
      own.clear();
      own.renew_pulls(map, problem);
      own.load(seen, nodes, h, problem);
      { own.after_step(model, h, problem) } -> std::same_as<double>;
      fixed.store(model, nodes, h, solved);
      fixed.refresh(model, nodes, moved);
      { fixed.meets_pinned(seen) } -> std::same_as<bool>;
      { fixed.virtual_energy(seen) } -> std::same_as<double>;
      { fixed.name_of_row(seen, key) } -> std::same_as<std::string>;
      fixed.accept_assigned(model, nodes);
      { fixed.prescribes_motion(seen, nodes) } -> std::same_as<bool>;
      { fixed.velocity_jump(solved, h) } -> std::same_as<double>;
      { fixed.rate_jump() } -> std::same_as<double>;
      fixed.impose_velocities(problem, h);
      fixed.impose_positions(problem);
      { fixed.keeps_awake(seen, solved) } -> std::same_as<bool>;
      fixed.put_to_rest(model, solved);
    };

/// visit(index, key) for the items of one type that an owner has added.
template <class Item, class Visit>
void for_each_item_of(std::uint8_t owner, const Problem& problem, Visit visit) {
  if (!problem.has_used<Item>()) return;
  const std::vector<solver::ItemKey>& keys = problem.pool_of<Item>().keys;
  for (std::size_t i = 0; i < keys.size(); ++i)
    if (keys[i].owner == owner) visit(i, keys[i]);
}

}  // namespace iota::ingredient
