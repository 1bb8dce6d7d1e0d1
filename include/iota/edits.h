// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iota/ids.h>
#include <iota/reports.h>
#include <iota/view.h>

#include <cstddef>
#include <cstdint>

namespace iota {

/// Changes of structure (thesis Tables 4.1-4.3), and batches of edits.
class Edits : public View {
 public:
  explicit Edits(Core& core) : View(core) {}

  /// @name Combining and separating
  ///@{
  /// Same particle: nothing. Same body: q is absorbed by p. Hinged: the hinge becomes rigid, q's body is absorbed by
  /// p's. Unrelated: a hinge; particles that are apart meet at once (`over` = 0, or a gap below 1e-4 of the bodies'
  /// extent) or within `over` seconds.
  RestructureReport combine(ParticleId p, ParticleId q, double over = 0);
  /// Makes two bodies one rigid body, without moving them; b is absorbed.
  RestructureReport combine(BodyId a, BodyId b);
  /// Same particle: a second one at the same place, half the mass each. Same body: q becomes a one-particle body
  /// hinged to p. Hinged: q leaves the ring. Unrelated: nothing.
  RestructureReport separate(ParticleId p, ParticleId q);
  /// Makes a part of a body, see Bodies::parts, a body of its own again. Restores hinges that combining had made rigid.
  RestructureReport separate(BodyId body, BodyId part);
  /// Number of pairs of particles that are still closing after `combine(p, q, over)`.
  std::uint32_t closing_count() const;
  ///@}

  /// @name Batches: all edits have one report and are undone together
  ///@{
  /// Batches within a batch are part of it. One that is not undoable is no step of `undo`: that goes past it.
  void begin(bool is_undoable = true);
  /// Reports what was created, destroyed and absorbed, and the energy; empty for a batch within a batch.
  RestructureReport end();
  void cancel();  ///< restores the state at `begin`
  bool is_open() const;
  /// Restores the state before the last batch, time included: each batch saves the whole state before it. At most 64,
  /// and 256 MiB, are kept; System::restore and Record::start drop them. False if there is none.
  bool undo();
  bool redo();
  std::size_t undo_count() const;
  std::size_t redo_count() const;
  ///@}
};

}  // namespace iota
