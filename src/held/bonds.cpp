// SPDX-License-Identifier: Apache-2.0
// Bonds that are evaluated once a step and held: scripted ones, laws in code, any law on request; the cost of laws.
#include "ingredient/bonds.h"
#include "base/text.h"
#include "held/held_forces.h"
#include "laws/force_limit.h"
#include "math/text.h"
#include "solver/forces/force_list.h"

#include <iota/reports.h>

#include <cmath>

namespace iota::held {

void HeldForces::switch_off(std::uint32_t slot, const std::string& why, StepReport& report) {
  const ingredient::Bond& bond = model_.bonds[slot];
  ingredient::Bonds::set_active(model_, slot, false);
  report.switched_off.push_back(model_.bonds.id(slot));
  const std::string law = bond.law == ingredient::scripted_law ? "" : model_.laws[bond.law].name.data();
  report.warnings.push_back(
      text("bond ", slot, law.empty() ? "" : " (" + law + ")", why, "; the bond is switched off"));
}

void HeldForces::add_force(std::uint32_t slot, const Vec3& on_p) {
  ingredient::Bond& bond = model_.bonds[slot];
  bond.held_force = on_p;
  if (bond.is_within_body(model_)) return;
  model_.pushes.make(model_.particles[bond.p].ring).force += on_p;
  model_.pushes.make(model_.particles[bond.q].ring).force -= on_p;
}

void HeldForces::take_laws(StepReport& report) {
  batches_.update(model_);
  for (BondBatch& batch : batches_.held) {
    const ingredient::Law& law = model_.laws[batch.law];
    if (law.kind == ingredient::LawKind::batch)
      take_batch_function(batch, report);
    else
      take_law(batch, report);
  }
  for (BondBatch& batch : batches_.watched) watch_implicit_law(batch, report);
}

void HeldForces::evaluate(BondBatch& batch, double time) const {
  const ingredient::Law& law = model_.laws[batch.law];
  const std::size_t n = batch.bonds.size();
  if (law.kind == ingredient::LawKind::radial) {
    const auto function = functions.of_laws.find(law.function);
    for (std::size_t i = 0; i < n; ++i) {
      std::array<double, max_law_parameters> parameters{};
      for (std::uint32_t k = 0; k < law.parameter_count; ++k) parameters[k] = batch.parameters[k][i];
      batch.force[i] = function->second.radial(batch.r[i], batch.v[i], time, parameters.data());
    }
    return;
  }
  laws::PairBatch numbers = batch.loaded(time);
  numbers.force = batch.force.data(), numbers.drag = batch.drag.data();
  model_.compiled(batch.law).evaluate(numbers);
}

namespace {

std::string not_finite(const BondBatch& batch, std::size_t i) {
  return text(": the force is not finite at r = ", batch.r[i], " m, dr/dt = ", batch.v[i], " m/s");
}

}  // namespace

void HeldForces::take_law(BondBatch& batch, StepReport& report) {
  if (!require_function(batch, report)) return;
  batch.load(model_, look_ahead(report.dt));
  evaluate(batch, time_of_places(report.dt));
  const bool has_drag = model_.laws[batch.law].has_derivative() && model_.compiled(batch.law).has_drag();
  for (std::size_t i = 0; i < batch.bonds.size(); ++i) {
    Vec3 on_p = -batch.force[i] * batch.direction[i];
    if (has_drag) on_p += batch.drag[i] * batch.rate[i];
    if (laws::is_force(on_p))
      add_force(batch.bonds[i], on_p);
    else
      switch_off(batch.bonds[i], not_finite(batch, i), report);
  }
}

// Newton's method would diverge with a law whose force is not finite.
void HeldForces::watch_implicit_law(BondBatch& batch, StepReport& report) {
  const laws::PairLaw& law = model_.compiled(batch.law);
  batch.load(model_, 0);
  evaluate(batch, model_.time + report.dt);
  for (std::size_t i = 0; i < batch.bonds.size(); ++i) {
    if (!laws::is_force(batch.force[i], 0, 0) || (law.has_drag() && !std::isfinite(batch.drag[i]))) {
      switch_off(batch.bonds[i], not_finite(batch, i), report);
    } else if (law.depends_on_time()) {
      // The law of the bond changes: external work.
      const ingredient::Bond& bond = model_.bonds[batch.bonds[i]];
      laws::PairState state = ingredient::Bonds::state(model_, bond);
      const double before = law.elastic(state, bond.parameters.data()).energy;
      state.t += report.dt;
      model_.external_work += law.elastic(state, bond.parameters.data()).energy - before;
    }
  }
}

bool HeldForces::has_function(const ingredient::Law& law) const {
  if (law.has_derivative()) return true;
  const auto found = functions.of_laws.find(law.function);
  if (found == functions.of_laws.end()) return false;
  return law.kind == ingredient::LawKind::radial ? found->second.radial != nullptr : found->second.batch != nullptr;
}

bool HeldForces::require_function(const BondBatch& batch, StepReport& report) {
  if (has_function(model_.laws[batch.law])) return true;
  for (const std::uint32_t slot : batch.bonds) switch_off(slot, " has no function in this system", report);
  return false;
}

void HeldForces::call(BondBatch& batch, double h) const {
  functions.of_laws.at(model_.laws[batch.law].function)
      .batch({batch.bonds.size(), time_of_places(h), batch.position_p.data(), batch.position_q.data(),
              batch.velocity_p.data(), batch.velocity_q.data(), batch.parameter_rows.data(), batch.ids.data(),
              batch.force_rows.data()});
}

void HeldForces::take_batch_function(BondBatch& batch, StepReport& report) {
  if (!require_function(batch, report)) return;
  const ingredient::Law& law = model_.laws[batch.law];
  batch.load_rows(model_, look_ahead(report.dt));
  const auto fail = [&](const std::string& why) {
    for (const std::uint32_t slot : batch.bonds) {
      ingredient::Bonds::set_active(model_, slot, false);
      report.switched_off.push_back(model_.bonds.id(slot));
    }
    report.warnings.push_back(text("law ", law.name.data(), " raised", why, "; its ", batch.bonds.size(),
                                   batch.bonds.size() == 1 ? " bond is" : " bonds are", " switched off"));
  };
  try {
    call(batch, report.dt);
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

void HeldForces::take_scripts(StepReport& report) {
  if (functions.of_bonds.empty()) return;
  const double ahead = look_ahead(report.dt);
  for (std::uint32_t slot = 0; slot < model_.bonds.slot_count(); ++slot) {
    if (!model_.bonds.is_alive(slot)) continue;
    const ingredient::Bond bond = model_.bonds[slot];
    if (bond.law != ingredient::scripted_law || !bond.acts()) continue;
    const auto script = functions.of_bonds.find(bond.script);
    if (script == functions.of_bonds.end()) {
      switch_off(slot, " has no function in this system", report);
      continue;
    }
    const auto name = [&] { return script->second.name.empty() ? "" : " (" + script->second.name + ")"; };
    try {
      const model::Ring &p = model_.rings[model_.particles[bond.p].ring],
                        &q = model_.rings[model_.particles[bond.q].ring];
      const Vec3 force = script->second.force({model_.bonds.id(slot), p.position + ahead * p.velocity,
                                               q.position + ahead * q.velocity, p.velocity + ahead * p.acceleration,
                                               q.velocity + ahead * q.acceleration, model_.time + ahead});
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

// --- forces of bonds ----------------------------------------------------------------------------------------------------

// --- cost of forces -------------------------------------------------------------------------------------------------

namespace {

/// Force and stiffness of an implicit bond, as in one iteration of Newton's method.
template <class Force>
void rehearse_implicit(Force force, const Vec3& e, double h) {
  const solver::ForceStage stage{h, true, false};
  const Vec3 next = 1.0001 * e;
  volatile double sink = force.force(e, next, stage).x + force.stiffness_matrix(e, next, stage).m[0][0];
  (void)sink;
}

}  // namespace

std::size_t HeldForces::rehearse_law(std::uint32_t law, double h) {
  batches_.update(model_);
  std::size_t count = 0;
  if (law == ingredient::scripted_law) {
    model_.bonds.for_each([&](std::uint32_t slot, const ingredient::Bond& bond) {
      if (bond.law != law || !bond.acts() || !functions.of_bonds.contains(bond.script)) return;
      const model::Ring &p = model_.rings[model_.particles[bond.p].ring],
                        &q = model_.rings[model_.particles[bond.q].ring];
      (void)functions.of_bonds.at(bond.script)
          .force({model_.bonds.id(slot), p.position, q.position, p.velocity, q.velocity, model_.time});
      ++count;
    });
    return count;
  }
  for (BondBatch& batch : batches_.held) {
    if (batch.law != law || !has_function(model_.laws[law])) continue;
    count += batch.bonds.size();
    if (model_.laws[law].kind == ingredient::LawKind::batch) {
      batch.load_rows(model_, 0);
      call(batch, h);
    } else {
      batch.load(model_, 0);
      evaluate(batch, model_.time);
    }
  }
  model_.bonds.for_each([&](std::uint32_t, const ingredient::Bond& bond) {
    if (bond.law != law || !bond.ties()) return;
    const Vec3 e = model_.position(bond.q) - model_.position(bond.p);
    const auto& p = bond.parameters;
    if (law == ingredient::spring_law)
      rehearse_implicit(solver::SpringForce{{}, p[0], p[1], p[2]}, e, h);
    else if (law == ingredient::drag_law)
      rehearse_implicit(solver::DragForce{{}, p[0]}, e, h);
    else
      rehearse_implicit(solver::RadialForce{{}, &model_.compiled(law), p, model_.time, model_.time}, e, h);
    ++count;
  });
  return count;
}

std::size_t HeldForces::rehearse_field(std::uint32_t field, double h) {
  StepReport report;
  report.dt = h;
  sets_.update(model_);
  ParticleSet& set = loaded_set(model_.fields[field].group, 0);
  take_field(field, set, report);
  return set.rings.size();
}

std::size_t HeldForces::rehearse_pairs(std::uint32_t pairs, double h) {
  StepReport report;
  report.dt = h;
  sets_.update(model_);
  ParticleSet& set = loaded_set(model_.pairs[pairs], 0, 0);
  take_pairs(pairs, set, report);
  return set.rings.size();
}

}  // namespace iota::held
