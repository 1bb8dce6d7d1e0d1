// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iota/ids.h>
#include <iota/vec3.h>
#include <iota/view.h>

#include <vector>

namespace iota {

using BalloonId = Id<"balloon">;

/// Constant forces on particles.
class Balloons : public View {
 public:
  explicit Balloons(Core& core) : View(core) {}

  BalloonId create(ParticleId, const Vec3& lift);  ///< N
  void set_lift(BalloonId, const Vec3&);
  void destroy(BalloonId);
  bool contains(BalloonId) const;
  std::vector<BalloonId> ids() const;

  Vec3 lift(BalloonId) const;
};

}  // namespace iota
