// SPDX-License-Identifier: Apache-2.0
#include "laws/noise.h"

#include <cmath>

namespace iota::laws {

namespace {

/// Mixes the bits of a lattice point; the constants are odd numbers without pattern, the shifts those of murmur's finalizer.
std::uint32_t mix(std::uint32_t x, std::uint32_t y, std::uint32_t z, std::uint32_t seed) {
  std::uint32_t h = seed * 0x9e3779b9u ^ x * 0x85ebca6bu ^ y * 0xc2b2ae35u ^ z * 0x27d4eb2fu;
  h ^= h >> 16, h *= 0x85ebca6bu, h ^= h >> 13, h *= 0xc2b2ae35u, h ^= h >> 16;
  return h;
}

/// A gradient towards the middle of one of a cube's twelve edges.
Vec3 edge(std::uint32_t h) {
  const double a = (h & 1) ? 1 : -1, b = (h & 2) ? 1 : -1;
  switch ((h >> 2) % 3) {
    case 0: return {a, b, 0};
    case 1: return {a, 0, b};
    default: return {0, a, b};
  }
}

}  // namespace

Noise gradient_noise(const Vec3& x, std::uint32_t seed) {
  if (!(std::abs(x.x) < 1e9 && std::abs(x.y) < 1e9 && std::abs(x.z) < 1e9)) return {};  // no lattice there
  const double cell[3] = {std::floor(x.x), std::floor(x.y), std::floor(x.z)};
  const double f[3] = {x.x - cell[0], x.y - cell[1], x.z - cell[2]};
  std::uint32_t i[3];
  double fade[3], slope[3];
  for (int k = 0; k < 3; ++k) {
    i[k] = static_cast<std::uint32_t>(static_cast<std::int32_t>(cell[k]));
    const double t = f[k];
    fade[k] = t * t * t * (t * (t * 6 - 15) + 10);
    slope[k] = 30 * t * t * (t * (t - 2) + 1);
  }
  Noise sum;
  for (int corner = 0; corner < 8; ++corner) {
    const std::uint32_t c[3] = {corner & 1u, (corner >> 1) & 1u, (corner >> 2) & 1u};
    double weight[3], change[3];
    for (int k = 0; k < 3; ++k) {
      weight[k] = c[k] ? fade[k] : 1 - fade[k];
      change[k] = c[k] ? slope[k] : -slope[k];
    }
    const Vec3 g = edge(mix(i[0] + c[0], i[1] + c[1], i[2] + c[2], seed));
    const double ramp = dot(g, Vec3{f[0] - c[0], f[1] - c[1], f[2] - c[2]});
    sum.value += weight[0] * weight[1] * weight[2] * ramp;
    sum.gradient += (weight[0] * weight[1] * weight[2]) * g;
    sum.gradient += ramp * Vec3{change[0] * weight[1] * weight[2], weight[0] * change[1] * weight[2],
                                weight[0] * weight[1] * change[2]};
  }
  return sum;
}

Vec3 turbulent_velocity(const Turbulence& t, const Vec3& position, double time) {
  constexpr double fall = 0.79370052598409974;  // 2^(-1/3)
  Vec3 u = t.mean;
  double frequency = 1 / t.size, speed = t.speed;
  Vec3 drift{0.61, 0.54, 0.58};  // octaves move in different directions, so that patterns change instead of traveling
  for (int octave = 0; octave < t.octaves; ++octave) {
    const Vec3 x = frequency * position + (t.evolution * time * frequency * t.size) * drift;
    const std::uint32_t seed = t.seed + 3 * static_cast<std::uint32_t>(octave);
    const Vec3 a = gradient_noise(x, seed).gradient;
    const Vec3 b = gradient_noise(x + Vec3{31.4, 15.9, 26.5}, seed + 1).gradient;
    const Vec3 c = gradient_noise(x + Vec3{-27.1, 82.8, -18.2}, seed + 2).gradient;
    u += speed * Vec3{c.y - b.z, a.z - c.x, b.x - a.y};
    frequency *= 2, speed *= fall;
    drift = {-drift.z, drift.x, -drift.y};
  }
  return u;
}

}  // namespace iota::laws
