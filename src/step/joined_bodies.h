// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ingredient/model.h"

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace iota::step {

/// Which bodies joints hold at each other, so that they may overlap. Bodies that welds hold together, each to the next, count as one:
/// a link between them may be in any of them. A weld that yields does not count, nor do static bodies, which everything is joined to.
/// Found anew in each step, from the joints of then.
class JoinedBodies {
 public:
  /// Before a step, as joints may have changed.
  void forget();
  bool has_welds(const model::Model&);  ///< any at all; without them, nothing below has to be asked
  /// Whether a hinge or a joint holds one of them at the other, or will do so when their particles have met.
  static bool are_joined(const model::Model&, std::uint32_t a, std::uint32_t b);
  /// Whether the same holds for what welds hold at them, welds hold one at the other, or both in the world.
  bool are_joined_by_welds(const model::Model&, std::uint32_t a, std::uint32_t b);
  /// A body and those that welds hold together with it. The list is valid until the next call.
  std::span<const std::uint32_t> welded_to(const model::Model&, std::uint32_t body);

 private:
  struct Range {
    std::uint32_t first = 0, count = 0;
  };
  struct Group {
    Range members, neighbors;
    bool has_neighbors = false;  ///< they are listed
    bool is_fixed = false;       ///< by a weld to the world or to a static body
  };
  struct Found {
    std::uint64_t look = 0;  ///< in which it was found
    std::uint32_t group = 0;
  };
  std::uint32_t group_of(const model::Model&, std::uint32_t body);
  void list_neighbors(const model::Model&, std::uint32_t group);

  std::uint64_t look_ = 1;
  std::optional<bool> has_welds_;
  std::vector<Found> found_;  ///< by body slot
  // Scratch, kept for its capacity.
  std::vector<Group> groups_;
  std::vector<std::uint32_t> members_;    ///< of all groups
  std::vector<std::uint32_t> neighbors_;  ///< groups that a joint holds at another one, in order
};

}  // namespace iota::step
