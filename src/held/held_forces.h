// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/parallel.h"
#include "held/bond_batches.h"
#include "held/functions.h"
#include "held/held_force_error.h"
#include "held/particle_sets.h"

namespace iota {
struct Energy;
struct StepReport;
}  // namespace iota

namespace iota::held {

/// Forces that are evaluated once a step and held during it: scripted bonds, laws given as code, any law on request,
/// fields and pairwise forces; and their energy. A function that throws, or a force that is not finite, is switched off
/// and named in the report of the step.
class HeldForces {
 public:
  HeldForces(model::Model& model, const Parallel& parallel) : model_(model), parallel_(parallel) {}

  Functions functions;

  /// Adds all held forces to the pushes of the next step, whose length is report.dt. Until `end_step` the energy is
  /// that of the start of the step.
  void begin_step(StepReport&);
  /// Adds the fields' forces on bodies that begin_step left out, as they were not to be solved in this step, and that something has
  /// touched since, or something full was found beside.
  void add_missed(StepReport&);
  /// Books the work of the step.
  void end_step();

  /// @name Energy, J: of bonds, fields and pairs whose law has one. It is potential energy, like that of an implicit
  /// spring, but no solver counts it, so it is booked here:
  /// - the change by edits since the last step is measured at the start of the next one;
  /// - the change in a step is subtracted from the work of the held forces, which their island books as external. The
  ///   remainder there is the error of holding, and is small if the step is short compared with the oscillation.
  ///@{
  double energy();
  void book_edits();
  Energy book();  ///< the system's whole energy balance
  double energy_of_pairs(std::uint32_t pairs) const;
  ///@}

  /// Evaluates without applying; returns the number. See Laws::rehearse.
  std::size_t rehearse_law(std::uint32_t law, double h);
  std::size_t rehearse_field(std::uint32_t field, double h);
  std::size_t rehearse_pairs(std::uint32_t pairs, double h);

  void note_change() { energy_is_known_ = false; }  ///< by a command
  void forget();                                    ///< the state was replaced

 private:
  double look_ahead(double h) const;
  double time_of_places(double h) const;
  void take_laws(StepReport&);
  void take_law(BondBatch&, StepReport&);
  void take_batch_function(BondBatch&, StepReport&);
  void take_scripts(StepReport&);
  void watch_implicit_law(BondBatch&, StepReport&);
  bool has_function(const ingredient::Law&) const;
  bool require_function(const BondBatch&, StepReport&);  ///< switches off the bonds of a law without its function
  void evaluate(BondBatch&, double time) const;
  void call(BondBatch&, double h) const;  ///< the function of a law for all its bonds; it may throw
  void add_force(std::uint32_t bond, const Vec3& on_p);
  void switch_off(std::uint32_t bond, const std::string& why, StepReport&);

  void take_fields(StepReport&);
  void take_field(std::uint32_t field, ParticleSet&, StepReport&);
  void add_field(const laws::FieldLaw&, const ingredient::Field&, double time, ParticleSet&) const;
  void add_rates(const laws::FieldLaw&, const ingredient::Field&, double time, ParticleSet&) const;
  bool call_field(std::uint32_t field, ParticleSet&, StepReport&);
  void take_pairs(std::uint32_t pairs, ParticleSet&, StepReport&);
  ParticleSet& loaded_set(std::uint32_t group, double ahead);
  ParticleSet& loaded_set(const ingredient::PairForce&, double ahead, double normals_ahead);

  double calc_energy();

  model::Model& model_;
  const Parallel& parallel_;
  BondBatches batches_;
  ParticleSets sets_;
  HeldForceError error_;
  bool in_step_ = false;
  bool energy_is_known_ = false;  // since the last command
  double energy_ = 0;
};

}  // namespace iota::held
