// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iota/forces.h>
#include <iota/view.h>

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace iota {

/// Laws of force, for any number of bonds and pairwise forces.
class Laws : public View {
 public:
  explicit Laws(Core& core) : View(core) {}

  /// For use by bonds as a SharedLaw. Throws std::invalid_argument, for an expression with the place of the error.
  LawId create(LawBody body, const LawOptions& options = {});
  /// A predefined law: spring, drag, dashpot, tether, soft_repulsion, gravity, coulomb, lennard_jones, morse, attract_repel.
  LawId find(std::string_view name) const;
  void destroy(LawId);  ///< throws std::invalid_argument if bonds use it
  bool contains(LawId) const;

  std::string name(LawId) const;
  std::string_view kind(LawId) const;   ///< predefined, expression, function (of one bond each), compiled, arrays
  std::string expression(LawId) const;  ///< empty for code
  std::vector<LawParameter> parameters(LawId) const;  ///< with default values

  /// Evaluates the forces of all active bonds of a law at the present state, without applying them, to measure their
  /// cost: implicit bonds once with their derivatives, as each iteration of the solver does. Functions of the script
  /// are called. Returns the number of bonds.
  std::size_t rehearse(LawId, double dt);
};

}  // namespace iota
