// SPDX-License-Identifier: Apache-2.0
#include "model/model.h"

#include <algorithm>
#include <cmath>

namespace iota::model {

bool Model::is_pinned(std::uint32_t ring) const {
  if (rings[ring].nailed) return true;
  bool pinned = false;
  for_each_in_ring(ring, [&](std::uint32_t p) {
    const BodyKind kind = bodies[particles[p].body].kind;
    pinned = pinned || kind == BodyKind::static_ || kind == BodyKind::scripted;
  });
  return pinned;
}

std::pair<Vec3, Vec3> Model::carried(std::uint32_t particle) const {
  const Body& body = bodies[particles[particle].body];
  const std::array<double, 4> w = weights(particle);
  Vec3 x, v;
  for (int i = 0; i < body.rank; ++i) {
    const Ring& b = rings[particles[body.basis[i]].ring];
    x += w[i] * b.position;
    v += w[i] * b.velocity;
  }
  return {x, v};
}

bool Model::follows_basis(std::uint32_t particle) const {
  if (particles[particle].basis_index >= 0) return true;
  const auto [x, v] = carried(particle);
  return norm(x - position(particle)) < 1e-9 && norm(v - velocity(particle)) < 1e-9;
}

// Energies and momenta are those of what is stepped: an inactive body has none, even where it is hinged to one that moves.

double Model::kinetic_energy() const {
  double twice = 0;
  particles.for_each([&](std::uint32_t, const Particle& p) {
    if (bodies[p.body].kind == BodyKind::inactive) return;
    const Vec3& v = rings[p.ring].velocity;
    twice += p.mass * dot(v, v);
  });
  inertia_pairs.for_each([&](std::uint32_t, const InertiaPair& i) {
    if (bodies[i.body].kind == BodyKind::inactive) return;
    const Vec3 v = velocity(i.p) - velocity(i.q);
    twice += i.inertia * dot(v, v);
  });
  attributes.for_each([&](std::uint32_t, const Attributes& a) {
    if (a.oriented && bodies[particles[a.particle].body].kind != BodyKind::inactive)
      twice += a.moment * dot(a.spin, a.spin);
  });
  spins.for_each([&](std::uint32_t body, const RodSpin&) { twice += 2 * spin_energy(body); });
  return twice / 2;
}

// Mass [A B; B A] with A + B = m/2 and A - B = m/2 + 2J = 2 It/L^2, and of a cylinder It = m L^2/12 + Ia/2.
double Model::axial_inertia(std::uint32_t slot) const {
  const Body& body = bodies[slot];
  if (body.rank != 2 || body.first_inertia == none || inertia_pairs[body.first_inertia].next != none) return 0;
  const InertiaPair& pair = inertia_pairs[body.first_inertia];
  const double mass = particles[pair.p].mass + particles[pair.q].mass, length = body.first_row.length;
  return std::max(0.0, (mass / 3 + 2 * pair.inertia) * length * length);
}

Vec3 Model::rod_axis(std::uint32_t body) const {
  const InertiaPair& pair = inertia_pairs[bodies[body].first_inertia];
  const Vec3 along = position(pair.q) - position(pair.p);
  return (1 / norm(along)) * along;
}

Vec3 Model::spin_momentum(std::uint32_t body) const {
  return spins.has(body) ? spins.at(body).momentum * rod_axis(body) : Vec3{};
}

double Model::spin_energy(std::uint32_t body) const {
  if (!spins.has(body)) return 0;
  const double momentum = spins.at(body).momentum;
  return 0.5 * momentum * momentum / axial_inertia(body);
}

void Model::set_spin(std::uint32_t body, double angular_velocity) {
  if (spins.has(body) != (angular_velocity != 0)) touch_body(body);
  if (angular_velocity == 0)
    spins.erase(body);
  else
    spins.make(body).momentum = axial_inertia(body) * angular_velocity;
}

double Model::potential_energy() const {
  double energy = 0;
  const Vec3 g = acting_gravity();
  if (g != Vec3{})
    particles.for_each([&](std::uint32_t, const Particle& p) {
      if (bodies[p.body].kind != BodyKind::inactive) energy -= p.mass * dot(g, rings[p.ring].position);
    });
  bonds.for_each([&](std::uint32_t slot, const Bond&) { energy += bond_energy(slot); });
  constraints.for_each([&](std::uint32_t slot, const Constraint&) { energy += constraint_energy(slot); });
  return energy;
}

double Model::bond_energy(std::uint32_t slot) const {
  const Bond& b = bonds[slot];
  if (!b.ties()) return 0;
  // Infinite where its ends have met, say: counts for nothing, and the next step switches it off.
  const double energy = compiled(b.law).elastic(bond_state(b), b.parameters.data()).energy;
  return std::isfinite(energy) ? energy : 0;
}

laws::PairState Model::bond_state(const Bond& b, double ahead) const {
  const Ring &p = rings[particles[b.p].ring], &q = rings[particles[b.q].ring];
  const Vec3 u = q.velocity - p.velocity, d = q.position - p.position + ahead * u;
  const double r = norm(d);
  return {r, dot(d, u) / (r + 1e-300), time, particles[b.p].mass, particles[b.q].mass};
}

Vec3 Model::bond_force(std::uint32_t slot) const {
  const Bond& b = bonds[slot];
  const laws::PairLaw& law = compiled(b.law);
  const laws::PairState state = bond_state(b);
  const Vec3 d = position(b.q) - position(b.p), u = velocity(b.q) - velocity(b.p);
  const double* const parameters = b.parameters.data();
  double along = -law.elastic(state, parameters).slope;
  if (law.has_push()) along += law.push(state, parameters).value;
  if (law.has_damping()) along += law.damping(state, parameters).value;
  const double drag = law.has_drag() ? law.drag(state, parameters) : 0;
  return (along / (state.r + 1e-300)) * d - drag * u;
}

double Model::constraint_energy(std::uint32_t slot) const {
  const Constraint& c = constraints[slot];
  double energy = 0;
  for (std::size_t i = 0; i < c.options.size() && c.active; ++i) {
    const double stretch = c.coordinate[i] - c.options[i].rest;
    energy += 0.5 * c.options[i].stiffness * stretch * stretch;
  }
  return energy;
}

void Model::begin_edits() {
  if (!has_edits) booked_energy = energy();
  has_edits = 1;
}

void Model::book_edits(double energy_now) {
  if (has_edits) edit_energy += energy_now - booked_energy;
  booked_energy = energy_now, has_edits = 0;
}

double Model::energy_of_edits() const { return edit_energy + (has_edits ? energy() - booked_energy : 0); }

Vec3 Model::momentum() const {
  Vec3 sum;
  particles.for_each([&](std::uint32_t, const Particle& p) {
    if (bodies[p.body].kind != BodyKind::inactive) sum += p.mass * rings[p.ring].velocity;
  });
  return sum;
}

Vec3 Model::angular_momentum() const {
  Vec3 sum;
  particles.for_each([&](std::uint32_t, const Particle& p) {
    if (bodies[p.body].kind == BodyKind::inactive) return;
    sum += p.mass * cross(rings[p.ring].position, rings[p.ring].velocity);
  });
  inertia_pairs.for_each([&](std::uint32_t, const InertiaPair& i) {
    if (bodies[i.body].kind == BodyKind::inactive) return;
    sum += i.inertia * cross(position(i.p) - position(i.q), velocity(i.p) - velocity(i.q));
  });
  attributes.for_each([&](std::uint32_t, const Attributes& a) {
    if (a.oriented && bodies[particles[a.particle].body].kind != BodyKind::inactive) sum += a.moment * a.spin;
  });
  spins.for_each([&](std::uint32_t body, const RodSpin&) { sum += spin_momentum(body); });
  return sum;
}

double Model::worst_gap() const {
  double worst = 0;
  const auto add = [&](double gap) {
    if (!(gap <= worst)) worst = gap;
  };
  bodies.for_each([&](std::uint32_t slot, const Body& b) {
    if (!is_free(b.kind)) return;  // nothing holds them, they are where they were put
    for (int row = 0; row < b.row_count; ++row) {
      const auto [i, j] = basis_pairs[row];
      add(std::abs(norm(position(b.basis[j]) - position(b.basis[i])) - this->row(slot, row).length));
    }
    if (b.count == b.rank) return;
    for_each_particle_of(slot, [&](std::uint32_t p) {
      if (particles[p].basis_index >= 0) return;
      add(norm(carried(p).first - position(p)));
    });
  });
  nails.for_each([&](std::uint32_t ring, const Nail& nail) {
    if (!rings[ring].nailed) return;
    bool moves = false;
    for_each_in_ring(ring, [&](std::uint32_t p) { moves = moves || is_free(bodies[particles[p].body].kind); });
    if (moves) add(norm(rings[ring].position - nail.position_before));
  });
  constraints.for_each([&](std::uint32_t, const Constraint& c) {
    if (is_in_force(*this, c)) add(c.gap);
  });
  return worst;
}

}  // namespace iota::model
