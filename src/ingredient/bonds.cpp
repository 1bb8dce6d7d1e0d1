// SPDX-License-Identifier: Apache-2.0
#include "ingredient/bonds.h"

#include "base/sort_unique.h"
#include "ingredient/model.h"
#include "ingredient/outcome.h"
#include "ingredient/row_loads.h"
#include "laws/pair_laws.h"

#include <iota/scene.h>

#include <algorithm>
#include <cmath>
#include <string_view>

namespace iota::ingredient {

namespace {

struct SpringParameters {
  double stiffness, damping, length;
};
SpringParameters spring_of(const Bond& bond) { return {bond.parameters[0], bond.parameters[1], bond.parameters[2]}; }

/// Times at the start and at the end of a step, s, for laws that depend on it.
struct Times {
  double before, at_end;
};
void set_parameters(solver::SpringForce& spring, const Bond& bond, Times) {
  const auto& [stiffness, damping, length] = spring_of(bond);
  spring.stiffness = stiffness, spring.damping = damping, spring.length = length;
}
void set_parameters(solver::DragForce& drag, const Bond& bond, Times) { drag.damping = bond.parameters[0]; }
void set_parameters(solver::RadialForce& radial, const Bond& bond, Times times) {
  radial.parameters = bond.parameters;
  radial.time_before = times.before, radial.time = times.at_end;
}

/// visit(force): with the solver's force for a bond, without its arm and parameters.
template <class Visit>
void visit_force_of(const Model& model, const Bond& bond, Visit visit) {
  if (bond.law == spring_law) return visit(solver::SpringForce{});
  if (bond.law == drag_law) return visit(solver::DragForce{});
  solver::RadialForce force;
  force.law = &model.compiled(bond.law);
  force.m_p = model.particles[bond.p].mass, force.m_q = model.particles[bond.q].mass;
  visit(force);
}

/// The length of a spring is known to 1e-16 m. Above this its stiffness, in a step of 0.01 s, times that, moves the
/// bodies by more than the tolerance of the solver.
bool is_stiff(const Model& model, const Bond& bond) {
  constexpr double step = 0.01, limit = 1e6;
  const auto& [stiffness, damping, length] = spring_of(bond);
  if (bond.law != spring_law || !(length > 0)) return false;
  const double mobility =
      1 / model.body_mass(model.particles[bond.p].body) + 1 / model.body_mass(model.particles[bond.q].body);
  return (stiffness + damping / step) * step * step * mobility > limit;
}

solver::SpanConstraint row_of(const Bond& bond, std::uint32_t p, std::uint32_t q) {
  solver::SpanConstraint row;
  row.add(0, p, -1), row.add(0, q, 1);
  row.first_side = 1;
  row.target_start = row.target = row.reference = spring_of(bond).length;
  return row;
}

solver::RowLaw law_of(const Bond& bond) {
  return {.compliance = 1 / spring_of(bond).stiffness, .damping = spring_of(bond).damping};
}

/// The tension of the bond's row in the last step, N. `d` leads from p to q at its end.
double tension(const Bond& bond, const Vec3& d) { return dot(bond.held_force, solver::SpringForce::direction(d)); }

}  // namespace

void Bonds::build(const IslandMap& map, Problem& problem) {
  const Model& model = map.model;
  if (model.bonds.size() == 0) return;
  std::vector<std::uint32_t> bonds;
  for (const std::uint32_t body : map.bodies)
    model.for_each_particle_of(body, [&](std::uint32_t p) {
      model.bonds.for_each_of(p, [&](std::uint32_t b) {
        if (model.bonds[b].ties()) bonds.push_back(b);
      });
    });
  sort_unique(bonds);
  for (const std::uint32_t slot : bonds) {
    const Bond& b = model.bonds[slot];
    solver::ForceArm arm;
    arm.nodes = {map.node_of(b.p), map.node_of(b.q)};
    arm.weights = {-1, 1};
    arm.count = 2;
    if (arm.nodes[0] == none || arm.nodes[1] == none || arm.nodes[0] == arm.nodes[1]) continue;
    if (b.implicit == Bond::as_row) {
      if (map.is_pinned(arm.nodes[0]) && map.is_pinned(arm.nodes[1])) continue;
      problem.add(row_of(b, arm.nodes[0], arm.nodes[1]), {owner, {}, slot});
      (void)problem.pool_of<solver::SpanConstraint>().law(0);
      continue;
    }
    visit_force_of(model, b, [&](auto force) {
      force.arm = arm;
      problem.add(force, {owner, {}, slot});
    });
  }
}

void Bonds::load(const Model& model, const IslandNodes&, double h, Problem& problem) {
  const auto load_all = [&]<class Force>() {
    const std::span forces = problem.items_of<Force>();
    for_each_item_of<Force>(owner, problem, [&](std::size_t i, solver::ItemKey key) {
      set_parameters(forces[i], model.bonds[key.slot], {model.time, model.time + h});
    });
  };
  load_all.operator()<solver::SpringForce>();
  load_all.operator()<solver::DragForce>();
  load_all.operator()<solver::RadialForce>();
  if (!problem.has_used<solver::SpanConstraint>()) return;
  auto& rows = problem.pool_of<solver::SpanConstraint>();
  for_each_item_of<solver::SpanConstraint>(owner, problem, [&](std::size_t i, solver::ItemKey key) {
    const Bond& bond = model.bonds[key.slot];
    solver::SpanConstraint& row = rows.items[i];
    row.target_start = row.target = row.reference = spring_of(bond).length;
    *rows.law(i) = law_of(bond);
    rows.multipliers[i] = tension(bond, row.arm(0, problem.position.data(), 0));
  });
}

void Bonds::store(Model& model, const IslandNodes&, double, const Problem& problem) const {
  if (model.bonds.size() == 0) return;
  const auto& rows = problem.pool_of<solver::SpanConstraint>();
  for_each_item_of<solver::SpanConstraint>(owner, problem, [&](std::size_t i, solver::ItemKey key) {
    const Vec3 d = rows.items[i].arm(0, problem.position.data(), 1);
    model.bonds[key.slot].held_force = rows.multipliers[i] * solver::SpringForce::direction(d);
  });
}

void Bonds::check_links(const Model& model, model::Audit& audit) {
  audit.check_ends("bond", model.bonds);
  model.bonds.for_each([&](std::uint32_t slot, const Bond& b) {
    audit.require(model.laws.is_alive(b.law), "bond ", slot, " has no living law");
    audit.require(!model.laws.is_alive(b.law) || !model.laws[b.law].has_derivative() ||
                      !model.compiled(b.law).depends_on_normals(),
                  "bond ", slot, " has a law of normals");
  });
}

void Bonds::validate(const Model& model, model::Audit& audit) {
  model.bonds.for_each([&](std::uint32_t slot, const Bond& b) {
    audit.require_ends("bond", slot, b);
    audit.use_particle(b.p), audit.use_particle(b.q);
    audit.use("law", b.law);
    audit.require(!b.implicit || model.laws[b.law].has_derivative(), "bond ", slot,
                  " is implicit without a derivative");
    audit.require(b.implicit != Bond::as_row || b.law == spring_law, "bond ", slot, " is a row, but not of a spring");
    for (const double v : b.parameters)
      audit.require(std::isfinite(v), "bond ", slot, " has a parameter that is not finite");
  });
  audit.require_listed("bond", model.bonds);
}

laws::PairState Bonds::state(const Model& model, const Bond& b, double ahead) {
  const model::Ring &p = model.rings[model.particles[b.p].ring], &q = model.rings[model.particles[b.q].ring];
  const Vec3 u = q.velocity - p.velocity, d = q.position - p.position + ahead * u;
  const double r = norm(d);
  return {r, dot(d, u) / (r + 1e-300), model.time, model.particles[b.p].mass, model.particles[b.q].mass};
}

double Bonds::energy(const Model& model, std::uint32_t slot) {
  const Bond& b = model.bonds[slot];
  if (!b.ties()) return 0;
  // An infinite energy, for instance of coincident ends, is not counted; the next step switches the bond off.
  const double energy = model.compiled(b.law).elastic(state(model, b), b.parameters.data()).energy;
  return std::isfinite(energy) ? energy : 0;
}

Vec3 Bonds::force(const Model& model, std::uint32_t slot) {
  const Bond& b = model.bonds[slot];
  const laws::PairLaw& law = model.compiled(b.law);
  const laws::PairState ends = state(model, b);
  const Vec3 d = model.position(b.q) - model.position(b.p), u = model.velocity(b.q) - model.velocity(b.p);
  const double* const parameters = b.parameters.data();
  double along = -law.elastic(ends, parameters).slope;
  if (law.has_push()) along += law.push(ends, parameters).value;
  if (law.has_damping()) along += law.damping(ends, parameters).value;
  const double drag = law.has_drag() ? law.drag(ends, parameters) : 0;
  return (along / (ends.r + 1e-300)) * d - drag * u;
}

void Bonds::add_energy(const Scope& scope, Energies& sum) {
  const Model& model = scope.model;
  if (scope.is_whole())
    model.bonds.for_each([&](std::uint32_t slot, const Bond&) { sum.potential += energy(model, slot); });
  else if (model.bonds.size() > 0)
    scope.for_each_particle([&](std::uint32_t p, const model::Particle&) {
      model.bonds.for_each_of(p, [&](std::uint32_t b) {
        if (model.bonds[b].p == p) sum.potential += energy(model, b);
      });
    });
}

void Bonds::add_loads(const LastStep& step, std::uint32_t body, LoadReader& reader) {
  const Model& model = step.model;
  if (!(step.h() > 0)) return;
  model.for_each_particle_of(body, [&](std::uint32_t p) {
    model.bonds.for_each_of(p, [&](std::uint32_t slot) {
      const Bond& bond = model.bonds[slot];
      if (!bond.ties()) return;  // held forces are applied as pushes
      if (bond.implicit == Bond::as_row) {
        const double multiplier = tension(bond, step.end(bond.q) - step.end(bond.p));
        for_each_row_force(step, row_of(bond, 0, 1), &multiplier, std::array{bond.p, bond.q},
                           [&](std::uint32_t particle, const Vec3& force) {
                             if (particle == p)
                               reader.take({.particle = p, .force = force, .part = model.particles[p].part});
                           });
        return;
      }
      Vec3 on_q;
      visit_force_of(model, bond, [&](auto force) {
        set_parameters(force, bond, {step.stage.instant ? model.time : model.time - step.h(), model.time});
        on_q = force.force(step.start(bond.q) - step.start(bond.p), step.end(bond.q) - step.end(bond.p), step.stage);
      });
      reader.take({.particle = p, .force = bond.p == p ? -on_q : on_q, .part = model.particles[p].part});
    });
  });
}

bool Bonds::holds(const Model& model, std::uint32_t particle) {
  bool any = false;
  model.bonds.for_each_of(particle, [&](std::uint32_t b) { any = any || model.bonds[b].ties(); });
  return any;
}

bool Bonds::uses(const Model& model, std::uint32_t particle) { return model.bonds.ends_at(particle); }

std::uint32_t Bonds::add(Model& model, const Bond& bond) {
  const std::uint32_t slot = model.bonds.create(bond);
  ++model.laws[bond.law].uses, ++model.bonds_revision;
  for (const std::uint32_t particle : {bond.p, bond.q}) {
    ++model.particles[particle].uses;
    model.mark_locally(model.particles[particle].body);
  }
  model.bonds[slot].muted = !model.acts(bond.p) || !model.acts(bond.q);
  parameter_changed(model, slot);
  return slot;
}

// Implicit ones whose law depends on the time, when it changes their force; forces that are held are pushes.
void Bonds::visit_stirred(const Model& model, double h, Visit visit) {
  if (model.bonds.size() == 0) return;
  const auto depends_on_time = [&](std::uint32_t law) {
    return model.laws[law].has_derivative() && model.compiled(law).depends_on_time();
  };
  bool any = false;
  model.laws.for_each([&](std::uint32_t law, const Law&) { any = any || depends_on_time(law); });
  if (!any) return;
  model.bonds.for_each([&](std::uint32_t, const Bond& bond) {
    if (!bond.ties() || !depends_on_time(bond.law)) return;
    const laws::PairLaw& law = model.compiled(bond.law);
    laws::PairState at = state(model, bond);
    const auto force = [&] {
      return law.push(at, bond.parameters.data()).value - law.elastic(at, bond.parameters.data()).slope;
    };
    const double before = force();
    at.t += h;
    if (force() == before) return;
    for (const std::uint32_t end : {bond.p, bond.q}) visit(model.particles[end].ring);
  });
}

void Bonds::parameter_changed(Model& model, std::uint32_t slot) {
  Bond& bond = model.bonds[slot];
  if (!bond.implicit) return;
  for (const std::uint32_t end : {bond.p, bond.q}) model.wake(model.bodies[model.particles[end].body].articulate);
  const std::uint8_t form = is_stiff(model, bond) ? Bond::as_row : Bond::as_force;
  if (form == bond.implicit) return;
  bond.implicit = form;
  for (const std::uint32_t end : {bond.p, bond.q}) model.mark_locally(model.particles[end].body);
}

void Bonds::remove(Model& model, std::uint32_t slot) {
  const Bond& bond = model.bonds[slot];
  --model.laws[bond.law].uses, ++model.bonds_revision;
  for (const std::uint32_t particle : {bond.p, bond.q}) {
    --model.particles[particle].uses;
    model.mark_locally(model.particles[particle].body);
  }
  model.bonds.destroy(slot);
  model.changed_bonds.note(slot);
}

void Bonds::set_active(Model& model, std::uint32_t slot, bool active) {
  Bond& bond = model.bonds[slot];
  if (bond.active == static_cast<std::uint8_t>(active)) return;
  bond.active = active;
  bond.broken = 0;
  ++model.bonds_revision, ++model.structure_version;
  for (const std::uint32_t end : {bond.p, bond.q}) model.mark_locally(model.particles[end].body);
}

bool Bonds::ties_any(const Model& model) { return model.bonds.size() > 0; }

void Bonds::visit_tied(const Model& model, std::uint32_t particle, Visit visit) {
  model.bonds.for_each_of(particle, [&](std::uint32_t slot) {
    const Bond& bond = model.bonds[slot];
    if (bond.ties()) visit(model.particles[bond.p == particle ? bond.q : bond.p].body);
  });
}

void Bonds::absorb(Model& model, std::uint32_t q, std::uint32_t p) {
  ++model.bonds_revision;
  const auto moved = [&](std::uint32_t) {
    --model.particles[q].uses, ++model.particles[p].uses;
    model.mark_particle(p);
  };
  model.bonds.redirect(q, p, moved, [&](std::uint32_t slot) { remove(model, slot); });
}

void Bonds::drop(Model& model, std::uint32_t particle) {
  model.bonds.for_each_of(particle, [&](std::uint32_t slot) { remove(model, slot); });
}

void Bonds::acting_changed(Model& model, std::uint32_t particle) {
  model.bonds.for_each_of(particle, [&](std::uint32_t slot) {
    Bond& bond = model.bonds[slot];
    bond.muted = !model.acts(bond.p) || !model.acts(bond.q);
    ++model.bonds_revision;
  });
}

Vec3 Bonds::force_on_first(const Model& model, std::uint32_t slot) {
  const Bond& bond = model.bonds[slot];
  if (!bond.acts()) return {};
  return bond.implicit == Bond::as_force ? -force(model, slot) : bond.held_force;
}

void Bonds::tell(Model& model, Outcome& outcome) {
  if (model.breakable_revision != model.bonds_revision) {
    model.breakable_revision = model.bonds_revision;
    model.breakable_bonds.clear();
    model.bonds.for_each([&](std::uint32_t slot, const Bond& bond) {
      if (bond.acts() && std::isfinite(bond.break_force)) model.breakable_bonds.push_back(slot);
    });
  }
  for (const std::uint32_t slot : model.breakable_bonds) {
    const Bond& bond = model.bonds[slot];
    const double force = norm(force_on_first(model, slot));
    if (!(force > bond.break_force)) continue;
    const Vec3 middle = 0.5 * (model.position(bond.p) + model.position(bond.q));
    outcome.overloaded.push_back({.bond = model.bonds.id(slot), .position = middle, .force = force});
  }
}

model::ChangedSlots* Bonds::scene_log(Model& model) { return &model.changed_bonds; }

// Springs are drawn. Their tie numbers are distinct from those of joints that are drawn as ties.
void Bonds::describe(const SceneView& view, SceneChanges& changes) {
  const Model& model = view.model;
  const auto list = [&](std::uint32_t p, std::vector<std::uint32_t>& slots) {
    model.bonds.for_each_of(p, [&](std::uint32_t bond) { slots.push_back(bond); });
  };
  constexpr std::size_t length = 2;  // of the spring's parameters
  static_assert(laws::Spring::parameters[length].name == std::string_view("length"));
  for (const std::uint32_t slot : view.slots(model.bonds, model.changed_bonds, list)) {
    const std::uint32_t tie = DrawnTie::slot_of_bond(slot);
    const bool is_drawn = model.bonds.is_alive(slot) && model.bonds[slot].active && model.bonds[slot].law == spring_law;
    if (!is_drawn) {
      changes.ties.gone.push_back(tie);
      continue;
    }
    const Bond& bond = model.bonds[slot];
    changes.ties.set.push_back(
        {tie, DrawnTie::Kind::spring, bond.parameters[length], view.anchor(bond.p), view.anchor(bond.q)});
  }
}

}  // namespace iota::ingredient
