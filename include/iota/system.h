// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iota/angle_springs.h>
#include <iota/bodies.h>
#include <iota/bonds.h>
#include <iota/constraints.h>
#include <iota/contacts.h>
#include <iota/edits.h>
#include <iota/emitters.h>
#include <iota/fields.h>
#include <iota/forces.h>
#include <iota/grips.h>
#include <iota/ids.h>
#include <iota/joints.h>
#include <iota/laws.h>
#include <iota/log.h>
#include <iota/many.h>
#include <iota/options.h>
#include <iota/particles.h>
#include <iota/places.h>
#include <iota/record.h>
#include <iota/reports.h>
#include <iota/scene.h>
#include <iota/shapes.h>
#include <iota/vec3.h>
#include <iota/viewer.h>

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

/// Iota: worlds of particles, bonds and exactly jointed rigid bodies that can be restructured while they run.
/// SI units; world frame right-handed, y up.
namespace iota {

/// The views of the objects that ids name.
using Views = std::tuple<Bodies, Particles, Bonds, CosmeticBonds, AngleSprings, Joints, Laws, Fields, Pairs, Groups,
                         Grips, Emitters>;

/// A world, sorted by noun: `system.bodies().mass(id)`. Functions throw std::invalid_argument for bad numbers and
/// StaleIdError for ids of destroyed objects, before any change. A system is used from one thread at a time.
///
/// During a step, functions of the script may read everything, and request the edits that `queued_edits` lists:
/// combine, destroy, nail, release, separate, set_active, set_color, set_compliance, set_coordinate, set_kind,
/// set_length, set_material, set_radius. These are made right after the step; all others throw std::logic_error.
class System {
 public:
  explicit System(const SystemOptions& options = {});
  ~System();
  System(System&&) noexcept;
  System& operator=(System&&) noexcept;

  /// @name By noun
  ///@{
  Bodies bodies() { return Bodies(*core_); }
  Particles particles() { return Particles(*core_); }
  Bonds bonds() { return Bonds(*core_); }
  CosmeticBonds cosmetic_bonds() { return CosmeticBonds(*core_); }
  AngleSprings angle_springs() { return AngleSprings(*core_); }
  Joints joints() { return Joints(*core_); }
  Laws laws() { return Laws(*core_); }
  Fields fields() { return Fields(*core_); }
  Pairs pairs() { return Pairs(*core_); }
  Groups groups() { return Groups(*core_); }
  Grips grips() { return Grips(*core_); }
  Many many() { return Many(*core_); }
  Emitters emitters() { return Emitters(*core_); }
  Edits edits() { return Edits(*core_); }
  Record record() { return Record(*core_); }
  Log log() { return Log(*core_); }
  Viewer viewer() { return Viewer(*core_); }
  Places places() { return Places(*core_); }
  Contacts contacts() { return Contacts(*core_); }
  // For a constant system only the functions that read can be called.
  const Bodies bodies() const { return Bodies(*core_); }
  const Particles particles() const { return Particles(*core_); }
  const Bonds bonds() const { return Bonds(*core_); }
  const CosmeticBonds cosmetic_bonds() const { return CosmeticBonds(*core_); }
  const AngleSprings angle_springs() const { return AngleSprings(*core_); }
  const Joints joints() const { return Joints(*core_); }
  const Laws laws() const { return Laws(*core_); }
  const Fields fields() const { return Fields(*core_); }
  const Pairs pairs() const { return Pairs(*core_); }
  const Groups groups() const { return Groups(*core_); }
  const Grips grips() const { return Grips(*core_); }
  const Many many() const { return Many(*core_); }
  const Emitters emitters() const { return Emitters(*core_); }
  const Edits edits() const { return Edits(*core_); }
  const Viewer viewer() const { return Viewer(*core_); }
  const Contacts contacts() const { return Contacts(*core_); }
  /// The same, for code that is written once for several views.
  template <class V>
  V view() {
    return V(*core_);
  }
  ///@}

  /// @name Time
  ///@{
  /// Advances by dt seconds (0 < dt <= 1). Never throws for numerical reasons.
  StepReport step(double dt);
  StepReport step(double dt, int count);  ///< count steps of dt; one report of all, see add_step
  bool is_stepping() const;
  double time() const;
  std::uint64_t step_count() const;
  int threads() const;
  /// Number of threads that share a step; 0: one per core. Not part of the state: results do not depend on it. Small
  /// steps are taken by the calling thread alone.
  void set_threads(int);
  /// "combine, destroy, ...": the edits that may be requested during a step.
  static std::string queued_edits();
  ///@}

  /// @name Settings
  ///@{
  Vec3 gravity() const;
  void set_gravity(const Vec3&);
  IntegrationMode mode() const;
  void set_mode(IntegrationMode);
  /// Solver of the equations of each step: "direct" (the built-in sparse Newton), or a registered one (iota/solver.h),
  /// which gets dense arrays and is far slower. If it fails, the built-in one takes over, with a warning.
  std::string solver() const;
  void set_solver(std::string_view name);
  /// The estimated local error of positions that the sub-steps of a second may add in mode accurate, in mean lengths of
  /// links (and springs) of an island; the motion may amplify it. 1e-12 to 1.
  double tolerance() const;
  void set_tolerance(double);
  StepBudget budget() const;
  void set_budget(const StepBudget&);
  double damping() const;
  void set_damping(double per_second);
  RestOptions rest() const;
  void set_rest(const RestOptions&);
  /// Radius of the lines of bodies that have none of their own (Bodies::radius), m. Chosen once, at the begin of the
  /// first step that finds a body, by usual_radius_of (iota/scene.h); before, as it would be chosen now.
  double usual_radius() const;
  void set_usual_radius(double meters);
  /// With which bodies touch that can move and have no material of their own; none at first: they touch nothing.
  std::optional<Material> usual_material() const;
  void set_usual_material(const std::optional<Material>&);
  ///@}

  /// @name The whole
  ///@{
  Energy energy() const;
  Vec3 momentum() const;
  Vec3 angular_momentum() const;  ///< about the origin
  double worst_gap() const;       ///< m
  /// Reports of the last step, one for each island, without free particles. Empty before the first step and after
  /// `restore`.
  std::vector<IslandReport> islands() const;
  std::uint32_t structure_version() const;
  Snapshot snapshot() const;
  /// Keeps the functions of this system. Throws std::invalid_argument for bytes that are not a snapshot or
  /// whose tables are inconsistent, even with a correct checksum; the system is then unchanged.
  void restore(const Snapshot&);
  std::uint64_t state_hash() const;
  /// Analyzes the constraints of the island of a body. Takes seconds for hundreds of rows.
  /// Throws std::invalid_argument above 600 rows.
  Diagnosis diagnose(BodyId) const;
  /// Checks the whole structure; returns one sentence per inconsistency.
  std::vector<std::string> validate() const;
  ///@}

 private:
  std::unique_ptr<Core> core_;
};

}  // namespace iota
