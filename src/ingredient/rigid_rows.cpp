// SPDX-License-Identifier: Apache-2.0
#include "ingredient/rigid_rows.h"

#include "base/text.h"
#include "ingredient/model.h"
#include "ingredient/row_loads.h"
#include "solver/largest.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace iota::ingredient {

namespace {

solver::DistanceConstraint constraint_of(const model::RigidRow& row, std::uint32_t a, std::uint32_t b) {
  return {{a, b}, row.length, row.length};
}

}  // namespace

void RigidRows::build(const IslandMap& map, Problem& problem) {
  const Model& model = map.model;
  std::size_t count = 0;
  for (const std::uint32_t body : map.bodies) count += model.bodies[body].row_count;
  if (count > 0) problem.pool_of<solver::DistanceConstraint>().reserve(count);
  for (const std::uint32_t slot : map.bodies) {
    const model::Body& body = model.bodies[slot];
    for (std::uint8_t row = 0; row < body.row_count; ++row) {
      const auto [i, j] = model::basis_pairs[row];
      const std::uint32_t a = map.node_of(body.basis[i]), b = map.node_of(body.basis[j]);
      if (map.is_pinned(a) && map.is_pinned(b)) {
        if (is_free(body.kind)) pinned_.push_back({slot, row});
        continue;
      }
      problem.add(constraint_of(model.row(slot, row), a, b), {owner, {row}, slot});
    }
  }
}

void RigidRows::leave(const IslandMap& map) {
  std::erase_if(pinned_, [&](const Row& r) { return map.has(r.body); });
}

void RigidRows::load(const Model& model, const IslandNodes&, double, Problem& problem) {
  if (!problem.has_used<solver::DistanceConstraint>()) return;
  auto& multipliers = problem.pool_of<solver::DistanceConstraint>().multipliers;
  for_each_item_of<solver::DistanceConstraint>(owner, problem, [&](std::size_t i, solver::ItemKey key) {
    multipliers[i] = model.row(key.slot, key.part[0]).multiplier;
  });
}

void RigidRows::store(Model& model, const IslandNodes&, double, const Problem& problem) const {
  const auto& multipliers = problem.pool_of<solver::DistanceConstraint>().multipliers;
  for_each_item_of<solver::DistanceConstraint>(owner, problem, [&](std::size_t i, solver::ItemKey key) {
    model.row(key.slot, key.part[0]).multiplier = multipliers[i];
  });
}

bool RigidRows::are_pinned_met(const Model& model) const {
  constexpr double met = 1e-6;  // of the length
  return std::all_of(pinned_.begin(), pinned_.end(), [&](const Row& r) {
    const model::Body& body = model.bodies[r.body];
    const auto [i, j] = model::basis_pairs[r.row];
    const double length = norm(model.position(body.basis[j]) - model.position(body.basis[i]));
    const double wanted = model.row(r.body, r.row).length;
    return std::abs(length - wanted) <= met * wanted;
  });
}

std::string RigidRows::name_of_row(const Model&, solver::ItemKey key) const {
  return text("the rigidity of body ", key.slot);
}

void RigidRows::validate(const Model& model, model::Audit& audit) {
  audit.require_owners("rows", model.more_rows, model.bodies);
  model.bodies.for_each([&](std::uint32_t slot, const model::Body& b) {
    audit.require(b.row_count == b.rank * (b.rank - 1) / 2 || b.count == 0, "body ", slot, " has ", int(b.row_count),
                  " rows at rank ", int(b.rank));
    audit.require((b.row_count > 1) == model.more_rows.has(slot), "body ", slot, " with ", int(b.row_count),
                  " rows has a wrong table of them");
  });
}

double RigidRows::worst_gap(const Scope& scope) {
  const Model& model = scope.model;
  solver::Largest worst;
  scope.for_each_body([&](std::uint32_t slot, const model::Body& b) {
    if (!is_free(b.kind)) return;  // not free: it is at its assigned place
    for (int row = 0; row < b.row_count; ++row) {
      const auto [i, j] = model::basis_pairs[row];
      const double length = norm(model.position(b.basis[j]) - model.position(b.basis[i]));
      worst.add(std::abs(length - model.row(slot, row).length));
    }
  });
  return worst.value;
}

void RigidRows::add_loads(const LastStep& step, std::uint32_t slot, LoadReader& reader) {
  const model::Body& body = step.model.bodies[slot];
  for (int row = 0; row < body.row_count; ++row) {
    const model::RigidRow& record = step.model.row(slot, row);
    const auto [i, j] = model::basis_pairs[row];
    const std::array points{body.basis[i], body.basis[j]};
    for_each_row_force(step, constraint_of(record, 0, 1), &record.multiplier, points,
                       [&](std::uint32_t particle, const Vec3& force) {
                         reader.take({.particle = particle, .force = force, .kind = Load::Kind::within});
                       });
  }
}

}  // namespace iota::ingredient
