// SPDX-License-Identifier: Apache-2.0
#include "step/edit_batch.h"

#include "ingredient/quantities.h"
#include "step/checks.h"
#include "step/execute.h"

#include <algorithm>

namespace iota {

namespace step {

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
  std::erase_if(gone, [&](IdType id) {
    return std::any_of(absorbed.begin(), absorbed.end(), [&](const auto& pair) { return pair.retired == id; });
  });
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
  sum.remaining_gap = report.remaining_gap;
  sum.energy_change += report.energy_change;
  sum.momentum_change += report.momentum_change;
  sum.angular_momentum_change += report.angular_momentum_change;
}

EditBatch::EditBatch(const model::Model& model, Snapshot start)
    : before(std::move(start)),
      bodies_(model.bodies.ids()),
      particles_(model.particles.ids()),
      version_(model.structure_version),
      edit_energy_(ingredient::energy_of_edits(model)) {
  report_.articulates_before = model.articulates.size();
}

void EditBatch::add(const RestructureReport& report) {
  const std::uint32_t articulates = report_.articulates_before;
  add_report(report_, report);
  report_.articulates_before = articulates;
}

RestructureReport EditBatch::finish(const model::Model& model) {
  report_.changed = model.structure_version != version_;
  note_changes(bodies_, model.bodies.ids(), report_.created_bodies, report_.destroyed_bodies);
  note_changes(particles_, model.particles.ids(), report_.created_particles, report_.destroyed_particles);
  forget_absorbed(report_.destroyed_bodies, report_.absorbed_bodies);
  forget_absorbed(report_.destroyed_particles, report_.absorbed_particles);
  report_.articulates_after = model.articulates.size();
  report_.structure_version = model.structure_version;
  report_.energy_change = ingredient::energy_of_edits(model) - edit_energy_;
  return std::move(report_);
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

}  // namespace step

void System::begin_edit() { implementation_->execute(step::BeginEdit{}); }
RestructureReport System::end_edit() { return implementation_->execute(step::EndEdit{}); }
void System::cancel_edit() { implementation_->execute(step::CancelEdit{}); }
bool System::is_editing() const { return implementation_->batch.has_value(); }
bool System::undo() { return implementation_->execute(step::Undo{}); }
bool System::redo() { return implementation_->execute(step::Redo{}); }
std::size_t System::undo_count() const { return implementation_->done.size(); }
std::size_t System::redo_count() const { return implementation_->undone.size(); }

void System::Implementation::apply(const step::BeginEdit&) {
  if (batch) {
    ++batch->depth;
    return;
  }
  book_held_edits();
  batch.emplace(model, snapshot());
}

RestructureReport System::Implementation::apply(const step::EndEdit&) {
  if (!batch) throw std::logic_error("end_edit: no edit has been begun");
  if (--batch->depth > 0) return {};
  book_held_edits();
  RestructureReport report = batch->finish(model);
  done.push(std::move(batch->before));
  undone.clear();
  batch.reset();
  return report;
}

void System::Implementation::apply(const step::CancelEdit&) {
  if (!batch) throw std::logic_error("cancel_edit: no edit has been begun");
  const Snapshot before = std::move(batch->before);
  batch.reset();
  restore(before);
}

bool System::Implementation::apply(const step::Undo&) { return go_to(done, undone); }
bool System::Implementation::apply(const step::Redo&) { return go_to(undone, done); }

bool System::Implementation::go_to(step::History& from, step::History& to) {
  if (batch) throw std::logic_error("undo and redo are not possible within an edit: end or cancel it first");
  const std::optional<Snapshot> state = from.pop();
  if (!state) return false;
  to.push(snapshot());
  restore(*state);
  return true;
}

}  // namespace iota
