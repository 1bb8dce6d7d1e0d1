// SPDX-License-Identifier: Apache-2.0
#include "held/particle_sets.h"

#include "math/mat3.h"

namespace iota::held {

namespace {

/// After its spin has turned it for some seconds.
Vec3 normal_of(const model::Attributes& ball, double ahead) {
  return rotate(turn_by(ahead * ball.spin), rotate(ball.orientation, {0, 0, 1}));
}

}  // namespace

void ParticleSet::find(const model::Model& model) {
  rings.clear(), family.clear(), attributes.clear(), ids.clear(), is_pushed.clear(), sides.clear();
  std::vector<std::uint8_t> seen(model.rings.slot_count(), 0);
  model.particles.for_each([&](std::uint32_t slot, const model::Particle& p) {
    const auto is_in = [&](std::uint32_t g) { return g != model::none && (p.groups >> g & 1); };
    if (group != model::none && !is_in(group) && !is_in(other)) return;
    if (!model.acts(slot) || p.is_marker() || seen[p.ring]) return;
    if (has_normals && (p.attributes == model::none || !model.attributes[p.attributes].oriented)) return;
    seen[p.ring] = 1;
    if (has_normals) attributes.push_back(p.attributes);
    if (other != model::none) sides.push_back(static_cast<std::uint8_t>(is_in(group) | is_in(other) << 1));
    rings.push_back(p.ring), family.push_back(p.body), ids.push_back(model.particles.id(slot));
    is_pushed.push_back(model::is_free(model.bodies[p.body].kind));
  });
  has_normals ? arrays.resize_with_normals(rings.size()) : arrays.resize(rings.size());
}

void ParticleSet::load(const model::Model& model, double ahead, double normals_ahead, const Parallel& parallel) {
  in_chunks(rings.size(), parallel, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) {
      const model::Ring& ring = model.rings[rings[i]];
      const Vec3 x = ring.position + ahead * ring.velocity;
      arrays.x[i] = x.x, arrays.y[i] = x.y, arrays.z[i] = x.z;
      arrays.vx[i] = ring.velocity.x, arrays.vy[i] = ring.velocity.y, arrays.vz[i] = ring.velocity.z;
      double mass = 0;
      for (std::uint32_t p = ring.first; p != model::none; p = model.particles[p].next_in_ring)
        mass += model.particles[p].mass;
      arrays.m[i] = mass;
      arrays.fx[i] = arrays.fy[i] = arrays.fz[i] = 0;
    }
  });
  if (has_normals) {
    load_normals(model, normals_ahead);
    for (auto* const t : {&arrays.tx, &arrays.ty, &arrays.tz}) std::ranges::fill(*t, 0.0);
  }
  rates.clear(), waiting.clear();
  is_loaded = true;
}

void ParticleSet::find_waiting(const model::Model& model, double h) {
  for (std::size_t i = 0; i < rings.size(); ++i)
    if (is_pushed[i] && ingredient::Strides::waits(model, family[i], rings[i], h))
      waiting.push_back(static_cast<std::uint32_t>(i));
}

void ParticleSet::unload(model::Model& model, const Parallel& parallel) const {
  for (std::size_t i = 0; i < rings.size(); ++i)  // here, since allocating is not thread-safe
    if (is_pushed[i]) {
      (void)model.pushes.make(rings[i]);
      if (!rates.empty()) (void)model.pushes_by_velocity.make(rings[i]);
    }
  in_chunks(rings.size(), parallel, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i)
      if (is_pushed[i]) {
        model.pushes.at(rings[i]).force += Vec3{arrays.fx[i], arrays.fy[i], arrays.fz[i]};
        if (rates.empty()) continue;
        ingredient::PushByVelocity& part = model.pushes_by_velocity.at(rings[i]);
        part.rate += rates[i];
        part.force += rates[i] * Vec3{arrays.vx[i], arrays.vy[i], arrays.vz[i]};
      }
  });
  for (std::size_t i = 0; i < attributes.size(); ++i)
    if (is_pushed[i]) model.attributes[attributes[i]].torque += Vec3{arrays.tx[i], arrays.ty[i], arrays.tz[i]};
}

void ParticleSets::update(const model::Model& model) {
  if (seen_structure == model.structure_version && seen_members == model.members_revision) {
    for (auto& set : sets) set->is_loaded = false;
    return;
  }
  forget();
  seen_structure = model.structure_version, seen_members = model.members_revision;
}

ParticleSet& ParticleSets::of(const model::Model& model, std::uint32_t group, std::uint32_t other, bool has_normals) {
  for (auto& set : sets)
    if (set->group == group && set->other == other && set->has_normals == has_normals) return *set;
  sets.push_back(std::make_unique<ParticleSet>());
  sets.back()->group = group, sets.back()->other = other, sets.back()->has_normals = has_normals;
  sets.back()->find(model);
  return *sets.back();
}

neighbors::PairSum& ParticleSets::sum(std::uint32_t pairs) {
  if (sums.size() <= pairs) sums.resize(pairs + 1);
  if (!sums[pairs]) sums[pairs] = std::make_unique<neighbors::PairSum>();
  return *sums[pairs];
}

void ParticleSet::follow(const model::Model& model) {
  for (std::size_t i = 0; i < rings.size(); ++i) {
    const Vec3& x = model.rings[rings[i]].position;
    arrays.x[i] = x.x, arrays.y[i] = x.y, arrays.z[i] = x.z;
  }
  if (has_normals) load_normals(model, 0);
}

void ParticleSet::load_normals(const model::Model& model, double ahead) {
  for (std::size_t i = 0; i < attributes.size(); ++i) {
    const Vec3 n = normal_of(model.attributes[attributes[i]], ahead);
    arrays.nx[i] = n.x, arrays.ny[i] = n.y, arrays.nz[i] = n.z;
  }
}

}  // namespace iota::held
