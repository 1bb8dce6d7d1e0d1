// SPDX-License-Identifier: Apache-2.0
#include "solver/sparse/pattern_cache.h"

#include <utility>

namespace iota::solver {

PatternCache& PatternCache::of_thread() {
  thread_local PatternCache cache;
  return cache;
}

/// Sets the key, and returns its hash (FNV-1a, by numbers instead of bytes).
std::uint64_t PatternCache::note_key(const CouplingGraph& graph) {
  key_.clear();
  key_.push_back(graph.node_count), key_.push_back(static_cast<std::uint32_t>(graph.couplings.size()));
  for (const auto& [a, b] : graph.couplings) key_.push_back(a << 8 | b);
  for (const auto& c : graph.constraints) {
    key_.push_back(std::uint32_t{c.rows} | std::uint32_t{c.node_count} << 8 | std::uint32_t{c.first_side} << 16 |
                   std::uint32_t{c.apart} << 24 | std::uint32_t{c.always_behind_first_side} << 25);
    for (const std::uint32_t node : graph.nodes_of(c)) key_.push_back(node);
  }
  std::uint64_t hash = 0xcbf29ce484222325;
  for (const std::uint32_t number : key_) hash = (hash ^ number) * 0x100000001b3;
  return hash ^ hash >> 32;
}

// A pattern that only the cache has cannot get another user meanwhile: it alone hands them out, in this thread.
PatternCache::Known* PatternCache::find_room(Set& set) {
  for (std::size_t i = 0; i < set.known.size(); ++i) {
    Known& known = set.known[set.next];
    set.next = (set.next + 1) % static_cast<std::uint32_t>(set.known.size());
    if (!known.pattern) known.pattern = std::make_shared<BlockPattern>();
    // The latest user may have been on another thread. The end of a copy comes after all that its owners did.
    if (known.pattern.use_count() == 1 && std::shared_ptr(known.pattern)) return &known;
  }
  return nullptr;
}

std::shared_ptr<const BlockPattern> PatternCache::find(CouplingGraph& graph) {
  if (graph.node_count > most_nodes) return nullptr;
  const std::uint64_t hash = note_key(graph);
  if (sets_.empty()) sets_.resize(set_count), seen_.resize(seen_count);
  auto& set = sets_[hash % set_count];
  if (set)
    for (const Known& known : set->known) {
      if (known.hash != hash || known.key != key_) continue;
      auto unknown = known.unknowns.begin();
      for (auto& c : graph.constraints) c.unknown = *unknown++;
      return known.pattern;
    }
  const auto other_bits = static_cast<std::uint32_t>(hash >> 32);
  if (std::exchange(seen_[hash % seen_count], other_bits) != other_bits) return nullptr;
  if (!set) set = std::make_unique<Set>();
  Known* const room = find_room(*set);
  if (!room) return nullptr;
  analyzed_.analyze(graph);
  *room->pattern = analyzed_;
  room->hash = hash, room->key.assign(key_.begin(), key_.end());
  room->unknowns.clear(), room->unknowns.reserve(graph.constraints.size());
  for (const auto& c : graph.constraints) room->unknowns.push_back(c.unknown);
  return room->pattern;
}

}  // namespace iota::solver
