// SPDX-License-Identifier: Apache-2.0
// Models made by hand, below the public `System`.
#pragma once

#include "ingredient/model.h"
#include "model/restructure.h"

#include <iota/reports.h>

#include <initializer_list>
#include <vector>

namespace iota::model {

/// A model whose bodies are made of unit masses, unless said otherwise.
struct SmallModel {
  Model model;

  std::uint32_t body(const std::vector<Vec3>& places, double mass = 1, BodyKind kind = BodyKind::dynamic) {
    const std::uint32_t slot = model.make_body(kind, 0);
    for (const Vec3& place : places) model.make_particle(slot, place, mass, {});
    model.rebuild_basis(slot);
    return slot;
  }
  /// The n-th particle of a body.
  std::uint32_t particle(std::uint32_t body, int n) const {
    std::uint32_t p = model.bodies[body].first;
    for (; n > 0; --n) p = model.particles[p].next_in_body;
    return p;
  }
  void hinge(std::uint32_t p, std::uint32_t q) {
    RestructureReport report;
    (void)combine_particles(model, p, q, report);
  }
  /// Rods of length 1 along x, each hinged to the next.
  std::vector<std::uint32_t> chain(int links, const Vec3& start = {}) {
    std::vector<std::uint32_t> bodies;
    for (int i = 0; i < links; ++i) {
      bodies.push_back(body({start + Vec3{double(i), 0, 0}, start + Vec3{i + 1.0, 0, 0}}));
      if (i > 0) hinge(particle(bodies[bodies.size() - 2], 1), particle(bodies.back(), 0));
    }
    return bodies;
  }
  /// Takes a particle out of its ring, into one of its own at the same place.
  void leave_ring(std::uint32_t p) {
    Ring own;
    own.position = model.position(p), own.velocity = model.velocity(p);
    model.take_from_ring(p);
    model.add_to_ring(p, model.rings.create(own).slot);
  }
};

}  // namespace iota::model
