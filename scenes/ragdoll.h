// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iota/system.h>

#include <array>
#include <utility>
#include <vector>

namespace iota::scenes {

/// A figure of 20 bodies and 19 ball hinges, 1.7 m tall and about 76 kg: two plates (pelvis, chest) and 18 rods.
struct Ragdoll {
  std::vector<BodyId> bodies;
  std::vector<std::pair<ParticleId, ParticleId>> hinges;  ///< the particle of the inner body, that of the outer one
};

/// `at`: where the pelvis' middle is, m.
inline Ragdoll make_ragdoll(System& system, const Vec3& at) {
  Ragdoll doll;
  const auto plate = [&](std::array<Vec3, 3> corners, double mass) {
    const BodyId body = system.bodies().create();
    doll.bodies.push_back(body);
    std::array<ParticleId, 3> particles;
    for (int i = 0; i < 3; ++i) particles[i] = system.particles().create(body, at + corners[i], mass / 3);
    return particles;
  };
  /// A rod from the particle `inner`, to which it is hinged, to `end`; returns its far particle.
  const auto rod = [&](ParticleId inner, const Vec3& end, double mass) {
    const BodyId body = system.bodies().create();
    doll.bodies.push_back(body);
    const ParticleId near = system.particles().create(body, system.particles().position(inner), mass / 2);
    const ParticleId far = system.particles().create(body, at + end, mass / 2);
    system.bodies().set_rod(body, mass, 0.05);
    (void)system.edits().combine(inner, near);
    doll.hinges.push_back({inner, near});
    return far;
  };
  const auto pelvis = plate({{{0, 0.1, 0}, {-0.1, -0.05, 0}, {0.1, -0.05, 0}}}, 11);
  const ParticleId waist = rod(pelvis[0], {0, 0.25, 0.02}, 8);
  const ParticleId ribs = rod(waist, {0, 0.38, 0}, 8);
  const auto chest = plate({{{0, 0.38, 0}, {-0.18, 0.5, 0}, {0.18, 0.5, 0}}}, 14);
  (void)system.edits().combine(ribs, chest[0]);
  doll.hinges.push_back({ribs, chest[0]});
  const ParticleId neck = rod(chest[0], {0, 0.6, 0}, 2);
  (void)rod(neck, {0, 0.8, 0}, 5);
  for (const int side : {-1, 1}) {
    const double x = 0.18 * side;
    const ParticleId elbow = rod(chest[side < 0 ? 1 : 2], {x + 0.28 * side, 0.5, 0}, 2.2);
    const ParticleId wrist = rod(elbow, {x + 0.53 * side, 0.5, 0.02}, 1.4);
    (void)rod(wrist, {x + 0.7 * side, 0.5, 0}, 0.5);
    const double hip = 0.1 * side;
    const ParticleId knee = rod(pelvis[side < 0 ? 1 : 2], {hip, -0.45, 0.02}, 6);
    const ParticleId ankle = rod(knee, {hip, -0.85, 0}, 3);
    const ParticleId ball = rod(ankle, {hip, -0.9, 0.15}, 0.8);
    (void)rod(ball, {hip, -0.9, 0.22}, 0.2);
  }
  return doll;
}

}  // namespace iota::scenes
