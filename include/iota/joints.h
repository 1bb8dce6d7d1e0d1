// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iota/constraints.h>
#include <iota/ids.h>
#include <iota/view.h>

#include <vector>

namespace iota {

/// Constraints of all kinds: joints between bodies, rods and ropes, paths and surfaces. Velocities and gaps are brought in
/// line with a new one at the start of the next step.
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
  std::vector<ParticleId> particles(ConstraintId) const;     ///< that it refers to, markers included
  std::vector<CoupledCoordinate> terms(ConstraintId) const;  ///< of a coupling or tackle; else none
  /// True repairs a broken one; bodies keep the relative place they were joined in.
  void set_active(ConstraintId, bool);
  /// Puts a coordinate at a value (rad, m) and lets the rest of the mechanism follow. Where the joint is in no loop, what
  /// hangs on a turns or slides as one rigid thing, or, where a hangs on something fixed, what hangs on b; in a loop all
  /// bodies move as little as they can. Velocities stay as far as the joints allow. Throws std::invalid_argument, with
  /// everything as it was, beyond the coordinate's limits and where the rest cannot follow.
  void set_value(ConstraintId, JointCoordinate, double value);
  CoordinateOptions coordinate(ConstraintId, JointCoordinate) const;
  void set_coordinate(ConstraintId, JointCoordinate, const CoordinateOptions&);
  void set_length(ConstraintId, double);  ///< of a rod, rope, tackle or coupling: reached during the next step
  BreakLimits break_limits(ConstraintId) const;
  void set_break_limits(ConstraintId, const BreakLimits&);
};

}  // namespace iota
