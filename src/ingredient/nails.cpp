// SPDX-License-Identifier: Apache-2.0
#include "ingredient/nails.h"

#include <algorithm>
#include "ingredient/model.h"
#include "ingredient/outcome.h"
#include "model/nailed.h"
#include "solver/largest.h"

#include <iota/scene.h>

namespace iota::ingredient {

namespace {

// Loads move it from where it is asked for, by the compliance of its row.
void note_arrival(const model::Ring& ring, Nail& nail) {
  nail.position_before = ring.nailed ? nail.position : ring.position;
}

Vec3 velocity_of(const solver::AffineConstraint& nail, double h) { return (1 / h) * (nail.target - nail.target_start); }

/// visit(nail, node) for the nails of a problem.
template <class SomeProblem, class Visit>
void for_each_nail(std::uint8_t owner, SomeProblem& problem, Visit visit) {
  const std::span affines = problem.template items_of<solver::AffineConstraint>();
  for_each_item_of<solver::AffineConstraint>(
      owner, problem, [&](std::size_t i, solver::ItemKey) { visit(affines[i], affines[i].nodes[0]); });
}

}  // namespace

void Nails::build(const IslandMap& map, Problem& problem) {
  for (std::uint32_t node = 0; node < map.nodes.size(); ++node) {
    if (!map.is_pinned(node)) continue;
    solver::AffineConstraint nail;
    nail.nodes[0] = node, nail.weights[0] = 1, nail.count = 1;
    problem.add(nail, {owner, {}, map.nodes.rings[node]});
  }
}

void Nails::load(const Model& model, const IslandNodes&, double h, Problem& problem) {
  if (!problem.has_used<solver::AffineConstraint>()) return;
  auto& affines = problem.pool_of<solver::AffineConstraint>();
  for_each_item_of<solver::AffineConstraint>(owner, problem, [&](std::size_t i, solver::ItemKey key) {
    const Nail& from = model.nails.at(key.slot);
    auto& nail = affines.items[i];
    nail.target = from.position - problem.origin;
    nail.target_start = model.rings[key.slot].nailed && h > 0 ? from.position_before - problem.origin : nail.target;
    double* const l = affines.multiplier(i);
    l[0] = from.multiplier.x, l[1] = from.multiplier.y, l[2] = from.multiplier.z;
  });
}

void Nails::store(Model& model, const IslandNodes&, double, const Problem& problem) const {
  const auto& affines = problem.pool_of<solver::AffineConstraint>();
  for_each_item_of<solver::AffineConstraint>(owner, problem, [&](std::size_t i, solver::ItemKey key) {
    Nail& nail = model.nails.at(key.slot);
    const double* const l = affines.multiplier(i);
    nail.multiplier = {l[0], l[1], l[2]};
    note_arrival(model.rings[key.slot], nail);
  });
}

void Nails::refresh(Model& model, const IslandNodes& nodes, bool moved) const {
  if (!moved) return;
  nodes.for_each_pinned([&](std::uint32_t ring) { note_arrival(model.rings[ring], model.nails.at(ring)); });
}

// A static body's rings are nailed at the body's assigned place. Nailed at their present place in each step, they would
// creep under load.
void Nails::accept_assigned(Model& model, const IslandNodes& nodes) const {
  nodes.for_each_pinned([&](std::uint32_t slot) {
    const model::Ring& ring = model.rings[slot];
    Nail& nail = model.nails.at(slot);
    if (!ring.nailed && ring.position != nail.position_before) nail.position = nail.position_before = ring.position;
  });
}

namespace {

/// Whether a pinned ring moves.
bool is_moved(const Model& model, std::uint32_t slot, const Nail& nail) {
  const model::Ring& ring = model.rings[slot];
  return (ring.nailed && nail.position != nail.position_before) || ring.velocity != Vec3{};
}

}  // namespace

bool Nails::prescribes_motion(const Model& model, const IslandNodes& nodes) const {
  bool any = false;
  nodes.for_each_pinned([&](std::uint32_t ring) { any = any || is_moved(model, ring, model.nails.at(ring)); });
  return any;
}

void Nails::visit_stirred(const Model& model, double, Visit visit) {
  model.nails.for_each([&](std::uint32_t ring, const Nail& nail) {
    if (model.rings[ring].nailed && nail.position != nail.position_before) visit(ring);
  });
}

double Nails::velocity_jump(const Problem& problem, double h) const {
  double largest = 0;
  for_each_nail(owner, problem, [&](const solver::AffineConstraint& nail, std::uint32_t node) {
    largest = std::max(largest, norm(velocity_of(nail, h) - problem.velocity[node]));
  });
  return largest;
}

void Nails::impose_velocities(Problem& problem, double h) const {
  for_each_nail(owner, problem, [&](const solver::AffineConstraint& nail, std::uint32_t node) {
    problem.velocity[node] = velocity_of(nail, h);
  });
}

void Nails::impose_positions(Problem& problem) const {
  for_each_nail(owner, problem, [&](const solver::AffineConstraint& nail, std::uint32_t node) {
    problem.position[node] = nail.target;
  });
}

std::string Nails::name_of_row(const Model& model, solver::ItemKey key) const {
  return "what pins " + name_of_ring(model, key.slot);
}

void Nails::validate(const Model& model, model::Audit& audit) {
  audit.require_owners("a nail", model.nails, model.rings);
  model.rings.for_each([&](std::uint32_t slot, const model::Ring& r) {
    audit.require(!r.nailed || model.nails.has(slot), "ring ", slot, " is nailed nowhere");
  });
}

double Nails::worst_gap(const Scope& scope) {
  const Model& model = scope.model;
  solver::Largest worst;
  scope.for_each_ring_in(model.nails, [&](std::uint32_t ring, const Nail& nail) {
    if (!model.rings[ring].nailed) return;
    bool moves = false;
    model.for_each_in_ring(
        ring, [&](std::uint32_t p) { moves = moves || is_free(model.bodies[model.particles[p].body].kind); });
    if (!moves) return;
    worst.add(norm(model.rings[ring].position - nail.position_before));
  });
  return worst.value;
}

// A nail is drawn at the first particle of its ring.
void Nails::ring_changed(Model& model, std::uint32_t ring) {
  model.changed_nails.note(ring);
  if (model.rings[ring].count == 0) model.nails.erase(ring);
}

void Nails::ring_merged(Model& model, std::uint32_t into, std::uint32_t from, bool replaces) {
  if (replaces) model.nails.copy(from, into);
}

void Nails::prepare(Model& model, std::uint32_t body) {
  const BodyKind kind = model.bodies[body].kind;
  if (kind == BodyKind::static_ || kind == BodyKind::scripted)
    model.for_each_particle_of(body, [&](std::uint32_t p) { (void)model.nails.make(model.particles[p].ring); });
}

model::ChangedSlots* Nails::scene_log(Model& model) { return &model.changed_nails; }

void Nails::describe(const SceneView& view, SceneChanges& changes) {
  const Model& model = view.model;
  const auto list = [&](std::uint32_t p, std::vector<std::uint32_t>& slots) {
    slots.push_back(model.particles[p].ring);
  };
  for (const std::uint32_t ring : view.slots(model.rings, model.changed_nails, list)) {
    if (model.rings.is_alive(ring) && model.rings[ring].nailed == model::by_nail)
      changes.nails.set.push_back({ring, view.anchor(model.rings[ring].first)});
    else
      changes.nails.gone.push_back(ring);
  }
}

void Nails::tell(Model& model, Outcome& outcome) {
  model.fuses.for_each([&](std::uint32_t particle, double most) {
    const double force = norm(calc_hinge_force(model, particle));
    if (force > most)
      outcome.overloaded.push_back(
          {.particle = model.particles.id(particle), .position = model.position(particle), .force = force});
  });
}

}  // namespace iota::ingredient
