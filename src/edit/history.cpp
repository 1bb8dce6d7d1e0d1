// SPDX-License-Identifier: Apache-2.0
#include "edit/history.h"

#include "ingredient/joint_readings.h"
#include "ingredient/quantities.h"

#include <iota/reports.h>

#include <algorithm>
#include <vector>

namespace iota::edit {

namespace {

template <class IdType>
void note_changes(const std::vector<IdType>& before, const std::vector<IdType>& after, std::vector<IdType>& created,
                  std::vector<IdType>& gone) {
  created.clear(), gone.clear();
  std::set_difference(after.begin(), after.end(), before.begin(), before.end(), std::back_inserter(created));
  std::set_difference(before.begin(), before.end(), after.begin(), after.end(), std::back_inserter(gone));
}

template <class IdType, class Absorbed>
void forget_absorbed(std::vector<IdType>& gone, const std::vector<Absorbed>& absorbed) {
  std::vector<IdType> retired;
  for (const auto& pair : absorbed) retired.push_back(pair.retired);
  std::sort(retired.begin(), retired.end());
  std::erase_if(gone, [&](IdType id) { return std::binary_search(retired.begin(), retired.end(), id); });
}

}  // namespace

void add_report(RestructureReport& sum, const RestructureReport& report) {
  const auto append = [](auto& all, const auto& more) { all.insert(all.end(), more.begin(), more.end()); };
  if (!sum.changed) sum.articulates_before = report.articulates_before;
  sum.changed = sum.changed || report.changed;
  append(sum.created_bodies, report.created_bodies), append(sum.created_particles, report.created_particles);
  append(sum.destroyed_bodies, report.destroyed_bodies), append(sum.destroyed_particles, report.destroyed_particles);
  append(sum.absorbed_bodies, report.absorbed_bodies), append(sum.absorbed_particles, report.absorbed_particles);
  append(sum.notes, report.notes);
  sum.articulates_after = report.articulates_after;
  sum.structure_version = report.structure_version;
  sum.closed_distance = std::max(sum.closed_distance, report.closed_distance);
  sum.remaining_gap = std::max(sum.remaining_gap, report.remaining_gap);
  sum.energy_change += report.energy_change;
  sum.momentum_change += report.momentum_change;
  sum.angular_momentum_change += report.angular_momentum_change;
}

Batch::Batch(const model::Model& model, Snapshot start)
    : before(std::move(start)),
      report_(std::make_unique<RestructureReport>()),
      bodies_(model.bodies.ids()),
      particles_(model.particles.ids()),
      version_(model.structure_version),
      edit_energy_(ingredient::energy_of_edits(model)) {
  report_->articulates_before = model.articulate_count();
}

Batch::~Batch() = default;

void Batch::add(const RestructureReport& report) {
  const std::uint32_t articulates = report_->articulates_before;
  add_report(*report_, report);
  report_->articulates_before = articulates;
}

void Batch::note_coordinates(const model::Model& model, std::uint32_t joint) {
  const Coordinates now{model.constraints.id(joint), model.constraints[joint].coordinate};
  const auto [noted, is_new] = coordinates_.try_emplace(joint, now);
  if (!is_new && noted->second.joint != now.joint) noted->second = now;  // another one has taken its slot
}

void Batch::forget_coordinates(std::uint32_t joint) { coordinates_.erase(joint); }

void Batch::count_coordinates(model::Model& model) const {
  std::vector<std::uint32_t> joints;
  for (const auto& [slot, noted] : coordinates_) {
    if (!model.constraints.contains(noted.joint)) continue;
    model.constraints[slot].coordinate = noted.values;
    ingredient::refresh_coordinates(model, slot);
    joints.push_back(slot);
  }
  ingredient::count_turns(model, joints);
}

RestructureReport Batch::finish(const model::Model& model) {
  report_->changed = report_->changed || model.structure_version != version_;
  note_changes(bodies_, model.bodies.ids(), report_->created_bodies, report_->destroyed_bodies);
  note_changes(particles_, model.particles.ids(), report_->created_particles, report_->destroyed_particles);
  forget_absorbed(report_->destroyed_bodies, report_->absorbed_bodies);
  forget_absorbed(report_->destroyed_particles, report_->absorbed_particles);
  report_->articulates_after = model.articulate_count();
  report_->structure_version = model.structure_version;
  report_->energy_change = ingredient::energy_of_edits(model) - edit_energy_;
  return std::move(*report_);
}

void History::push(Snapshot state) {
  bytes_ += state.bytes.size();
  states_.push_back(std::move(state));
  while (states_.size() > most || (bytes_ > most_bytes && states_.size() > 1)) {
    bytes_ -= states_.front().bytes.size();
    states_.pop_front();
  }
}

std::optional<Snapshot> History::pop() {
  if (states_.empty()) return std::nullopt;
  Snapshot state = std::move(states_.back());
  states_.pop_back();
  bytes_ -= state.bytes.size();
  return state;
}

}  // namespace iota::edit
