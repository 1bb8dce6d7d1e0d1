// SPDX-License-Identifier: Apache-2.0
#include "edit/many.h"

#include "base/disjoint_sets.h"
#include "base/text.h"
#include "edit/batches.h"
#include "edit/bodies.h"
#include "edit/body_forces.h"
#include "edit/bonds.h"
#include "edit/combine.h"
#include "edit/constraints.h"
#include "edit/particles.h"
#include "math/checks.h"
#include "math/mat3.h"
#include "model/solid.h"

#include <iota/reports.h>

#include <algorithm>
#include <utility>

namespace iota::edit {

namespace {

/// The i-th of values: one for each, one for all, or none.
template <class T>
const T& value_of(const std::vector<T>& values, std::size_t i, const T& standard) {
  return values.empty() ? standard : values.size() == 1 ? values[0] : values[i];
}
template <class T>
void require_count(std::string_view name, const std::vector<T>& values, std::size_t count) {
  if (values.size() > 1 && values.size() != count)
    throw std::invalid_argument(text(name, " must be one, or one for each of ", count, ", got ", values.size()));
}
void require_same(std::string_view name, std::size_t got, std::size_t count) {
  if (got != count) throw std::invalid_argument(text(name, " must have a row for each of ", count, ", got ", got));
}

/// Adds the number of the row to an error.
template <class Check>
void check_rows(std::size_t count, Check check) {
  for (std::size_t i = 0; i < count; ++i) {
    try {
      check(i);
    } catch (const StaleIdError& error) {
      throw StaleIdError(text("row ", i, ": ", error.what()));
    } catch (const std::invalid_argument& error) {
      throw std::invalid_argument(text("row ", i, ": ", error.what()));
    }
  }
}

void require_radius(double radius) {
  if (!(radius >= 0 && radius <= 1e9))
    throw std::invalid_argument(text("radius must be between 0 and 1e9 m, got ", radius));
}

Vec3 vector_in(const double* row) { return {row[0], row[1], row[2]}; }
Quaternion quaternion_in(const double* row) { return {row[0], row[1], row[2], row[3]}; }

/// The state before an edit that may be refused in the middle.
class Undone {
 public:
  explicit Undone(Editor& e) : editor_(e), before_(e.snapshot(Editor::Origin::own)) {}
  template <class Change>
  auto attempt(Change change) {
    try {
      return change();
    } catch (...) {
      editor_.restore(before_, Editor::Origin::own);
      throw;
    }
  }

 private:
  Editor& editor_;
  Snapshot before_;
};

}  // namespace

// --- making -------------------------------------------------------------------------------------------------------------

std::vector<ParticleId> apply(Editor& e, const CreatePoints& c) {
  model::Model& model = e.model;
  const PointRows& rows = c.rows;
  const std::size_t count = rows.positions.size();
  require_count("velocities", rows.velocities, count);
  require_count("masses", rows.masses, count);
  require_not_negative("damping", rows.body.damping);
  check_rows(count, [&](std::size_t i) { require_finite("position", rows.positions[i]); });
  check_rows(rows.velocities.size(), [&](std::size_t i) { require_finite("velocity", rows.velocities[i]); });
  check_rows(rows.masses.size(), [&](std::size_t i) { require_mass("mass", rows.masses[i]); });
  std::vector<ParticleId> made;
  made.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint32_t body = model.make_body(rows.body.kind, rows.body.damping);
    const std::uint32_t particle = model.make_particle(body, rows.positions[i], value_of(rows.masses, i, 1.0),
                                                       value_of(rows.velocities, i, Vec3{}));
    model.rebuild_basis(body);
    model.mark_body(body);
    e.mark_velocity_dirty(particle);
    made.push_back(model.particles.id(particle));
  }
  e.structure_changed();
  return made;
}

std::vector<BodyId> apply(Editor& e, const CreateRods& c) {
  model::Model& model = e.model;
  const RodRows& rows = c.rows;
  const std::size_t count = rows.starts.size();
  require_same("ends", rows.ends.size(), count);
  require_count("masses", rows.masses, count);
  require_count("radii", rows.radii, count);
  require_not_negative("damping", rows.body.damping);
  check_rows(count, [&](std::size_t i) {
    require_finite("start", rows.starts[i]);
    require_finite("end", rows.ends[i]);
    require_positive("the length of a rod", norm(rows.ends[i] - rows.starts[i]));
  });
  check_rows(rows.masses.size(), [&](std::size_t i) { require_mass("mass", rows.masses[i]); });
  check_rows(rows.radii.size(), [&](std::size_t i) { require_radius(rows.radii[i]); });
  std::vector<BodyId> made;
  made.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint32_t body = model.make_body(rows.body.kind, rows.body.damping);
    const double mass = value_of(rows.masses, i, 1.0), radius = value_of(rows.radii, i, 0.0);
    for (const Vec3& end : {rows.starts[i], rows.ends[i]})
      e.mark_velocity_dirty(model.make_particle(body, end, mass / 2, {}));
    model.rebuild_basis(body);
    model.mark_body(body);
    made.push_back(model.bodies.id(body));
    if (radius > 0) apply(e, SetRod{made.back(), mass, radius});
  }
  e.structure_changed();
  return made;
}

std::vector<BondId> apply(Editor& e, const CreateBonds& c) {
  const std::size_t count = c.p.size();
  require_same("q", c.q.size(), count);
  require_count("parameters", c.parameters, count);
  const std::array<double, max_law_parameters> none{};
  const auto row = [&](std::size_t i) {
    return CreateBond{c.p[i], c.q[i], c.law, c.implicit, 0, value_of(c.parameters, i, none)};
  };
  check_rows(count, [&](std::size_t i) { check(e, row(i)); });
  std::vector<BondId> made;
  made.reserve(count);
  for (std::size_t i = 0; i < count; ++i) made.push_back(apply(e, row(i)));
  return made;
}

namespace {

/// Whether no row can be refused, whatever the rows before it have done: each one hinges what no row before it has joined,
/// no body would have two points in one place, and at most one of the points of each place is held. Then no state before
/// the edit is needed, which would take most of its time.
bool are_plain_hinges(const Editor& e, const CombineMany& c) {
  const model::Model& model = e.model;
  const std::uint32_t rings = model.rings.slot_count();
  DisjointSets places(rings);
  std::vector<std::uint8_t> is_joined(rings);
  for (std::size_t i = 0; i < c.p.size(); ++i) {
    const std::uint32_t p = model.particles[e.require(c.p[i])].ring, q = model.particles[e.require(c.q[i])].ring;
    const std::uint32_t into = places.root(p), from = places.root(q);
    if (into == from) return false;
    places.set_parent(from, into);
    is_joined[p] = is_joined[q] = 1;
  }
  // In the order of slots, which in a large system takes half of the time of that of rows.
  std::vector<std::uint8_t> is_held(rings);
  std::vector<std::uint32_t> body_at(rings, model::none);
  bool plain = true;
  const auto hold = [&](std::uint32_t ring) { plain = plain && !std::exchange(is_held[places.root(ring)], 1); };
  model.bodies.for_each([&](std::uint32_t body, const model::Body& b) {
    const bool is_fixed = b.kind == BodyKind::static_ || b.kind == BodyKind::scripted;
    model.for_each_particle_of(body, [&](std::uint32_t p) {
      const std::uint32_t ring = model.particles[p].ring;
      plain = plain && std::exchange(body_at[places.root(ring)], body) != body;
      if (is_fixed && is_joined[ring]) hold(ring);
    });
  });
  for (std::uint32_t ring = 0; ring < rings && plain; ++ring)
    if (is_joined[ring] && model.rings[ring].nailed) hold(ring);
  return plain;
}

}  // namespace

RestructureReport apply(Editor& e, const CombineMany& c) {
  require_same("q", c.q.size(), c.p.size());
  check_rows(c.p.size(), [&](std::size_t i) { (void)e.require(c.p[i]), (void)e.require(c.q[i]); });
  RestructureReport sum;
  sum.articulates_before = e.model.articulate_count();
  const auto combine = [&] {
    check_rows(c.p.size(), [&](std::size_t i) { add_report(sum, apply(e, CombineParticles{c.p[i], c.q[i], 0})); });
  };
  if (are_plain_hinges(e, c))
    combine();
  else
    Undone(e).attempt(combine);
  sum.articulates_after = e.model.articulate_count();
  sum.structure_version = e.model.structure_version;
  return sum;
}

// --- changing -----------------------------------------------------------------------------------------------------------

void apply(Editor& e, const AssignParticles& c) {
  const model::Model& model = e.model;
  const std::size_t count = c.particles.size(), columns = width(c.quantity);
  require_same("the array", c.values.size(), count * columns);
  const auto row = [&](std::size_t i) { return c.values.data() + columns * i; };
  bool has_markers = false;
  check_rows(count, [&](std::size_t i) {
    has_markers = has_markers || model.particles[e.require(c.particles[i])].is_marker();
    switch (c.quantity) {
      case Quantity::position: return require_finite("position", vector_in(row(i)));
      case Quantity::velocity: return require_finite("velocity", vector_in(row(i)));
      case Quantity::force: return require_finite("force", vector_in(row(i)));
      case Quantity::mass: return require_mass("mass", *row(i));
      default: throw std::invalid_argument("particles have no such quantity that can be assigned");
    }
  });
  const auto assign = [&] {
    for (std::size_t i = 0; i < count; ++i) {
      const ParticleId id = c.particles[i];
      if (c.quantity == Quantity::mass)
        apply(e, SetMass{id, *row(i)});
      else if (c.quantity == Quantity::position)
        apply(e, SetPosition{id, vector_in(row(i))});
      else if (c.quantity == Quantity::velocity)
        apply(e, SetVelocity{id, vector_in(row(i))});
      else
        apply(e, ApplyForce{id, vector_in(row(i))});
    }
  };
  if (has_markers && c.quantity == Quantity::position)  // they may be outside of the span of the others
    Undone(e).attempt(assign);
  else
    assign();
}

namespace {

/// The values of a body in some rows; the others do not change.
struct Wanted {
  std::uint32_t body = model::none;
  Vec3 position, velocity, spin;
  Quaternion orientation;
};
Wanted wanted(const model::Model& model, BodyId id, Quantity quantity, const double* row) {
  const std::uint32_t body = id.slot;
  Wanted w{body, model.center_of_mass(body), body_velocity(model, body), body_angular_velocity(model, body),
           model.bodies[body].orientation};
  if (quantity == Quantity::position || quantity == Quantity::pose) w.position = vector_in(row);
  if (quantity == Quantity::orientation) w.orientation = normalized(quaternion_in(row));
  if (quantity == Quantity::pose) w.orientation = normalized(quaternion_in(row + 3));
  if (quantity == Quantity::velocity || quantity == Quantity::motion) w.velocity = vector_in(row);
  if (quantity == Quantity::angular_velocity) w.spin = vector_in(row);
  if (quantity == Quantity::motion) w.spin = vector_in(row + 3);
  return w;
}

/// Moves each body, without those hinged to it, to its place; its velocities are turned too.
void place_bodies(Editor& e, const std::vector<Wanted>& all) {
  model::Model& model = e.model;
  struct Placed {
    std::uint32_t ring;
    Vec3 position, velocity;
  };
  std::vector<Placed> placed;
  for (const Wanted& w : all) {
    if (model.bodies[w.body].kind == BodyKind::scripted) {
      apply(e, SetPose{model.bodies.id(w.body), w.position, w.orientation});
      continue;
    }
    ingredient::Contacts::wake(model, w.body);
    const Quaternion& q = model.bodies[w.body].orientation;
    const Quaternion turn = multiply(w.orientation, {-q.x, -q.y, -q.z, q.w});
    const Vec3 center = model.center_of_mass(w.body);
    model.for_each_particle_of(w.body, [&](std::uint32_t p) {
      const std::uint32_t ring = model.particles[p].ring;
      placed.push_back({ring, w.position + rotate(turn, model.rings[ring].position - center),
                        w.velocity + rotate(turn, model.rings[ring].velocity - w.velocity)});
    });
    model.bodies[w.body].orientation = w.orientation;
  }
  for (const Placed& at : placed) {
    model.rings[at.ring].position = at.position, model.rings[at.ring].velocity = at.velocity;
    if (auto* const nail = model.nails.find(at.ring)) nail->position = nail->position_before = at.position;
  }
  for (const Wanted& w : all) refresh_coordinates_of(e, w.body);
  e.orientations.forget();
}

/// Gives each body a rigid motion; points that bodies share get that of the last one.
void move_bodies(Editor& e, const std::vector<Wanted>& all, bool turned) {
  model::Model& model = e.model;
  for (const Wanted& w : all) {
    model.for_each_particle_of(w.body, [&](std::uint32_t p) {
      auto& ring = model.rings[model.particles[p].ring];
      ring.velocity = w.velocity + cross(w.spin, ring.position - w.position);
    });
    if (turned) set_axial_spin(model, w.body, w.spin);
  }
}

}  // namespace

void apply(Editor& e, const AssignBodies& c) {
  using enum Quantity;
  const model::Model& model = e.model;
  const std::size_t count = c.bodies.size(), columns = width(c.quantity);
  require_same("the array", c.values.size(), count * columns);
  const auto row = [&](std::size_t i) { return c.values.data() + columns * i; };
  std::vector<std::pair<ParticleId, Vec3>> forces;
  check_rows(count, [&](std::size_t i) {
    const std::uint32_t body = e.require(c.bodies[i]);
    if (model.bodies[body].count == 0) throw std::invalid_argument(text("body ", body, " has no particles"));
    switch (c.quantity) {
      case position: return require_finite("position", vector_in(row(i)));
      case orientation: return (void)require_quaternion("orientation", quaternion_in(row(i)));
      case pose:
        require_finite("position", vector_in(row(i)));
        return (void)require_quaternion("orientation", quaternion_in(row(i) + 3));
      case velocity: return require_finite("velocity", vector_in(row(i)));
      case angular_velocity:
        require_finite("angular velocity", vector_in(row(i)));
        return require_can_spin(model, body, vector_in(row(i)));
      case motion:
        require_finite("velocity", vector_in(row(i)));
        require_finite("angular velocity", vector_in(row(i) + 3));
        return require_can_spin(model, body, vector_in(row(i) + 3));
      case mass: return check(e, SetBodyMass{c.bodies[i], *row(i)});
      case force: require_finite("force", vector_in(row(i))); return spread(model, body, vector_in(row(i)), forces);
      case torque:
        require_finite("torque", vector_in(row(i)));
        return ingredient::Pushes::check_torque(model, body, vector_in(row(i)));
      default: throw std::invalid_argument("bodies have no such quantity that can be assigned");
    }
  });
  if (c.quantity == mass) {
    for (std::size_t i = 0; i < count; ++i) apply(e, SetBodyMass{c.bodies[i], *row(i)});
    return;
  }
  if (c.quantity == torque)
    for (std::size_t i = 0; i < count; ++i)
      ingredient::Pushes::add_torque(e.model, c.bodies[i].slot, vector_in(row(i)));
  if (c.quantity == force || c.quantity == torque) {
    for (const auto& [particle, share] : forces) apply(e, ApplyForce{particle, share});
    return;
  }
  if (c.quantity == orientation || c.quantity == pose) {
    std::vector<std::uint32_t> slots;
    for (const BodyId id : c.bodies) slots.push_back(id.slot);
    e.orientations.refresh(e.model, slots);
  }
  std::vector<Wanted> all;
  for (std::size_t i = 0; i < count; ++i) all.push_back(wanted(model, c.bodies[i], c.quantity, row(i)));
  if (c.quantity == position || c.quantity == orientation || c.quantity == pose)
    place_bodies(e, all);
  else
    move_bodies(e, all, c.quantity != velocity);
  for (const Wanted& w : all) e.mark_velocity_dirty(model.bodies[w.body].first);
}

void apply(Editor& e, const AssignBonds& c) {
  require_same("the array", c.values.size(), c.bonds.size());
  require_same("the parameters", c.index.size(), c.bonds.size());
  check_rows(c.bonds.size(), [&](std::size_t i) { check(e, SetBondParameter{c.bonds[i], c.index[i], c.values[i]}); });
  for (std::size_t i = 0; i < c.bonds.size(); ++i) apply(e, SetBondParameter{c.bonds[i], c.index[i], c.values[i]});
}

}  // namespace iota::edit
