// SPDX-License-Identifier: Apache-2.0
// Fields and pairwise forces, evaluated once a step and held.
#include "base/text.h"
#include "held/chunks.h"
#include "held/held_forces.h"
#include "laws/force_limit.h"

#include <iota/reports.h>

#include <cmath>

namespace iota::held {

void HeldForces::take_fields(StepReport& report) {
  if (model_.fields.size() == 0 && model_.pairs.size() == 0) return;
  sets_.update(model_);
  const double ahead = look_ahead(report.dt);  // of positions; particles turn by the leapfrog scheme in every mode
  // In mode `accurate` the error of holding a force is estimated from all of its changes.
  const bool may_wait = ingredient::Strides::any(model_) && model_.mode != IntegrationMode::accurate;
  for (std::uint32_t slot = 0; slot < model_.fields.slot_count(); ++slot) {
    if (!model_.fields.is_alive(slot) || !model_.fields[slot].active) continue;
    ParticleSet& set = sets_.of(model_, model_.fields[slot].group);
    if (!set.is_loaded) {
      set.load(model_, ahead, 0, parallel_);
      if (may_wait) set.find_waiting(model_, report.dt);
    }
    take_field(slot, set, report);
  }
  for (std::uint32_t slot = 0; slot < model_.pairs.slot_count(); ++slot)
    if (model_.pairs.is_alive(slot) && model_.pairs[slot].active)
      take_pairs(slot, loaded_set(model_.pairs[slot], ahead, report.dt / 2), report);
  for (const auto& set : sets_.sets)
    if (set->is_loaded) set->unload(model_, parallel_);
}

ParticleSet& HeldForces::loaded_set(std::uint32_t group, double ahead) {
  ParticleSet& set = sets_.of(model_, group);
  if (!set.is_loaded) set.load(model_, ahead, 0, parallel_);
  return set;
}

ParticleSet& HeldForces::loaded_set(const ingredient::PairForce& pairs, double ahead, double normals_ahead) {
  ParticleSet& set = sets_.of(model_, pairs.group, pairs.other, model_.compiled(pairs.law).depends_on_normals());
  if (!set.is_loaded) set.load(model_, ahead, normals_ahead, parallel_);
  return set;
}

void HeldForces::take_field(std::uint32_t slot, ParticleSet& set, StepReport& report) {
  const ingredient::Field& field = model_.fields[slot];
  const std::size_t n = set.rings.size();
  set.force_rows.resize(3 * n);
  if (field.kind == ingredient::FieldKind::function) {
    if (!call_field(slot, set, report)) return;
  } else {
    const laws::FieldLaw& law = model_.compiled_field(slot);
    const double time = time_of_places(report.dt);
    for (const std::size_t row : set.waiting) std::fill_n(set.force_rows.begin() + 3 * row, 3, 0.0);
    set.for_each_acting(parallel_, [&](std::size_t first, std::size_t last) {
      law.evaluate(set.arrays, first, last - first, time, field.parameters.data(), set.force_rows.data() + 3 * first);
    });
    if (law.depends_on_velocity()) add_rates(law, field, time, set);
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

// The solver takes the part of a force that is linear in the velocity implicitly.
void HeldForces::add_rates(const laws::FieldLaw& law, const ingredient::Field& field, double time,
                           ParticleSet& set) const {
  const std::size_t n = set.rings.size();
  set.rates.resize(n), set.rate_rows.resize(9 * n);
  set.for_each_acting(parallel_, [&](std::size_t first, std::size_t last) {
    double* const rows = set.rate_rows.data() + 9 * first;
    law.evaluate_rates(set.arrays, first, last - first, time, field.parameters.data(), rows);
    for (std::size_t i = first; i < last; ++i) {
      const double *const f = set.force_rows.data() + 3 * i, *const rate = rows + 9 * (i - first);
      if (!laws::is_force(f[0], f[1], f[2])) continue;
      for (int k = 0; k < 9; ++k) set.rates[i].m[k / 3][k % 3] += rate[k];
    }
  });
}

void HeldForces::add_missed(StepReport& report) {
  for (const auto& set : sets_.sets) {
    if (!set->is_loaded || set->waiting.empty()) continue;
    for (const std::uint32_t row : set->waiting) {
      const std::uint32_t ring = set->rings[row];
      if (ingredient::Strides::waits(model_, set->family[row], ring, report.dt)) continue;
      const double time = time_of_places(report.dt);
      const Vec3 v{set->arrays.vx[row], set->arrays.vy[row], set->arrays.vz[row]};
      model_.fields.for_each([&](std::uint32_t slot, const ingredient::Field& field) {
        if (!field.active || field.kind == ingredient::FieldKind::function || field.group != set->group) return;
        const laws::FieldLaw& law = model_.compiled_field(slot);
        Vec3 force;
        law.evaluate(set->arrays, row, 1, time, field.parameters.data(), &force.x);
        if (!laws::is_force(force.x, force.y, force.z)) return;
        model_.pushes.make(ring).force += force;
        if (!law.depends_on_velocity()) return;
        Mat3 rate;
        law.evaluate_rates(set->arrays, row, 1, time, field.parameters.data(), &rate.m[0][0]);
        ingredient::PushByVelocity& part = model_.pushes_by_velocity.make(ring);
        part.rate += rate;
        part.force += rate * v;
      });
    }
  }
}

bool HeldForces::call_field(std::uint32_t slot, ParticleSet& set, StepReport& report) {
  const ingredient::Field field = model_.fields[slot];
  const auto fail = [&](const std::string& why) {
    model_.fields[slot].active = 0;
    report.warnings.push_back(text("field ", slot, field.name[0] ? " (" : "", field.name.data(),
                                   field.name[0] ? ")" : "", why, "; the field is switched off"));
    return false;
  };
  const auto function = functions.of_fields.find(field.function);
  if (function == functions.of_fields.end()) return fail(" has no function in this system");
  const std::size_t n = set.rings.size();
  set.position_rows.resize(3 * n), set.velocity_rows.resize(3 * n);
  for (std::size_t i = 0; i < n; ++i) {
    double *const x = set.position_rows.data() + 3 * i, *const v = set.velocity_rows.data() + 3 * i;
    x[0] = set.arrays.x[i], x[1] = set.arrays.y[i], x[2] = set.arrays.z[i];
    v[0] = set.arrays.vx[i], v[1] = set.arrays.vy[i], v[2] = set.arrays.vz[i];
  }
  try {
    function->second({n, time_of_places(report.dt), report.dt, set.position_rows.data(), set.velocity_rows.data(),
                      set.arrays.m.data(), set.ids.data(), set.force_rows.data()});
    return true;
  } catch (const std::exception& error) {
    return fail(std::string(" raised: ") + error.what());
  } catch (...) {
    return fail(" raised");
  }
}

void HeldForces::take_pairs(std::uint32_t slot, ParticleSet& set, StepReport& report) {
  const ingredient::PairForce& pairs = model_.pairs[slot];
  const auto bad = sets_.sum(slot).add_forces(set.arrays, {set.family, set.sides}, model_.compiled(pairs.law),
                                              pairs.parameters.data(), {pairs.cutoff, pairs.shifted != 0},
                                              time_of_places(report.dt), parallel_);
  if (bad.count > 0)
    report.warnings.push_back(text("pairwise force ", slot, " gives no finite force between particles ",
                                   set.ids[bad.i].slot, " and ", set.ids[bad.j].slot,
                                   bad.count > 1 ? text(" and ", bad.count - 1, " more pairs") : "",
                                   "; there it gives none"));
}

}  // namespace iota::held
