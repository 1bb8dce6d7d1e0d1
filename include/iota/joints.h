// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iota/constraints.h>
#include <iota/ids.h>
#include <iota/view.h>

#include <vector>

namespace iota {

/// Constraints of all kinds: joints between bodies, rods and ropes, paths and surfaces. Velocities and gaps are
/// projected on a new one at the start of the next step.
class Joints : public View {
 public:
  explicit Joints(Core& core) : View(core) {}

  ConstraintId create(const JointSpec&);
  ConstraintId create(const DistanceSpec&);
  ConstraintId create(const PathSpec&);
  ConstraintId create(const SurfaceSpec&);
  ConstraintId create(const SurfacePairSpec&);
  ConstraintId create(const SpanSpec&);
  ConstraintId create(const CouplingSpec&);
  ConstraintId create(const TackleSpec&);
  void destroy(ConstraintId);
  bool contains(ConstraintId) const;
  std::vector<ConstraintId> ids() const;  ///< in order of slots

  ConstraintState state(ConstraintId) const;
  std::vector<ParticleId> particles(ConstraintId) const;     ///< all particles of it, markers included
  std::vector<CoupledCoordinate> terms(ConstraintId) const;  ///< of a coupling or tackle; otherwise empty
  /// How it was made, with the points where they are now. Throws std::invalid_argument for another kind.
  PathSpec path(ConstraintId) const;
  std::vector<Surface> surfaces(ConstraintId) const;  ///< of a and b, where they are now; empty for other kinds
  /// True repairs a broken one, with the relative pose in which its bodies were joined.
  void set_active(ConstraintId, bool);
  /// Moves a coordinate to a value (rad, m), with the rest of the mechanism. If the joint is in no loop, everything
  /// attached to a turns or slides as one rigid body (if a is attached to something fixed, everything attached to b);
  /// in a loop all bodies make the least motion. Velocities stay as far as the joints allow. Throws
  /// std::invalid_argument and changes nothing if the value is beyond the limits or the mechanism cannot reach it.
  void set_value(ConstraintId, JointCoordinate, double value);
  CoordinateOptions coordinate(ConstraintId, JointCoordinate) const;
  void set_coordinate(ConstraintId, JointCoordinate, const CoordinateOptions&);
  void set_length(ConstraintId, double);  ///< of a rod, rope, tackle or coupling: reached during the next step
  Compliance compliance(ConstraintId) const;
  /// Only kinds that hold a place, directions or a distance can be compliant; paths, surfaces and couplings cannot.
  void set_compliance(ConstraintId, const Compliance&);
  BreakLimits break_limits(ConstraintId) const;
  void set_break_limits(ConstraintId, const BreakLimits&);
};

}  // namespace iota
