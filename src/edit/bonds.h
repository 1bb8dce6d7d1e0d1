// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "edit/editor.h"

namespace iota::edit {

struct CreateBond {
  ParticleId p, q;
  LawId law;
  bool implicit;
  std::uint64_t script;                               ///< key of its own function; 0: none
  std::array<double, max_law_parameters> parameters;  ///< NaN: the present distance of the ends
};
struct SetBondParameter {
  BondId bond;
  std::uint32_t index;
  double value;
};
struct SetBondActive {
  static constexpr std::string_view queued_as = "set_active";
  BondId bond;
  bool active;
};
struct SetBondBreakForce {
  BondId bond;
  double force;
};

void check(const Editor&, const CreateBond&);
BondId apply(Editor&, const CreateBond&);
void check(const Editor&, const SetBondParameter&);
void apply(Editor&, const SetBondParameter&);
void apply(Editor&, const SetBondActive&);
void apply(Editor&, const SetBondBreakForce&);
void apply(Editor&, const Destroy<BondId>&);

}  // namespace iota::edit
