// SPDX-License-Identifier: Apache-2.0
#include "edit/law_checks.h"
#include "ingredient/joint_readings.h"
#include "ingredient/loads.h"
#include "model/solid.h"
#include "system/core.h"

#include <algorithm>
#include <vector>

namespace iota {

std::size_t width(Quantity quantity) {
  using enum Quantity;
  switch (quantity) {
    case orientation: return 4;
    case mass:
    case length:
    case value:
    case speed:
    case effort: return 1;
    case pose: return 7;
    case motion: return 6;
    case work: return 2;
    default: return 3;
  }
}

namespace {

/// Provides rows of the right width.
template <class IdType, class Write>
void write_rows(const Core& core, Quantity quantity, std::span<const IdType> ids, std::span<double> out, Write write) {
  const std::size_t columns = width(quantity);
  if (out.size() != columns * ids.size())
    throw std::invalid_argument(text("read: the array must have ", columns * ids.size(), " numbers, got ", out.size()));
  double* row = out.data();
  for (const IdType id : ids) write(core.slot(id), row), row += columns;
}

void put(const Vec3& v, double* row) { row[0] = v.x, row[1] = v.y, row[2] = v.z; }
void put(const Quaternion& q, double* row) { row[0] = q.x, row[1] = q.y, row[2] = q.z, row[3] = q.w; }

[[noreturn]] void refuse(const char* things) {
  throw std::invalid_argument(text("read: ", things, " have no such quantity"));
}

}  // namespace

std::vector<ParticleId> Many::create_points(const PointRows& rows) { return core_.execute(edit::CreatePoints{rows}); }

std::vector<BodyId> Many::create_rods(const RodRows& rows) { return core_.execute(edit::CreateRods{rows}); }

std::vector<BondId> Many::create_bonds(const BondRows& rows) {
  const auto& law = core_.model.laws[core_.slot(rows.law.law)];
  edit::CreateBonds command{rows.p, rows.q, rows.law.law, rows.law.implicit.value_or(law.has_derivative()), {}};
  auto standard = law.standard;
  for (const LawParameter& p : rows.law.parameters) standard[edit::require_parameter(law, p.name)] = p.value;
  command.parameters.assign(rows.columns.empty() ? 1 : rows.p.size(), standard);
  for (const BondRows::Column& column : rows.columns) {
    const std::uint32_t index = edit::require_parameter(law, column.name);
    if (column.values.size() != rows.p.size())
      throw std::invalid_argument(
          text(column.name, " must have a value for each of ", rows.p.size(), " bonds, got ", column.values.size()));
    for (std::size_t i = 0; i < rows.p.size(); ++i) command.parameters[i][index] = column.values[i];
  }
  return core_.execute(command);
}

RestructureReport Many::combine(std::span<const ParticleId> p, std::span<const ParticleId> q) {
  return core_.execute(edit::CombineMany{{p.begin(), p.end()}, {q.begin(), q.end()}});
}

void Many::read(Quantity quantity, std::span<const ParticleId> ids, std::span<double> out) const {
  const model::Model& m = core_.model;
  write_rows(core_, quantity, ids, out, [&](std::uint32_t p, double* row) {
    const model::Ring& ring = m.rings[m.particles[p].ring];
    switch (quantity) {
      case Quantity::position: return put(ring.position, row);
      case Quantity::velocity: return put(ring.velocity, row);
      case Quantity::mass: *row = m.particles[p].mass; return;
      case Quantity::force: return put(m.particles[p].mass * ring.acceleration, row);
      default: refuse("particles");
    }
  });
}

void Many::read(Quantity quantity, std::span<const BodyId> ids, std::span<double> out) const {
  const model::Model& m = core_.model;
  if (quantity == Quantity::orientation || quantity == Quantity::pose) {
    std::vector<std::uint32_t> slots;
    for (const BodyId id : ids) slots.push_back(core_.slot(id));
    core_.orientations.refresh(core_.model, slots);
  }
  write_rows(core_, quantity, ids, out, [&](std::uint32_t body, double* row) {
    switch (quantity) {
      case Quantity::position: return put(m.center_of_mass(body), row);
      case Quantity::velocity: return put(body_velocity(m, body), row);
      case Quantity::angular_velocity: return put(body_angular_velocity(m, body), row);
      case Quantity::mass: *row = m.body_mass(body); return;
      case Quantity::force: return put(ingredient::calc_net_load(m, body, {}).force, row);
      case Quantity::torque: return put(ingredient::calc_net_load(m, body, {}).torque, row);
      case Quantity::orientation: return put(m.bodies[body].orientation, row);
      case Quantity::pose: return put(m.center_of_mass(body), row), put(m.bodies[body].orientation, row + 3);
      case Quantity::motion: return put(body_velocity(m, body), row), put(body_angular_velocity(m, body), row + 3);
      case Quantity::work: {
        const auto [work, steps] = core_.islands.work_of(m, m.bodies[body].articulate);
        row[0] = work, row[1] = steps;
        return;
      }
      default: refuse("bodies");
    }
  });
}

void Many::read(Quantity quantity, std::span<const BondId> ids, std::span<double> out) const {
  const model::Model& m = core_.model;
  write_rows(core_, quantity, ids, out, [&](std::uint32_t slot, double* row) {
    const auto& bond = m.bonds[slot];
    switch (quantity) {
      case Quantity::force: return put(ingredient::Bonds::force_on_first(core_.model, slot), row);
      case Quantity::length: *row = norm(m.position(bond.q) - m.position(bond.p)); return;
      default: refuse("bonds");
    }
  });
}

void Many::read(Quantity quantity, JointCoordinate which, std::span<const ConstraintId> ids,
                std::span<double> out) const {
  const model::Model& m = core_.model;
  write_rows(core_, quantity, ids, out, [&](std::uint32_t slot, double* row) {
    const auto& joint = m.constraints[slot];
    if (!has_coordinate(joint.kind, which))
      throw std::invalid_argument(text("joint ", slot, " has no such coordinate"));
    switch (quantity) {
      case Quantity::value: *row = ingredient::calc_coordinate(m, slot, which).first; return;
      case Quantity::speed: *row = ingredient::calc_coordinate(m, slot, which).second; return;
      case Quantity::effort:
        *row = 0;
        for (const double multiplier : joint.efforts[static_cast<std::size_t>(which)]) *row -= multiplier;
        return;
      default: refuse("joints");
    }
  });
}

void Many::read(std::string_view parameter, std::span<const BondId> ids, std::span<double> out) const {
  const model::Model& m = core_.model;
  write_rows(core_, Quantity::length, ids, out, [&](std::uint32_t slot, double* row) {
    const auto& bond = m.bonds[slot];
    *row = bond.parameters[edit::require_parameter(m.laws[bond.law], parameter)];
  });
}

void Many::assign(Quantity quantity, std::span<const ParticleId> ids, std::span<const double> values) {
  core_.execute(edit::AssignParticles{quantity, {ids.begin(), ids.end()}, {values.begin(), values.end()}});
}

void Many::assign(Quantity quantity, std::span<const BodyId> ids, std::span<const double> values) {
  core_.execute(edit::AssignBodies{quantity, {ids.begin(), ids.end()}, {values.begin(), values.end()}});
}

void Many::assign(std::string_view parameter, std::span<const BondId> ids, std::span<const double> values) {
  const model::Model& m = core_.model;
  edit::AssignBonds command{{}, {ids.begin(), ids.end()}, {values.begin(), values.end()}};
  for (const BondId id : ids)
    command.index.push_back(edit::require_parameter(m.laws[m.bonds[core_.slot(id)].law], parameter));
  core_.execute(command);
}

}  // namespace iota
