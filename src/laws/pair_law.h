// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "expression/program.h"
#include "laws/pair_laws.h"

#include <array>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace iota::laws {

/// Many pairs, as arrays of `count` numbers.
struct PairBatch {
  std::size_t count = 0;
  const double *r = nullptr, *v = nullptr, *m_p = nullptr, *m_q = nullptr;
  /// Cosines: of each normal with the line from p to q, and of both normals. Only where `depends_on_normals()`.
  const double *cos_p = nullptr, *cos_q = nullptr, *cos_pq = nullptr;
  double t = 0;
  const double* const* parameters = nullptr;  ///< one array a parameter, or one number each
  bool same_parameters = false;               ///< one number each
  double* force = nullptr;                    ///< out: along the line, positive pushes apart, N
  double* drag = nullptr;                     ///< out: of the velocity difference, N s/m; only where `has_drag()`
  /// out: derivative of the energy with respect to cos_p, cos_q, cos_pq, J; only where `depends_on_normals()`
  std::array<double*, 3> slopes{};
  double* energy = nullptr;  ///< out, of `energies`: J
};

/// A law between two points: one of the list, or an expression. Its force on the second point is f n - c (v_q - v_p), with n
/// from the first to the second and f = -U'(r, t) + push(r, t) + damping(r, v, t), where U is the energy of the law and
/// damping vanishes with v. The solver treats the three parts differently.
///
/// An expression law defines `energy` (J), `force` (N along the line, positive pushes apart) or `drag` (N s/m), or several,
/// of r, v = dr/dt, t, m_p, m_q and its parameters: "energy = 0.5*k*(r - r0)^2; force = -c*v". The energy may depend on the
/// normals of two oriented particles too, by the cosines cos_p, cos_q and cos_pq: such a law turns them as well.
class PairLaw {
 public:
  /// A law of the list.
  explicit PairLaw(std::uint32_t number);
  /// Throws expression::ExpressionError, or std::invalid_argument for a text that defines no force.
  PairLaw(std::string_view text, std::vector<std::string> parameters);

  bool has_energy() const { return has_energy_; }
  bool has_push() const { return has_push_; }        ///< forces at rest that do not derive from an energy
  bool has_damping() const { return has_damping_; }  ///< forces of v
  bool has_drag() const { return has_drag_; }
  bool depends_on_time() const { return depends_on_time_; }
  bool damping_depends_on_distance() const { return damping_depends_on_distance_; }  ///< or the drag
  bool depends_on_mass() const { return depends_on_mass_; }
  bool depends_on_normals() const { return depends_on_normals_; }
  /// Whether it may add energy to the world, as forces of a user's expression without an energy may.
  bool may_do_work() const { return has_push_ || (number_ == pair_law_count && (has_damping_ || has_drag_)); }

  /// @name One pair, with derivatives, for the solver, which knows no normals
  ///@{
  Elastic elastic(const PairState&, const double* parameters) const;
  struct Slope {
    double value = 0, slope = 0;
  };
  Slope push(const PairState&, const double* parameters) const;     ///< at v = 0, and its slope over r
  Slope damping(const PairState&, const double* parameters) const;  ///< force(v) - force(0), and its slope over v
  double drag(const PairState&, const double* parameters) const;
  ///@}

  /// Many pairs, force and drag only.
  void evaluate(const PairBatch&) const;
  /// Many pairs, energy only; only where `has_energy()`.
  void energies(const PairBatch&) const;

  /// Variables of an expression law before its parameters.
  static constexpr const char* variables[] = {"r", "v", "t", "m_p", "m_q", "cos_p", "cos_q", "cos_pq"};

 private:
  void run(const expression::Program& of_bonds, const expression::Program& of_pairs, const PairBatch&,
           double* const* outputs) const;

  std::uint32_t number_ = pair_law_count;  // of the list; else an expression
  bool has_energy_ = false, has_push_ = false, has_damping_ = false, has_drag_ = false, depends_on_time_ = false,
       depends_on_mass_ = false, depends_on_normals_ = false, damping_depends_on_distance_ = false;
  std::size_t parameter_count_ = 0;
  expression::Program elastic_, push_, damping_, drag_;
  // Programs for batches, with parameters of each pair, or equal ones: force and drag, energy.
  expression::Program bonds_, pairs_, bond_energies_, pair_energies_;
};

/// Number in the list, `pair_law_count` for an unknown name.
std::uint32_t find_pair_law(std::string_view name);
const char* pair_law_name(std::uint32_t number);
const char* pair_law_text(std::uint32_t number);  ///< the same law as an expression
std::span<const Parameter> pair_law_parameters(std::uint32_t number);

}  // namespace iota::laws
