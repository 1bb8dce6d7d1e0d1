// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "edit/editor.h"

#include <iota/many.h>

namespace iota {

template <>
struct LastEnumerator<Quantity> : std::integral_constant<Quantity, Quantity::motion> {};

}  // namespace iota

/// Commands with arrays: each does for many things what a command does for one.
namespace iota::edit {

struct CreatePoints {
  PointRows rows;
};
struct CreateRods {
  RodRows rows;
};
struct CreateBonds {
  std::vector<ParticleId> p, q;
  LawId law;
  bool implicit;
  std::vector<std::array<double, max_law_parameters>> parameters;  ///< one for each, or one for all
};
struct CombineMany {
  std::vector<ParticleId> p, q;
};
/// values: width(quantity) for each thing.
struct AssignParticles {
  static constexpr bool wakes_what_it_changes = true;
  Quantity quantity;
  std::vector<ParticleId> particles;
  std::vector<double> values;
};
struct AssignBodies {
  static constexpr bool wakes_what_it_changes = true;
  Quantity quantity;
  std::vector<BodyId> bodies;
  std::vector<double> values;
};
struct AssignBonds {
  std::vector<std::uint32_t> index;  ///< of the parameter, one for each
  std::vector<BondId> bonds;
  std::vector<double> values;
};

std::vector<ParticleId> apply(Editor&, const CreatePoints&);
std::vector<BodyId> apply(Editor&, const CreateRods&);
std::vector<BondId> apply(Editor&, const CreateBonds&);
RestructureReport apply(Editor&, const CombineMany&);
void apply(Editor&, const AssignParticles&);
void apply(Editor&, const AssignBodies&);
void apply(Editor&, const AssignBonds&);

}  // namespace iota::edit
