// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/parallel.h"
#include "model/model.h"
#include "model/restructure.h"
#include "step/commands.h"
#include "step/edit_batch.h"
#include "step/free_particles.h"
#include "step/held_forces.h"
#include "step/islands.h"
#include "step/particle_sets.h"

#include <iota/system.h>

#include <map>

namespace iota {

namespace step {
}  // namespace step

/// The model, its solver islands, and the one door through which everything changes: `execute`.
struct System::Implementation {
  model::Model model;
  step::Islands islands;
  step::HeldForces held_forces;
  step::ParticleSets particle_sets;
  Parallel parallel;
  std::vector<solver::AdvanceReport> advanced;  // of each island, in the step at hand
  std::vector<std::uint32_t> jolted,
      disturbed;  // articulates, since the last step: lists of that step, kept for their room
  std::map<std::uint64_t, ScriptedLaw> scripts;  // functions of scripted bonds; not part of the saved state
  struct LawFunction {
    RadialFunction radial = nullptr;
    BatchFunction batch;
  };
  std::map<std::uint64_t, LawFunction> law_functions;  // of laws that are code; not part of the saved state
  std::map<std::uint64_t, FieldFunction> field_functions;
  std::vector<std::byte> spelled;  // pieces of a record so far
  std::uint64_t next_script = 1;
  std::uint64_t scripts_saved_below = 0;  // keys that the latest snapshot may name
  std::map<std::uint64_t, Mesh> meshes;   // for drawing, by content; not part of the saved state either
  std::vector<Vec3> path_points;          // of a path that is about to be made
  bool stepping = false;
  bool held_energy_is_known = false;  // since the last command
  double held_energy_now = 0;
  std::vector<step::Command> queue;  // edits asked for during a step
  std::optional<Recording> recording;
  std::optional<step::EditBatch> batch;
  step::History done, undone;  // batches
  std::uint64_t oriented_step = ~0ull;

  /// Applies a command now, or queues it if it is a structural edit asked for during a step; records it.
  /// Throws std::logic_error for anything else asked for during a step.
  template <class C>
  auto execute(const C& command);

  // One apply per command; all checking of input is here.
  void apply(const step::SetGravity&);
  void apply(const step::SetMode&);
  void apply(const step::SetSolver&);
  void apply(const step::SetSystemDamping&);
  BodyId apply(const step::CreateBody&);
  ParticleId apply(const step::CreateParticle&);
  void apply(const step::SetRod&);
  BodyId apply(const step::CreateSolid&);
  ParticleId apply(const step::CreateAttachment&);
  void apply(const step::SetPose&);
  void apply(const step::SetBodyVelocity&);
  void apply(const step::SetAngularVelocity&);
  CosmeticBondId apply(const step::CreateCosmeticBond&);
  void apply(const step::Spell&);
  LawId apply(const step::CreateLaw&);
  GroupId apply(const step::CreateGroup&);
  void apply(const step::SetMember&);
  FieldId apply(const step::CreateField&);
  void apply(const step::SetFieldParameter&);
  void apply(const step::SetFieldActive&);
  PairsId apply(const step::CreatePairs&);
  void apply(const step::SetPairsParameter&);
  void apply(const step::SetPairsActive&);
  void apply(const step::Destroy<GroupId>&);
  void apply(const step::Destroy<FieldId>&);
  void apply(const step::Destroy<PairsId>&);
  BondId apply(const step::CreateBond&);
  void apply(const step::SetParameter&);
  void apply(const step::Destroy<LawId>&);
  GripId apply(const step::CreateGrip&);
  void apply(const step::MoveGrip&);
  void apply(const step::SetKind&);
  void apply(const step::SetBodyDamping&);
  void apply(const step::SetPosition&);
  void apply(const step::SetVelocity&);
  void apply(const step::SetMass&);
  void apply(const step::ApplyForce&);
  void apply(const step::SetActive&);
  ConstraintId apply(const step::CreateJoint&);
  ConstraintId apply(const step::CreateDistance&);
  void apply(const step::AddCurvePoints&);
  ConstraintId apply(const step::CreatePath&);
  ConstraintId apply(const step::CreateSurface&);
  ConstraintId apply(const step::CreateSurfacePair&);
  void apply(const step::SetConstraintActive&);
  void apply(const step::SetCoordinate&);
  void apply(const step::SetLength&);
  void apply(const step::SetBreakLimits&);
  void apply(const step::SetBreakForce&);
  void apply(const step::SetBondBreakForce&);
  void apply(const step::Destroy<ConstraintId>&);
  void apply(const step::SetParticleActive&);
  void apply(const step::SetRest&);
  EmitterId apply(const step::CreateEmitter&);
  void apply(const step::SetEmitter&);
  void apply(const step::Destroy<EmitterId>&);
  void apply(const step::SetAttributes&);
  void apply(const step::SetTurn&);
  void apply(const step::BeginEdit&);
  RestructureReport apply(const step::EndEdit&);
  void apply(const step::CancelEdit&);
  bool apply(const step::Undo&);
  bool apply(const step::Redo&);
  StepReport apply(const step::Step&);
  void apply(const step::Destroy<BodyId>&);
  void apply(const step::Destroy<ParticleId>&);
  void apply(const step::Destroy<BondId>&);
  RestructureReport apply(const step::Destroy<CosmeticBondId>&);
  void apply(const step::Destroy<GripId>&);
  RestructureReport apply(const step::CombineParticles&);
  RestructureReport apply(const step::CombineBodies&);
  RestructureReport apply(const step::Separate&);
  RestructureReport apply(const step::SeparatePart&);
  void apply(const step::Nail&);
  void apply(const step::Release&);

  std::uint32_t require(BodyId) const;
  std::uint32_t require(ParticleId) const;
  std::uint32_t require(BondId) const;
  std::uint32_t require(LawId) const;
  std::uint32_t require(GroupId) const;
  std::uint32_t require(FieldId) const;
  std::uint32_t require(PairsId) const;
  void spell(const void* record, std::size_t size);  ///< executes the Spell commands of a record
  std::uint32_t require(GripId) const;
  std::uint32_t require(EmitterId) const;
  std::uint32_t require(ConstraintId) const;

  /// Runs a structural edit and settles its physics: positions, velocities, momenta, energy; fills the report.
  /// `gentle` edits move nothing and no mass, so there is nothing to measure and their cost does not grow with the system.
  template <class EditFunction>
  RestructureReport restructure(std::span<const std::uint32_t> touched_bodies, bool gentle, EditFunction edit);

  RestructureReport seen(ViewEvent::Kind, const Vec3& place, RestructureReport);

  struct Conserved {
    double kinetic = 0, potential = 0;
    Vec3 momentum, angular_momentum;
    double energy() const { return kinetic + potential; }
  };
  /// Of these bodies and the springs between them; those no longer alive count as nothing.
  Conserved conserved(std::span<const std::uint32_t> bodies) const;
  /// Projects positions and velocities of the islands that the bodies are in.
  void settle(std::span<const std::uint32_t> bodies, bool positions, RestructureReport&);
  /// Displacements and moved masses change momenta; a rigid motion of all that hangs together with the bodies gives them
  /// back without disturbing any constraint; `affected` is what `before` was taken of. False where something is pinned: the rest of the world has taken them.
  bool give_back_momenta(std::span<const std::uint32_t> bodies, std::span<const std::uint32_t> affected,
                         const Conserved& before);
  void put_to_rest(std::uint32_t body);  ///< with all that hangs together with it
  /// Adds motion(position) to the velocities of a body's particles.
  template <class Motion>
  void add_motion(std::uint32_t body, Motion motion);
  void refresh_coordinates(std::uint32_t body);  ///< of its joints
  /// What comes after making or changing a constraint: its island is made anew, its velocities are projected before the
  /// next step, and what is apart closes there.
  void constraint_changed(std::uint32_t constraint);
  void wake(std::uint32_t constraint);  ///< bodies at rest that a changed motor or rope must move
  ConstraintId made(std::uint32_t constraint);
  /// A surface as plain data; its function, if it has one, is kept under the next key.
  model::PlacedSurface placed(const Surface&);
  template <class Specify>
  ConstraintId make_with_functions(Specify specify);
  ParticleId make_marker(std::uint32_t body, const Vec3& position);
  /// Ends a closing before its particles have met.
  RestructureReport call_off(std::uint32_t closing);
  /// @name Forces that are taken once a step and held (held_forces.cpp)
  ///@{
  double held_ahead(double h) const;  ///< how far ahead of the start of a step of h they are taken, s
  void run_laws(StepReport&);
  void run_held_law(step::LawBatch&, double ahead, StepReport&);
  void call(step::LawBatch&) const;  ///< the function of a law for all its bonds; it may throw
  void run_batch_function(step::LawBatch&, double ahead, StepReport&);
  void run_scripts(StepReport&);
  void watch_implicit_law(step::LawBatch&, StepReport&);
  void run_fields(StepReport&);
  void run_field(std::uint32_t field, step::ParticleSet&, StepReport&);
  bool run_field_function(std::uint32_t field, step::ParticleSet&, StepReport&);
  void run_pairs(std::uint32_t pairs, step::ParticleSet&, StepReport&);
  double pairs_energy(std::uint32_t pairs);
  /// @name Their energy, J (held_energy.cpp)
  ///@{
  double held_energy();  ///< now; within a step, at its start
  double calc_held_energy();
  void book_held_edits();
  void book_held_work();
  Energy energy();
  ///@}
  /// Evaluates without applying; returns for how many.
  std::size_t rehearse(std::uint32_t law, double h);
  template <class Run>
  std::size_t rehearse_on(std::uint32_t group, double h, Run run);
  void evaluate(step::LawBatch&, double time);
  bool has_function(const step::LawBatch&, StepReport&);
  void add_force(std::uint32_t bond, const Vec3& on_p);
  Vec3 bond_force(std::uint32_t bond) const;  ///< on its first particle, N
  void switch_off(std::uint32_t bond, const std::string& why, StepReport&);
  ///@}
  void live(StepReport&);  ///< particles age, turn, die and are born
  void turn(model::Attributes&, double h);
  void emit(std::uint32_t emitter, StepReport&);
  model::Attributes& attributes_of(std::uint32_t particle);  ///< made where it has none
  void finish_closings(StepReport&);
  /// Switches off what the step has loaded beyond its limits.
  void break_overloaded(StepReport&);
  /// Switches off constraints on surfaces whose function has failed.
  void switch_off_failed_surfaces(StepReport&);
  void apply_queue(StepReport&);
  void structure_changed() { ++model.structure_version; }
  void jolt(std::uint32_t particle);
  void refresh_orientations();
  Snapshot snapshot();
  void restore(const Snapshot&);
  bool go_to(step::History& from, step::History& to);
  void forget_edits() { batch.reset(), done.clear(), undone.clear(); }
};

}  // namespace iota
