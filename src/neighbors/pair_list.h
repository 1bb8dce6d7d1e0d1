// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "laws/particle_arrays.h"

#include <cstdint>
#include <span>
#include <vector>

/// Pairs of near particles.
namespace iota::neighbors {

/// All pairs nearer than a radius, each once, as rows: row i holds the partners j > i in rising order. Found by sorting
/// particles into cells; the particles may be anywhere, memory is linear in their number. A particle at a place that is not finite has no pairs.
class PairList {
 public:
  /// `family`: pairs with equal numbers are left out (points of one rigid body), unless it is empty. `sides`: only
  /// pairs of one with bit 0 and one with bit 1, unless it is empty.
  void build(const laws::ParticleArrays& particles, double radius, std::span<const std::uint32_t> family,
             std::span<const std::uint8_t> sides = {});

  std::size_t row_count() const { return start_.empty() ? 0 : start_.size() - 1; }
  const std::uint32_t* row(std::size_t i) const { return partners_.data() + start_[i]; }
  std::size_t row_size(std::size_t i) const { return start_[i + 1] - start_[i]; }
  std::size_t pair_count() const { return partners_.size(); }

 private:
  struct Pair {
    std::uint32_t i, j;
  };
  struct Placed {
    std::uint64_t cell;
    std::uint32_t particle;
  };
  std::vector<std::size_t> start_;
  std::vector<std::uint32_t> partners_;
  // Scratch.
  std::vector<Placed> placed_;
  std::vector<double> x_, y_, z_;
  std::vector<std::uint32_t> particle_, family_;
  std::vector<Pair> found_, by_second_;  // found_ keeps its room, and old pairs behind the new ones
  std::vector<std::size_t> count_;
};

}  // namespace iota::neighbors
