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

/// A force on each of many particles by itself: one of the list, or an expression that defines fx, fy, fz (N; those it
/// leaves out are zero) of x, y, z, vx, vy, vz, m, t and its parameters: "fx = -k*x; fy = -m*9.81".
class FieldLaw {
 public:
  explicit FieldLaw(std::uint32_t number);
  /// Throws expression::ExpressionError.
  FieldLaw(std::string_view text, std::vector<std::string> parameters);

  /// Forces of particles [first, first + count) into out, which has that many rows (count, 3).
  void evaluate(const ParticleArrays&, std::size_t first, std::size_t count, double t, double h,
                const double* parameters, double* out) const;

  static constexpr const char* variables[] = {"x", "y", "z", "vx", "vy", "vz", "m", "t"};

 private:
  std::uint32_t number_ = field_law_count;  // of the list; else an expression
  std::size_t parameter_count_ = 0;
  expression::Program program_;
};

std::uint32_t find_field_law(std::string_view name);  ///< field_law_count for an unknown name
const char* field_law_name(std::uint32_t number);
std::span<const Parameter> field_law_parameters(std::uint32_t number);

}  // namespace iota::laws
