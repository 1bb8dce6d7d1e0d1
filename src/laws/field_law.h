// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "expression/program.h"
#include "laws/field_laws.h"
#include "laws/particle_arrays.h"

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace iota::laws {

/// A force on each single particle: one of the list, or an expression of x, y, z, vx, vy, vz, m, t and its
/// parameters. The expression defines `energy` (J; the force is its negative gradient), or fx, fy, fz (N; a missing one
/// is zero), or both, which are added: "energy = 0.5*k*x^2 + m*9.81*y; fx = -c*vx".
class FieldLaw {
 public:
  explicit FieldLaw(std::uint32_t number);
  /// Throws expression::ExpressionError.
  FieldLaw(std::string_view text, std::vector<std::string> parameters);

  bool has_energy() const { return has_energy_; }
  bool depends_on_velocity() const { return depends_on_velocity_; }

  /// Forces of particles [first, first + count) into out, which has that many rows (count, 3).
  void evaluate(const ParticleArrays&, std::size_t first, std::size_t count, double t, const double* parameters,
                double* out) const;
  /// The derivatives of these forces by the velocities, N s/m: row i of particle j at out[9 j + 3 i]. Zero for a particle
  /// where any is not finite, as that of a quadratic drag is at rest.
  void evaluate_rates(const ParticleArrays&, std::size_t first, std::size_t count, double t, const double* parameters,
                      double* out) const;
  /// Energy of all particles, J; 0 for fields without one. A particle whose energy is not finite adds nothing.
  double energy(const ParticleArrays&, double t, const double* parameters) const;

  static constexpr const char* variables[] = {"x", "y", "z", "vx", "vy", "vz", "m", "t"};

 private:
  std::uint32_t number_ = field_law_count;  // of the list; else an expression
  /// Runs a program over blocks of particles, and calls take(first, count, outputs) for each; outputs[k][i].
  template <class Take>
  void run(const expression::Program&, const ParticleArrays&, std::size_t first, std::size_t count, double t,
           const double* parameters, Take take) const;

  bool has_energy_ = false, depends_on_velocity_ = false;
  std::size_t parameter_count_ = 0;
  expression::Program force_, energy_, rates_;
};

std::uint32_t find_field_law(std::string_view name);  ///< field_law_count for an unknown name
const char* field_law_name(std::uint32_t number);
std::span<const Parameter> field_law_parameters(std::uint32_t number);

}  // namespace iota::laws
