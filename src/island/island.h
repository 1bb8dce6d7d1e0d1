// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ingredient/ingredient_list.h"
#include "ingredient/model.h"
#include "solver/integrator.h"

#include <iota/solver.h>

#include <memory>
#include <span>
#include <string>
#include <vector>

namespace iota::island {

/// Rings that something has moved, as they were before. A ring may be listed more than once.
struct MovedRings {
  struct State {
    std::uint32_t ring;
    Vec3 position, velocity;
  };
  std::vector<State> before = {};
  bool is_asked_for = true;  ///< else nothing is listed

  void put(model::Model&, std::uint32_t ring, const Vec3& position, const Vec3& velocity);
  /// The rings are as they were; called again, as they are.
  void exchange(model::Model&);
};

/// Articulates that bonds and constraints tie together, as one problem for the solver: nodes, ingredients, an integrator.
/// What acts on the nodes is the ingredients' business; the stages here are folds over them.
class Island {
 public:
  /// Builds the problem's structure; `node_of_ring` is scratch for all rings, `none` everywhere before and after. Islands
  /// have no ring in common, so they may be built at once with the same scratch.
  void assemble(const model::Model&, std::span<const std::uint32_t> articulates,
                std::vector<std::uint32_t>& node_of_ring);

  /// Keeps up with a change at some bodies and rings; its other bodies are as they were, and which bodies it has too.
  /// For a fraction of the time it is then as if it had been assembled anew, but for the order of elimination. False if so
  /// much changed that it must be assembled.
  bool follow(model::Model&, std::span<const std::uint32_t> articulates, const model::Model::LocalChange&,
              std::vector<std::uint32_t>& node_of_ring, MovedRings&);
  /// Takes over pulls that have come and gone: see Structure::touch_pull. False if it must be assembled.
  bool renew_pulls(const model::Model&, std::vector<std::uint32_t>& node_of_ring);
  std::span<const std::uint32_t> bodies() const { return nodes_.bodies; }

  /// Points to solve for: a measure of the work.
  std::size_t size() const { return nodes_.size(); }

  /// Puts carried particles where their basis has them, and as fast. Where they were not (assigned velocities, conflicts),
  /// their momentum goes over to what carries them.
  void carry_along(model::Model&, MovedRings&);

  /// State of the model into the problem, for a step of h seconds (h = 0: for projections).
  void load(const model::Model&, double h);

  solver::AdvanceReport advance(model::Model&, double h, IntegrationMode);

  /// See System::diagnose; after `load(model, 0)`.
  Diagnosis diagnose(const model::Model&) const;

  /// Wakes it in the next step.
  void wake() { to_wake_ = true; }
  bool is_asleep(const model::Model&) const;
  void put_to_rest(model::Model&) const;
  std::size_t body_count() const { return nodes_.bodies.size(); }

  /// Projects velocities, and before that positions where asked to, on the constraints. False where no position meets all
  /// of them.
  bool project(model::Model&, bool positions);

  /// The same after an edit of some bodies (all alive), around them only where no more is needed.
  bool settle(model::Model&, std::span<const std::uint32_t> bodies, bool positions, MovedRings& moved);
  /// Whether a point of an articulate is pinned.
  bool is_pinned(const model::Model&, std::uint32_t articulate) const;

 private:
  /// visit(ingredient) for each, in the order of the list.
  template <class Visit>
  void for_each_ingredient(Visit visit) {
    std::apply([&](auto&... ingredient) { (visit(ingredient), ...); }, ingredients_);
  }
  template <class Visit>
  void for_each_ingredient(Visit visit) const {
    std::apply([&](const auto&... ingredient) { (visit(ingredient), ...); }, ingredients_);
  }
  template <class Test>
  bool any_ingredient(Test test) const {
    return std::apply([&](const auto&... ingredient) { return (test(ingredient) || ...); }, ingredients_);
  }

  Vec3 choose_origin(const model::Model&) const;
  bool has_finite_motion() const;
  std::vector<std::uint32_t> find_changed_nodes(const model::Model&, const model::Model::LocalChange&,
                                                std::vector<std::uint32_t>& node_of_ring);
  void remove_nodes(std::vector<std::uint32_t>);

  solver::AdvanceReport advance_idle(model::Model&, double h);
  bool is_driven(const model::Model&) const;  ///< by prescribed motion
  double velocity_jump(double h) const;       ///< see ingredient::NoAnswers
  void impose_velocities(double h);
  double virtual_energy(const model::Model&) const;
  void store_step(model::Model&, double h) const;
  bool project_all(model::Model&, bool positions);
  std::vector<std::uint32_t> nodes_of(const model::Model&, std::span<const std::uint32_t> bodies) const;
  void store_projection(model::Model&, bool moved, MovedRings&, std::span<const std::uint32_t> only = {}) const;
  void store_carried(model::Model&, MovedRings&) const;
  bool meets_pinned(const model::Model&) const;

  /// Whether it sleeps on; one that `wake` was called for is awake afterwards.
  bool skip_if_asleep(model::Model&);
  /// Falls asleep once it has been slow for long enough, if the model asks for that.
  void update_sleep_timer(model::Model&, double h, solver::AdvanceReport&) const;
  model::Articulate& articulate(model::Model&) const;  ///< of its first body: keeps what the island has to remember
  void use_solver(const std::array<char, 32>& name);
  std::string name_of_row(const model::Model&, const solver::RowName&) const;

  ingredient::IslandNodes nodes_;
  ingredient::Ingredients ingredients_;
  solver::Problem problem_;
  solver::Integrator integrator_;
  std::array<char, 32> solver_name_{};
  std::unique_ptr<Solver> solver_;  // who is asked instead of the integrator's own
  bool idle_ = false;               // no body of it can move by itself: there is nothing to solve
  bool to_wake_ = false;
};

}  // namespace iota::island
