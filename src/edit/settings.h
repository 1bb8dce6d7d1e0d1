// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "edit/editor.h"

#include <iota/options.h>

/// Commands for settings of the system.
namespace iota::edit {

struct SetGravity {
  Vec3 value;
};
struct SetMode {
  IntegrationMode mode;
};
struct SetTolerance {
  double value;
};
struct SetBudget {
  StepBudget budget;
};
struct SetSolver {
  std::string name;
};
struct SetDamping {
  double per_second;
};
struct SetUsualRadius {
  static constexpr bool keeps_energy = true;
  double value;
};
/// The material of all bodies that can move and have none of their own.
struct SetUsualMaterial {
  static constexpr bool keeps_energy = true;
  bool touches;
  Material value;
};
struct SetRest {
  RestOptions options;
};

void apply(Editor&, const SetGravity&);
void apply(Editor&, const SetMode&);
void apply(Editor&, const SetTolerance&);
void apply(Editor&, const SetBudget&);
void apply(Editor&, const SetSolver&);
void apply(Editor&, const SetDamping&);
void apply(Editor&, const SetUsualRadius&);
void apply(Editor&, const SetUsualMaterial&);
void apply(Editor&, const SetRest&);

}  // namespace iota::edit
