// SPDX-License-Identifier: Apache-2.0
#include "ingredient/affine_rows.h"

#include "base/text.h"
#include "ingredient/model.h"
#include "ingredient/row_loads.h"
#include "solver/largest.h"

#include <algorithm>
#include <cmath>

namespace iota::ingredient {

namespace {

/// Reference length of a particle's gap, m.
double reference_length(const Model& model, std::uint32_t body) {
  const double extent = model.extent(body);
  return extent > 0 ? extent : 1;
}

/// The row that keeps a particle at its place in the basis of its body; its nodes are the particles.
solver::AffineConstraint constraint_of(const Model& model, std::uint32_t particle) {
  solver::AffineConstraint row;
  const auto add = [&](std::uint32_t p, double weight) {
    row.nodes[row.count] = p;
    row.weights[row.count++] = weight;
  };
  add(particle, 1);
  const model::Body& body = model.bodies[model.particles[particle].body];
  const auto& weights = model.affine[particle].weights;
  for (int i = 0; i < body.rank; ++i)
    if (weights[i] != 0) add(body.basis[i], -weights[i]);
  return row;
}

}  // namespace

void AffineRows::build(const IslandMap& map, Problem& problem) {
  const Model& model = map.model;
  for (const std::uint32_t slot : map.bodies) {
    const model::Body& body = model.bodies[slot];
    if (body.count == body.rank) continue;
    const double reference = reference_length(model, slot);
    model.for_each_particle_of(slot, [&](std::uint32_t p) {
      const model::Particle& particle = model.particles[p];
      if (particle.basis_index >= 0 || !model.is_unknown(particle)) return;
      solver::AffineConstraint row = constraint_of(model, p);
      row.reference = reference;
      bool movable = false;
      for (std::uint32_t i = 0; i < row.count; ++i) {
        row.nodes[i] = map.node_of(row.nodes[i]);
        movable = movable || !map.is_pinned(row.nodes[i]);
      }
      if (!movable) {
        if (is_free(body.kind)) pinned_.push_back(p);
        return;
      }
      problem.add(row, {owner, {}, p});
    });
  }
}

void AffineRows::leave(const IslandMap& map) {
  std::erase_if(pinned_, [&](std::uint32_t p) { return map.has(map.model.particles[p].body); });
}

void AffineRows::load(const Model& model, const IslandNodes&, double, Problem& problem) {
  if (!problem.has_used<solver::AffineConstraint>()) return;
  auto& affines = problem.pool_of<solver::AffineConstraint>();
  for_each_item_of<solver::AffineConstraint>(owner, problem, [&](std::size_t i, solver::ItemKey key) {
    std::copy_n(model.affine.at(key.slot).multiplier.begin(), 3, affines.multiplier(i));
  });
}

void AffineRows::store(Model& model, const IslandNodes&, double, const Problem& problem) const {
  const auto& affines = problem.pool_of<solver::AffineConstraint>();
  for_each_item_of<solver::AffineConstraint>(owner, problem, [&](std::size_t i, solver::ItemKey key) {
    std::copy_n(affines.multiplier(i), 3, model.affine.at(key.slot).multiplier.begin());
  });
}

bool AffineRows::are_pinned_met(const Model& model) const {
  constexpr double met = 1e-6;  // of the body's extent
  return std::all_of(pinned_.begin(), pinned_.end(), [&](std::uint32_t p) {
    const double gap = norm(model.carried(p).first - model.position(p));
    return gap <= met * reference_length(model, model.particles[p].body);
  });
}

std::string AffineRows::name_of_row(const Model& model, solver::ItemKey key) const {
  return text("the place of particle ", key.slot, " in body ", model.particles[key.slot].body);
}

void AffineRows::validate(const Model& model, model::Audit& audit) {
  audit.require_owners("the weights", model.affine, model.particles);
  model.particles.for_each([&](std::uint32_t slot, const model::Particle& p) {
    audit.require((p.basis_index < 0) == model.affine.has(slot), "particle ", slot,
                  " is in a basis and has weights in it, or neither");
    double sum = 0, size = 0;  // weights of a place far outside of the basis cancel
    for (const double w : model.weights(slot)) sum += w, size += std::abs(w);
    audit.require(std::abs(sum - 1) < 1e-9 * size, "particle ", slot, " has basis weights that sum to ", sum);
  });
}

double AffineRows::worst_gap(const Scope& scope) {
  const Model& model = scope.model;
  solver::Largest worst;
  scope.for_each_particle_in(model.affine, [&](std::uint32_t p) {
    if (!is_free(model.bodies[model.particles[p].body].kind)) return;  // not free: it is at its assigned place
    worst.add(norm(model.carried(p).first - model.position(p)));
  });
  return worst.value;
}

void AffineRows::add_loads(const LastStep& step, std::uint32_t slot, LoadReader& reader) {
  const Model& model = step.model;
  const model::Body& body = model.bodies[slot];
  if (body.count == body.rank) return;
  model.for_each_particle_of(slot, [&](std::uint32_t p) {
    const model::Particle& particle = model.particles[p];
    if (particle.basis_index >= 0 || !model.is_unknown(particle)) return;
    const solver::AffineConstraint row = constraint_of(model, p);
    const std::array<Vec3, solver::AffineConstraint::max_nodes> anywhere{};  // its gradient is constant
    for_each_row_force(row, model.affine[p].multiplier.data(), false, anywhere.data(), anywhere.data(),
                       [&](std::uint32_t particle_of_row, const Vec3& force) {
                         reader.take({.particle = particle_of_row, .force = force, .kind = Load::Kind::within});
                       });
  });
}

}  // namespace iota::ingredient
