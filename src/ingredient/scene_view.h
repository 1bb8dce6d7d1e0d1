// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/sort_unique.h"
#include "model/structure.h"

#include <cstdint>
#include <vector>

namespace iota {
struct Anchor;
}

namespace iota::ingredient {

/// A description of a model for viewers: complete, or the changes since the last one. Ingredients describe their items
/// with it.
class SceneView {
 public:
  SceneView(const model::Model&, bool whole);

  const model::Model& model;

  bool is_whole() const { return whole_; }
  /// The items to describe, each once, also destroyed ones: all in `table`, or those in `log` and those attached to a
  /// changed body: list(particle, slots) adds the items of a particle.
  template <class Table, class List>
  std::vector<std::uint32_t> slots(const Table& table, const model::ChangedSlots& log, List list) const {
    std::vector<std::uint32_t> slots;
    if (whole_) {
      table.for_each([&](std::uint32_t slot, const auto&) { slots.push_back(slot); });
      return slots;
    }
    slots = log.slots();
    for (const std::uint32_t body : structure_.scene.bodies.slots())
      if (structure_.bodies.is_alive(body))
        structure_.for_each_particle_of(body, [&](std::uint32_t p) { list(p, slots); });
    sort_unique(slots);
    return slots;
  }

  /// A direction, and a place, in the drawn frame of a body.
  Vec3 into_body(std::uint32_t body, const Vec3& direction) const;
  Vec3 point_in(std::uint32_t body, const Vec3& place) const;
  Anchor anchor(std::uint32_t body, const Vec3& place) const;  ///< body `none`: the world
  Anchor anchor(std::uint32_t particle) const;

 private:
  const model::Structure& structure_;
  bool whole_;
};

}  // namespace iota::ingredient
