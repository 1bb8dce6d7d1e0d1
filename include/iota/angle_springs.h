// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iota/ids.h>
#include <iota/view.h>

#include <array>
#include <limits>
#include <vector>

namespace iota {

using AngleSpringId = Id<"angle spring">;

/// A spring on the angle between the legs from a middle particle to two others. It turns them towards `rest` with
/// energy stiffness/2 (angle - rest)^2 to second order; exactly it is a function of cos(angle/2), smooth where the legs
/// are straight, as long as the legs keep the lengths that they had when it was made.
struct AngleSpringOptions {
  double stiffness = 0;                                    ///< N m/rad, zero or more
  double damping = 0;                                      ///< N m s/rad, zero or more
  double rest = std::numeric_limits<double>::quiet_NaN();  ///< angle, rad, 0.01 to pi; NaN: the present one
};

/// Springs on angles: bending stiffness of ropes and beams, angle terms of molecules. A chain of rods of length l with
/// the stiffness EI / l at its joints bends as a beam with the bending stiffness EI.
class AngleSprings : public View {
 public:
  explicit AngleSprings(Core& core) : View(core) {}

  AngleSpringId create(ParticleId p, ParticleId middle, ParticleId q, const AngleSpringOptions&);
  void set(AngleSpringId, const AngleSpringOptions&);
  void destroy(AngleSpringId);
  bool contains(AngleSpringId) const;
  std::vector<AngleSpringId> ids() const;  ///< in order of slots

  std::array<ParticleId, 3> ends(AngleSpringId) const;  ///< the middle one is the second
  AngleSpringOptions options(AngleSpringId) const;
  double angle(AngleSpringId) const;   ///< now, rad, 0 to pi
  double moment(AngleSpringId) const;  ///< of its stiffness now, N m; positive: it opens the angle
};

}  // namespace iota
