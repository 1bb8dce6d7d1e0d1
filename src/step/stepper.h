// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "edit/door.h"
#include "ingredient/outcome.h"
#include "step/contact_watches.h"
#include "step/contacts.h"

#include <optional>
#include <vector>

namespace iota::step {

/// One step of the whole system.
class Stepper {
 public:
  Stepper(edit::Editor& editor, edit::Door& door, contact::Outlines& outlines, ContactWatches& watches)
      : editor_(editor), door_(door), outlines_(outlines), watches_(watches) {}

  /// Advances by dt seconds. Throws std::invalid_argument for another dt than 0 < dt <= 1, and nothing else.
  StepReport step(double dt);

 private:
  // The stages, in their order; described in stepper.cpp.
  void take_held_forces(StepReport&);
  void find_contacts(double h);
  void update_islands(double dt);
  void wake(double dt);
  void renew_islands(double dt);
  void look_along_ways(double dt);
  bool may_go_beyond(island::Island&);
  void look_along_way_of_part(std::uint32_t leader, std::optional<double> part, double dt);
  bool meets_on_its_way(island::Island&, double h, bool is_part);
  void advance_in_parts(StepReport&);
  void advance_islands(StepReport&);
  void add(const solver::AdvanceReport&, StepReport&);
  void apply_edits(StepReport&);
  void fill(StepReport&);

  edit::Editor& editor_;
  edit::Door& door_;
  contact::Outlines& outlines_;
  ContactWatches& watches_;
  ContactFinder contacts_;
  // Scratch of the present step, kept for its capacity.
  double made_ = 0;  // by the islands in this step, J
  int solves_ = 0, iterations_ = 0, handed_back_ = 0;
  double spin_lost_ = 0;
  island::Island::Clock::time_point deadline_;
  ingredient::Outcome outcome_;
  std::vector<std::uint32_t> flagged_, dirty_, woken_;  // articulates: both, velocities to project, sleepers to wake
  std::vector<std::uint32_t> sprung_;                   // articulates whose islands springs or motors move
  std::vector<std::pair<std::uint32_t, Vec3>> ways_;    // rings, with their mean velocities on their ways
  std::vector<std::uint32_t> hasty_;                    // articulates whose islands take the step in parts
  std::vector<std::optional<double>> parts_;            // of each of them: the next one, s, if it is not the last
};

}  // namespace iota::step
