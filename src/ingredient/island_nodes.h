// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "model/structure.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace iota::ingredient {

using model::is_free;
using model::Model;
using model::none;

/// Up to four nodes with their weights; a weight of 0 ends the list.
using WeightedNodes = std::array<std::pair<std::uint32_t, double>, 4>;

/// The unknown points of an island (its nodes), and the particles that follow from them.
struct IslandNodes {
  std::vector<std::uint32_t> articulates;  ///< in order
  std::vector<std::uint32_t> bodies;       ///< with particles; none is inactive
  std::vector<std::uint32_t> rings;        ///< of each node
  std::vector<std::uint8_t> pinned;        ///< of each node: 1 if a nail, a static or a scripted body holds it
  std::vector<std::uint32_t> carried;      ///< particles that are not nodes: affine combinations of their body's basis
  std::vector<WeightedNodes> carriers;     ///< of each carried particle

  /// `node_of_ring` has an entry for each ring of the model, `none` before and for rings outside of the island after.
  void build(const Model&, std::span<const std::uint32_t> articulates, std::vector<std::uint32_t>& node_of_ring);
  void clear() {
    articulates.clear(), bodies.clear(), rings.clear(), pinned.clear();
    carried.clear(), carriers.clear();
  }
  /// Call it if the carried particles of some bodies (sorted) or their weights may have changed; `left`: bodies (sorted)
  /// that are no longer here.
  void find_carried_again(const Model&, std::span<const std::uint32_t> bodies, std::span<const std::uint32_t> left,
                          const std::vector<std::uint32_t>& node_of_ring);
  /// The last nodes take the numbers of removed ones, the highest first.
  void remove(std::span<const std::uint32_t> nodes);

  bool has(const Model&, std::uint32_t body) const;
  std::size_t size() const { return rings.size(); }
  std::size_t pinned_count() const { return static_cast<std::size_t>(std::count(pinned.begin(), pinned.end(), 1)); }
  template <class Visit>
  void for_each_ring(const model::Structure& model,
                     Visit visit) const {  ///< visit(ring): of the nodes, then of the carried
    for (const std::uint32_t ring : rings) visit(ring);
    for (const std::uint32_t p : carried) visit(model.particles[p].ring);
  }
  template <class Visit>
  void for_each_pinned(Visit visit) const {  ///< visit(ring)
    for (std::size_t node = 0; node < size(); ++node)
      if (pinned[node]) visit(rings[node]);
  }
};

std::string name_of_ring(const Model&, std::uint32_t ring);  ///< for a sentence
/// The particle's own ring if it is an unknown, otherwise those of its basis.
WeightedNodes rings_that_carry(const Model&, std::uint32_t particle);
/// Whether two particles are always at one place: hinged, or rigidly at a place that is.
bool are_on_one_ring(const Model&, std::uint32_t p, std::uint32_t q);

/// The nodes of an island by the model's numbers, and the bodies whose items are to be added; lives while the island is
/// being built or follows a change.
class IslandMap {
 public:
  IslandMap(const Model& model, const IslandNodes& nodes, std::span<const std::uint32_t> bodies,
            const std::vector<std::uint32_t>& node_of_ring);

  const Model& model;
  const IslandNodes& nodes;
  std::span<const std::uint32_t> bodies;

  /// Whether it is one of the bodies, which are in order if the island follows a change.
  bool has(std::uint32_t body) const { return std::binary_search(bodies.begin(), bodies.end(), body); }

  /// The node of the ring of an island's particle; `none` if the particle is carried or its body inactive. Do not ask
  /// for those of other islands, which may be built at the same time.
  std::uint32_t node_of(std::uint32_t particle) const { return node_of_ring_[structure_.particles[particle].ring]; }
  /// The particle's own node, or those of its basis.
  WeightedNodes nodes_of(std::uint32_t particle) const;
  bool is_pinned(std::uint32_t node) const { return nodes.pinned[node]; }

 private:
  const model::Structure& structure_;
  const std::vector<std::uint32_t>& node_of_ring_;
};

}  // namespace iota::ingredient
