// SPDX-License-Identifier: Apache-2.0
#include "solver/sparse/pattern_cache.h"

namespace iota::solver {

PatternCache& PatternCache::of_thread() {
  thread_local PatternCache cache;
  return cache;
}

std::shared_ptr<const BlockPattern> PatternCache::find(CouplingGraph& graph) {
  constexpr std::size_t most_patterns = 4096;  // some megabytes
  if (graph.node_count > most_nodes) return nullptr;
  key_.clear();
  key_.push_back(graph.node_count), key_.push_back(static_cast<std::uint32_t>(graph.couplings.size()));
  for (const auto& [a, b] : graph.couplings) key_.push_back(a << 8 | b);
  for (const auto& c : graph.constraints) {
    key_.push_back(std::uint32_t{c.rows} | std::uint32_t{c.node_count} << 8 | std::uint32_t{c.first_side} << 16 |
                   std::uint32_t{c.apart} << 24 | std::uint32_t{c.always_behind_first_side} << 25);
    for (const std::uint32_t node : graph.nodes_of(c)) key_.push_back(node);
  }
  auto found = known_.find(key_);
  if (found == known_.end()) {
    if (known_.size() == most_patterns) known_.clear();
    const auto pattern = std::make_shared<BlockPattern>();
    pattern->analyze(graph);
    found = known_.emplace(key_, Known{pattern, {}}).first;
    for (const auto& c : graph.constraints) found->second.unknowns.push_back(c.unknown);
  } else {
    auto unknown = found->second.unknowns.begin();
    for (auto& c : graph.constraints) c.unknown = *unknown++;
  }
  return found->second.pattern;
}

}  // namespace iota::solver
