// SPDX-License-Identifier: Apache-2.0
#include "ingredient/island_nodes.h"

#include "base/renumbering.h"
#include "base/text.h"
#include "ingredient/model.h"

namespace iota::ingredient {

void IslandNodes::build(const Model& model, std::span<const std::uint32_t> members,
                        std::vector<std::uint32_t>& node_of_ring) {
  articulates.assign(members.begin(), members.end());
  // Lists that grow by doubling would waste a quarter of their memory.
  std::size_t body_count = 0, point_count = 0;
  for (const std::uint32_t a : articulates)
    model.for_each_body_of(a, [&](std::uint32_t body) { ++body_count, point_count += model.bodies[body].count; });
  bodies.reserve(body_count);
  rings.reserve(point_count), pinned.reserve(point_count);
  for (const std::uint32_t articulate : articulates)
    model.for_each_body_of(articulate, [&](std::uint32_t body) {
      if (model.bodies[body].kind == BodyKind::inactive || model.bodies[body].count == 0) return;
      bodies.push_back(body);
      model.for_each_particle_of(body, [&](std::uint32_t p) {
        const model::Particle& particle = model.particles[p];
        if (!model.is_unknown(particle)) return carried.push_back(p);
        if (node_of_ring[particle.ring] != none) return;
        node_of_ring[particle.ring] = static_cast<std::uint32_t>(rings.size());
        rings.push_back(particle.ring);
        pinned.push_back(model.is_pinned(particle.ring));
      });
    });
  const IslandMap map(model, *this, bodies, node_of_ring);
  carriers.reserve(carried.size());
  for (const std::uint32_t p : carried) carriers.push_back(map.nodes_of(p));
}

bool IslandNodes::has(const Model& model, std::uint32_t body) const {
  return std::binary_search(articulates.begin(), articulates.end(), model.bodies[body].articulate);
}

void IslandNodes::find_carried_again(const Model& model, std::span<const std::uint32_t> changed,
                                     std::span<const std::uint32_t> left,
                                     const std::vector<std::uint32_t>& node_of_ring) {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < carried.size(); ++i) {
    const std::uint32_t body = model.particles[carried[i]].body;
    const auto is_in = [&](std::span<const std::uint32_t> list) {
      return std::binary_search(list.begin(), list.end(), body);
    };
    if (!is_in(changed) && !is_in(left)) carried[kept] = carried[i], carriers[kept] = carriers[i], ++kept;
  }
  carried.resize(kept), carriers.resize(kept);
  const IslandMap map(model, *this, changed, node_of_ring);
  for (const std::uint32_t body : changed)
    model.for_each_particle_of(body, [&](std::uint32_t p) {
      if (!model.is_unknown(model.particles[p])) carried.push_back(p), carriers.push_back(map.nodes_of(p));
    });
}

void IslandNodes::remove(std::span<const std::uint32_t> nodes) {
  if (nodes.empty()) return;
  thread_local Renumbering number;
  number.set(size(), nodes);
  number.apply(rings), number.apply(pinned);
  for (WeightedNodes& list : carriers)
    for (auto& [carrier, weight] : list)
      if (weight != 0) carrier = number(carrier);
}

std::string name_of_ring(const Model& model, std::uint32_t ring) {
  const std::uint32_t particle = model.rings[ring].first;
  return text("particle ", particle, " of body ", model.particles[particle].body);
}

IslandMap::IslandMap(const Model& model, const IslandNodes& nodes, std::span<const std::uint32_t> bodies,
                     const std::vector<std::uint32_t>& node_of_ring)
    : model(model), nodes(nodes), bodies(bodies), structure_(model), node_of_ring_(node_of_ring) {}

WeightedNodes rings_that_carry(const Model& model, std::uint32_t particle) {
  const model::Particle& p = model.particles[particle];
  WeightedNodes list{};
  if (model.is_unknown(p)) {
    list[0] = {p.ring, 1.0};
    return list;
  }
  const model::Body& body = model.bodies[p.body];
  const auto& weights = model.affine[particle].weights;
  int used = 0;
  for (int i = 0; i < body.rank; ++i)
    if (weights[i] != 0) list[used++] = {model.particles[body.basis[i]].ring, weights[i]};
  return list;
}

bool are_on_one_ring(const Model& model, std::uint32_t p, std::uint32_t q) {
  const WeightedNodes a = rings_that_carry(model, p), b = rings_that_carry(model, q);
  return a[0] == b[0] && a[0].second == 1;
}

WeightedNodes IslandMap::nodes_of(std::uint32_t particle) const {
  WeightedNodes list = rings_that_carry(model, particle);
  for (auto& [node, weight] : list)
    if (weight != 0) node = node_of_ring_[node];
  return list;
}

}  // namespace iota::ingredient
