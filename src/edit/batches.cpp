// SPDX-License-Identifier: Apache-2.0
#include "edit/batches.h"

#include "edit/settle.h"

#include <iota/reports.h>

namespace iota::edit {

void apply(Editor& e, const BeginEdit& c) {
  if (e.batch) {
    ++e.batch->depth;
    return;
  }
  e.held.book_edits();
  e.batch.emplace(e.model, e.snapshot(Editor::Origin::own));
  e.batch->is_undoable = c.is_undoable;
}

RestructureReport apply(Editor& e, const EndEdit&) {
  if (!e.batch) throw std::logic_error("end_edit: no edit has been begun");
  if (--e.batch->depth > 0) return {};
  e.held.book_edits();
  e.batch->count_coordinates(e.model);
  RestructureReport report = e.batch->finish(e.model);
  settle_batch(e, report);
  if (!e.batch->is_empty && e.batch->is_undoable) {
    e.undo.push(std::move(e.batch->before));
    e.redo.clear();
  }
  e.batch.reset();
  return report;
}

void apply(Editor& e, const CancelEdit&) {
  if (!e.batch) throw std::logic_error("cancel_edit: no edit has been begun");
  const Snapshot before = std::move(e.batch->before);
  e.batch.reset();
  e.restore(before, Editor::Origin::own);
}

namespace {

bool go_to(Editor& e, History& from, History& to) {
  if (e.batch) throw std::logic_error("undo and redo are not possible within an edit: end or cancel it first");
  const std::optional<Snapshot> state = from.pop();
  if (!state) return false;
  to.push(e.snapshot(Editor::Origin::own));
  e.restore(*state, Editor::Origin::own);
  return true;
}

}  // namespace

bool apply(Editor& e, const Undo&) { return go_to(e, e.undo, e.redo); }
bool apply(Editor& e, const Redo&) { return go_to(e, e.redo, e.undo); }

}  // namespace iota::edit
