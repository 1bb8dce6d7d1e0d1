// SPDX-License-Identifier: Apache-2.0
#include "held/held_force_error.h"

#include <algorithm>
#include <cmath>

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
  double worst = 0;
  model.pushes.for_each([&](std::uint32_t slot, const ingredient::Push& push) {
    const std::uint32_t first = model.rings[slot].first;
    if (first == model::none) return;
    now_[slot] = push.force - applied_[slot];
    const model::Body& body = model.bodies[model.particles[first].body];
    // Sub-steps have the part that is linear in the velocity; single particles have none.
    const bool is_single = body.rank < 2;
    if (const auto* const part = model.pushes_by_velocity.find(slot); part && !is_single) now_[slot] -= part->force;
    const double mass = model.ring_mass(slot), length = is_single ? 1 : body.first_row.length;
    if (known_ < 2 || !(mass > 0)) return;
    const Vec3 change = now_[slot] - last_[slot], change_before = last_[slot] - earlier_[slot];
    worst = std::max(worst, (norm(change - change_before) / 24 + h * norm(change) / 12) / (mass * length));
  });
  earlier_.swap(last_), last_.swap(now_);
  ++known_;
  return worst;
}

}  // namespace iota::held
