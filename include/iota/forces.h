// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iota/ids.h>
#include <iota/vec3.h>

#include <cstddef>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

/// Laws of force and their uses. `docs/forces.md` lists the cost of each way to write a law.
namespace iota {

inline constexpr int max_law_parameters = 8;

/// A NaN value means the distance of the two ends when the bond is made.
struct LawParameter {
  std::string name;
  double value = 0;
};

/// Compiled code for one bond: the force along the line in N, positive pushes apart, of the distance r (m), its rate v (m/s), the
/// time t (s) and the bond's parameters. Called with no lock held; must neither throw nor use the system.
using RadialFunction = double (*)(double r, double v, double t, const double* parameters);

/// All bonds of one law at once, arrays of `count` rows in C order.
struct BondBatch {
  std::size_t count;
  double time;                            ///< of the positions, s
  const double *position_p, *position_q;  ///< (count, 3), m
  const double *velocity_p, *velocity_q;  ///< (count, 3), m/s
  const double* parameters;               ///< (count, number of parameters)
  const BondId* bonds;                    ///< (count)
  double* force;                          ///< out: (count, 3), on p in N; q gets the opposite
};
/// May throw: then the bonds of the law are switched off, and the step reports it.
using BatchFunction = std::function<void(const BondBatch&)>;

/// How a law is written: an expression of r, v = dr/dt, t, m_p, m_q and the parameters that defines `energy` (J), `force` (N
/// along the line, positive pushes apart) or `drag` (N s/m, times the velocity difference), or compiled code. An energy of
/// pairwise forces may depend on normals too, by the cosines cos_p, cos_q (with the line p-q) and cos_pq.
using LawBody = std::variant<std::string, RadialFunction, BatchFunction>;

struct LawOptions {
  std::string name;                      ///< for reports; at most 31 bytes
  std::vector<LawParameter> parameters;  ///< with default values
};

/// f = -(stiffness (r - length) + damping r') along the line p-q. Solved implicitly: any stiffness is stable.
struct SpringLaw {
  double stiffness = 100;                                    ///< N/m
  double damping = 0;                                        ///< N s/m, along the line
  double length = std::numeric_limits<double>::quiet_NaN();  ///< rest length, m; NaN: the distance at creation
};

/// f = -damping (v_p - v_q): viscous drag between two particles, implicit.
struct DragLaw {
  double damping = 1;  ///< N s/m
};

/// The arguments of a scripted bond's function. Held forces are evaluated in the energy-keeping mode at the middle of
/// the step (at positions extrapolated by half a step: the leapfrog scheme), in the robust mode at its start.
struct BondState {
  BondId bond;
  Vec3 position_p, position_q;  ///< m
  Vec3 velocity_p, velocity_q;  ///< m/s, at the start of the step
  double time;                  ///< s, of the positions
};

/// Any function of the script: returns the force on p in N (q gets the opposite), evaluated once a step and held.
/// A throw or a non-finite force switches the bond off and is reported by the step.
struct ScriptedLaw {
  std::function<Vec3(const BondState&)> force;
  std::string name;  ///< for reports
};

/// A law of `Laws::create` or `Laws::find`, with parameters that differ from the law's own.
struct SharedLaw {
  LawId law;
  std::vector<LawParameter> parameters;
  /// Solved together with the joints, or evaluated once a step and held. Unset: implicit if the law has a derivative.
  std::optional<bool> implicit;
};

using BondLaw = std::variant<SpringLaw, DragLaw, ScriptedLaw, SharedLaw>;

inline constexpr int max_field_parameters = 12;
inline constexpr int max_groups = 32;

/// All particles of a field at once, arrays of `count` rows in C order. Particles that are hinged together are one row.
struct ParticleBatch {
  std::size_t count;
  double time, dt;              ///< of the positions; length of the step, s
  const double* position;       ///< (count, 3), m
  const double* velocity;       ///< (count, 3), m/s
  const double* mass;           ///< (count), kg
  const ParticleId* particles;  ///< (count)
  double* force;                ///< out: (count, 3), N
};
/// May throw: then the field is switched off, and the step reports it.
using FieldFunction = std::function<void(const ParticleBatch&)>;

/// A predefined field (uniform, wind, current, well, attractor), an expression that defines energy (J), or fx, fy, fz (N), of x, y, z, vx, vy,
/// vz, m, t and its parameters, or a function.
using FieldBody = std::variant<std::string, FieldFunction>;

struct FieldOptions {
  std::string name;  ///< for reports; at most 31 bytes
  std::vector<LawParameter> parameters;
  std::optional<GroupId> group;   ///< unset: all particles
  bool replaces_gravity = false;  ///< while it is active, System::gravity() does not act
};

struct PairsOptions {
  double cutoff = 1;             ///< m: no force between pairs farther apart
  std::optional<GroupId> group;  ///< unset: all particles
  std::optional<GroupId> other;  ///< set: only pairs of a particle of `group` and one of this group
  /// Subtracts a constant and a linear term from the law's energy, such that force and energy are zero at the cut-off
  /// and do not jump there. The law must have an energy.
  bool shifted = false;
};

}  // namespace iota
