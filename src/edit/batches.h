// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "edit/editor.h"

/// Commands for batches of edits, undo and redo.
namespace iota::edit {

struct BeginEdit {
  bool is_undoable = true;  ///< else an undo goes past it
};
struct EndEdit {};
struct CancelEdit {};
struct Undo {};
struct Redo {};

void apply(Editor&, const BeginEdit&);
RestructureReport apply(Editor&, const EndEdit&);
void apply(Editor&, const CancelEdit&);
bool apply(Editor&, const Undo&);
bool apply(Editor&, const Redo&);

}  // namespace iota::edit
