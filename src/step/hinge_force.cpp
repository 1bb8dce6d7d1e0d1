// SPDX-License-Identifier: Apache-2.0
#include "step/hinge_force.h"

#include "ingredient/joint_readings.h"


#include <tuple>

namespace iota::step {

using namespace model;

namespace {

/// The equations of motion of one body at one of its points: what is left of M a - f + G' lambda there, when the body's
/// own masses, rows and forces are all taken, comes from the bodies that it shares the point with.
class PointBalance {
 public:
  PointBalance(const Model& model, std::uint32_t particle)
      : model_(model), particle_(model.particles[particle]), slot_(particle), body_(model.bodies[particle_.body]) {
    const bool at_end = model.steps_to_end_point();
    back_ = at_end ? 0 : model.last_dt / 2;
  }

  Vec3 unbalanced() {
    if (particle_.basis_index >= 0)
      at_basis();
    else
      tied();
    implicit_bonds();
    return sum_;
  }

 private:
  /// Where the scheme takes gradients: at the end of the step, or half way, x = x1 - h (v0 + v1) / 4.
  Vec3 place(std::uint32_t p) const {
    const Ring& r = model_.rings[model_.particles[p].ring];
    return r.position - back_ * (r.velocity - back_ * r.acceleration);
  }
  /// Weight of the particle at the point; those that are unknowns of their own and no basis points have none.
  double weight(std::uint32_t p) const {
    const Particle& k = model_.particles[p];
    if (k.basis_index < 0 && model_.is_unknown(k)) return 0;
    return model_.weights(p)[static_cast<std::size_t>(particle_.basis_index)];
  }
  Vec3 pull_of_tie(std::uint32_t p) const {
    const auto& multiplier = model_.ties[p].multiplier;
    return {multiplier[0], multiplier[1], multiplier[2]};
  }
  Vec3 inertial(std::uint32_t p) const {
    const Ring& r = model_.rings[model_.particles[p].ring];
    return r.acceleration - model_.acting_gravity() + (model_.damping + body_.damping) * r.velocity;
  }

  void at_basis() {
    const auto index = static_cast<std::size_t>(particle_.basis_index);
    model_.for_each_particle_of(particle_.body, [&](std::uint32_t p) {
      const Particle& k = model_.particles[p];
      const double w = weight(p);
      if (w != 0) sum_ += (w * k.mass) * inertial(p);
      if (w != 0 && p != slot_ && k.basis_index < 0) sum_ -= w * model_.pushes[k.ring].before;
      if (k.basis_index < 0 && model_.is_unknown(k))  // its tie to the basis
        sum_ -= model_.ties[p].weights[index] * pull_of_tie(p);
      model_.for_each_constraint_of(p, [&](std::uint32_t c, int at) {
        if (const double part = model_.weights(p)[index]; part != 0) sum_ -= part * ingredient::calc_force_at(model_, c, at);
      });
    });
    model_.for_each_inertia_of(particle_.body, [&](std::uint32_t i) {
      const InertiaPair& pair = model_.inertia_pairs[i];
      const double w = weight(pair.p) - weight(pair.q);
      if (w != 0)
        sum_ += (w * pair.inertia) * (model_.rings[model_.particles[pair.p].ring].acceleration -
                                      model_.rings[model_.particles[pair.q].ring].acceleration);
      if (w != 0 && model_.spins.has(particle_.body)) sum_ += w * gyroscopic(pair);
    });
    for (int row = 0; row < body_.row_count; ++row) {
      const auto [i, j] = basis_pairs[row];
      if (i != index && j != index) continue;
      const Vec3 d = place(body_.basis[j]) - place(body_.basis[i]);
      const RigidRow& rigid = model_.row(particle_.body, row);
      sum_ += ((j == index ? 1 : -1) * rigid.multiplier / rigid.length) * d;
    }
    model_.grips.for_each([&](std::uint32_t, const Grip& g) {
      for (std::uint32_t i = 0; i < g.count; ++i) {
        if (g.body != particle_.body || g.points[i] != slot_) continue;
        sum_ -= g.weights[i] * g.force;
      }
    });
  }

  /// On the first point of a spinning rod, as in solver/forces/gyroscopic.h.
  Vec3 gyroscopic(const InertiaPair& pair) const {
    const Ring &p = model_.rings[model_.particles[pair.p].ring], &q = model_.rings[model_.particles[pair.q].ring];
    const double h = model_.last_dt;
    const Vec3 e = q.position - p.position,
               turning = q.velocity - p.velocity - back_ * (q.acceleration - p.acceleration);
    const Vec3 em = e - 0.5 * h * turning;
    return (model_.spins.at(particle_.body).momentum / (norm(e) * dot(em, em))) * cross(em, turning);
  }

  void tied() {
    sum_ += particle_.mass * inertial(slot_);
    sum_ += pull_of_tie(slot_);
  }

  void implicit_bonds() {
    model_.for_each_bond_of(slot_, [&](std::uint32_t b) {
      const Bond& bond = model_.bonds[b];
      if (bond.ties()) sum_ -= (bond.p == slot_ ? -1 : 1) * model_.bond_force(b);
    });
  }

  const Model& model_;
  const Particle& particle_;
  std::uint32_t slot_;
  const Body& body_;
  double back_ = 0;
  Vec3 sum_;
};

bool moves_freely(const Model& model, std::uint32_t particle) {
  return is_free(model.bodies[model.particles[particle].body].kind);
}

}  // namespace

Vec3 calc_hinge_force(const Model& model, std::uint32_t particle) {
  const std::uint32_t slot = model.particles[particle].ring;
  const Ring& ring = model.rings[slot];
  const bool pinned = model.is_pinned(slot);
  if (ring.count == 1) return ring.nailed && moves_freely(model, particle) ? -model.nails[slot].multiplier : Vec3{};
  const Vec3& applied = model.pushes[slot].before;
  Vec3 own, all;
  int free = 0;
  model.for_each_in_ring(model.particles[particle].ring, [&](std::uint32_t p) {
    if (!moves_freely(model, p)) return;
    const Vec3 force = PointBalance(model, p).unbalanced();
    all += force, ++free;
    if (p == particle) own = force;
  });
  if (!moves_freely(model, particle)) return -(all - applied);  // it carries what the others do not
  return pinned ? own - (1.0 / free) * applied : own - (1.0 / free) * all;
}

}  // namespace iota::step
