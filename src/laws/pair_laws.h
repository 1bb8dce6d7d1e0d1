// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "expression/functions.h"

#include <cmath>
#include <limits>
#include <span>
#include <tuple>

/// The predefined laws between two points, one list. A new law is a struct and a name in `PairLaws`.
namespace iota::laws {

inline constexpr int max_parameters = 8;

enum class Range : unsigned char { any, not_negative, positive };

struct Parameter {
  const char* name;
  double standard;  ///< NaN: the distance of the two points when the bond is made
  Range range = Range::any;
};

inline constexpr double distance_now = std::numeric_limits<double>::quiet_NaN();

/// An energy U(r), J, with its slope U' (the pull along the line, N) and its curvature U'' (N/m).
struct Elastic {
  double energy = 0, slope = 0, curvature = 0;
};

/// Two points at distance r (m), growing by v (m/s), of masses m_p and m_q (kg), at time t (s).
struct PairState {
  double r = 0, v = 0, t = 0, m_p = 1, m_q = 1;
};

/// Defaults of a law: no energy, no dashpot, no drag.
struct NoForce {
  static constexpr bool has_energy = true, has_dashpot = false, has_drag = false, needs_mass = false;
  static Elastic elastic(const PairState&, const double*) { return {}; }
  static double dashpot(const double*) { return 0; }  ///< c of the force -c v along the line, N s/m
  static double drag(const double*) { return 0; }     ///< c of the force -c (v_p - v_q), N s/m
};

struct Spring : NoForce {
  static constexpr const char* name = "spring";
  static constexpr const char* text = "energy = 0.5*stiffness*(r - length)^2; force = -damping*v";
  static constexpr Parameter parameters[] = {{"stiffness", 100, Range::not_negative},
                                             {"damping", 0, Range::not_negative},
                                             {"length", distance_now, Range::not_negative}};
  static constexpr bool has_dashpot = true;
  IOTA_ALWAYS_INLINE static Elastic elastic(const PairState& s, const double* p) {
    const double stretch = s.r - p[2];
    return {0.5 * p[0] * stretch * stretch, p[0] * stretch, p[0]};
  }
  static double dashpot(const double* p) { return p[1]; }
};

struct Drag : NoForce {
  static constexpr const char* name = "drag";
  static constexpr const char* text = "drag = damping";
  static constexpr Parameter parameters[] = {{"damping", 1, Range::not_negative}};
  static constexpr bool has_energy = false, has_drag = true;
  static double drag(const double* p) { return p[0]; }
};

struct Dashpot : NoForce {
  static constexpr const char* name = "dashpot";
  static constexpr const char* text = "force = -damping*v";
  static constexpr Parameter parameters[] = {{"damping", 1, Range::not_negative}};
  static constexpr bool has_energy = false, has_dashpot = true;
  static double dashpot(const double* p) { return p[0]; }
};

/// Only pulls: an elastic string, slack below its length.
struct Tether : NoForce {
  static constexpr const char* name = "tether";
  static constexpr const char* text = "energy = 0.5*stiffness*max(r - length, 0)^2";
  static constexpr Parameter parameters[] = {{"stiffness", 100, Range::not_negative},
                                             {"length", distance_now, Range::not_negative}};
  IOTA_ALWAYS_INLINE static Elastic elastic(const PairState& s, const double* p) {
    const double stretch = s.r > p[1] ? s.r - p[1] : 0;
    return {0.5 * p[0] * stretch * stretch, p[0] * stretch, s.r > p[1] ? p[0] : 0};
  }
};

/// Only pushes, below its length: soft balls.
struct SoftRepulsion : NoForce {
  static constexpr const char* name = "soft_repulsion";
  static constexpr const char* text = "energy = 0.5*stiffness*min(r - length, 0)^2";
  static constexpr Parameter parameters[] = {{"stiffness", 100, Range::not_negative}, {"length", 1, Range::positive}};
  IOTA_ALWAYS_INLINE static Elastic elastic(const PairState& s, const double* p) {
    const double stretch = s.r < p[1] ? s.r - p[1] : 0;
    return {0.5 * p[0] * stretch * stretch, p[0] * stretch, s.r < p[1] ? p[0] : 0};
  }
};

/// Newton's law, Plummer-softened: strength is G in m^3/(kg s^2).
struct Gravity : NoForce {
  static constexpr bool needs_mass = true;
  static constexpr const char* name = "gravity";
  static constexpr const char* text = "energy = -strength*m_p*m_q/sqrt(r^2 + softening^2)";
  static constexpr Parameter parameters[] = {{"strength", 1}, {"softening", 0, Range::not_negative}};
  IOTA_ALWAYS_INLINE static Elastic elastic(const PairState& s, const double* p) {
    const double r2 = s.r * s.r, d2 = r2 + p[1] * p[1], k = p[0] * s.m_p * s.m_q;
    const double inverse = 1 / d2, u = -k * std::sqrt(inverse);
    return {u, -u * inverse * s.r, -u * inverse * (1 - 3 * r2 * inverse)};
  }
};

/// strength is q_p q_q / (4 pi eps0) in N m^2; positive repels.
struct Coulomb : NoForce {
  static constexpr const char* name = "coulomb";
  static constexpr const char* text = "energy = strength/sqrt(r^2 + softening^2)";
  static constexpr Parameter parameters[] = {{"strength", 1}, {"softening", 0, Range::not_negative}};
  IOTA_ALWAYS_INLINE static Elastic elastic(const PairState& s, const double* p) {
    const double r2 = s.r * s.r, inverse = 1 / (r2 + p[1] * p[1]), u = p[0] * std::sqrt(inverse);
    return {u, -u * inverse * s.r, -u * inverse * (1 - 3 * r2 * inverse)};
  }
};

/// Long-range attraction, short-range repulsion: zero at r = size, deepest (-depth) at 2^(1/6) size.
struct LennardJones : NoForce {
  static constexpr const char* name = "lennard_jones";
  static constexpr const char* text = "energy = 4*depth*((size/r)^12 - (size/r)^6)";
  static constexpr Parameter parameters[] = {{"depth", 1, Range::not_negative}, {"size", 1, Range::positive}};
  IOTA_ALWAYS_INLINE static Elastic elastic(const PairState& s, const double* p) {
    const double inverse = 1 / (s.r * s.r), q = p[1] * p[1] * inverse, q6 = q * q * q, d = 4 * p[0];
    return {d * q6 * (q6 - 1), d * q6 * (6 - 12 * q6) * inverse * s.r, d * q6 * (156 * q6 - 42) * inverse};
  }
};

/// A chemical bond that breaks: zero at rest, dissociation energy `depth`; width in 1/m. Morse, Phys. Rev. 34 (1929).
struct Morse : NoForce {
  static constexpr const char* name = "morse";
  static constexpr const char* text = "energy = depth*(1 - exp(-width*(r - length)))^2";
  static constexpr Parameter parameters[] = {
      {"depth", 1, Range::not_negative}, {"width", 1, Range::positive}, {"length", distance_now, Range::not_negative}};
  IOTA_ALWAYS_INLINE static Elastic elastic(const PairState& s, const double* p) {
    const double e = expression::exp(-p[1] * (s.r - p[2])), d = 1 - e;
    return {p[0] * d * d, 2 * p[0] * p[1] * d * e, 2 * p[0] * p[1] * p[1] * e * (2 * e - 1)};
  }
};

/// A swarm: repels nearby, attracts farther off, and aligns velocities. D'Orsogna et al., Phys. Rev. Lett. 96 (2006).
struct AttractRepel : NoForce {
  static constexpr const char* name = "attract_repel";
  static constexpr const char* text =
      "energy = repulsion*exp(-r/repulsion_range) - attraction*exp(-r/attraction_range); drag = alignment";
  static constexpr Parameter parameters[] = {{"attraction", 0.5, Range::not_negative},
                                             {"attraction_range", 2, Range::positive},
                                             {"repulsion", 1, Range::not_negative},
                                             {"repulsion_range", 0.5, Range::positive},
                                             {"alignment", 0, Range::not_negative}};
  static constexpr bool has_drag = true;
  IOTA_ALWAYS_INLINE static Elastic elastic(const PairState& s, const double* p) {
    const double a = p[0] * expression::exp(-s.r / p[1]), b = p[2] * expression::exp(-s.r / p[3]);
    return {b - a, a / p[1] - b / p[3], b / (p[3] * p[3]) - a / (p[1] * p[1])};
  }
  static double drag(const double* p) { return p[4]; }
};

/// The list of laws. Names, parameters, batches, bindings and documentation are folds over it.
using PairLaws =
    std::tuple<Spring, Drag, Dashpot, Tether, SoftRepulsion, Gravity, Coulomb, LennardJones, Morse, AttractRepel>;
inline constexpr std::uint32_t pair_law_count = std::tuple_size_v<PairLaws>;

}  // namespace iota::laws
