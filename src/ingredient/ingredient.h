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

#include <algorithm>
#include <concepts>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

namespace iota::ingredient {

using model::Structure;
using solver::Problem;
using Visit = Structure::Visit;

/// The answers of a kind of thing that has nothing to say. An ingredient inherits them and hides those that it answers
/// itself. Static functions are about the whole model. The others are about one island: an ingredient object belongs to an
/// island and knows the places of its rows and forces in the island's problem.
struct NoAnswers {
  /// Marks our items in the problem; the island numbers its ingredients.
  std::uint8_t owner = 0;

  /// @name The model
  ///@{

  /// What it keeps. `Model` inherits the tables of all ingredients, so that members are found by their names.
  struct Tables {
    /// To and from bytes. The structure is there already.
    template <class Archive>
    void archive(Archive&, const Structure&) {}
  };
  /// Moves what bytes do not hold from the model that a restored one replaces, and makes anew what is made of tables.
  static void take_over(Model& /*restored*/, Model& /*before*/) {}
  static void validate(const Model&, model::Audit&) {}
  /// What must be true of its tables before anything follows their slots: see `Audit::check_links`.
  static void check_links(const Model&, model::Audit&) {}
  /// Its share of kinetic and potential energy, and of momentum.
  static void add_energy(const Scope&, Energies&) {}
  static void add_momentum(const Scope&, Momenta&) {}
  /// The largest gap of its constraints, m.
  static double worst_gap(const Model&) { return 0; }
  /// What it did to the points of a body in the last step.
  static void add_loads(const LastStep&, std::uint32_t /*body*/, LoadReader&) {}
  /// Whether it keeps a particle that is a body by itself from flying freely.
  static bool holds(const Model&, std::uint32_t /*particle*/) { return false; }

  /// Whether anything of it refers to a particle.
  static bool uses(const Model&, std::uint32_t /*particle*/) { return false; }
  /// Whether a force of it takes the place of gravity.
  static bool replaces_gravity(const Model&) { return false; }
  /// Angular momentum of a body that its points know nothing of, kg m^2/s.
  static Vec3 inner_momentum(const Model&, std::uint32_t /*body*/) { return {}; }
  ///@}

  /// @name Who hangs together
  ///@{

  /// visit(body): of those that it joins with a particle's in one articulate, as hinges do.
  static void visit_joined(const Model&, std::uint32_t /*particle*/, Visit) {}
  /// visit(body): of those that must be solved together with a particle's. By constraints (rigidly), or by forces.
  static constexpr bool ties_rigidly = false;
  static void visit_tied(const Model&, std::uint32_t /*particle*/, Visit) {}
  static bool ties_any(const Model&) { return false; }
  static bool ties_to_world(const Model&, std::uint32_t /*body*/) { return false; }  ///< by a constraint
  /// visit(particle): of those that stay with a particle when its body falls apart.
  static void visit_companions(const Model&, std::uint32_t /*particle*/, Visit) {}
  ///@}

  /// @name Edits
  ///@{

  /// Particle q becomes p: what refers to q refers to p from now on, or ends.
  static void absorb(Model&, std::uint32_t /*q*/, std::uint32_t /*p*/) {}
  /// A particle is going: ends what refers to it.
  static void drop(Model&, std::uint32_t /*particle*/) {}
  static void forget_particle(Model&, std::uint32_t /*particle*/) {}  ///< it is gone
  static void forget_body(Model&, std::uint32_t /*body*/) {}
  /// Another particle is the first of a ring, or it is empty and gone.
  static void ring_changed(Model&, std::uint32_t /*ring*/) {}
  /// A ring becomes another one; `replaces`: what holds `from` in its place holds `into` there now.
  static void ring_merged(Model&, std::uint32_t /*into*/, std::uint32_t /*from*/, bool /*replaces*/) {}
  static void inertia_changed(Model&, std::uint32_t /*body*/) {}     ///< the basis or the inertia pairs of a body
  static void acting_changed(Model&, std::uint32_t /*particle*/) {}  ///< see Structure::acts
  /// Ends what brings two particles together. False if nothing does.
  static bool call_off(Model&, std::uint32_t /*p*/, std::uint32_t /*q*/) { return false; }
  /// Ends what an edit of some bodies (all alive) has left without sense, and says so in the notes.
  static void settle(Model&, std::span<const std::uint32_t> /*bodies*/, std::vector<std::string>& /*notes*/) {}
  /// What it has to know from before an edit of some bodies to follow that afterwards.
  struct Memory {};
  static Memory remember(const Model&, std::span<const std::uint32_t> /*bodies*/) { return {}; }
  /// Since then particles may have been absorbed, bodies joined, torn apart or destroyed.
  static void follow(Model&, const Memory&) {}
  /// Bodies may have other bases, in the same places.
  static void follow_bases(Model&) {}
  /// Adds to tables what an island with the body will write to from many threads.
  static void prepare(Model&, std::uint32_t /*body*/) {}
  ///@}

  /// @name Viewers
  ///@{

  /// Items that have changed or gone by themselves, not with a body; null: it has none.
  static model::ChangedSlots* scene_log(Model&) { return nullptr; }
  /// Describes the items that the view asks for.
  static void describe(const SceneView&, SceneChanges&) {}
  /// Its part of how a body is drawn.
  static void draw(const SceneView&, std::uint32_t /*body*/, DrawnBody&) {}
  ///@}

  /// @name Building and stepping
  ///@{

  /// Adds the masses, rows and forces of the map's bodies, after those of the ingredients before it in the list. When an
  /// island follows a change, the map has the bodies at the nodes that changed, and the problem refuses items at other
  /// nodes, which it has already. An item's key says what it is of: it needs no list that runs along.
  void build(const IslandMap&, Problem&) {}
  /// Forgets what `build` is about to list again, beyond the items of the problem.
  void leave(const IslandMap&) {}
  /// Replaces the island's forces that come and go and couple no points but those that are coupled anyway.
  void renew_pulls(const IslandMap&, Problem&) {}
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
  /// Says what a row of ours is.
  std::string name_of_row(const Model&, solver::ItemKey) const { return {}; }
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
  void put_to_rest(Model&, const Problem&) const {}
  ///@}
};

/// What is asked of every ingredient about the model.
template <class I>
concept ModelIngredient = requires(
    Model& model, const Model& seen, model::Audit& audit, const Scope& scope, Energies& energies, Momenta& momenta,
    const LastStep& step, LoadReader& loads, std::uint32_t slot, std::span<const std::uint32_t> bodies,
    std::vector<std::string>& notes, Visit visit, const SceneView& view, SceneChanges& changes, DrawnBody& drawn) {
  typename I::Tables;
  I::take_over(model, model);
  I::validate(seen, audit);
  I::check_links(seen, audit);
  I::add_energy(scope, energies);
  I::add_momentum(scope, momenta);
  { I::worst_gap(seen) } -> std::same_as<double>;
  I::add_loads(step, slot, loads);
  { I::holds(seen, slot) } -> std::same_as<bool>;
  { I::uses(seen, slot) } -> std::same_as<bool>;
  { I::replaces_gravity(seen) } -> std::same_as<bool>;
  { I::inner_momentum(seen, slot) } -> std::same_as<Vec3>;
  I::visit_joined(seen, slot, visit);
  { I::ties_rigidly } -> std::convertible_to<bool>;
  I::visit_tied(seen, slot, visit);
  { I::ties_any(seen) } -> std::same_as<bool>;
  { I::ties_to_world(seen, slot) } -> std::same_as<bool>;
  I::visit_companions(seen, slot, visit);
  I::absorb(model, slot, slot);
  I::drop(model, slot);
  I::forget_particle(model, slot);
  I::forget_body(model, slot);
  I::ring_changed(model, slot);
  I::ring_merged(model, slot, slot, true);
  I::inertia_changed(model, slot);
  I::acting_changed(model, slot);
  { I::call_off(model, slot, slot) } -> std::same_as<bool>;
  I::settle(model, bodies, notes);
  { I::remember(seen, bodies) } -> std::same_as<typename I::Memory>;
  I::follow(model, I::remember(seen, bodies));
  I::follow_bases(model);
  I::prepare(model, slot);
  { I::scene_log(model) } -> std::same_as<model::ChangedSlots*>;
  I::describe(view, changes);
  I::draw(view, slot, drawn);
};

/// What the stages of a step ask of an ingredient of an island.
template <class I>
concept IslandIngredient =
    std::default_initializable<I> && std::movable<I> &&
    requires(I& own, const I& fixed, Model& model, const Model& seen, const IslandNodes& nodes, const IslandMap& map,
             Problem& problem, const Problem& solved, solver::ItemKey key, double h, bool moved) {
      own.build(map, problem);
      own.leave(map);
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
      fixed.impose_velocities(problem, h);
      fixed.impose_positions(problem);
      { fixed.wakes(seen, nodes) } -> std::same_as<bool>;
      { fixed.keeps_awake(solved) } -> std::same_as<bool>;
      fixed.put_to_rest(model, solved);
    };

/// visit(index, key) for the items of one type that an owner has added.
template <class Item, class Visit>
void for_each_item_of(std::uint8_t owner, const Problem& problem, Visit visit) {
  const std::vector<solver::ItemKey>& keys = problem.pool_of<Item>().keys;
  for (std::size_t i = 0; i < keys.size(); ++i)
    if (keys[i].owner == owner) visit(i, keys[i]);
}

/// Each number once, in order.
inline void sort_unique(std::vector<std::uint32_t>& list) {
  std::sort(list.begin(), list.end());
  list.erase(std::unique(list.begin(), list.end()), list.end());
}

}  // namespace iota::ingredient
