// SPDX-License-Identifier: Apache-2.0
#include "read/poses.h"

#include "ingredient/grips.h"
#include "ingredient/quantities.h"
#include "read/attributes.h"

#include <algorithm>

namespace iota::read {

PoseSnapshot poses(model::Model& m, held::HeldForces& held, Orientations& orientations) {
  orientations.refresh(m);
  PoseSnapshot snapshot;
  snapshot.step = m.step, snapshot.time = m.time, snapshot.structure_version = m.structure_version;
  const ingredient::Energies energies = ingredient::calc_energies(m);
  snapshot.kinetic = static_cast<float>(energies.kinetic);
  snapshot.potential = static_cast<float>(energies.potential + held.energy());
  snapshot.gap = static_cast<float>(ingredient::worst_gap(m));
  const auto put = [](float (&out)[3], const Vec3& v) {
    out[0] = static_cast<float>(v.x), out[1] = static_cast<float>(v.y), out[2] = static_cast<float>(v.z);
  };
  snapshot.bodies.reserve(m.bodies.size());
  m.bodies.for_each([&](std::uint32_t slot, const model::Body& b) {
    if (b.kind == BodyKind::inactive || (b.count == 0 && !m.obstacles.has(slot))) return;
    if (b.count > 0 && m.is_spark(b.first)) {
      const model::Attributes& spark_attributes = m.attributes[m.particles[b.first].attributes];
      const ParticleAttributes look = attributes(m, spark_attributes);
      SparkPose& spark = snapshot.sparks.emplace_back();
      put(spark.position, m.position(b.first));
      spark.set = spark_attributes.emitter;
      spark.radius = static_cast<float>(look.radius);
      for (int i = 0; i < 3; ++i)
        spark.color = spark.color << 8 | static_cast<std::uint32_t>(std::clamp(look.color[i], 0.0f, 1.0f) * 255 + 0.5f);
      return;
    }
    BodyPose& pose = snapshot.bodies.emplace_back();
    pose.body = slot;
    put(pose.position, m.center_of_mass(slot));
    const Quaternion& q = b.orientation;
    const double values[4] = {q.x, q.y, q.z, q.w};
    for (int i = 0; i < 4; ++i) pose.orientation[i] = static_cast<float>(values[i]);
  });
  m.grips.for_each([&](std::uint32_t, const ingredient::Grip& g) {
    HoldPose& hold = snapshot.holds.emplace_back();
    hold.client = g.client, hold.hold = g.hold, hold.body = g.body;
    put(hold.point, ingredient::Grips::point(m, g));
    put(hold.target, g.target);
    hold.force = static_cast<float>(norm(g.force));
  });
  return snapshot;
}

}  // namespace iota::read
