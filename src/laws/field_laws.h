// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "laws/noise.h"
#include "laws/pair_laws.h"

#include <algorithm>
#include <tuple>

/// The predefined forces on single particles, one list. A new field is a struct and a name in `FieldLaws`.
namespace iota::laws {

inline constexpr int max_field_parameters = 12;

/// One particle at time t (s).
struct FieldState {
  Vec3 position, velocity;  ///< m, m/s
  double mass = 1;          ///< kg
  double t = 0;
};

/// Defaults of a field: no energy.
struct NoEnergy {
  static constexpr bool has_energy = false, has_drag = false;
  static double energy(const FieldState&, const double*) { return 0; }  ///< J; the force is its negative gradient
  /// The drag of a field that has one: N s/m, minus the derivative of the force by the velocity.
  static double drag(const double* p) { return p[3]; }
};

/// Uniform acceleration (m/s^2).
struct Uniform : NoEnergy {
  static constexpr bool has_energy = true;
  static constexpr const char* name = "uniform";
  static constexpr Parameter parameters[] = {{"acceleration_x", 0}, {"acceleration_y", 0}, {"acceleration_z", 0}};
  static Vec3 force(const FieldState& s, const double* p) { return s.mass * Vec3{p[0], p[1], p[2]}; }
  static double energy(const FieldState& s, const double* p) {
    return -s.mass * dot(s.position, Vec3{p[0], p[1], p[2]});
  }
};

/// Drag (N s/m) relative to moving air.
struct Wind : NoEnergy {
  static constexpr bool has_drag = true;
  static constexpr const char* name = "wind";
  static constexpr Parameter parameters[] = {
      {"velocity_x", 0}, {"velocity_y", 0}, {"velocity_z", 0}, {"drag", 0.1, Range::not_negative}};
  static Vec3 force(const FieldState& s, const double* p) { return p[3] * (Vec3{p[0], p[1], p[2]} - s.velocity); }
};

/// Drag (N s/m) relative to a turbulent current; see Turbulence.
struct Current : NoEnergy {
  static constexpr bool has_drag = true;
  static constexpr const char* name = "current";
  static constexpr Parameter parameters[] = {{"velocity_x", 0},
                                             {"velocity_y", 0},
                                             {"velocity_z", 0},
                                             {"drag", 0.1, Range::not_negative},
                                             {"speed", 1, Range::not_negative},
                                             {"size", 1, Range::positive},
                                             {"octaves", 3, Range::not_negative},
                                             {"evolution", 0.1},
                                             {"seed", 0, Range::not_negative}};
  static Vec3 force(const FieldState& s, const double* p) {
    const Turbulence current{{p[0], p[1], p[2]},
                             p[4],
                             p[5],
                             static_cast<int>(std::min(p[6], 16.0)),
                             p[7],
                             static_cast<std::uint32_t>(std::min(p[8], 4e9))};
    return p[3] * (turbulent_velocity(current, s.position, s.t) - s.velocity);
  }
};

/// A heavy point: acceleration strength/d^2 towards the center (strength in m^3/s^2), Plummer-softened. Negative repels.
struct Well : NoEnergy {
  static constexpr bool has_energy = true;
  static constexpr const char* name = "well";
  static constexpr Parameter parameters[] = {
      {"center_x", 0}, {"center_y", 0}, {"center_z", 0}, {"strength", 1}, {"softening", 0.1, Range::not_negative}};
  static Vec3 force(const FieldState& s, const double* p) {
    const Vec3 d = Vec3{p[0], p[1], p[2]} - s.position;
    const double inverse = 1 / (dot(d, d) + p[4] * p[4]);
    return (s.mass * p[3] * inverse * std::sqrt(inverse)) * d;
  }
  static double energy(const FieldState& s, const double* p) {
    const Vec3 d = Vec3{p[0], p[1], p[2]} - s.position;
    return -s.mass * p[3] * std::sqrt(1 / (dot(d, d) + p[4] * p[4]));
  }
};

/// Pulls with `strength` (N) towards the center, decaying over `range` (m): strength exp(-d/range). Negative repels.
struct Attractor : NoEnergy {
  static constexpr bool has_energy = true;
  static constexpr const char* name = "attractor";
  static constexpr Parameter parameters[] = {
      {"center_x", 0}, {"center_y", 0}, {"center_z", 0}, {"strength", 1}, {"range", 1, Range::positive}};
  static Vec3 force(const FieldState& s, const double* p) {
    const Vec3 d = Vec3{p[0], p[1], p[2]} - s.position;
    const double r = norm(d);
    return (p[3] * expression::exp(-r / p[4]) / (r + 1e-300)) * d;
  }
  static double energy(const FieldState& s, const double* p) {
    return -p[3] * p[4] * expression::exp(-norm(Vec3{p[0], p[1], p[2]} - s.position) / p[4]);
  }
};

using FieldLaws = std::tuple<Uniform, Wind, Current, Well, Attractor>;
inline constexpr std::uint32_t field_law_count = std::tuple_size_v<FieldLaws>;

}  // namespace iota::laws
