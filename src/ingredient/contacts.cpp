// SPDX-License-Identifier: Apache-2.0
#include "ingredient/contacts.h"

#include "base/text.h"
#include "ingredient/model.h"
#include "math/mat3.h"
#include "model/basis_weights.h"
#include "solver/largest.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace iota::ingredient {

namespace {

/// Shares of the natural compliance of a row, h^2 sum w^2/m. The first makes the forces of a box on four corners unique, and lets
/// it sink by 1e-8 of the way that it would fall in a step. The second keeps Newton's method from cycling between sticking
/// and slipping corners; a contact that sticks yields by a hundredth of that way, once (docs/contact.md).
constexpr double normal_softness = 1e-8, tangent_softness = 1e-2;
/// An overlap of a body that nothing else holds falls to a third in this time, s. A deeper one, in sizes of the body, is
/// left alone.
constexpr double easing_time = 0.1, deepest = 0.1;

Vec3 place_of(const Contact& c, const std::array<double, 4>& weights, const auto& position) {
  Vec3 sum;
  for (std::uint32_t i = 0; i < c.count; ++i) sum += weights[i] * position(c.points[i]);
  return sum;
}

bool has_basis(const Contact& c, const model::Body& body) {
  return c.count == body.rank && std::equal(body.basis.begin(), body.basis.begin() + body.rank, c.points.begin());
}

void take_basis(Contact& c, const model::Body& body) {
  c.points = {}, c.count = body.rank;
  std::copy_n(body.basis.begin(), body.rank, c.points.begin());
}

/// The turn of a body in the first half of a step of the mid-point rule, by tan(w h/2).
class HalfTurn {
 public:
  HalfTurn(const Vec3& spin, double h) : tangent_(0.5 * h * norm(spin)), axis_(spin) {
    if (tangent_ > 0) axis_ = (1 / norm(spin)) * spin;
  }
  /// The place now of the point of the body that will be at `arm` in the middle of the step. It is a little further out, so
  /// that its chord is as long as the way that the body rolls in this time: else what rolls slips by w^2 h^2/8 of it.
  Vec3 back(const Vec3& arm) const {
    const Vec3 along = dot(axis_, arm) * axis_, across = arm - along;
    return along + across - tangent_ * cross(axis_, across);
  }

 private:
  double tangent_;
  Vec3 axis_;
};

void set_weights(solver::ContactConstraint& row, const Contact& c) {
  row.weights = {};
  std::copy(c.center.begin(), c.center.end(), row.weights[0].begin());
  std::copy(c.place.begin(), c.place.end(), row.weights[1].begin());
}

/// Whether only contacts hold a body: easing out an overlap might pull others out of their places.
bool is_on_its_own(const Model& model, std::uint32_t body) {
  if (model.articulates[model.bodies[body].articulate].count != 1) return false;
  bool is_held = false;
  model.for_each_particle_of(body, [&](std::uint32_t p) {
    is_held = is_held || model.rings[model.particles[p].ring].nailed;
    for_each_type<Ingredients>([&]<class I>() {
      if constexpr (!std::is_same_v<I, Contacts>) is_held = is_held || I::holds(model, p);
    });
  });
  return !is_held;
}

bool is_same(const Contact& c, const Contacts::Found& found) {
  return c.other == found.other && c.part == found.touch.part && c.feature == found.touch.feature;
}

}  // namespace

void Contacts::take(Model& model, std::uint32_t body, std::span<const Found> found, const Motion& motion) {
  const model::Body& b = model.bodies[body];
  bool has_changed = false;
  thread_local std::vector<std::uint32_t> former;
  former.clear();
  model.contacts.for_each_of(body, [&](std::uint32_t slot, const Contact&) { former.push_back(slot); });
  for (const std::uint32_t slot : former)
    if (std::none_of(found.begin(), found.end(), [&](const Found& f) { return is_same(model.contacts[slot], f); }))
      model.contacts.destroy(slot), has_changed = true;
  if (!found.empty()) {
    const model::BasisWeights weights(model, body);
    const HalfTurn half(motion.spin, motion.h);
    for (const Found& f : found) {
      const auto known = std::find_if(former.begin(), former.end(), [&](std::uint32_t slot) {
        return model.contacts.is_alive(slot) && is_same(model.contacts[slot], f);
      });
      const bool is_new = known == former.end();
      if (is_new && f.touch.gap < -deepest * motion.size) continue;
      const std::uint32_t slot = is_new ? model.contacts
                                              .create({.body = body,
                                                       .other = f.other,
                                                       .part = f.touch.part,
                                                       .feature = f.touch.feature,
                                                       .depth = std::min(0.0, f.touch.gap)})
                                              .slot
                                        : *known;
      has_changed = has_changed || is_new;
      Contact& c = model.contacts[slot];
      has_changed = has_changed || !has_basis(c, b);
      take_basis(c, b);
      const Vec3 arm = half.back(f.touch.place - f.touch.center);
      c.center = weights.of(f.touch.center), c.place = weights.of(f.touch.center + arm);
      c.origin = f.touch.origin, c.normal = f.touch.normal, c.radius = f.touch.radius;
      c.friction = std::sqrt(model.material(body)->friction * model.material(f.other)->friction);
      const Vec3 velocity = place_of(c, c.center, [&](std::uint32_t p) { return model.velocity(p); });
      c.approach = c.force == Vec3{} ? std::max(0.0, -dot(c.normal, velocity)) : 0;
      if (c.depth < 0)
        c.depth = std::max(std::min(0.0, f.touch.gap),
                           is_on_its_own(model, body) ? c.depth * std::exp(-motion.h / easing_time) : c.depth);
    }
  }
  if (has_changed) model.touch_rows(body);
}

void Contacts::end(Model& model, std::uint32_t body) {
  if (model.contacts.size() == 0) return;
  std::vector<std::uint32_t> ended;
  model.contacts.for_each_of(body, [&](std::uint32_t slot, const Contact&) { ended.push_back(slot); });
  for (const std::uint32_t slot : ended) model.contacts.destroy(slot);
  if (!ended.empty()) model.touch_rows(body);
}

void Contacts::forget_body(Model& model, std::uint32_t body) {
  if (model.contacts.size() == 0) return;
  std::vector<std::uint32_t> ended;
  model.contacts.for_each([&](std::uint32_t slot, const Contact& c) {
    if (c.body == body || c.other == body) ended.push_back(slot);
  });
  for (const std::uint32_t slot : ended) {
    const std::uint32_t of = model.contacts[slot].body;
    model.contacts.destroy(slot);
    if (of != body) model.touch_rows(of);
  }
}

void Contacts::drop(Model& model, std::uint32_t particle) { end(model, model.particles[particle].body); }

void Contacts::absorb(Model& model, std::uint32_t q, std::uint32_t) { drop(model, q); }

// The body may have another basis, in the same place.
void Contacts::prepare(Model& model, std::uint32_t body) {
  const model::Body& b = model.bodies[body];
  std::optional<model::BasisWeights> weights;
  model.contacts.for_each_of(body, [&](std::uint32_t slot, const Contact& seen) {
    if (has_basis(seen, b)) return;
    Contact& c = model.contacts[slot];
    const auto position = [&](std::uint32_t p) { return model.position(p); };
    const Vec3 center = place_of(c, c.center, position), place = place_of(c, c.place, position);
    if (!weights) weights.emplace(model, body);
    take_basis(c, b);
    c.center = weights->of(center), c.place = weights->of(place);
  });
}

bool Contacts::holds(const Model& model, std::uint32_t particle) {
  return model.contacts.has_any(model.particles[particle].body);
}

void Contacts::build(const IslandMap& map, Problem& problem) {
  const Model& model = map.model;
  if (model.contacts.size() == 0) return;
  for (const std::uint32_t body : map.bodies)
    model.contacts.for_each_of(body, [&](std::uint32_t slot, const Contact& c) {
      solver::ContactConstraint row;
      for (std::uint32_t i = 0; i < c.count; ++i) {
        const std::uint32_t node = map.node_of(c.points[i]);
        if (node == none) return;  // inactive
        row.nodes[i] = node;
      }
      row.count = c.count;
      set_weights(row, c);  // they tell the problem which arms are places of the world: Problem::set_origin
      problem.add(row, {owner, {}, slot});
    });
}

void Contacts::load(const Model& model, const IslandNodes&, double h, Problem& problem) {
  if (!problem.has_used<solver::ContactConstraint>()) return;
  auto& rows = problem.pool_of<solver::ContactConstraint>();
  for_each_item_of<solver::ContactConstraint>(owner, problem, [&](std::size_t i, solver::ItemKey key) {
    const Contact& c = model.contacts[key.slot];
    solver::ContactConstraint& row = rows.items[i];
    set_weights(row, c);
    double of_center = 0, of_place = 0, size = 0;
    for (std::uint32_t k = 0; k < c.count; ++k) {
      of_center += c.center[k] * c.center[k] / problem.mass[row.nodes[k]];
      of_place += c.place[k] * c.place[k] / problem.mass[row.nodes[k]];
      size = std::max(size, norm(problem.position[row.nodes[k]] - problem.position[row.nodes[0]]));
    }
    const Vec3 first = any_perpendicular(c.normal), second = cross(c.normal, first);
    row.set_world_plane(c.origin - problem.origin, c.normal, first, second);
    row.radius = c.radius + c.depth;
    row.friction = c.friction;
    row.normal_compliance = normal_softness * h * h * of_center;
    row.compliance = tangent_softness * h * h * of_place;
    row.reference = std::max({size, c.radius, 1e-9});
    double* const l = rows.multiplier(i);
    l[0] = -dot(c.force, c.normal), l[1] = -dot(c.force, first), l[2] = -dot(c.force, second);
  });
}

void Contacts::store(Model& model, const IslandNodes&, double, const Problem& problem) const {
  if (!problem.has_used<solver::ContactConstraint>()) return;
  const auto& rows = problem.pool_of<solver::ContactConstraint>();
  for_each_item_of<solver::ContactConstraint>(owner, problem, [&](std::size_t i, solver::ItemKey key) {
    const double* const l = rows.multiplier(i);
    const solver::ContactConstraint& row = rows.items[i];
    Contact& c = model.contacts[key.slot];
    c.force = -(l[0] * row.constant[2] + l[1] * row.constant[3] + l[2] * row.constant[4]);
    c.energy = solver::strain_energy(row, l);
  });
}

Vec3 Contacts::place(const Model& model, const Contact& c) {
  return place_of(c, c.center, [&](std::uint32_t p) { return model.position(p); }) - c.radius * c.normal;
}

Impact Contacts::hardest_impact(const Model& model) {
  Impact hardest;
  model.contacts.for_each([&](std::uint32_t, const Contact& c) {
    if (c.approach > hardest.speed && c.force != Vec3{}) hardest = {place(model, c), c.approach};
  });
  return hardest;
}

namespace {

/// visit(contact): of all bodies, or of one.
template <class Visit>
void for_each_contact(const Scope& scope, Visit visit) {
  const auto& contacts = scope.model.contacts;
  const auto each = [&](std::uint32_t, const Contact& c) { visit(c); };
  if (scope.is_whole())
    contacts.for_each(each);
  else
    scope.for_each_body([&](std::uint32_t body, const model::Body&) { contacts.for_each_of(body, each); });
}

}  // namespace

double Contacts::worst_gap(const Scope& scope) {
  solver::Largest worst;
  for_each_contact(scope, [&](const Contact& c) {
    const Vec3 center = place_of(c, c.center, [&](std::uint32_t p) { return scope.model.position(p); });
    worst.add(std::max(0.0, c.radius + c.depth - dot(c.normal, center - c.origin)));
  });
  return worst.value;
}

void Contacts::add_energy(const Scope& scope, Energies& sum) {
  for_each_contact(scope, [&](const Contact& c) { sum.potential += c.energy; });
}

void Contacts::add_loads(const LastStep& step, std::uint32_t body, LoadReader& reader) {
  step.model.contacts.for_each_of(body, [&](std::uint32_t, const Contact& c) {
    const Vec3 push = dot(c.force, c.normal) * c.normal, friction = c.force - push;
    const Vec3 place = place_of(c, c.place, [&](std::uint32_t p) { return step.place(p); });
    const BodyId part = step.model.part_at(body, place);
    for (std::uint32_t i = 0; i < c.count; ++i)
      reader.take({.particle = c.points[i], .force = c.center[i] * push + c.place[i] * friction, .part = part});
  });
}

void Contacts::check_links(const Model& model, model::Audit& audit) {
  model.contacts.for_each([&](std::uint32_t slot, const Contact& c) {
    audit.require(model.bodies.is_alive(c.body) && model.bodies.is_alive(c.other), "contact ", slot,
                  " is of no living bodies");
    audit.require(c.count >= 1 && c.count <= c.points.size(), "contact ", slot, " refers to ", c.count, " points");
    for (std::uint32_t i = 0; i < std::min<std::size_t>(c.count, c.points.size()); ++i)
      audit.require(model.particles.is_alive(c.points[i]), "contact ", slot,
                    " refers to a particle that does not exist");
  });
}

void Contacts::validate(const Model& model, model::Audit& audit) {
  model.contacts.for_each([&](std::uint32_t slot, const Contact& c) {
    bool is_listed = false;
    model.contacts.for_each_of(c.body, [&](std::uint32_t other, const Contact&) { is_listed |= other == slot; });
    audit.require(is_listed, "contact ", slot, " is not listed at its body");
    for (std::uint32_t i = 0; i < c.count; ++i)
      audit.require(model.particles[c.points[i]].body == c.body, "contact ", slot,
                    " refers to a particle of another body");
    audit.require(is_finite(c.force) && std::abs(dot(c.normal, c.normal) - 1) < 1e-9 && c.friction >= 0 && c.depth <= 0,
                  "contact ", slot, " has no valid plane, force or friction");
  });
}

std::string Contacts::name_of_row(const Model& model, solver::ItemKey key) const {
  const Contact& c = model.contacts[key.slot];
  return text("contact of body ", c.body, " with body ", c.other);
}

}  // namespace iota::ingredient
