// SPDX-License-Identifier: Apache-2.0
// Fields and pairwise forces, taken once a step and held.
#include "step/particle_sets.h"

#include "laws/force_limit.h"
#include "step/checks.h"
#include "step/implementation.h"

#include <cmath>

namespace iota {

using namespace step;

namespace step {

namespace {

constexpr std::size_t chunk = 2048;  // rows that a thread takes in one go

template <class Work>
void in_chunks(std::size_t count, const Parallel& parallel, Work work) {
  parallel.for_each((count + chunk - 1) / chunk, 1,
                    [&](std::size_t c) { work(c * chunk, std::min(count, (c + 1) * chunk)); });
}

}  // namespace

void ParticleSet::find(const model::Model& model) {
  rings.clear(), family.clear(), ids.clear(), is_pushed.clear();
  std::vector<std::uint8_t> seen(model.rings.slot_count(), 0);
  model.particles.for_each([&](std::uint32_t slot, const model::Particle& p) {
    if (group != model::none && !(p.groups >> group & 1)) return;
    if (!model.acts(slot) || p.is_marker() || seen[p.ring]) return;
    seen[p.ring] = 1;
    rings.push_back(p.ring), family.push_back(p.body), ids.push_back(model.particles.id(slot));
    is_pushed.push_back(model::is_free(model.bodies[p.body].kind));
  });
  arrays.resize(rings.size());
}

void ParticleSet::load(const model::Model& model, double ahead, const Parallel& parallel) {
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
  is_loaded = true;
}

void ParticleSet::unload(model::Model& model, const Parallel& parallel) const {
  for (std::size_t i = 0; i < rings.size(); ++i)  // here, since making room is not for many threads
    if (is_pushed[i]) (void)model.pushes.make(rings[i]);
  in_chunks(rings.size(), parallel, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i)
      if (is_pushed[i]) model.pushes.at(rings[i]).force += Vec3{arrays.fx[i], arrays.fy[i], arrays.fz[i]};
  });
}

void ParticleSets::update(const model::Model& model) {
  if (seen_structure == model.structure_version && seen_members == model.members_revision) {
    for (auto& set : sets) set->is_loaded = false;
    return;
  }
  forget();
  seen_structure = model.structure_version, seen_members = model.members_revision;
}

ParticleSet& ParticleSets::of(const model::Model& model, std::uint32_t group) {
  for (auto& set : sets)
    if (set->group == group) return *set;
  sets.push_back(std::make_unique<ParticleSet>());
  sets.back()->group = group;
  sets.back()->find(model);
  return *sets.back();
}

neighbors::PairSum& ParticleSets::sum(std::uint32_t pairs) {
  if (sums.size() <= pairs) sums.resize(pairs + 1);
  if (!sums[pairs]) sums[pairs] = std::make_unique<neighbors::PairSum>();
  return *sums[pairs];
}

}  // namespace step

void System::Implementation::run_fields(StepReport& report) {
  if (model.fields.size() == 0 && model.pairs.size() == 0) return;
  particle_sets.update(model);
  const double ahead = held_ahead(report.dt);
  const auto loaded = [&](std::uint32_t group) -> ParticleSet& {
    ParticleSet& set = particle_sets.of(model, group);
    if (!set.is_loaded) set.load(model, ahead, parallel);
    return set;
  };
  for (std::uint32_t slot = 0; slot < model.fields.slot_count(); ++slot)
    if (model.fields.is_alive(slot) && model.fields[slot].active)
      run_field(slot, loaded(model.fields[slot].group), report);
  for (std::uint32_t slot = 0; slot < model.pairs.slot_count(); ++slot)
    if (model.pairs.is_alive(slot) && model.pairs[slot].active)
      run_pairs(slot, loaded(model.pairs[slot].group), report);
  for (const auto& set : particle_sets.sets)
    if (set->is_loaded) set->unload(model, parallel);
}

void System::Implementation::run_field(std::uint32_t slot, ParticleSet& set, StepReport& report) {
  const model::Field& field = model.fields[slot];
  const std::size_t n = set.rings.size();
  set.force_rows.resize(3 * n);
  if (field.kind == model::FieldKind::function) {
    if (!run_field_function(slot, set, report)) return;
  } else {
    const laws::FieldLaw& law = model.compiled_field(slot);
    in_chunks(n, parallel, [&](std::size_t first, std::size_t last) {
      law.evaluate(set.arrays, first, last - first, model.time, report.dt, field.parameters.data(),
                   set.force_rows.data() + 3 * first);
    });
  }
  std::size_t bad = 0, first_bad = 0;
  const double* f = set.force_rows.data();
  for (std::size_t i = 0; i < n; ++i, f += 3) {
    if (!laws::is_force(f[0], f[1], f[2])) [[unlikely]] {
      if (bad++ == 0) first_bad = i;
      continue;
    }
    set.arrays.fx[i] += f[0], set.arrays.fy[i] += f[1], set.arrays.fz[i] += f[2];
  }
  if (bad > 0)
    report.warnings.push_back(text("field ", slot, field.name[0] ? " (" : "", field.name.data(),
                                   field.name[0] ? ")" : "", " gives no finite force on particle ",
                                   set.ids[first_bad].slot, bad > 1 ? text(" and ", bad - 1, " more") : "",
                                   "; there it gives none"));
}

bool System::Implementation::run_field_function(std::uint32_t slot, ParticleSet& set, StepReport& report) {
  const model::Field field = model.fields[slot];
  const auto fail = [&](const std::string& why) {
    (void)apply(step::SetFieldActive{model.fields.id(slot), false});
    report.warnings.push_back(text("field ", slot, field.name[0] ? " (" : "", field.name.data(),
                                   field.name[0] ? ")" : "", why, "; the field is switched off"));
    return false;
  };
  const auto function = field_functions.find(field.function);
  if (function == field_functions.end()) return fail(" has no function in this system");
  const std::size_t n = set.rings.size();
  set.position_rows.resize(3 * n), set.velocity_rows.resize(3 * n);
  for (std::size_t i = 0; i < n; ++i) {
    double *const x = set.position_rows.data() + 3 * i, *const v = set.velocity_rows.data() + 3 * i;
    x[0] = set.arrays.x[i], x[1] = set.arrays.y[i], x[2] = set.arrays.z[i];
    v[0] = set.arrays.vx[i], v[1] = set.arrays.vy[i], v[2] = set.arrays.vz[i];
  }
  try {
    function->second({n, model.time, report.dt, set.position_rows.data(), set.velocity_rows.data(), set.arrays.m.data(),
                      set.ids.data(), set.force_rows.data()});
    return true;
  } catch (const std::exception& error) {
    return fail(std::string(" raised: ") + error.what());
  } catch (...) {
    return fail(" raised");
  }
}

void System::Implementation::run_pairs(std::uint32_t slot, ParticleSet& set, StepReport& report) {
  const model::Pairs& pairs = model.pairs[slot];
  const auto bad = particle_sets.sum(slot).add_forces(set.arrays, set.family, model.compiled(pairs.law),
                                                      pairs.parameters.data(), pairs.cutoff, model.time, parallel);
  if (bad.count > 0)
    report.warnings.push_back(text("pairwise force ", slot, " gives no finite force between particles ",
                                   set.ids[bad.i].slot, " and ", set.ids[bad.j].slot,
                                   bad.count > 1 ? text(" and ", bad.count - 1, " more pairs") : "",
                                   "; there it gives none"));
}

}  // namespace iota
