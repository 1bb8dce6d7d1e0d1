// SPDX-License-Identifier: Apache-2.0
#include "ingredient/contact_readings.h"

#include "ingredient/model.h"
#include "model/basis_weights.h"

#include <algorithm>
#include <optional>
#include <tuple>

namespace iota::ingredient {

namespace {

constexpr double of_limit = 1e-6;  ///< friction within this of its largest value slides

/// The velocity of places of one body; that of the next contact is often the same one.
class Carrier {
 public:
  Vec3 velocity(const Model& model, std::uint32_t slot, const Vec3& place) {
    const model::Body& body = model.bodies[slot];
    if (body.kind == BodyKind::static_) return {};
    if (slot_ != slot) slot_ = slot, weights_.emplace(model, slot);
    const std::array<double, 4> weights = weights_->of(place);
    Vec3 sum;
    for (std::size_t i = 0; i < body.rank; ++i) sum += weights[i] * model.velocity(body.basis[i]);
    return sum;
  }

 private:
  std::uint32_t slot_ = none;
  std::optional<model::BasisWeights> weights_;
};

ContactPoint read(const Model& model, const Contact& c, std::uint32_t body, Carrier (&carriers)[2]) {
  const bool is_point = c.p == body;
  const double sign = is_point ? 1 : -1;
  const std::uint32_t other = is_point ? c.q : c.p;
  ContactPoint point;
  point.body = model.bodies.id(body), point.other = model.bodies.id(other);
  point.position = Contacts::place(model, c);
  point.normal = sign * c.normal, point.force = sign * c.mean_force();
  point.gap = Contacts::gap(model, c);
  const Vec3 relative = carriers[0].velocity(model, body, point.position) -
                        carriers[1].velocity(model, other, point.position) - sign * c.drift;
  point.slip = norm(relative - dot(relative, c.normal) * c.normal);
  const double edge = c.friction * c.push, drag = norm(c.drag);
  const bool holds = c.static_friction > c.friction && drag > (1 + of_limit) * edge;
  point.slides = drag >= (1 - of_limit) * edge && !holds;
  return point;
}

}  // namespace

ContactPair pair_of(const Model& model, const Contact& c) {
  const auto is_fixed = [&](std::uint32_t body) { return model.bodies[body].kind == BodyKind::static_; };
  const bool is_turned = is_fixed(c.p) != is_fixed(c.q) ? is_fixed(c.p) : c.q < c.p;
  return is_turned ? ContactPair{c.q, c.p} : ContactPair{c.p, c.q};
}

std::vector<ContactPoint> contact_points(const Model& model) {
  std::vector<std::tuple<ContactPair, std::uint32_t>> order;
  model.contacts.for_each([&](std::uint32_t slot, const Contact& c) {
    if (c.mean_force() != Vec3{}) order.emplace_back(pair_of(model, c), slot);
  });
  std::sort(order.begin(), order.end());
  std::vector<ContactPoint> points;
  points.reserve(order.size());
  Carrier carriers[2];
  for (const auto& [pair, slot] : order) points.push_back(read(model, model.contacts[slot], pair.body, carriers));
  return points;
}

std::vector<ContactPoint> contact_points(const Model& model, std::uint32_t body) {
  std::vector<std::uint32_t> slots;
  model.contacts.for_each_of(body, [&](std::uint32_t slot) {
    if (model.contacts[slot].mean_force() != Vec3{}) slots.push_back(slot);
  });
  std::sort(slots.begin(), slots.end());
  std::vector<ContactPoint> points;
  Carrier carriers[2];
  for (const std::uint32_t slot : slots) points.push_back(read(model, model.contacts[slot], body, carriers));
  return points;
}

Vec3 contact_force(const Model& model, std::uint32_t body, std::uint32_t other) {
  std::vector<std::uint32_t> slots;
  model.contacts.for_each_of(body, [&](std::uint32_t slot) {
    if (const Contact& c = model.contacts[slot]; c.p == other || c.q == other) slots.push_back(slot);
  });
  std::sort(slots.begin(), slots.end());  // so that the sum has the same bits after a restore
  Vec3 sum;
  for (const std::uint32_t slot : slots) {
    const Contact& c = model.contacts[slot];
    sum += (c.p == body ? 1.0 : -1.0) * c.mean_force();
  }
  return sum;
}

}  // namespace iota::ingredient
