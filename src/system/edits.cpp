// SPDX-License-Identifier: Apache-2.0
#include "system/core.h"

namespace iota {

void Edits::begin(bool is_undoable) { core_.execute(edit::BeginEdit{is_undoable}); }

RestructureReport Edits::end() { return core_.execute(edit::EndEdit{}); }

void Edits::cancel() { core_.execute(edit::CancelEdit{}); }

bool Edits::is_open() const { return core_.editor.batch.has_value(); }

bool Edits::undo() { return core_.execute(edit::Undo{}); }

bool Edits::redo() { return core_.execute(edit::Redo{}); }

std::size_t Edits::undo_count() const { return core_.editor.undo.size(); }

std::size_t Edits::redo_count() const { return core_.editor.redo.size(); }

RestructureReport Edits::separate(BodyId body, BodyId part) { return core_.execute(edit::SeparatePart{body, part}); }

RestructureReport Edits::combine(ParticleId p, ParticleId q, double over) {
  return core_.execute(edit::CombineParticles{p, q, over});
}

RestructureReport Edits::combine(BodyId a, BodyId b) { return core_.execute(edit::CombineBodies{a, b}); }

RestructureReport Edits::separate(ParticleId p, ParticleId q) { return core_.execute(edit::Separate{p, q}); }

std::uint32_t Edits::closing_count() const { return core_.model.closings.size(); }

}  // namespace iota
