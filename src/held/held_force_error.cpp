// SPDX-License-Identifier: Apache-2.0
#include "held/held_force_error.h"

#include "model/solid.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>
#include <vector>

namespace iota::held {

namespace {

bool is_single(const model::Model& model, std::uint32_t body) { return model.bodies[body].rank < 2; }

/// The change within a step of the forces on a body, wherever they act on it, and the change of that. A force at a point
/// without a mass of its own moves the body: by the mass of such a point the error seemed 5000 times too large.
struct Changes {
  Vec3 force, second_force;    ///< N
  Vec3 moment, second_moment;  ///< about the first point of its basis, N m
};

Vec3 first_point(const model::Model& model, std::uint32_t body) { return model.position(model.bodies[body].basis[0]); }

/// Bodies that share a point share what pushes it, by their masses.
void add_change(const model::Model& model, std::uint32_t ring, const Vec3& change, const Vec3& second_change,
                std::span<Changes> changes) {
  double mass = 0;
  const bool is_shared = model.rings[ring].count > 1;
  if (is_shared)
    model.for_each_in_ring(ring, [&](std::uint32_t p) { mass += model.body_mass(model.particles[p].body); });
  model.for_each_in_ring(ring, [&](std::uint32_t p) {
    const std::uint32_t body = model.particles[p].body;
    const double share = is_shared ? model.body_mass(body) / mass : 1;
    const Vec3 first = share * change, second = share * second_change;
    Changes& c = changes[body];
    c.force += first, c.second_force += second;
    if (is_single(model, body)) return;
    const Vec3 arm = model.position(p) - first_point(model, body);
    c.moment += cross(arm, first), c.second_moment += cross(arm, second);
  });
}

/// In lengths per second: of its center and, by its turning, of the farthest of its points.
double error_of_body(const model::Model& model, std::uint32_t body, const Changes& c, double h) {
  if ((c.force == Vec3{} && c.second_force == Vec3{}) || !model::is_free(model.bodies[body].kind)) return 0;
  const double mass = model.body_mass(body);
  if (!(mass > 0)) return 0;
  const auto error = [&](const Vec3& first, const Vec3& second) { return norm(second) / 24 + h * norm(first) / 12; };
  const double of_center = error((1 / mass) * c.force, (1 / mass) * c.second_force);
  if (is_single(model, body)) return of_center;
  const SymmetricEigen inertia = symmetric_eigen(model::body_inertia(model, body));
  const Vec3 center = model.center_of_mass(body), arm = center - first_point(model, body);
  double farthest = 0;
  for (std::uint32_t i = 0; i < model.bodies[body].rank; ++i)
    farthest = std::max(farthest, norm(model.position(model.bodies[body].basis[i]) - center));
  const double of_turning = error(solve_semidefinite(inertia, c.moment - cross(arm, c.force), 1e-12),
                                  solve_semidefinite(inertia, c.second_moment - cross(arm, c.second_force), 1e-12));
  return (of_center + farthest * of_turning) / model.bodies[body].first_row.length;
}

}  // namespace

void HeldForceError::begin(const model::Model& model) {
  if (model.mode != IntegrationMode::accurate) return forget();
  if (structure_ != model.structure_version) forget();
  structure_ = model.structure_version;
  applied_.assign(model.rings.slot_count(), {});
  model.pushes.for_each([&](std::uint32_t ring, const ingredient::Push& push) { applied_[ring] = push.force; });
}

double HeldForceError::estimate(const model::Model& model, double h) {
  if (model.mode != IntegrationMode::accurate) return 0;
  if (h != h_) forget();
  h_ = h;
  now_.assign(applied_.size(), {});
  last_.resize(now_.size()), change_before_.resize(now_.size());
  thread_local std::vector<Changes> changes;
  changes.assign(known_ < 2 || model.pushes.is_empty() ? 0 : model.bodies.slot_count(), {});
  model.pushes.for_each([&](std::uint32_t slot, const ingredient::Push& push) {
    const std::uint32_t first = model.rings[slot].first;
    if (first == model::none) return;
    Held& now = now_[slot];
    now.force = push.force - applied_[slot];
    // Sub-steps have the part that is linear in the velocity, with a rate that is held; single particles have none.
    if (const auto* const part = model.pushes_by_velocity.find(slot);
        part && !is_single(model, model.particles[first].body))
      now.force -= part->force, now.rate = part->rate;
    if (known_ < 1) return;
    const Held& last = last_[slot];
    const Vec3 change = now.force - last.force + (now.rate + -1.0 * last.rate) * model.rings[slot].velocity;
    const Vec3 change_before = std::exchange(change_before_[slot], change);
    if (known_ >= 2) add_change(model, slot, change, change - change_before, changes);
  });
  double worst = 0;
  for (std::uint32_t body = 0; body < changes.size(); ++body)
    if (model.bodies.is_alive(body)) worst = std::max(worst, error_of_body(model, body, changes[body], h));
  last_.swap(now_);
  ++known_;
  return worst;
}

}  // namespace iota::held
