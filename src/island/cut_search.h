// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/function_ref.h"
#include "ingredient/model.h"

#include <cstdint>
#include <span>
#include <vector>

namespace iota::island {

/// Finds the parts of an island that nothing connects with the rest any more. It searches from all articulates at which
/// something has changed, in turns, so that it costs what the parts cost that are found to be cut off, and not the rest.
/// Parts of more than `most` bodies are not found.
class CutSearch {
 public:
  /// Puts the articulates of all parts but one into `cut_off`. `suspects`: some of each part, living members of the
  /// island, each once.
  void find(const model::Model&, std::span<const std::uint32_t> suspects, std::size_t most,
            FunctionRef<bool(std::uint32_t)> is_member, std::vector<std::uint32_t>& cut_off);

 private:
  /// The articulates that are connected with a suspect.
  struct Flood {
    std::vector<std::uint32_t> found;  // in order; those from `next` on have not been visited
    std::size_t next = 0;
    std::size_t bodies = 0;  // visited
    bool is_open = false;    // neither complete nor joined with another one
  };
  void visit_next(const model::Model&, std::uint32_t flood, FunctionRef<bool(std::uint32_t)> is_member);
  void join(std::uint32_t flood, std::uint32_t into);

  static constexpr std::uint32_t none = model::none;
  std::vector<Flood> floods_;
  std::vector<std::uint32_t> flood_of_;  // of each articulate; `none` before and after a search
  std::vector<std::uint32_t> joined_;    // of each flood, the one that has what it found
  std::size_t open_ = 0;
};

}  // namespace iota::island
