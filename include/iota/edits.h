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
  /// p's. Unrelated: a hinge; particles that are apart meet at once (`over` = 0) or within `over` seconds.
  RestructureReport combine(ParticleId p, ParticleId q, double over = 0);
  /// Makes one rigid body of two, in place; b is absorbed.
  RestructureReport combine(BodyId a, BodyId b);
  /// Same particle: a second one at the same place, half the mass each. Same body: q becomes a one-particle body
  /// hinged to p. Hinged: q leaves the ring. Unrelated: nothing.
  RestructureReport separate(ParticleId p, ParticleId q);
  /// Makes one of a body's parts, see Bodies::parts, a body of its own again. Hinges that combining had made rigid are back.
  RestructureReport separate(BodyId body, BodyId part);
  /// How many pairs of particles are on their way to each other after `combine(p, q, over)`.
  std::uint32_t closing_count() const;
  ///@}

  /// @name Batches: one report for all edits, which are undone as one
  ///@{
  void begin();  ///< batches within a batch are part of it
  /// Says what has been created, destroyed and absorbed since, and its energy; empty for a batch within a batch.
  RestructureReport end();
  void cancel();  ///< the system is what it was at `begin`
  bool is_open() const;
  /// Back to just before the last batch, time included: a batch is kept as the whole state before it. At most 64, and
  /// 256 MiB, are kept; System::restore and Record::start forget them. False when there is none.
  bool undo();
  bool redo();
  std::size_t undo_count() const;
  std::size_t redo_count() const;
  ///@}
};

}  // namespace iota
