// SPDX-License-Identifier: Apache-2.0
// Forces that are taken once a step and held: scripted bonds, laws that are code, and any law on request.
#include "step/held_forces.h"

#include "ingredient/bonds.h"
#include "laws/force_limit.h"
#include "step/checks.h"
#include "step/implementation.h"

#include <cmath>

namespace iota {

using namespace step;

namespace step {

namespace {

/// Laws whose force is finite wherever their bonds are.
bool is_tame(const model::Law& law) {
  return law.kind == model::LawKind::listed &&
         (law.number == model::spring_law || law.number == model::drag_law ||
          law.number == laws::find_pair_law("dashpot") || law.number == laws::find_pair_law("tether") ||
          law.number == laws::find_pair_law("soft_repulsion"));
}

void put(double* out, std::size_t row, const Vec3& v) {
  out[3 * row] = v.x, out[3 * row + 1] = v.y, out[3 * row + 2] = v.z;
}

}  // namespace

void HeldForces::update(const model::Model& model) {
  if (seen_revision == model.bonds_revision) return;
  seen_revision = model.bonds_revision;
  held.clear(), watched.clear(), breakable.clear();
  std::vector<std::uint32_t> place_held(model.laws.slot_count(), model::none), place_watched = place_held;
  const auto put = [&](std::vector<LawBatch>& batches, std::uint32_t& place, std::uint32_t slot, std::uint32_t law) {
    if (place == model::none) {
      place = static_cast<std::uint32_t>(batches.size());
      batches.emplace_back().law = law;
    }
    batches[place].bonds.push_back(slot);
    batches[place].ids.push_back(model.bonds.id(slot));
  };
  model.bonds.for_each([&](std::uint32_t slot, const model::Bond& bond) {
    if (!bond.acts()) return;
    if (std::isfinite(bond.break_force)) breakable.push_back(slot);
    if (bond.law == model::scripted_law) return;
    if (!bond.implicit)
      put(held, place_held[bond.law], slot, bond.law);
    else if (!is_tame(model.laws[bond.law]))
      put(watched, place_watched[bond.law], slot, bond.law);
  });
  const auto by_law = [](const LawBatch& a, const LawBatch& b) { return a.law < b.law; };
  std::sort(held.begin(), held.end(), by_law);
  std::sort(watched.begin(), watched.end(), by_law);
}

void LawBatch::load(const model::Model& model, double ahead) {
  const std::size_t n = bonds.size();
  for (auto* const column : {&r, &v, &m_p, &m_q, &force, &drag}) column->resize(n);
  direction.resize(n), rate.resize(n);
  const std::uint32_t count = model.laws[law].parameter_count;
  for (std::uint32_t k = 0; k < count; ++k) parameters[k].resize(n);
  for (std::size_t i = 0; i < n; ++i) {
    const model::Bond& bond = model.bonds[bonds[i]];
    const model::Particle &p = model.particles[bond.p], &q = model.particles[bond.q];
    const model::Ring &from = model.rings[p.ring], &to = model.rings[q.ring];
    rate[i] = to.velocity - from.velocity;
    const Vec3 d = to.position - from.position + ahead * rate[i];
    r[i] = norm(d);
    direction[i] = (1 / (r[i] + 1e-300)) * d;
    v[i] = dot(direction[i], rate[i]);
    m_p[i] = p.mass, m_q[i] = q.mass;
    for (std::uint32_t k = 0; k < count; ++k) parameters[k][i] = bond.parameters[k];
  }
}

laws::PairBatch LawBatch::loaded(double time) {
  for (std::size_t k = 0; k < columns.size(); ++k) columns[k] = parameters[k].data();
  return {.count = bonds.size(),
          .r = r.data(),
          .v = v.data(),
          .m_p = m_p.data(),
          .m_q = m_q.data(),
          .t = time,
          .parameters = columns.data()};
}

void LawBatch::load_rows(const model::Model& model, double ahead) {
  const std::size_t n = bonds.size(), count = model.laws[law].parameter_count;
  for (auto* const rows : {&position_p, &position_q, &velocity_p, &velocity_q, &force_rows}) rows->resize(3 * n);
  parameter_rows.resize(n * count);
  for (std::size_t i = 0; i < n; ++i) {
    const model::Bond& bond = model.bonds[bonds[i]];
    const model::Ring &p = model.rings[model.particles[bond.p].ring], &q = model.rings[model.particles[bond.q].ring];
    put(position_p.data(), i, p.position + ahead * p.velocity), put(velocity_p.data(), i, p.velocity);
    put(position_q.data(), i, q.position + ahead * q.velocity), put(velocity_q.data(), i, q.velocity);
    for (std::size_t k = 0; k < count; ++k) parameter_rows[i * count + k] = bond.parameters[k];
  }
}

}  // namespace step

void System::Implementation::switch_off(std::uint32_t slot, const std::string& why, StepReport& report) {
  const model::Bond& bond = model.bonds[slot];
  apply(step::SetActive{model.bonds.id(slot), false});
  report.switched_off.push_back(model.bonds.id(slot));
  const std::string law = bond.law == model::scripted_law ? "" : model.laws[bond.law].name.data();
  report.warnings.push_back(
      text("bond ", slot, law.empty() ? "" : " (" + law + ")", why, "; the bond is switched off"));
}

void System::Implementation::add_force(std::uint32_t slot, const Vec3& on_p) {
  model::Bond& bond = model.bonds[slot];
  bond.held_force = on_p;
  model.pushes.make(model.particles[bond.p].ring).force += on_p;
  model.pushes.make(model.particles[bond.q].ring).force -= on_p;
}

// Held forces act best in the middle of the step. With the mid-point rule, positions half a step ahead make that the
// leapfrog scheme, which neither gains nor loses energy in the long run; forces at the start of the step would pump energy in.
double System::Implementation::held_ahead(double h) const { return model.steps_to_end_point() ? 0 : h / 2; }

void System::Implementation::run_laws(StepReport& report) {
  held_forces.update(model);
  const double ahead = held_ahead(report.dt);
  for (LawBatch& batch : held_forces.held) {
    const model::Law& law = model.laws[batch.law];
    if (law.kind == model::LawKind::batch)
      run_batch_function(batch, ahead, report);
    else
      run_held_law(batch, ahead, report);
  }
  for (LawBatch& batch : held_forces.watched) watch_implicit_law(batch, report);
}

void System::Implementation::evaluate(LawBatch& batch, double time) {
  const model::Law& law = model.laws[batch.law];
  const std::size_t n = batch.bonds.size();
  if (law.kind == model::LawKind::radial) {
    const auto function = law_functions.find(law.function);
    for (std::size_t i = 0; i < n; ++i) {
      std::array<double, max_law_parameters> parameters{};
      for (std::uint32_t k = 0; k < law.parameter_count; ++k) parameters[k] = batch.parameters[k][i];
      batch.force[i] = function->second.radial(batch.r[i], batch.v[i], time, parameters.data());
    }
    return;
  }
  laws::PairBatch numbers = batch.loaded(time);
  numbers.force = batch.force.data(), numbers.drag = batch.drag.data();
  model.compiled(batch.law).evaluate(numbers);
}

namespace {

std::string not_finite(const LawBatch& batch, std::size_t i) {
  return text(": the force is not finite at r = ", batch.r[i], " m, dr/dt = ", batch.v[i], " m/s");
}

}  // namespace

void System::Implementation::run_held_law(LawBatch& batch, double ahead, StepReport& report) {
  if (!has_function(batch, report)) return;
  batch.load(model, ahead);
  evaluate(batch, model.time);
  const bool has_drag = model.laws[batch.law].has_derivative() && model.compiled(batch.law).has_drag();
  for (std::size_t i = 0; i < batch.bonds.size(); ++i) {
    Vec3 on_p = -batch.force[i] * batch.direction[i];
    if (has_drag) on_p += batch.drag[i] * batch.rate[i];
    if (laws::is_force(on_p))
      add_force(batch.bonds[i], on_p);
    else
      switch_off(batch.bonds[i], not_finite(batch, i), report);
  }
}

// A law that has no finite force where its bond is would only get Newton lost.
void System::Implementation::watch_implicit_law(LawBatch& batch, StepReport& report) {
  const laws::PairLaw& law = model.compiled(batch.law);
  batch.load(model, 0);
  evaluate(batch, model.time + report.dt);
  for (std::size_t i = 0; i < batch.bonds.size(); ++i) {
    if (!laws::is_force(batch.force[i], 0, 0) || (law.has_drag() && !std::isfinite(batch.drag[i]))) {
      switch_off(batch.bonds[i], not_finite(batch, i), report);
    } else if (law.depends_on_time()) {
      // The law changes under the bond: work from outside.
      const model::Bond& bond = model.bonds[batch.bonds[i]];
      laws::PairState state = ingredient::Bonds::state(model, bond);
      const double before = law.elastic(state, bond.parameters.data()).energy;
      state.t += report.dt;
      model.external_work += law.elastic(state, bond.parameters.data()).energy - before;
    }
  }
}

bool System::Implementation::has_function(const LawBatch& batch, StepReport& report) {
  const model::Law& law = model.laws[batch.law];
  if (law.has_derivative() || law_functions.contains(law.function)) return true;
  for (const std::uint32_t slot : batch.bonds) switch_off(slot, " has no function in this system", report);
  return false;
}

void System::Implementation::call(LawBatch& batch) const {
  law_functions.at(model.laws[batch.law].function)
      .batch({batch.bonds.size(), model.time, batch.position_p.data(), batch.position_q.data(), batch.velocity_p.data(),
              batch.velocity_q.data(), batch.parameter_rows.data(), batch.ids.data(), batch.force_rows.data()});
}

void System::Implementation::run_batch_function(LawBatch& batch, double ahead, StepReport& report) {
  if (!has_function(batch, report)) return;
  const model::Law& law = model.laws[batch.law];
  batch.load_rows(model, ahead);
  const auto fail = [&](const std::string& why) {
    for (const std::uint32_t slot : batch.bonds) {
      apply(step::SetActive{model.bonds.id(slot), false});
      report.switched_off.push_back(model.bonds.id(slot));
    }
    report.warnings.push_back(text("law ", law.name.data(), " raised", why, "; its ", batch.bonds.size(),
                                   batch.bonds.size() == 1 ? " bond is" : " bonds are", " switched off"));
  };
  try {
    call(batch);
  } catch (const std::exception& error) {
    return fail(std::string(": ") + error.what());
  } catch (...) {
    return fail("");
  }
  for (std::size_t i = 0; i < batch.bonds.size(); ++i) {
    const double* const f = batch.force_rows.data() + 3 * i;
    const Vec3 on_p{f[0], f[1], f[2]};
    if (laws::is_force(on_p))
      add_force(batch.bonds[i], on_p);
    else
      switch_off(batch.bonds[i], text(": its function gave the force ", text_of(on_p)), report);
  }
}

void System::Implementation::run_scripts(StepReport& report) {
  if (scripts.empty()) return;
  const double ahead = held_ahead(report.dt);
  for (std::uint32_t slot = 0; slot < model.bonds.slot_count(); ++slot) {
    if (!model.bonds.is_alive(slot)) continue;
    const model::Bond bond = model.bonds[slot];
    if (bond.law != model::scripted_law || !bond.acts()) continue;
    const auto script = scripts.find(bond.script);
    if (script == scripts.end()) {
      switch_off(slot, " has no function in this system", report);
      continue;
    }
    const auto name = [&] { return script->second.name.empty() ? "" : " (" + script->second.name + ")"; };
    try {
      const model::Ring &p = model.rings[model.particles[bond.p].ring], &q = model.rings[model.particles[bond.q].ring];
      const Vec3 force = script->second.force({model.bonds.id(slot), p.position + ahead * p.velocity,
                                               q.position + ahead * q.velocity, p.velocity, q.velocity, model.time});
      if (laws::is_force(force))
        add_force(slot, force);
      else
        switch_off(slot, name() + " returned a force that is not finite", report);
    } catch (const std::exception& error) {
      switch_off(slot, name() + " raised: " + error.what(), report);
    } catch (...) {
      switch_off(slot, name() + " raised", report);
    }
  }
}

// --- what bonds carry ---------------------------------------------------------------------------------------------------

Vec3 System::Implementation::bond_force(std::uint32_t slot) const {
  const model::Bond& bond = model.bonds[slot];
  if (!bond.acts()) return {};
  return bond.implicit ? -ingredient::Bonds::force(model, slot) : bond.held_force;
}

Vec3 System::force(BondId id) const { return implementation_->bond_force(implementation_->require(id)); }

// --- what forces cost -------------------------------------------------------------------------------------------------

namespace {

/// Force and stiffness of an implicit bond as one iteration of Newton asks for them.
template <class Force>
void rehearse_implicit(Force force, const Vec3& e, double h) {
  const solver::ForceStage stage{h, true, false};
  const Vec3 next = 1.0001 * e;
  volatile double sink = force.force(e, next, stage).x + force.stiffness_matrix(e, next, stage).m[0][0];
  (void)sink;
}

}  // namespace

std::size_t System::Implementation::rehearse(std::uint32_t law, double h) {
  held_forces.update(model);
  std::size_t count = 0;
  if (law == model::scripted_law) {
    model.bonds.for_each([&](std::uint32_t slot, const model::Bond& bond) {
      if (bond.law != law || !bond.acts() || !scripts.contains(bond.script)) return;
      const model::Ring &p = model.rings[model.particles[bond.p].ring], &q = model.rings[model.particles[bond.q].ring];
      (void)scripts.at(bond.script)
          .force({model.bonds.id(slot), p.position, q.position, p.velocity, q.velocity, model.time});
      ++count;
    });
    return count;
  }
  for (LawBatch& batch : held_forces.held) {
    if (batch.law != law) continue;
    count += batch.bonds.size();
    if (model.laws[law].kind == model::LawKind::batch) {
      batch.load_rows(model, 0);
      call(batch);
    } else {
      batch.load(model, 0);
      evaluate(batch, model.time);
    }
  }
  model.bonds.for_each([&](std::uint32_t, const model::Bond& bond) {
    if (bond.law != law || !bond.ties()) return;
    const Vec3 e = model.position(bond.q) - model.position(bond.p);
    const auto& p = bond.parameters;
    if (law == model::spring_law)
      rehearse_implicit(solver::SpringForce{{}, p[0], p[1], p[2]}, e, h);
    else if (law == model::drag_law)
      rehearse_implicit(solver::DragForce{{}, p[0]}, e, h);
    else
      rehearse_implicit(solver::RadialForce{{}, &model.compiled(law), p, model.time}, e, h);
    ++count;
  });
  return count;
}

template <class Run>
std::size_t System::Implementation::rehearse_on(std::uint32_t group, double h, Run run) {
  StepReport report;
  report.dt = h;
  particle_sets.update(model);
  ParticleSet& set = particle_sets.of(model, group);
  set.load(model, 0, parallel);
  run(set, report);
  return set.rings.size();
}

std::size_t System::rehearse(LawId id, double dt) {
  return implementation_->rehearse(implementation_->require(id), dt);
}
std::size_t System::rehearse(FieldId id, double dt) {
  Implementation& i = *implementation_;
  const std::uint32_t slot = i.require(id);
  return i.rehearse_on(i.model.fields[slot].group, dt,
                       [&](ParticleSet& set, StepReport& report) { i.run_field(slot, set, report); });
}
std::size_t System::rehearse(PairsId id, double dt) {
  Implementation& i = *implementation_;
  const std::uint32_t slot = i.require(id);
  return i.rehearse_on(i.model.pairs[slot].group, dt,
                       [&](ParticleSet& set, StepReport& report) { i.run_pairs(slot, set, report); });
}

}  // namespace iota
