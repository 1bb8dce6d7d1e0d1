// SPDX-License-Identifier: Apache-2.0
#include "step/island.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <tuple>
#include <utility>

namespace iota::step {

using model::Body;
using model::is_free;
using model::Model;
using model::none;
using model::Particle;
using model::Ring;

namespace {

/// Shrinks smoothly from 1 to a hundredth, each step by moving positions only, since forces that close in a given time
/// shoot (measured: 25 to 120 J where this adds 0.03 J); the last bit is closed by projection (a distance row has no direction at 0).
double closing_factor(double elapsed, double duration) {
  const double s = std::clamp(elapsed / duration, 0.0, 1.0);
  return 1 - 0.99 * s * s * (3 - 2 * s);
}

solver::Care care_of(IntegrationMode mode) {
  switch (mode) {
    case IntegrationMode::plausible: return solver::Care::plausible();
    case IntegrationMode::robust: return solver::Care::robust();
    case IntegrationMode::energy_keeping: return solver::Care::energy_keeping();
    case IntegrationMode::accurate: return solver::Care::accurate();
  }
  return {};
}

/// Of a marker that is an unknown of its own, kg.
double virtual_mass(const Model& model, std::uint32_t marker) {
  return 0.1 * model.body_mass(model.particles[marker].body);
}

}  // namespace

Island::Weighted Island::nodes_of(const Model& model, std::uint32_t particle,
                                  const std::vector<std::uint32_t>& node_of_ring) const {
  const Particle& p = model.particles[particle];
  Weighted list{};
  if (model.is_unknown(p)) {
    list[0] = {node_of_ring[p.ring], 1.0};
    return list;
  }
  const Body& body = model.bodies[p.body];
  const auto& weights = model.ties[particle].weights;
  int used = 0;
  for (int i = 0; i < body.rank; ++i)
    if (weights[i] != 0) list[used++] = {node_of_ring[model.particles[body.basis[i]].ring], weights[i]};
  return list;
}

void Island::add_mass_outer(const Weighted& a, double mass) {
  for (std::size_t i = 0; i < a.size() && a[i].second != 0; ++i) {
    problem_.mass[a[i].first] += mass * a[i].second * a[i].second;
    for (std::size_t j = i + 1; j < a.size() && a[j].second != 0; ++j)
      problem_.mass_couplings.push_back({a[i].first, a[j].first, mass * a[i].second * a[j].second});
  }
}

/// A marker that is an unknown of its own would leave an empty pivot: mass that only acts against leaving its place in
/// the body, of which the rows that tie it there leave nothing.
void Island::add_virtual_mass(const Model& model, std::uint32_t marker,
                              const std::vector<std::uint32_t>& node_of_ring) {
  const Particle& p = model.particles[marker];
  const Body& body = model.bodies[p.body];
  std::array<std::pair<std::uint32_t, double>, 5> difference{{{node_of_ring[p.ring], 1.0}}};
  const auto& weights = model.ties[marker].weights;
  int used = 1;
  for (int i = 0; i < body.rank; ++i)
    if (weights[i] != 0) difference[used++] = {node_of_ring[model.particles[body.basis[i]].ring], -weights[i]};
  const double mass = virtual_mass(model, marker);
  virtual_.push_back(marker);
  for (int a = 0; a < used; ++a) {
    problem_.mass[difference[a].first] += mass * difference[a].second * difference[a].second;
    for (int b = a + 1; b < used; ++b)
      problem_.mass_couplings.push_back(
          {difference[a].first, difference[b].first, mass * difference[a].second * difference[b].second});
  }
}

double Island::virtual_energy(const Model& model) const {
  double twice = 0;
  for (const std::uint32_t marker : virtual_) {
    const Vec3 off = model.velocity(marker) - model.carried(marker).second;
    twice += virtual_mass(model, marker) * dot(off, off);
  }
  return twice / 2;
}

void Island::add_masses(const Model& model, std::uint32_t body, const std::vector<std::uint32_t>& node_of_ring) {
  model.for_each_particle_of(body, [&](std::uint32_t p) {
    const Particle& particle = model.particles[p];
    if (!particle.is_marker())
      add_mass_outer(nodes_of(model, p, node_of_ring), particle.mass);
    else if (model.is_unknown(particle) && model.ring_mass(particle.ring) == 0)
      add_virtual_mass(model, p, node_of_ring);
    if (!model.is_unknown(particle)) slaves_.push_back(p), slave_nodes_.push_back(nodes_of(model, p, node_of_ring));
  });
  model.for_each_inertia_of(body, [&](std::uint32_t i) {
    const model::InertiaPair& pair = model.inertia_pairs[i];
    std::array<std::pair<std::uint32_t, double>, 8> difference{};
    std::size_t used = 0;
    const auto add = [&](const Weighted& list, double sign) {
      for (const auto& entry : list) {
        if (entry.second == 0) break;
        auto* const end = difference.data() + used;
        auto* const found = std::find_if(difference.data(), end, [&](const auto& d) { return d.first == entry.first; });
        if (found == end) difference[used++] = {entry.first, 0};
        found->second += sign * entry.second;
      }
    };
    add(nodes_of(model, pair.p, node_of_ring), 1);
    add(nodes_of(model, pair.q, node_of_ring), -1);
    for (std::size_t a = 0; a < used; ++a) {
      problem_.mass[difference[a].first] += pair.inertia * difference[a].second * difference[a].second;
      for (std::size_t b = a + 1; b < used; ++b)
        problem_.mass_couplings.push_back(
            {difference[a].first, difference[b].first, pair.inertia * difference[a].second * difference[b].second});
    }
  });
}

/// A node is damped by its bodies in the proportion in which they weigh on it.
void Island::add_damped_masses(const Model& model, std::uint32_t body, const std::vector<std::uint32_t>& node_of_ring) {
  const double k = model.bodies[body].damping;
  if (!(k > 0)) return add_masses(model, body, node_of_ring);
  node_damping_.resize(rings_.size());
  const auto for_each_node = [&](auto visit) {
    model.for_each_particle_of(body, [&](std::uint32_t p) {
      const std::uint32_t node = node_of_ring[model.particles[p].ring];
      if (model.is_unknown(model.particles[p]) && node != none) visit(node);
    });
  };
  for_each_node([&](std::uint32_t node) { node_damping_[node] -= k * problem_.mass[node]; });
  add_masses(model, body, node_of_ring);
  for_each_node([&](std::uint32_t node) { node_damping_[node] += k * problem_.mass[node]; });
}

void Island::add_constraints(const Model& model, std::uint32_t slot, const std::vector<std::uint32_t>& node_of_ring) {
  const Body& body = model.bodies[slot];
  auto& distances = std::get<solver::ConstraintPool<solver::DistanceConstraint>>(problem_.constraints).items;
  auto& affines = std::get<solver::ConstraintPool<solver::AffineConstraint>>(problem_.constraints).items;
  const auto node_of = [&](std::uint32_t particle) { return node_of_ring[model.particles[particle].ring]; };
  const double extent = model.extent(slot);
  for (int row = 0; row < body.row_count; ++row) {
    const auto [i, j] = model::basis_pairs[row];
    const std::uint32_t a = node_of(body.basis[i]), b = node_of(body.basis[j]);
    if (pinned_[a] && pinned_[b]) {
      if (is_free(body.kind)) pinned_rows_.push_back({slot, static_cast<std::uint8_t>(row)});
      continue;
    }
    const double length = model.row(slot, row).length;
    distances.push_back({{a, b}, length, length});
    rigid_rows_.push_back({slot, static_cast<std::uint8_t>(row)});
  }
  if (body.count == body.rank) return;
  model.for_each_particle_of(slot, [&](std::uint32_t p) {
    const Particle& particle = model.particles[p];
    if (particle.basis_index >= 0 || !model.is_unknown(particle)) return;
    solver::AffineConstraint tie;
    tie.nodes[0] = node_of(p), tie.weights[0] = 1, tie.count = 1;
    tie.reference = extent > 0 ? extent : 1;
    const auto& weights = model.ties[p].weights;
    bool movable = !pinned_[tie.nodes[0]];
    for (int i = 0; i < body.rank; ++i) {
      if (weights[i] == 0) continue;
      movable = movable || !pinned_[node_of(body.basis[i])];
      tie.nodes[tie.count] = node_of(body.basis[i]);
      tie.weights[tie.count++] = -weights[i];
    }
    if (!movable) {
      if (is_free(body.kind)) pinned_ties_.push_back(p);
      return;
    }
    affines.push_back(tie);
    tied_.push_back(p);
  });
}

void Island::add_bonds(const Model& model, const std::vector<std::uint32_t>& node_of_ring) {
  const auto arm_between = [&](std::uint32_t p, std::uint32_t q) {
    solver::ForceArm arm;
    arm.nodes = {node_of_ring[model.particles[p].ring], node_of_ring[model.particles[q].ring]};
    arm.weights = {-1, 1};
    arm.count = 2;
    return arm;
  };
  std::vector<std::uint32_t> bonds;  // each once, in order of slots
  for (const std::uint32_t body : bodies_)
    model.for_each_particle_of(body, [&](std::uint32_t p) {
      model.for_each_bond_of(p, [&](std::uint32_t b) {
        if (model.bonds[b].p == p && model.bonds[b].ties()) bonds.push_back(b);
      });
    });
  std::sort(bonds.begin(), bonds.end());
  for (const std::uint32_t slot : bonds) {
    const model::Bond& b = model.bonds[slot];
    const solver::ForceArm arm = arm_between(b.p, b.q);
    if (arm.nodes[0] == none || arm.nodes[1] == none || arm.nodes[0] == arm.nodes[1]) continue;
    if (b.law == model::spring_law) {
      std::get<solver::ForcePool<solver::SpringForce>>(problem_.forces).items.push_back({arm});
      springs_.push_back(slot);
    } else if (b.law == model::drag_law) {
      std::get<solver::ForcePool<solver::DragForce>>(problem_.forces).items.push_back({arm});
      drags_.push_back(slot);
    } else {
      solver::RadialForce force{arm, &model.compiled(b.law)};
      force.m_p = model.particles[b.p].mass, force.m_q = model.particles[b.q].mass;
      std::get<solver::ForcePool<solver::RadialForce>>(problem_.forces).items.push_back(force);
      radials_.push_back(slot);
    }
  }
}

void Island::add_spin(const Model& model, std::uint32_t body, const std::vector<std::uint32_t>& node_of_ring) {
  const model::InertiaPair& pair = model.inertia_pairs[model.bodies[body].first_inertia];
  solver::GyroscopicForce force;
  force.arm.nodes = {node_of_ring[model.particles[pair.p].ring], node_of_ring[model.particles[pair.q].ring]};
  force.arm.weights = {-1, 1};
  force.arm.count = 2;
  std::get<solver::ForcePool<solver::GyroscopicForce>>(problem_.forces).items.push_back(force);
  spinning_.push_back(body);
}

void Island::store_spins(Model& model, double h) const {
  for (const std::uint32_t body : spinning_) {
    model::RodSpin& spin = model.spins.at(body);
    spin.angle += h * spin.momentum / model.axial_inertia(body);
  }
}

double Island::damp_spins(Model& model, double h) const {
  double lost = 0;
  for (const std::uint32_t body : spinning_) {
    lost += model.spin_energy(body);
    model.spins.at(body).momentum *= std::exp(-(model.damping + model.bodies[body].damping) * h);
    lost -= model.spin_energy(body);
  }
  return lost;
}

void Island::load_bonds(const Model& model, double h) {
  auto& gyroscopic = std::get<solver::ForcePool<solver::GyroscopicForce>>(problem_.forces).items;
  for (std::size_t i = 0; i < spinning_.size(); ++i)
    gyroscopic[i].spin = model.spins[spinning_[i]].momentum / model.bodies[spinning_[i]].first_row.length;
  auto& springs = std::get<solver::ForcePool<solver::SpringForce>>(problem_.forces).items;
  for (std::size_t i = 0; i < springs_.size(); ++i) {
    const auto& p = model.bonds[springs_[i]].parameters;
    springs[i].stiffness = p[0], springs[i].damping = p[1], springs[i].length = p[2];
  }
  auto& drags = std::get<solver::ForcePool<solver::DragForce>>(problem_.forces).items;
  for (std::size_t i = 0; i < drags_.size(); ++i) drags[i].damping = model.bonds[drags_[i]].parameters[0];
  auto& radials = std::get<solver::ForcePool<solver::RadialForce>>(problem_.forces).items;
  for (std::size_t i = 0; i < radials_.size(); ++i) {
    radials[i].parameters = model.bonds[radials_[i]].parameters;
    radials[i].time = model.time + h;  // a law that changes with time is taken at the end of the step
  }
}

void Island::add_joints(const Model& model, const std::vector<std::uint32_t>& node_of_ring) {
  std::vector<std::uint32_t> constraints;  // each once, in order of slots
  for (const std::uint32_t body : bodies_)
    model.for_each_particle_of(body, [&](std::uint32_t p) {
      model.for_each_constraint_of(p, [&](std::uint32_t c, int place) {
        if (place == model::a_origin && model.constraints[c].active) constraints.push_back(c);
      });
    });
  std::sort(constraints.begin(), constraints.end());
  for (const std::uint32_t slot : constraints) {
    const model::Constraint& c = model.constraints[slot];
    PlaceArms places{};
    bool complete = true;  // not so where one side is inactive
    for (int place = 0; place < model::place_count; ++place) {
      if (!c.has(place)) continue;
      if (c.particles[place] == none) {
        places[place].constant = c.fixed[place - model::b_origin];
        continue;
      }
      // Through the basis, also where the particle is an unknown of its own: a row then couples two bodies and no more.
      const Body& body = model.bodies[model.particles[c.particles[place]].body];
      const std::array<double, 4> weights = model.weights(c.particles[place]);
      int used = 0;
      for (int i = 0; i < body.rank; ++i) {
        if (weights[i] == 0) continue;
        const std::uint32_t node = node_of_ring[model.particles[body.basis[i]].ring];
        complete = complete && node != none;
        places[place].nodes[used++] = {node, weights[i]};
      }
    }
    if (complete) constraint_rows_.add(model, slot, places, pinned_, problem_);
  }
}

// Lists that grow by doubling leave holes in memory, a quarter of what they hold.
void Island::make_room(const Model& model, std::span<const std::uint32_t> articulates) {
  std::size_t bodies = 0, points = 0, rows = 0;
  for (const std::uint32_t a : articulates)
    model.for_each_body_of(a, [&](std::uint32_t body) {
      ++bodies, points += model.bodies[body].count, rows += model.bodies[body].row_count;
    });
  bodies_.reserve(bodies);
  rings_.reserve(points), pinned_.reserve(points);
  rigid_rows_.reserve(rows);
  std::get<solver::ConstraintPool<solver::DistanceConstraint>>(problem_.constraints).items.reserve(rows);
}

void Island::assemble(const Model& model, std::span<const std::uint32_t> articulates,
                      std::vector<std::uint32_t>& node_of_ring) {
  *this = Island{};
  make_room(model, articulates);
  double total_mass = 0;
  for (const std::uint32_t articulate : articulates)
    model.for_each_body_of(articulate, [&](std::uint32_t body) {
      if (model.bodies[body].kind == BodyKind::inactive || model.bodies[body].count == 0) return;
      bodies_.push_back(body);
      if (is_free(model.bodies[body].kind)) total_mass += model.body_mass(body);
      model.for_each_particle_of(body, [&](std::uint32_t p) {
        const Particle& particle = model.particles[p];
        if (!model.is_unknown(particle) || node_of_ring[particle.ring] != none) return;
        node_of_ring[particle.ring] = static_cast<std::uint32_t>(rings_.size());
        rings_.push_back(particle.ring);
        pinned_.push_back(model.is_pinned(particle.ring));
      });
    });
  idle_ = std::none_of(bodies_.begin(), bodies_.end(), [&](std::uint32_t b) { return is_free(model.bodies[b].kind); });

  const std::size_t n = rings_.size();
  problem_.add_nodes(n);
  for (const std::uint32_t body : bodies_) {
    add_damped_masses(model, body, node_of_ring);
    add_constraints(model, body, node_of_ring);
    if (model.spins.has(body)) add_spin(model, body, node_of_ring);
  }
  for (std::size_t i = 0; i < node_damping_.size(); ++i) node_damping_[i] /= problem_.mass[i];

  auto& distances = std::get<solver::ConstraintPool<solver::DistanceConstraint>>(problem_.constraints).items;
  if (model.closings.size() > 0) {
    for (const std::uint32_t body : bodies_)
      model.for_each_particle_of(body, [&](std::uint32_t p) {
        model.for_each_closing_of(p, [&](std::uint32_t c) {
          if (model.closings[c].p == p) closings_.push_back(c);
        });
      });
    std::sort(closings_.begin(), closings_.end());
    std::erase_if(closings_, [&](std::uint32_t slot) {
      const model::Closing& c = model.closings[slot];
      const std::uint32_t a = node_of_ring[model.particles[c.p].ring], b = node_of_ring[model.particles[c.q].ring];
      if (a == none || b == none) return true;
      distances.push_back({{a, b}, c.distance, c.distance});
      return false;
    });
  }
  auto& affines = std::get<solver::ConstraintPool<solver::AffineConstraint>>(problem_.constraints).items;
  for (std::uint32_t node = 0; node < n; ++node) {
    if (!pinned_[node]) continue;
    solver::AffineConstraint nail;
    nail.nodes[0] = node, nail.weights[0] = 1, nail.count = 1;
    affines.push_back(nail);
    nails_.push_back(node);
  }
  if (model.constraints.size() > 0) add_joints(model, node_of_ring);
  if (model.bonds.size() > 0) add_bonds(model, node_of_ring);
  model.grips.for_each([&](std::uint32_t slot, const model::Grip& g) {
    if (!is_free(model.bodies[g.body].kind)) return;
    solver::GripForce force;
    for (std::uint32_t i = 0; i < g.count; ++i) {
      const std::uint32_t node = node_of_ring[model.particles[g.points[i]].ring];
      if (node == none) return;
      force.arm.nodes[i] = node, force.arm.weights[i] = g.weights[i];
    }
    force.arm.count = g.count;
    std::get<solver::ForcePool<solver::GripForce>>(problem_.forces).items.push_back(force);
    grips_.push_back(slot);
    // A hand feels the body it holds and, through the hinges, part of what hangs on it: enough to lift it all.
    const double own = model.body_mass(g.body);
    grip_masses_.push_back(own + 0.5 * (total_mass - own));
  });
  integrator_.compile(problem_);
  for (const std::uint32_t ring : rings_) node_of_ring[ring] = none;
}

void Island::carry_along(Model& model) {
  // What a static body holds is nailed where the body was put: held where it is, it would creep under its load.
  constexpr double creep = 1e-7;  // m: farther, and somebody has moved it
  for (const std::uint32_t node : nails_) {
    const Ring& r = model.rings[rings_[node]];
    model::Nail& nail = model.nails.at(rings_[node]);
    if (!r.nailed && norm(r.position - nail.position) > creep) nail.position = nail.position_before = r.position;
  }
  bool differs = false;
  std::vector<Vec3> impulses;
  for (std::size_t i = 0; i < slaves_.size(); ++i) {
    const Vec3 v = model.velocity(slaves_[i]), ahead = v - model.carried(slaves_[i]).second;
    if (norm(ahead) <= 1e-12 * norm(v)) continue;
    if (!differs) impulses.assign(rings_.size(), Vec3{});
    differs = true;
    for (const auto& [node, weight] : slave_nodes_[i])
      if (weight != 0) impulses[node] += (weight * model.particles[slaves_[i]].mass) * ahead;
  }
  if (!differs || idle_) {
    store_carried(model);
    return constraint_rows_.refresh_coordinates(model);  // a new basis may have its places a little elsewhere
  }
  load(model, 0);
  integrator_.project_velocities(problem_, 0, impulses);
  store(model, 0);
}

void Island::load(const Model& model, double h) {
  problem_.gravity = model.acting_gravity();
  for (std::size_t i = 0; i < rings_.size(); ++i) {
    const Ring& r = model.rings[rings_[i]];
    problem_.position[i] = r.position;
    problem_.velocity[i] = r.velocity;
  }
  load_pushes(model);
  load_bonds(model, h);
  auto& distances = std::get<solver::ConstraintPool<solver::DistanceConstraint>>(problem_.constraints);
  for (std::size_t i = 0; i < rigid_rows_.size(); ++i)
    distances.multipliers[i] = model.row(rigid_rows_[i].body, rigid_rows_[i].row).multiplier;
  for (std::size_t i = 0; i < closings_.size(); ++i) {
    const model::Closing& c = model.closings[closings_[i]];
    const std::size_t k = rigid_rows_.size() + i;
    distances.multipliers[k] = c.multiplier;
    distances.items[k].length = c.distance * closing_factor(c.elapsed + h, c.duration);
  }
  auto& affines = std::get<solver::ConstraintPool<solver::AffineConstraint>>(problem_.constraints);
  for (std::size_t i = 0; i < tied_.size(); ++i)
    std::copy_n(model.ties.at(tied_[i]).multiplier.begin(), 3, affines.multiplier(i));
  for (std::size_t i = 0; i < nails_.size(); ++i) {
    const std::uint32_t ring = rings_[nails_[i]];
    const model::Nail& from = model.nails.at(ring);
    auto& nail = affines.items[tied_.size() + i];
    nail.target = from.position;
    nail.target_start = model.rings[ring].nailed && h > 0 ? from.position_before : nail.target;
    double* const l = affines.multiplier(tied_.size() + i);
    l[0] = from.multiplier.x, l[1] = from.multiplier.y, l[2] = from.multiplier.z;
  }
  constraint_rows_.load(model, problem_);
  auto& grips = std::get<solver::ForcePool<solver::GripForce>>(problem_.forces).items;
  for (std::size_t i = 0; i < grips_.size(); ++i) {
    const model::Grip& g = model.grips[grips_[i]];
    const double omega = 2 * std::numbers::pi * g.frequency, mass = grip_masses_[i];
    grips[i].arm.origin = g.target;
    // The cap makes the spring constant-force far away: stiffness is what gives the capped force at this distance.
    const double distance = norm(grips[i].arm.value(problem_.position.data()));
    grips[i].stiffness = mass * std::min(omega * omega, g.max_acceleration / (distance + 1e-12));
    grips[i].damping = 2 * mass * omega;
  }
}

void Island::load_pushes(const Model& model) {
  problem_.force.clear();
  if (model.pushes.is_empty()) return;
  const auto add = [&](std::uint32_t node, const Vec3& force) {
    if (force == Vec3{}) return;
    if (problem_.force.empty()) problem_.force.resize(problem_.size());
    problem_.force[node] += force;
  };
  for (std::uint32_t node = 0; node < rings_.size(); ++node) add(node, model.pushes[rings_[node]].force);
  for (std::size_t i = 0; i < slaves_.size(); ++i) {  // forces on carried particles act through the basis
    const Vec3& f = model.pushes[model.particles[slaves_[i]].ring].force;
    for (const auto& [node, weight] : slave_nodes_[i])
      if (weight != 0) add(node, weight * f);
  }
}

void Island::store_carried(Model& model) const {
  for (const std::uint32_t p : slaves_) {
    Ring& r = model.rings[model.particles[p].ring];
    std::tie(r.position, r.velocity) = model.carried(p);
  }
}

// Means over the step, taken where the scheme takes forces, at its end or half way, and before velocities are damped.
void Island::store_hands(Model& model, double h) const {
  const auto& hands = std::get<solver::ForcePool<solver::GripForce>>(problem_.forces).items;
  for (std::size_t i = 0; i < hands.size(); ++i) {
    const solver::ForceArm& arm = hands[i].arm;
    Vec3 moved;
    for (std::uint32_t k = 0; k < arm.count; ++k)
      moved += arm.weights[k] * (problem_.position[arm.nodes[k]] - model.rings[rings_[arm.nodes[k]]].position);
    const Vec3 at = arm.value(problem_.position.data()) - (model.steps_to_end_point() ? 0 : 0.5) * moved;
    model.grips[grips_[i]].force = -hands[i].stiffness * at - (hands[i].damping / h) * moved;
  }
}

void Island::store(Model& model, double h) {
  const bool stepped = h > 0;
  if (stepped) store_hands(model, h);
  const bool any_pushed = stepped && !model.pushes.is_empty();
  const auto put = [&](std::uint32_t ring, const Vec3& position, const Vec3& velocity) {
    Ring& r = model.rings[ring];
    if (stepped) r.acceleration = (1 / h) * (velocity - r.velocity);
    if (any_pushed)
      if (model::Push* const push = model.pushes.find(ring)) push->before = std::exchange(push->force, Vec3{});
    r.position = position, r.velocity = velocity;
  };
  for (std::size_t i = 0; i < rings_.size(); ++i) put(rings_[i], problem_.position[i], problem_.velocity[i]);
  for (const std::uint32_t p : slaves_) {
    const auto [position, velocity] = model.carried(p);
    put(model.particles[p].ring, position, velocity);
  }
  if (!stepped) return constraint_rows_.refresh_coordinates(model);
  const auto& distances = std::get<solver::ConstraintPool<solver::DistanceConstraint>>(problem_.constraints);
  for (std::size_t i = 0; i < rigid_rows_.size(); ++i)
    model.row(rigid_rows_[i].body, rigid_rows_[i].row).multiplier = distances.multipliers[i];
  for (std::size_t i = 0; i < closings_.size(); ++i)
    model.closings[closings_[i]].multiplier = distances.multipliers[rigid_rows_.size() + i];
  const auto& affines = std::get<solver::ConstraintPool<solver::AffineConstraint>>(problem_.constraints);
  for (std::size_t i = 0; i < tied_.size(); ++i)
    std::copy_n(affines.multiplier(i), 3, model.ties.at(tied_[i]).multiplier.begin());
  for (std::size_t i = 0; i < nails_.size(); ++i) {
    model::Nail& nail = model.nails.at(rings_[nails_[i]]);
    const double* const l = affines.multiplier(tied_.size() + i);
    nail.multiplier = {l[0], l[1], l[2]};
    nail.position_before = nail.position;
  }
  constraint_rows_.store(model, problem_);
}

bool Island::nails_move(const Model& model) const {
  return std::any_of(nails_.begin(), nails_.end(), [&](std::uint32_t node) {
    const Ring& r = model.rings[rings_[node]];
    const model::Nail& nail = model.nails.at(rings_[node]);
    return (r.nailed && nail.position != nail.position_before) || r.velocity != Vec3{};
  });
}

void Island::use_solver(const std::array<char, 32>& name) {
  struct Missing final : Solver {
    Ending search(NonlinearProblem&, std::span<double>, const SolverOptions&) override { return {}; }
  };
  if (name == solver_name_) return;
  solver_name_ = name;
  solver_.reset();
  if (name[0] != 0) {
    try {
      solver_ = make_solver(name.data());
    } catch (const std::exception&) {  // a snapshot of another process: reported as one that finds nothing
      solver_ = std::make_unique<Missing>();
    }
  }
  integrator_.set_external(solver_.get());
}

solver::AdvanceReport Island::advance(Model& model, double h, IntegrationMode mode) {
  if ((idle_ && !nails_move(model)) || stays_at_rest(model)) return {};
  load(model, h);
  // The mid-point rule would carry a jump of a nail's velocity along for ever, as a ringing of the reactions.
  auto& nails = std::get<solver::ConstraintPool<solver::AffineConstraint>>(problem_.constraints).items;
  const auto nail_velocity = [&](std::size_t i) {
    return (1 / h) * (nails[tied_.size() + i].target - nails[tied_.size() + i].target_start);
  };
  const auto energy = [&] { return problem_.kinetic_energy() + problem_.potential_energy(problem_.position.data()); };
  const auto jolt = [&] {  // how much the nails' velocities differ from what they are about to be
    double largest = 0;
    for (std::size_t i = 0; i < nails_.size(); ++i)
      largest = std::max(largest, norm(nail_velocity(i) - problem_.velocity[nails_[i]]));
    return largest;
  };
  const auto take_nails_along = [&] {
    for (std::size_t i = 0; i < nails_.size(); ++i) problem_.velocity[nails_[i]] = nail_velocity(i);
  };
  double given = 0;  // by the nails at once, J
  if (idle_) {       // carried by the script: there is nothing to solve
    solver::AdvanceReport report;
    report.external_work -= energy();
    take_nails_along();
    for (std::size_t i = 0; i < nails_.size(); ++i) problem_.position[nails_[i]] = nails[tied_.size() + i].target;
    report.external_work += energy();
    store(model, h);
    return report;
  }
  use_solver(model.solver);
  const double virtual_before = virtual_energy(model);
  if (jolt() > 1e-9) {
    given -= problem_.kinetic_energy();
    take_nails_along();
    integrator_.project_velocities(problem_, h);
    given += problem_.kinetic_energy();
  }
  model::Articulate& articulate = model.articulates[model.bodies[bodies_.front()].articulate];
  problem_.standing_gap = articulate.standing_gap, problem_.standing_steps = articulate.standing_steps;
  auto report = integrator_.advance(problem_, h, care_of(mode));
  articulate.standing_gap = problem_.standing_gap, articulate.standing_steps = problem_.standing_steps;
  if (jolt() > 0) {  // where there was no solution
    given -= problem_.kinetic_energy();
    take_nails_along();
    given += problem_.kinetic_energy();
  }
  report.external_work += given;
  if (!node_damping_.empty() || model.damping > 0) {
    const double before = problem_.kinetic_energy();
    for (std::size_t i = 0; i < rings_.size(); ++i)
      problem_.velocity[i] *= std::exp(-(model.damping + (node_damping_.empty() ? 0 : node_damping_[i])) * h);
    report.dissipated += before - problem_.kinetic_energy() + damp_spins(model, h);
  }
  store_spins(model, h);
  store(model, h);
  report.dissipated += virtual_energy(model) - virtual_before;
  report.converged = report.converged && meets_pinned_rows(model);
  tire(model, h, report);
  return report;
}

bool Island::meets_pinned_rows(const Model& model) const {
  constexpr double met = 1e-6;  // of the body's extent
  const bool rows = std::all_of(pinned_rows_.begin(), pinned_rows_.end(), [&](const RigidRow& r) {
    const Body& body = model.bodies[r.body];
    const auto [i, j] = model::basis_pairs[r.row];
    const double length = norm(model.position(body.basis[j]) - model.position(body.basis[i]));
    const double wanted = model.row(r.body, r.row).length;
    return std::abs(length - wanted) <= met * wanted;
  });
  return rows && constraint_rows_.meets_pinned(model) &&
         std::all_of(pinned_ties_.begin(), pinned_ties_.end(), [&](std::uint32_t p) {
           const double extent = model.extent(model.particles[p].body);
           return norm(model.carried(p).first - model.position(p)) <= met * (extent > 0 ? extent : 1);
         });
}

bool Island::settle(Model& model, bool positions) {
  if (!bodies_.empty()) model.articulates[model.bodies[bodies_.front()].articulate].standing_gap = 0;  // try again
  load(model, 0);
  bool met = true;
  if (idle_) {
    std::fill(problem_.velocity.begin(), problem_.velocity.end(), Vec3{});
  } else {
    met = !positions || integrator_.project_positions(problem_);
    integrator_.project_velocities(problem_);
  }
  store(model, 0);
  if (positions && !idle_)
    for (const std::uint32_t node : nails_) {
      model::Nail& nail = model.nails.at(rings_[node]);
      nail.position_before = nail.position;
    }
  return met;
}

}  // namespace iota::step
