// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "model/model.h"
#include "solver/diagnosis.h"
#include "solver/integrator.h"
#include "step/constraint_rows.h"

#include <iota/solver.h>

#include <memory>
#include <span>
#include <vector>

namespace iota::step {

/// Articulates that bonds and constraints tie together, as one problem for the solver: the only translation between model and solver.
class Island {
 public:
  /// Builds the problem's structure; `node_of_ring` is scratch for all rings, `none` everywhere before and after. Islands
  /// have no ring in common, so they may be built at once with the same scratch.
  void assemble(const model::Model&, std::span<const std::uint32_t> articulates,
                std::vector<std::uint32_t>& node_of_ring);

  /// Follows when some of its bodies have been hinged to each other otherwise, or no longer, and nothing else changed.
  /// False where that is more than moving a few rows: then it must be assembled anew.
  bool relink(const model::Model&, std::span<const std::uint32_t> bodies);
  std::span<const std::uint32_t> bodies() const { return bodies_; }

  /// Points to solve for: a measure of the work.
  std::size_t size() const { return rings_.size(); }

  /// Puts carried particles where their basis has them, and as fast. Where they were not (assigned velocities, conflicts),
  /// their momentum goes over to what carries them.
  void carry_along(model::Model&);

  /// State of the model into the problem, for a step of h seconds (h = 0: for projections).
  void load(const model::Model&, double h);
  /// The problem's state back, particles that are no unknowns of their own included. After a step of h
  /// seconds (0: a projection) nails have arrived and applied forces are spent.
  void store(model::Model&, double h);

  solver::AdvanceReport advance(model::Model&, double h, IntegrationMode);

  /// See System::diagnose; after `load(model, 0)`.
  Diagnosis diagnose(const model::Model&) const;

  /// Whether it sleeps and nothing has disturbed it; one that was disturbed is awake afterwards.
  bool stays_at_rest(model::Model&);
  void disturb() { disturbed_ = true; }
  bool rests(const model::Model&) const;
  void put_to_rest(model::Model&) const;
  std::size_t body_count() const { return bodies_.size(); }

  /// Projections after an edit; false where no position meets all constraints.
  bool settle(model::Model&, bool positions);

 private:
  std::string name_of_row(const model::Model&, const solver::RowName&) const;
  std::string name_of_node(const model::Model&, std::size_t node) const;
  bool nails_move(const model::Model&) const;
  void use_solver(const std::array<char, 32>& name);
  double& slow_time(model::Model&) const;
  bool is_pushed(const model::Model&) const;  ///< by forces applied for the step
  /// Falls asleep once it has been slow for long enough, if the model asks for that.
  void tire(model::Model&, double h, solver::AdvanceReport&) const;
  bool meets_pinned_rows(const model::Model&) const;
  void store_carried(model::Model&) const;
  using Weighted = std::array<std::pair<std::uint32_t, double>, 4>;  // nodes and weights; weight 0 ends the list
  Weighted nodes_of(const model::Model&, std::uint32_t particle, const std::vector<std::uint32_t>& node_of_ring) const;
  void make_room(const model::Model&, std::span<const std::uint32_t> articulates);
  void add_masses(const model::Model&, std::uint32_t body, const std::vector<std::uint32_t>& node_of_ring);
  void add_virtual_mass(const model::Model&, std::uint32_t marker, const std::vector<std::uint32_t>& node_of_ring);
  /// Of the virtual masses, J: nothing, except in a conflict. It is none of the model's.
  double virtual_energy(const model::Model&) const;
  void add_mass_outer(const Weighted& a, double mass);
  void add_damped_masses(const model::Model&, std::uint32_t body, const std::vector<std::uint32_t>& node_of_ring);
  void add_constraints(const model::Model&, std::uint32_t body, const std::vector<std::uint32_t>& node_of_ring);
  void store_hands(model::Model&, double h) const;
  void add_bonds(const model::Model&, const std::vector<std::uint32_t>& node_of_ring);
  void load_pushes(const model::Model&);
  void load_bonds(const model::Model&, double h);
  void add_spin(const model::Model&, std::uint32_t body, const std::vector<std::uint32_t>& node_of_ring);
  void store_spins(model::Model&, double h) const;
  double damp_spins(model::Model&, double h) const;  ///< returns what that costs, J
  void add_joints(const model::Model&, const std::vector<std::uint32_t>& node_of_ring);

  solver::Problem problem_;
  solver::Integrator integrator_;
  std::array<char, 32> solver_name_{};
  std::unique_ptr<Solver> solver_;  // who is asked instead of the integrator's own
  bool idle_ = false, disturbed_ = false;
  std::vector<std::uint32_t> rings_;  // of each node
  std::vector<std::uint8_t> pinned_;  // of each node
  std::vector<double> node_damping_;  // 1/s, without the system's; empty: none
  struct RigidRow {
    std::uint32_t body;
    std::uint8_t row;
  };
  std::vector<RigidRow> rigid_rows_;  // of the first distance constraints
  // Rows and tied particles none of whose points can move: nails decide whether they are met.
  std::vector<RigidRow> pinned_rows_;
  std::vector<std::uint32_t> pinned_ties_;
  std::vector<std::uint32_t> virtual_;   // markers with a virtual mass
  std::vector<std::uint32_t> closings_;  // of the distance constraints after them
  std::vector<std::uint32_t> tied_;      // particles of the first affine constraints
  std::vector<std::uint32_t> nails_;     // nodes of the affine constraints after them
  std::vector<std::uint32_t> slaves_;    // particles carried by their basis
  std::vector<Weighted> slave_nodes_;    // of each, by which it is carried
  std::vector<std::uint32_t> springs_, drags_, radials_, grips_;
  std::vector<std::uint32_t> spinning_;  // bodies of the gyroscopic forces
  ConstraintRows constraint_rows_;
  std::vector<double> grip_masses_;  // kg, what a hand can feel
  std::vector<std::uint32_t> bodies_;
};

}  // namespace iota::step
