// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iota/reports.h>

#include <string>
#include <vector>

namespace iota::model {
class Model;
}

namespace iota::ingredient {

/// The outcome of a step: the answers of all ingredients to one question, by the loads and ages at the end of the step
/// and before any edit. The step then makes the edits, in the order of these lists.
struct Outcome {
  std::vector<ConstraintId> failed;  ///< the function of a surface has failed: to be switched off
  std::vector<ParticleId> ended;     ///< their lifetime is over
  std::vector<EmitterId> due;        ///< they owe at least one birth
  std::vector<Broken> overloaded;    ///< to be switched off, separated or released
  std::vector<Id<"closing">> met;    ///< their time is over: the particles become one
  std::vector<StopEvent> stops;      ///< also of those that are switched off
  std::vector<std::string> warnings;

  bool has_edits() const {
    return !(failed.empty() && ended.empty() && due.empty() && overloaded.empty() && met.empty());
  }
  void clear() {
    failed.clear(), ended.clear(), due.clear(), overloaded.clear(), met.clear(), stops.clear(), warnings.clear();
  }
};

/// Changes by a step of h seconds that no island makes; call it once all islands have stepped.
void end_step(model::Model&, double h);

/// Asks all ingredients what the step has led to.
void tell(model::Model&, Outcome&);

}  // namespace iota::ingredient
