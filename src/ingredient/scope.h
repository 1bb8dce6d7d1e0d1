// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "model/structure.h"

#include <cstdint>

namespace iota::ingredient {

/// The scope of energies and momenta: the whole model, or one body. An inactive body has none, even if it is hinged to
/// a moving one. A bond or joint belongs to the body of its first end.
class Scope {
 public:
  explicit Scope(const model::Model& model, std::uint32_t body = model::none);

  const model::Model& model;

  bool is_whole() const { return body_ == model::none; }
  bool is_active(std::uint32_t body) const { return structure_.bodies[body].kind != BodyKind::inactive; }

  /// visit(slot, particle)
  template <class Visit>
  void for_each_particle(Visit visit) const {
    if (is_whole())
      structure_.particles.for_each([&](std::uint32_t slot, const model::Particle& p) {
        if (is_active(p.body)) visit(slot, p);
      });
    else if (is_active(body_))
      structure_.for_each_particle_of(body_, [&](std::uint32_t p) { visit(p, structure_.particles[p]); });
  }
  template <class Visit>
  void for_each_inertia_pair(Visit visit) const {
    if (is_whole())
      structure_.inertia_pairs.for_each([&](std::uint32_t, const model::InertiaPair& pair) {
        if (is_active(pair.body)) visit(pair);
      });
    else if (is_active(body_))
      structure_.for_each_inertia_of(body_, [&](std::uint32_t i) { visit(structure_.inertia_pairs[i]); });
  }
  /// visit(slot, body): inactive ones, too.
  template <class Visit>
  void for_each_body(Visit visit) const {
    if (is_whole())
      structure_.bodies.for_each(visit);
    else
      visit(body_, structure_.bodies[body_]);
  }
  /// visit(particle): of those that have a value in a side table; inactive ones, too.
  template <class T, class Visit>
  void for_each_particle_in(const SideTable<T>& values, Visit visit) const {
    if (is_whole())
      values.for_each([&](std::uint32_t particle, const T&) { visit(particle); });
    else if (!values.is_empty())
      structure_.for_each_particle_of(body_, [&](std::uint32_t p) {
        if (values.has(p)) visit(p);
      });
  }
  /// visit(ring, value): of those that have a value in a side table; inactive ones, too.
  template <class T, class Visit>
  void for_each_ring_in(const SideTable<T>& values, Visit visit) const {
    if (is_whole())
      values.for_each(visit);
    else if (!values.is_empty())
      structure_.for_each_particle_of(body_, [&](std::uint32_t p) {
        const std::uint32_t ring = structure_.particles[p].ring;
        if (values.has(ring)) visit(ring, values.at(ring));
      });
  }
  /// visit(body): of those that have a value in a side table.
  template <class T, class Visit>
  void for_each_body_in(const SideTable<T>& values, Visit visit) const {
    if (is_whole())
      values.for_each([&](std::uint32_t body, const T&) { visit(body); });
    else if (values.has(body_))
      visit(body_);
  }

 private:
  const model::Structure& structure_;
  std::uint32_t body_;
};

struct Energies {
  double kinetic = 0, potential = 0;  ///< J
  double total() const { return kinetic + potential; }
};

struct Momenta {
  Vec3 linear;   ///< kg m/s
  Vec3 angular;  ///< about the origin, kg m^2/s
};

}  // namespace iota::ingredient
