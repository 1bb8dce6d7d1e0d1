// SPDX-License-Identifier: Apache-2.0
#include "system/core.h"

namespace iota {

void System::begin_edit() { implementation_->execute(edit::BeginEdit{}); }

RestructureReport System::end_edit() { return implementation_->execute(edit::EndEdit{}); }

void System::cancel_edit() { implementation_->execute(edit::CancelEdit{}); }

bool System::is_editing() const { return implementation_->editor.batch.has_value(); }

bool System::undo() { return implementation_->execute(edit::Undo{}); }

bool System::redo() { return implementation_->execute(edit::Redo{}); }

std::size_t System::undo_count() const { return implementation_->editor.undo.size(); }

std::size_t System::redo_count() const { return implementation_->editor.redo.size(); }

RestructureReport System::separate(BodyId body, BodyId part) {
  return implementation_->execute(edit::SeparatePart{body, part});
}

RestructureReport System::combine(ParticleId p, ParticleId q, double over) {
  return implementation_->execute(edit::CombineParticles{p, q, over});
}

RestructureReport System::combine(BodyId a, BodyId b) { return implementation_->execute(edit::CombineBodies{a, b}); }

RestructureReport System::separate(ParticleId p, ParticleId q) {
  return implementation_->execute(edit::Separate{p, q});
}

std::uint32_t System::closing_count() const { return implementation_->model.closings.size(); }

}  // namespace iota
