// SPDX-License-Identifier: Apache-2.0
#include "held/held_force_error.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace iota::held {

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
  double worst = 0;
  model.pushes.for_each([&](std::uint32_t slot, const ingredient::Push& push) {
    const std::uint32_t first = model.rings[slot].first;
    if (first == model::none) return;
    Held& now = now_[slot];
    now.force = push.force - applied_[slot];
    const model::Body& body = model.bodies[model.particles[first].body];
    const bool is_single = body.rank < 2;
    // Sub-steps have the part that is linear in the velocity, with a rate that is held; single particles have none.
    if (const auto* const part = model.pushes_by_velocity.find(slot); part && !is_single)
      now.force -= part->force, now.rate = part->rate;
    const double mass = model.ring_mass(slot), length = is_single ? 1 : body.first_row.length;
    if (known_ < 1) return;
    const Held& last = last_[slot];
    const Vec3 change = now.force - last.force + (now.rate + -1.0 * last.rate) * model.rings[slot].velocity;
    const Vec3 change_before = std::exchange(change_before_[slot], change);
    if (known_ < 2 || !(mass > 0)) return;
    worst = std::max(worst, (norm(change - change_before) / 24 + h * norm(change) / 12) / (mass * length));
  });
  last_.swap(now_);
  ++known_;
  return worst;
}

}  // namespace iota::held
