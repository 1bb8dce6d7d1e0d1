// SPDX-License-Identifier: Apache-2.0
#include "ingredient/contacts.h"

#include "base/prefetch.h"
#include "base/sort_unique.h"
#include "base/text.h"
#include "contact/rims.h"
#include "ingredient/model.h"
#include "math/mat3.h"
#include "model/basis_weights.h"
#include "solver/largest.h"
#include "solver/settings.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

namespace iota::ingredient {

using contact::TouchForm;

namespace {

/// Shares of the natural compliance of a row, h^2 sum w^2/m. The first makes the forces of a box on four corners unique, and lets
/// it sink by 1e-8 of the way that it would fall in a step. The second keeps Newton's method from cycling between sticking
/// and slipping corners; a contact that sticks yields by a hundredth of that way, once (docs/contact.md).
constexpr double normal_softness = 1e-8, tangent_softness = 1e-2;
/// An overlap of a body that nothing else holds falls to a third in this time, s. A deeper one, in sizes of the body, is left
/// alone, as parts of machines often begin in each other. Where nothing else holds them, two that move come out however deep they
/// are, and what moves comes out of an obstacle that its middle is not in: a ball that was put a little too low fell for ever.
constexpr double easing_time = 0.1, deepest = 0.1, deepest_of_moving = 0.3, half_buried = 0.5;

/// The part of a contact in the key of its row against spinning; 0 and 1 are those against rolling.
constexpr std::uint8_t spin_row = 2;

enum Arm : std::size_t { center, place, turned, first_tangent, second_tangent };

/// The sum of f(point) over some points, by their weights in an arm.
Vec3 sum_over(const Contact& c, Arm arm, std::uint32_t first, std::uint32_t last, const auto& f) {
  Vec3 sum;
  for (std::uint32_t i = first; i < last; ++i) sum += c.weights[arm][i] * f(c.points[i]);
  return sum;
}
auto positions_of(const Model& model) {
  return [&model](std::uint32_t p) { return model.position(p); };
}

/// Whether it moves, by itself or by the script, so that its points are in the rows of its contacts.
bool has_points(const model::Body& body) { return body.kind != BodyKind::static_; }

/// The points in the rows of its contacts.
std::span<const std::uint32_t> points_of(const model::Body& body) {
  return {body.basis.data(), has_points(body) ? std::size_t{body.rank} : 0};
}

bool has_basis(const Contact& c, const model::Body& p, const model::Body& q) {
  const auto of_p = points_of(p), of_q = points_of(q);
  return c.of_p == of_p.size() && c.point_count == of_p.size() + of_q.size() &&
         std::equal(of_p.begin(), of_p.end(), c.points.begin()) &&
         std::equal(of_q.begin(), of_q.end(), c.points.begin() + c.of_p);
}

void take_basis(Contact& c, const model::Body& p, const model::Body& q) {
  const auto of_p = points_of(p), of_q = points_of(q);
  c.points = {};
  std::copy(of_q.begin(), of_q.end(), std::copy(of_p.begin(), of_p.end(), c.points.begin()));
  c.of_p = static_cast<std::uint32_t>(of_p.size());
  c.point_count = c.of_p + static_cast<std::uint32_t>(of_q.size());
}

/// Whether it is a plane of the world, or a point of it.
bool has_world_plane(const Contact& c) { return c.point_count == c.of_p; }
bool has_world_point(const Contact& c) { return c.of_p == 0; }

/// The place of p or of q in one of the first two arms.
Vec3 place_of(const Model& model, const Contact& c, Arm arm, bool of_q) {
  const double sign = of_q ? -1 : 1;
  if (of_q ? has_world_plane(c) : has_world_point(c)) return sign * (arm == Arm::center ? c.center : c.place);
  return sign * sum_over(c, arm, of_q ? c.of_p : 0, of_q ? c.point_count : c.of_p, positions_of(model));
}

/// The extent of the larger body, m. position(i): of its points.
double extent_of(const Contact& c, auto position) {
  double extent = 0;
  for (std::uint32_t i = 0; i < c.point_count; ++i)
    extent = std::max(extent, norm(position(i) - position(i < c.of_p ? 0 : c.of_p)));
  return std::max({extent, c.radius, 1e-9});
}

/// Whether only contacts hold a body: easing out an overlap might pull others out of their places.
bool is_on_its_own(const Model& model, std::uint32_t body) {
  if (!is_free(model.bodies[body].kind)) return true;
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

/// Whether an overlap of two bodies is eased out.
bool is_eased(const Model& model, std::uint32_t first, std::uint32_t second) {
  return is_on_its_own(model, first) && is_on_its_own(model, second);
}

/// by_motion: in a heap some contact begins or ends in nearly each step, which would keep it awake for ever. How fast it is
/// tells whether it moves.
void mark(Model& model, const model::Ends& c, bool by_motion) {
  const auto sleeps = [&](std::uint32_t body) {
    return model.bodies.is_alive(body) && model.bodies[body].kind == BodyKind::resting;
  };
  const bool wakes = !by_motion || sleeps(c.p) || sleeps(c.q);
  for (const std::uint32_t body : {c.p, c.q})
    if (model.bodies.is_alive(body) && has_points(model.bodies[body])) model.mark_rows(body, wakes);
}

/// A contact that motion ends does not keep its strain. An edit between the same two steps has not taken it.
void dissipate_strain(Model& model, const Contact& c) { model.dissipated += c.energy, model.booked_energy -= c.energy; }

void destroy(Model& model, std::uint32_t slot, bool by_motion = false) {
  if (by_motion) dissipate_strain(model, model.contacts[slot]);  // of an edit it is in the account of edits
  const model::Ends ends = model.contacts[slot];
  model.contacts.destroy(slot);
  mark(model, ends, by_motion);
}

bool is_same(const Contact& c, std::uint32_t p, const contact::Touch& t) {
  return c.p == p && c.part == t.part && c.feature == t.feature && c.other_part == t.other_part &&
         c.other_feature == t.other_feature;
}

/// Whether it is not a place: see Contacts::tie.
bool is_tie(const Contact& c) { return c.feature == none && c.part == none; }

/// The basis weights of the two bodies of a contact: those that are known, or computed when they are asked for.
class Sides {
 public:
  Sides(const Model& model, std::uint32_t p, std::uint32_t q, const model::BasisWeights* of_p = nullptr,
        const model::BasisWeights* of_q = nullptr)
      : model_(model), bodies_{p, q}, known_{of_p, of_q} {}
  std::array<double, 4> of(int side, const Vec3& place) {
    if (!has_points(model_.bodies[bodies_[side]])) return {};
    if (!known_[side]) known_[side] = &weights_[side].emplace(model_, bodies_[side]);
    return known_[side]->of(place);
  }

 private:
  const Model& model_;
  std::uint32_t bodies_[2];
  const model::BasisWeights* known_[2];
  std::optional<model::BasisWeights> weights_[2];
};

/// The places of a contact of two bodies.
struct Places {
  Vec3 center, origin, point, other_point;

  /// Sets the first arm alone, which has the velocities at the center and the origin, ...
  void set_center(Contact& c, Sides& sides) const {
    c.weights = {};
    set_arm(c, Arm::center, center, origin, sides);
  }
  /// ... and all others, with the basis and the directions of the contact.
  void set_others(Contact& c, const model::Body& p, const model::Body& q, Sides& sides) const {
    set_arm(c, Arm::place, point, other_point, sides);
    c.center = c.place = {};
    if (has_world_plane(c)) c.center = -1.0 * origin, c.place = -1.0 * other_point;
    if (has_world_point(c)) c.center = center, c.place = point;
    // Directions turn with a body of three dimensions, and the axis of a rod with the rod: what depends only on places of
    // both keeps angular momentum.
    const auto set_direction = [&](Arm arm, const Vec3& direction, bool of_q) {
      const std::array<double, 4> end = sides.of(of_q, (of_q ? origin : center) + direction);
      const std::uint32_t first = of_q ? c.of_p : 0, count = of_q ? c.point_count - c.of_p : c.of_p;
      const auto& start = c.weights[Arm::center];  // those of q are negative
      for (std::uint32_t i = first; i < first + count; ++i)
        c.weights[arm][i] = end[i - first] - (of_q ? -start[i] : start[i]);
    };
    const bool with_q = !has_world_plane(c) && q.rank == 4, with_p = !has_world_point(c) && p.rank == 4;
    c.slips_turn = !has_world_plane(c) && (with_q || with_p);
    const bool has_wires = c.form == TouchForm::wires;
    if (c.slips_turn) {
      set_direction(Arm::first_tangent, c.first, with_q || has_wires);
      set_direction(Arm::second_tangent, c.second, with_q);
    }
    const bool is_axis_of_q = c.form == TouchForm::round && !has_world_plane(c) && q.rank > 1;
    c.turns = has_wires ? !has_world_point(c) : with_q || is_axis_of_q || (c.slips_turn && c.form != TouchForm::face);
    if (c.turns) set_direction(Arm::turned, c.is_round() ? c.axis : c.normal, !has_wires && (with_q || is_axis_of_q));
  }

 private:
  static void set_arm(Contact& c, Arm arm, const Vec3& of_p, const Vec3& of_q, Sides& sides) {
    const std::array<double, 4> plus = sides.of(0, of_p), minus = sides.of(1, of_q);
    std::copy_n(plus.begin(), c.of_p, c.weights[arm].begin());
    for (std::uint32_t i = c.of_p; i < c.point_count; ++i) c.weights[arm][i] = -minus[i - c.of_p];
  }
};

/// Whether the axis of a wire turns with its body: with any of three dimensions, with a rod along its own.
bool turns_with(const Model& model, const model::Body& body, const Vec3& axis) {
  constexpr double askew = 0.2;
  if (body.rank != 2) return body.rank == 4;
  const Vec3 along = model.position(body.basis[1]) - model.position(body.basis[0]);
  return norm(cross(along, axis)) <= askew * norm(along);
}

/// The velocity of the center less that of the origin, m/s.
Vec3 relative_velocity(const Model& model, const Contact& c) {
  return sum_over(c, Arm::center, 0, c.point_count, [&](std::uint32_t p) { return model.velocity(p); });
}

/// The geometry of a touch. The origin is below the center, so that a normal that turns makes no torque by itself.
void set_geometry(const Model& model, Contact& c, const contact::Touch& t, const Vec3& spin_p, const Vec3& spin_q,
                  double h, Sides& sides) {
  const model::Body &p = model.bodies[c.p], &q = model.bodies[c.q];
  take_basis(c, p, q);
  // The side of the second wire is a direction of friction, too. A rod has no places beside its axis: friction of two that turned with
  // one of them would act there at the axis of the other one.
  const bool has_wires =
      (has_world_point(c) || turns_with(model, p, t.axis)) &&
      (has_world_plane(c) || q.rank == 4 || (p.rank == 4 && turns_with(model, q, cross(t.normal, t.axis))));
  c.form = t.form == TouchForm::wires && !has_wires ? TouchForm::edges : t.form;
  c.axis = t.axis, c.bends = {t.bends[0], t.bends[1]};
  c.normal = t.normal, c.first = c.form == TouchForm::wires ? cross(c.normal, c.axis) : any_perpendicular(c.normal);
  c.second = cross(c.normal, c.first);
  c.radius = t.radius, c.ball = std::clamp(dot(t.normal, t.center - t.place), 0.0, std::max(0.0, t.radius));
  const bool is_round = c.is_round();
  Places places;
  places.center = t.center;
  places.origin = is_round ? t.origin : t.center - (t.gap + t.radius) * t.normal;
  places.point = t.center + solver::arm_before(0.5 * h * spin_p, t.place - t.center);
  // If the gap closes in this step, the two points are at one place in its middle.
  places.other_point = t.place - 0.5 * t.gap * t.normal;
  places.set_center(c, sides);
  if (!has_world_plane(c)) {  // the point of q that touches in the middle of the step
    const Vec3 closing = relative_velocity(model, c), along = closing - dot(closing, t.normal) * t.normal;
    if (is_round)
      places.other_point = t.origin + solver::arm_before(0.5 * h * spin_q, places.other_point - t.origin) +
                           (0.5 * h * (t.radius - c.ball) / t.radius) * along;
    else
      places.other_point += 0.5 * h * along;
  }
  // The place of contact runs over q's surface, and leaves behind the point that touched in the middle of the step.
  const Vec3 closing = relative_velocity(model, c);
  Vec3 run = closing - dot(closing, t.normal) * t.normal;
  if (is_round && t.radius > 0)
    run = ((t.radius - c.ball) / t.radius) * run - (t.radius - c.ball) * cross(spin_q, t.normal);
  // A scripted body goes straight and turns between its steps.
  const auto turn = [](const model::Body& body, const Vec3& spin) {
    return body.kind == BodyKind::scripted ? Vec3{} : spin;
  };
  c.pivot = -0.5 * h * dot(turn(p, spin_p) - turn(q, spin_q), t.normal) * cross(t.normal, run);
  places.set_others(c, p, q, sides);
}

/// The place where the weight of the upper one of two bodies meets a plane, from a point of it; zero if there is none.
Vec3 weight_on(const Model& model, std::uint32_t p, std::uint32_t q, const Vec3& normal, const Vec3& point) {
  const Vec3 gravity = model.acting_gravity();
  const double down = -dot(gravity, normal);
  const std::uint32_t upper = down > 0 ? p : q;
  if (!(std::abs(down) > 0) || !has_points(model.bodies[upper])) return {};
  const Vec3 center = model.center_of_mass(upper) - point;
  return center + (dot(center, normal) / down) * gravity;
}

/// A rim that lies on a plane has fixed points at a sixth of a turn from each other. Points are added beside its load of the last
/// step, and beside the place of its weight: the support is a circle, not a hexagon.
void add_loaded_points(const Model& model, std::uint32_t first, std::uint32_t second,
                       std::span<const std::uint32_t> former, std::span<const contact::Touch> touches,
                       std::vector<contact::Touch>& added) {
  for (std::size_t k = 0; k < touches.size(); ++k) {
    const contact::Touch& t = touches[k];
    const auto is_of_same = [&](const contact::Touch& other) { return contact::are_on_one_rim(other, t); };
    if (!t.rim || std::any_of(touches.begin(), touches.begin() + static_cast<std::ptrdiff_t>(k), is_of_same)) continue;
    const std::uint32_t p = t.is_turned ? second : first;
    contact::PointsOfRim points(touches, t, added);
    points.add_beside(weight_on(model, p, t.is_turned ? first : second, t.normal, t.rim->middle));
    double push = 0;
    Vec3 moment;
    for (const std::uint32_t slot : former) {
      const Contact& c = model.contacts[slot];
      if (is_tie(c) || c.p != p || c.part != t.part || c.other_part != t.other_part || !(c.push > 0)) continue;
      push += c.push, moment += c.push * (Contacts::place(model, c) - t.rim->middle);
      points.add_again(t.is_turned ? c.other_feature : c.feature);
    }
    if (push > 0) points.add_beside((1 / push) * moment);
  }
}

/// Whether a face carries its load along an edge of the polygon of its points.
bool is_on_edge(const Model& model, std::span<const std::uint32_t> slots) {
  constexpr std::size_t least = 5;  // a box on its edge has no other points
  return slots.size() >= least &&
         std::ranges::count_if(slots, [&](std::uint32_t slot) { return model.contacts[slot].push > 0; }) <= 2;
}

/// Whether it has a spin, or stands.
bool has_orientation(const model::Body& body) { return !has_points(body) || body.rank == 4; }

struct Resistance {
  double rolling, spinning;  ///< coefficients
};

/// Resistance acts at the first place where two bodies touch, by the force at all of them in the last step and the mean radius at its
/// places: a cone has another one at its tip. At one place it may roll in two directions and spin, along a line it may roll in
/// one, on a face in none.
void resist_turning(Model& model, std::span<const std::uint32_t> slots, const Resistance& by,
                    const Contacts::Motion& motion, std::uint32_t first) {
  double push = 0, moment = 0, radius = 0;
  for (const std::uint32_t slot : slots) {
    const Contact& c = model.contacts[slot];
    const double own = c.has_left() ? 0 : std::max(0.0, c.push), round = std::max(c.ball, c.radius - c.ball);
    push += own, moment += own * round, radius = std::max(radius, round);
  }
  if (push > 0) radius = moment / push;
  for (const std::uint32_t slot : slots) {
    Contact& c = model.contacts[slot];
    const bool resists = slot == slots[0] && slots.size() <= 2 && radius > 0 && has_orientation(model.bodies[c.p]) &&
                         has_orientation(model.bodies[c.q]);
    const bool rolls = resists && by.rolling > 0, spins = resists && by.spinning > 0 && slots.size() == 1;
    const std::uint32_t rolls_before =
        std::exchange(c.roll_rows, rolls ? 3 - static_cast<std::uint32_t>(slots.size()) : 0);
    const std::uint32_t spins_before = std::exchange(c.spin_rows, spins ? 1 : 0);
    if (c.roll_rows != rolls_before || c.spin_rows != spins_before) mark(model, c, true);
    if (!rolls) c.rolling = 0, c.torque = {};
    if (!spins) c.spinning = c.twist = 0;
    c.carried = rolls || spins ? push : 0;
    if (!rolls && !spins) continue;
    const Vec3 &spin_p = motion.spins[c.p != first], &spin_q = motion.spins[c.p == first];
    const Vec3 turn_of_p = 0.5 * motion.h * spin_p, turn_of_q = 0.5 * motion.h * spin_q;
    if (spins) {
      c.spinner = solver::arm_before(turn_of_p, c.first), c.spin_second = solver::arm_before(turn_of_q, c.second);
      c.spinning = by.spinning * radius;
    }
    if (!rolls) continue;
    // A slow roll keeps its direction: that of a ball at rest would be noise.
    const Vec3 way = motion.h * cross(spin_p - spin_q, c.normal);
    Vec3 along = norm(way) > 1e-6 ? way : c.roll_first;
    if (slots.size() == 2)
      along = cross(Contacts::place(model, model.contacts[slots[1]]) - Contacts::place(model, c), c.normal);
    c.roll_first = unit_or(along - dot(along, c.normal) * c.normal, c.first),
    c.roll_second = cross(c.normal, c.roll_first);
    c.roller = solver::arm_before(turn_of_p, c.normal);
    c.roll_first = solver::arm_before(turn_of_q, c.roll_first),
    c.roll_second = solver::arm_before(turn_of_q, c.roll_second);
    c.rolling = by.rolling * radius;
  }
}

}  // namespace

namespace {

/// Two bodies that touch in a step.
class Meeting {
 public:
  Meeting(Model& model, std::uint32_t first, std::uint32_t second, const Contacts::Motion& motion)
      : model_(model), first_(first), second_(second), motion_(motion) {}

  bool is_eased() const { return ingredient::is_eased(model_, first_, second_); }
  /// A contact at this gap takes its numbers from the materials, the motion and the step before.
  void renew(Contact& c, double gap) const {
    c.friction = std::sqrt(one_.friction * other_.friction);
    c.static_friction = std::sqrt(one_.largest_friction() * other_.largest_friction());
    c.restitution = std::max(one_.restitution, other_.restitution);
    c.drift = (c.p == second_ ? 1.0 : -1.0) * (one_.surface_velocity - other_.surface_velocity);
    c.found_in = model_.step + 1;
    const Vec3 across = c.drag - dot(c.drag, c.normal) * c.normal;  // the plane may have turned
    const double kept = norm(across);
    c.drag = kept > 0 ? (norm(c.drag) / kept) * across : Vec3{};
    const double approach = c.carries() ? 0 : std::max(0.0, -dot(c.normal, relative_velocity(model_, c)));
    c.approach = c.continues ? std::max(c.approach, approach) : approach;
    if (c.depth < 0) c.depth = std::max(std::min(0.0, gap), is_eased() ? eased(c) : c.depth);
  }
  void resist_turning(std::span<const std::uint32_t> slots) const {
    ingredient::resist_turning(model_, slots,
                               {std::max(one_.rolling, other_.rolling), std::max(one_.spinning, other_.spinning)},
                               motion_, first_);
  }

 private:
  /// The depth of a contact after this step, m. The solver moves places by what closes, but a gap that it takes for closed would
  /// become motion: what would close by so little closes at once, or stays if it is all that there is. A box that came out of
  /// the ground in space flew away, in `accurate` by its length in each second.
  double eased(const Contact& c) const {
    const double next = c.depth * std::exp(-motion_.h / easing_time);
    if (c.is_of_sweeps) return next;
    const double least =
        2 * solver::strained_gap * extent_of(c, [&](std::uint32_t i) { return model_.position(c.points[i]); });
    return next - c.depth >= least ? next : -c.depth < least ? c.depth : 0;
  }

  Model& model_;
  std::uint32_t first_, second_;
  const Contacts::Motion& motion_;
  const Material &one_ = *model_.material(first_), &other_ = *model_.material(second_);
};

/// Once for each body.
void tell_that_it_is_buried(Model& model, std::uint32_t first, std::uint32_t second, double depth) {
  const auto [mover, other] = has_points(model.bodies[first]) ? std::pair(first, second) : std::pair(second, first);
  if (std::ranges::find(model.told_as_buried, mover) != model.told_as_buried.end()) return;
  model.told_as_buried.push_back(mover);
  model.notes.push_back(text("body ", mover, " is ", depth, " m deep in body ", other,
                             ", over half of its size, and will pass through it; place it outside or let it ignore "
                             "that body"));
}

}  // namespace

void Contacts::take(Model& model, std::uint32_t first, std::uint32_t second, std::span<const std::uint32_t> former,
                    std::span<const contact::Touch> found, const Motion& motion) {
  thread_local std::vector<contact::Touch> added;
  added.clear();
  add_loaded_points(model, first, second, former, found, added);
  if (!added.empty()) added.insert(added.begin(), found.begin(), found.end());
  const std::span<const contact::Touch> touches = added.empty() ? found : added;
  const Meeting meeting(model, first, second, motion);
  thread_local std::vector<std::uint32_t> taken;
  taken.clear();
  const auto [basis, other_basis] = motion.bases;
  Sides sides[2]{{model, first, second, basis, other_basis}, {model, second, first, other_basis, basis}};
  const bool both_move = has_points(model.bodies[first]) && has_points(model.bodies[second]);
  const double most = (both_move ? deepest_of_moving : deepest) * motion.size;
  // Parts that touch take all their places: two bodies that had been pressed together went through each other when other
  // places became their nearest ones.
  const auto are_known = [&](const contact::Touch& t, std::uint32_t p) {
    return std::ranges::any_of(former, [&](std::uint32_t slot) {
      const Contact& c = model.contacts[slot];
      return !is_tie(c) && (c.p == p ? c.part == t.part && c.other_part == t.other_part
                                     : c.part == t.other_part && c.other_part == t.part);
    });
  };
  for (const contact::Touch& t : touches) {
    const std::uint32_t p = t.is_turned ? second : first, q = t.is_turned ? first : second;
    const auto known = std::find_if(former.begin(), former.end(),
                                    [&](std::uint32_t slot) { return is_same(model.contacts[slot], p, t); });
    const bool is_new = known == former.end();
    const auto may_come_out = [&] { return both_move || t.gap >= -half_buried * motion.size || are_known(t, p); };
    if (is_new && t.gap < -most && !(meeting.is_eased() && may_come_out())) {
      if (!both_move && meeting.is_eased()) tell_that_it_is_buried(model, first, second, -t.gap);
      continue;
    }
    Contact fresh;
    fresh.p = p, fresh.q = q;
    fresh.part = t.part, fresh.feature = t.feature, fresh.other_part = t.other_part,
    fresh.other_feature = t.other_feature;
    fresh.depth = std::min(0.0, t.gap);
    const std::uint32_t slot = is_new ? model.contacts.create(fresh) : *known;
    Contact& c = model.contacts[slot];
    const bool by_motion = is_new || std::exchange(c.is_off, 0);
    const bool has_changed = by_motion || !has_basis(c, model.bodies[p], model.bodies[q]);
    set_geometry(model, c, t, motion.spins[t.is_turned], motion.spins[!t.is_turned], motion.h, sides[t.is_turned]);
    meeting.renew(c, t.gap);
    if (has_changed) mark(model, c, by_motion);
    taken.push_back(slot);
  }
  meeting.resist_turning(taken);
}

bool Contacts::renew(Model& model, std::uint32_t first, std::uint32_t second, std::span<const std::uint32_t> former,
                     const Motion& motion) {
  if (former.empty() ||
      std::ranges::any_of(former, [&](std::uint32_t slot) { return model.contacts[slot].is_off != 0; }))
    return false;
  if (is_on_edge(model, former)) return false;
  const Meeting meeting(model, first, second, motion);
  for (const std::uint32_t slot : former) {
    Contact& c = model.contacts[slot];
    meeting.renew(c, c.depth < 0 ? gap(model, c) : 0);
  }
  meeting.resist_turning(former);
  return true;
}

namespace {

/// Whether it was found for the step that follows, or is at hand.
bool is_of_next_step(const Model& model, const Contact& c) { return c.found_in == model.step + 1; }

template <class Test>
void end_if(Model& model, std::uint32_t body, bool by_motion, Test test) {
  if (model.contacts.size() == 0) return;
  model.contacts.for_each_of(body, [&](std::uint32_t slot) {
    if (test(model.contacts[slot])) destroy(model, slot, by_motion);
  });
}

}  // namespace

void Contacts::tie(Model& model, std::uint32_t first, std::uint32_t second) {
  Contact c;
  c.p = first, c.q = second;
  c.part = c.feature = c.other_part = c.other_feature = none;
  c.normal = {0, 1, 0}, c.first = {1, 0, 0}, c.second = {0, 0, 1};
  c.is_off = 1, c.found_in = model.step + 1;
  take_basis(c, model.bodies[first], model.bodies[second]);
  mark(model, model.contacts[model.contacts.create(c)], true);
}

void Contacts::begin_part(Model& model, std::span<const std::uint32_t> slots, bool is_first) {
  for (const std::uint32_t slot : slots) {
    Contact& c = model.contacts[slot];
    c.found_in = 0, c.continues = !is_first && c.impulse != Vec3{};
  }
}

bool Contacts::keep(Model& model, std::span<const std::uint32_t> slots) {
  bool any = false;
  for (const std::uint32_t slot : slots) {
    Contact& c = model.contacts[slot];
    if (!c.is_off) c.found_in = model.step + 1, any = true;
  }
  return any;
}

void Contacts::end_part(Model& model, std::span<const std::uint32_t> slots) {
  for (const std::uint32_t slot : slots) {
    Contact& c = model.contacts[slot];
    if (c.found_in != 0) continue;
    c.found_in = model.step + 1, c.continues = 0;
    if (std::exchange(c.is_off, 1)) continue;
    dissipate_strain(model, c);
    c.push = c.energy = c.depth = 0, c.drag = c.torque = {};
    c.roll_rows = c.spin_rows = 0, c.twist = 0;
    mark(model, c, true);
  }
}

bool Contacts::is_of_sweeps(const Model& model, std::uint32_t body) {
  bool any = false;
  if (model.contacts.size() > 0)
    model.contacts.for_each_of(body, [&](std::uint32_t slot) { any = any || model.contacts[slot].is_of_sweeps; });
  return any;
}

void Contacts::take_over(Model& restored, Model& before) { restored.restores = before.restores + 1; }

void Contacts::end_old(Model& model, std::uint32_t body) {
  end_if(model, body, true, [&](const Contact& c) { return !is_of_next_step(model, c); });
}

void Contacts::end(Model& model, std::uint32_t body) {
  end_if(model, body, false, [](const Contact&) { return true; });
}

void Contacts::wake(Model& model, std::uint32_t body) {
  const BodyKind kind = model.bodies[body].kind;
  // A flagged static body wakes what sleeps near it, see ContactFinder.
  if (model::is_free(kind) || kind == BodyKind::static_) model.wake(model.bodies[body].articulate);
  if (model.contacts.size() == 0) return;
  model.contacts.for_each_of(body, [&](std::uint32_t slot) {
    const Contact& c = model.contacts[slot];
    for (const std::uint32_t each : {c.p, c.q})
      if (model::is_free(model.bodies[each].kind)) model.wake(model.bodies[each].articulate);
  });
}

void Contacts::forget_body(Model& model, std::uint32_t body) {
  end(model, body);
  std::erase(model.told_as_buried, body);
}

void Contacts::drop(Model& model, std::uint32_t particle) { end(model, model.particles[particle].body); }

void Contacts::absorb(Model& model, std::uint32_t q, std::uint32_t) { drop(model, q); }

// Contacts of the step at hand get the new basis in `prepare`: of two boxes between which a bond was made, the places that it holds
// became unknowns after their contacts had been found, and a weak spring drew one into the other within a step.
void Contacts::inertia_changed(Model& model, std::uint32_t body) {
  end_if(model, body, false, [&](const Contact& c) { return !is_of_next_step(model, c); });
}

// A body may have another basis, in the same place.
void Contacts::prepare(Model& model, std::uint32_t body) {
  if (model.contacts.size() == 0) return;
  model.contacts.for_each_of(body, [&](std::uint32_t slot) {
    Contact& c = model.contacts[slot];
    const model::Body &p = model.bodies[c.p], &q = model.bodies[c.q];
    if (has_basis(c, p, q)) return;
    const Places places{place_of(model, c, Arm::center, false), place_of(model, c, Arm::center, true),
                        place_of(model, c, Arm::place, false), place_of(model, c, Arm::place, true)};
    Sides sides(model, c.p, c.q);
    take_basis(c, p, q);
    places.set_center(c, sides), places.set_others(c, p, q, sides);
  });
}

bool Contacts::holds(const Model& model, std::uint32_t particle) {
  return model.contacts.ends_at(model.particles[particle].body);
}

bool Contacts::ties_any(const Model& model) { return model.contacts.size() > 0; }

// The first particle of a body answers for all of them.
void Contacts::visit_tied(const Model& model, std::uint32_t particle, Visit visit) {
  const std::uint32_t body = model.particles[particle].body;
  if (model.contacts.size() == 0 || model.bodies[body].first != particle || !has_points(model.bodies[body])) return;
  model.contacts.for_each_of(body, [&](std::uint32_t slot) {
    const Contact& c = model.contacts[slot];
    const std::uint32_t other = c.p == body ? c.q : c.p;
    if (has_points(model.bodies[other])) visit(other);
  });
}

namespace {

/// A contact and its row take 2 kB: more than this many are in no cache that is near, and contacts are in no order. Their memory
/// is asked for two items ahead.
constexpr std::size_t many_contacts = 200, contacts_ahead = 2;

void fetch_ahead(const Model& model, const solver::ConstraintPool<solver::ContactConstraint>& rows, std::size_t i) {
  const std::size_t next = i + contacts_ahead;
  if (rows.items.size() < many_contacts || next >= rows.items.size()) return;
  prefetch(rows.items[next]);
  if (rows.keys[next].owner == rows.keys[i].owner) prefetch(model.contacts[rows.keys[next].slot]);
}

}  // namespace

void Contacts::build(const IslandMap& map, Problem& problem) {
  const Model& model = map.model;
  if (model.contacts.size() == 0) return;
  std::vector<std::uint32_t> slots;
  for (const std::uint32_t body : map.bodies)
    if (has_points(model.bodies[body]))
      model.contacts.for_each_of(body, [&](std::uint32_t slot) { slots.push_back(slot); });
  sort_unique(slots);
  const auto& rows = problem.pool_of<solver::ContactConstraint>().items;
  for (std::size_t k = 0; k < slots.size(); ++k) {
    const std::uint32_t slot = slots[k];
    if (slots.size() >= many_contacts && k + contacts_ahead < slots.size()) {
      prefetch(model.contacts[slots[k + contacts_ahead]]);
      if (rows.size() + contacts_ahead < rows.capacity()) prefetch(rows.data()[rows.size() + contacts_ahead]);
    }
    const Contact& c = model.contacts[slot];
    if (c.is_off) continue;
    solver::ContactConstraint row;
    bool is_here = true, moves = false;
    for (std::uint32_t i = 0; i < c.point_count; ++i) {
      row.nodes[i] = map.node_of(c.points[i]);
      is_here = is_here && row.nodes[i] != none;
      moves = moves || (is_here && !map.is_pinned(row.nodes[i]));
    }
    const auto nodes = std::span(row.nodes).first(c.point_count);
    const auto has_node = [&](std::uint32_t node) {
      return std::find(nodes.begin(), nodes.begin() + c.of_p, node) != nodes.begin() + c.of_p;
    };
    // Inactive, or hinged to each other meanwhile.
    if (!is_here || !moves || std::any_of(nodes.begin() + c.of_p, nodes.end(), has_node)) continue;
    row.count = c.point_count;
    row.first_side = has_world_plane(c) ? 0 : c.of_p;
    row.weights = c.weights;  // they tell which arms are places of the world: Problem::set_origin
    const auto turns = [&](std::uint32_t body) {
      return is_free(model.bodies[body].kind) && model.bodies[body].rank == 4;
    };
    row.of_first = c.of_p, row.first_turns = turns(c.p), row.second_turns = turns(c.q);
    problem.add(row, {owner, {}, slot});
    solver::ResistanceConstraint roll;
    roll.nodes = row.nodes, roll.count = row.count, roll.first_side = row.first_side;
    for (std::uint8_t k = 0; k < c.roll_rows; ++k) problem.add(roll, {owner, {k}, slot});
    if (c.spin_rows > 0) problem.add(roll, {owner, {spin_row}, slot});
    if (c.roll_rows + c.spin_rows > 0) (void)problem.pool_of<solver::ResistanceConstraint>().law(0);
  }
}

namespace {

/// c_n and c_t for a step of h seconds, without the softness. Along the normal, nailed points of a body count as free ones if it has
/// any: its nailed corner hardly moves, and an overlap of round-off would be worth a thousand times the weight there.
std::array<double, 2> natural_compliances(const solver::ContactConstraint& row, std::uint32_t of_p,
                                          const IslandNodes& nodes, double h, const Problem& problem) {
  std::array<double, 2> sum{};
  for (const auto& [first, last] : {std::pair(0u, of_p), std::pair(of_p, std::uint32_t{row.count})}) {
    const auto is_free = [&](std::uint32_t i) { return !nodes.pinned[row.nodes[i]]; };
    bool any = false;
    for (std::uint32_t i = first; i < last; ++i) any = any || is_free(i);
    for (std::uint32_t i = first; i < last; ++i)
      for (const Arm arm : {Arm::center, Arm::place})
        if (is_free(i) || (any && arm == Arm::center))
          sum[arm] += h * h * row.weights[arm][i] * row.weights[arm][i] / problem.mass[row.nodes[i]];
  }
  return sum;
}

}  // namespace

namespace {

/// The mean force in the step by which bodies that begin to touch would stop and rebound if nothing else held them, N.
double stopping_force(const Model& model, const Contact& c, std::span<const std::uint32_t> at, const IslandNodes& nodes,
                      double h, const Problem& problem) {
  double gap = std::max(0.0, Contacts::gap(model, c) - c.depth), speed = 0, fall = 0, mobility = 0;
  for (std::uint32_t i = 0; i < c.point_count; ++i) {
    const double w = c.weights[Arm::center][i], along = w * dot(c.normal, problem.velocity[at[i]]);
    const bool is_free = !nodes.pinned[at[i]];
    speed += along;
    if (is_free) fall += w * dot(c.normal, h * problem.gravity), mobility += w * w / problem.mass[at[i]];
  }
  const bool meets = gap + h * (speed + 0.5 * fall) < 0;
  const double rebound = speed < -h * norm(problem.gravity) ? c.restitution * speed : 0;
  return meets && mobility > 0 ? std::max(0.0, -(speed + rebound + fall) / (h * mobility)) : 0;
}

/// The places of contacts in their pool, by their slots.
using ItemsBySlot = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

/// The items of the one or two contacts of two bodies.
std::array<std::uint32_t, 2> items_of_both(const Model& model, const Contact& c, const ItemsBySlot& items) {
  std::array<std::uint32_t, 2> found{none, none};
  const auto [mover, other] = has_points(model.bodies[c.p]) ? std::pair(c.p, c.q) : std::pair(c.q, c.p);
  model.contacts.for_each_of(mover, [&](std::uint32_t slot) {
    if (model.contacts[slot].p != other && model.contacts[slot].q != other) return;
    const auto at = std::lower_bound(items.begin(), items.end(), std::pair(slot, 0u));
    if (at != items.end() && at->first == slot) found[found[0] != none] = at->second;
  });
  return found;
}

/// The rows against rolling and spinning: the angle between a direction of p and one of q is held, up to a torque.
void load_resistance(std::uint8_t owner, const Model& model, const IslandNodes& nodes, double h, Problem& problem) {
  if (problem.items_of<solver::ResistanceConstraint>().empty()) return;
  auto& rows = problem.pool_of<solver::ResistanceConstraint>();
  thread_local ItemsBySlot items;
  items.clear();
  for_each_item_of<solver::ContactConstraint>(owner, problem, [&](std::size_t i, solver::ItemKey key) {
    items.emplace_back(key.slot, static_cast<std::uint32_t>(i));
  });
  std::sort(items.begin(), items.end());
  for_each_item_of<solver::ResistanceConstraint>(owner, problem, [&](std::size_t i, solver::ItemKey key) {
    const Contact& c = model.contacts[key.slot];
    solver::ResistanceConstraint& row = rows.items[i];
    Sides sides(model, c.p, c.q);
    const bool spins = key.part[0] == spin_row;
    const Vec3& along = spins ? c.spin_second : key.part[0] == 0 ? c.roll_first : c.roll_second;
    row.weights = {};
    const auto set_arm = [&](std::size_t arm, const Vec3& direction, bool of_q) {
      const std::uint32_t first = of_q ? c.of_p : 0, count = of_q ? c.point_count - c.of_p : c.of_p;
      if (count == 0) return row.set_constant(static_cast<int>(arm), direction);
      const Vec3 origin = model.position(c.points[first]);
      const std::array<double, 4> start = sides.of(of_q, origin), end = sides.of(of_q, origin + direction);
      for (std::uint32_t k = 0; k < count; ++k) row.weights[arm][first + k] = end[k] - start[k];
    };
    set_arm(0, spins ? c.spinner : c.roller, false), set_arm(1, along, true);
    row.share = spins ? c.spinning : c.rolling;
    row.contacts = items_of_both(model, c, items), row.begins = !(c.carried > 0);
    const double most = row.share * (row.begins ? stopping_force(model, c, row.nodes, nodes, h, problem) : c.carried);
    rows.law(i)[0] = {.lower = -most, .upper = most, .is_rate = true};
    *rows.multiplier(i) = spins ? c.twist : dot(c.torque, along);
  });
}

/// Whether round things that are eased out of each other are apart by so much that the way between their middles tells where to. A
/// ball that was put on the axis of a capsule stayed there.
bool has_direction(const Model& model, const Contact& c) {
  return c.depth == 0 || Contacts::gap(model, c) + c.radius > 1e-3 * (c.radius + c.depth);
}

}  // namespace

void Contacts::load(const Model& model, const IslandNodes& nodes, double h, Problem& problem) {
  constexpr double steady = 0.05;           // of the force, from the mean over the last step
  constexpr double least_share = 1.0 / 64;  // of a step; with less, rows that share a weight differ by round-off alone
  if (!problem.has_used<solver::ContactConstraint>()) return;
  load_resistance(owner, model, nodes, h, problem);
  auto& rows = problem.pool_of<solver::ContactConstraint>();
  for_each_item_of<solver::ContactConstraint>(owner, problem, [&](std::size_t i, solver::ItemKey key) {
    fetch_ahead(model, rows, i);
    const Contact& c = model.contacts[key.slot];
    solver::ContactConstraint& row = rows.items[i];
    row.weights = c.weights;
    row.find_turning();
    row.impulse = {}, row.share = 1;
    const double of_world = has_world_point(c) ? 1 : has_world_plane(c) ? -1 : 0;
    row.set_constant(0, c.center - of_world * problem.origin), row.set_constant(1, c.place - of_world * problem.origin);
    row.constant[1] -= h * c.drift;
    row.is_round = c.is_round() && c.radius + c.depth > 0 && has_direction(model, c);
    row.has_wires = c.form == TouchForm::wires && row.is_round;
    row.bends[0] = row.has_wires ? c.bends[0] : 1, row.bends[1] = row.has_wires ? c.bends[1] : 0;
    const auto constant = [](bool turns, const Vec3& v) { return turns ? Vec3{} : v; };
    row.set_directions({constant(c.turns, row.is_round ? c.axis : c.normal), constant(c.slips_turn, c.first),
                        constant(c.slips_turn, c.second)});
    row.radius = c.radius + c.depth;
    row.is_of_sweeps = c.is_of_sweeps;
    row.pivots[0] = dot(c.pivot, c.first), row.pivots[1] = dot(c.pivot, c.second);
    row.ball = c.ball, row.from = 0, row.to = 1;
    row.friction = c.friction, row.static_friction = c.static_friction, row.restitution = c.restitution;
    const auto [of_center, of_place] = natural_compliances(row, c.of_p, nodes, h, problem);
    row.normal_compliance = normal_softness * of_center;
    row.compliance = tangent_softness * of_place;
    row.reference = extent_of(c, [&](std::uint32_t k) { return problem.position[row.nodes[k]]; });
    // Its compliance goes with the square of the step, see ContactConstraint::fit. The force of an impact in a short part,
    // taken over, was worth a hundred times the motion. What rests on a steady one would sag by a part of g h^2 in each step, so that
    // mode `accurate` took hundreds of parts: there it goes on with the compliance of the last part.
    const double part = c.duration < h ? c.duration / h : 1;
    row.is_steady = model.mode == IntegrationMode::accurate && part < 1 && c.carries() &&
                    norm(c.mean_force() - c.force()) <= steady * norm(c.force());
    if (row.is_steady) row.share = std::max(part, least_share);
    row.normal_compliance *= row.share * row.share, row.compliance *= row.share * row.share;
    const double kept = part * part / (row.share * row.share);
    double* const l = rows.multiplier(i);
    l[0] = -kept * c.push, l[1] = -kept * dot(c.drag, c.first), l[2] = -kept * dot(c.drag, c.second);
    const bool slipped = c.static_friction > c.friction && row.state_of(l).slips();
    row.drag_before[0] = slipped ? l[1] : 0, row.drag_before[1] = slipped ? l[2] : 0;
    // To come to rest may have taken more than what holds it: it would begin to slip again before it is solved.
    const double drag = std::hypot(l[1], l[2]), most = row.largest_hold(l);
    if (c.static_friction > c.friction && drag > most) l[1] *= most / drag, l[2] *= most / drag;
    row.is_strained = c.energy != 0 || !c.is_of_sweeps;
    if (c.has_left()) std::fill_n(l, 3, 0.0);
    row.unstored = c.energy - solver::strain_energy(row, l);
  });
}

double Contacts::after_step(Model&, double, Problem& problem) {
  double dissipated = 0;
  for (const solver::ContactConstraint& row : problem.items_of<solver::ContactConstraint>()) dissipated += row.unstored;
  return dissipated;
}

void Contacts::store(Model& model, const IslandNodes&, double h, const Problem& problem) const {
  if (!problem.has_used<solver::ContactConstraint>()) return;
  const auto& rows = problem.pool_of<solver::ContactConstraint>();
  for_each_item_of<solver::ContactConstraint>(owner, problem, [&](std::size_t i, solver::ItemKey key) {
    fetch_ahead(model, rows, i);
    const double* const l = rows.multiplier(i);
    const solver::ContactConstraint& row = rows.items[i];
    Contact& c = model.contacts[key.slot];
    const auto arm = [&](Arm which) { return row.arm(which, problem.position.data(), 1); };
    if (c.slips_turn) c.first = arm(Arm::first_tangent), c.second = arm(Arm::second_tangent);
    if (row.is_round)
      c.axis = arm(Arm::turned),
      c.normal = unit_or(row.off(arm(Arm::center), c.axis, arm(Arm::first_tangent)), c.normal);
    else if (c.turns)
      c.normal = unit_or(arm(Arm::turned), c.normal);
    c.is_of_sweeps = row.is_of_sweeps;
    c.push = -l[0], c.drag = -(l[1] * c.first + l[2] * c.second), c.duration = row.share * h;
    c.energy = row.leaves ? 0 : solver::strain_energy(row, l);
    if (!std::exchange(c.continues, 0)) c.impulse = {}, c.time = 0;
    c.time += h;
    c.impulse -= (row.impulse[0] * c.normal + row.impulse[1] * c.first + row.impulse[2] * c.second);
    c.torque = {}, c.twist = 0;
  });
  if (!problem.has_used<solver::ResistanceConstraint>()) return;
  const auto& rolls = problem.pool_of<solver::ResistanceConstraint>();
  for_each_item_of<solver::ResistanceConstraint>(owner, problem, [&](std::size_t i, solver::ItemKey key) {
    Contact& c = model.contacts[key.slot];
    if (key.part[0] == spin_row)
      c.twist = *rolls.multiplier(i);
    else
      c.torque += *rolls.multiplier(i) * (key.part[0] == 0 ? c.roll_first : c.roll_second);
  });
}

// Bodies that are eased out of an overlap move, though their velocities do not tell it: they fell asleep within each other.
bool Contacts::keeps_awake(const Model& model, const Problem& problem) const {
  bool any = false;
  for_each_item_of<solver::ContactConstraint>(owner, problem, [&](std::size_t, solver::ItemKey key) {
    const Contact& c = model.contacts[key.slot];
    const bool is_fast = -c.depth > easing_time * model.rest_speed && c.is_of_sweeps == 0;
    any = any || (is_fast && is_eased(model, c.p, c.q));
  });
  return any;
}

Vec3 Contact::off(const Vec3& d) const {
  const Vec3 across = d - (form == TouchForm::wires ? bends[0] : 1) * dot(axis, d) * axis;
  return form == TouchForm::wires ? across - bends[1] * dot(first, d) * first : across;
}

Vec3 Contacts::place(const Model& model, const Contact& c) {
  return place_of(model, c, Arm::center, false) - c.ball * c.normal;
}

double Contacts::gap(const Model& model, const Contact& c) {
  const Vec3 d = place_of(model, c, Arm::center, false) - place_of(model, c, Arm::center, true);
  if (c.form == TouchForm::wires) return std::sqrt(std::max(0.0, dot(c.off(d), d))) - c.radius;
  return (c.is_round() ? norm(c.off(d)) : dot(c.normal, d)) - c.radius;
}

Impact Contacts::hardest_impact(const Model& model, std::span<const std::uint32_t> bodies) {
  Impact hardest;
  if (model.contacts.size() == 0) return hardest;
  std::uint32_t found = none;  // of equal ones the first
  for (const std::uint32_t body : bodies)
    model.contacts.for_each_of(body, [&](std::uint32_t slot) {
      const Contact& c = model.contacts[slot];
      if (!(c.approach > hardest.speed || (c.approach == hardest.speed && slot < found)) || !c.has_touched()) return;
      if (c.approach > 0) hardest = {place(model, c), c.approach}, found = slot;
    });
  return hardest;
}

namespace {

/// visit(contact): of all bodies, or of those whose point one body is.
template <class Visit>
void for_each_contact(const Scope& scope, Visit visit) {
  const auto& contacts = scope.model.contacts;
  if (contacts.size() == 0) return;
  if (scope.is_whole()) return contacts.for_each([&](std::uint32_t, const Contact& c) { visit(c); });
  scope.for_each_body([&](std::uint32_t body, const model::Body&) {
    contacts.for_each_of(body, [&](std::uint32_t slot) {
      if (contacts[slot].p == body) visit(contacts[slot]);
    });
  });
}

}  // namespace

double Contacts::worst_gap(const Scope& scope) {
  solver::Largest worst;
  for_each_contact(scope, [&](const Contact& c) {
    if (!c.is_off) worst.add(std::max(0.0, c.depth - gap(scope.model, c)));
  });
  return worst.value;
}

void Contacts::add_energy(const Scope& scope, Energies& sum) {
  for_each_contact(scope, [&](const Contact& c) { sum.potential += c.energy; });
}

void Contacts::add_loads(const LastStep& step, std::uint32_t body, LoadReader& reader) {
  if (step.model.contacts.size() == 0) return;
  const auto place = [&](std::uint32_t p) { return step.place(p); };
  step.model.contacts.for_each_of(body, [&](std::uint32_t slot) {
    const Contact& c = step.model.contacts[slot];
    const std::uint32_t first = c.p == body ? 0 : c.of_p, last = c.p == body ? c.of_p : c.point_count;
    const Vec3 arm = c.radius * c.normal;
    const double of_normal = c.is_round() ? 0 : 1;
    const Vec3 force = c.mean_force();
    const double push = dot(force, c.normal);
    const Vec3 drag = force - push * c.normal;
    const BodyId part =
        step.model.part_at(body, (c.p == body ? 1.0 : -1.0) * sum_over(c, Arm::place, first, last, place));
    for (std::uint32_t i = first; i < last; ++i)
      reader.take(
          {.particle = c.points[i],
           .force = push * (c.weights[Arm::center][i] * c.normal + of_normal * c.weights[Arm::turned][i] * arm) +
                    c.weights[Arm::place][i] * drag,
           .part = part});
    const int side = c.p == body ? 0 : 1;
    const auto take_couple = [&](const Vec3& arm, const Vec3& force) {  // moment arm x force on q
      Sides sides(step.model, c.p, c.q);
      const Vec3 origin = step.model.position(c.points[first]);
      const std::array<double, 4> start = sides.of(side, origin), end = sides.of(side, origin + arm);
      for (std::uint32_t i = first; i < last; ++i)
        reader.take({.particle = c.points[i],
                     .force = (side == 0 ? -1 : 1) * (end[i - first] - start[i - first]) * force,
                     .part = part});
    };
    if (c.roll_rows > 0) take_couple(c.roller, c.torque);
    if (c.spin_rows > 0) take_couple(c.spinner, c.twist * c.spin_second);
  });
}

void Contacts::check_links(const Model& model, model::Audit& audit) {
  audit.check_ends("contact", model.contacts, model.bodies);
  model.contacts.for_each([&](std::uint32_t slot, const Contact& c) {
    audit.require(c.point_count >= 1 && c.of_p <= c.point_count && c.point_count <= c.points.size(), "contact ", slot,
                  " refers to ", c.point_count, " points");
    for (std::uint32_t i = 0; i < std::min<std::size_t>(c.point_count, c.points.size()); ++i)
      audit.require(model.particles.is_alive(c.points[i]), "contact ", slot,
                    " refers to a particle that does not exist");
  });
}

void Contacts::validate(const Model& model, model::Audit& audit) {
  model.contacts.for_each([&](std::uint32_t slot, const Contact& c) {
    audit.require(c.p != c.q && (has_points(model.bodies[c.p]) || has_points(model.bodies[c.q])), "contact ", slot,
                  " is of one body, or of static ones");
    for (std::uint32_t i = 0; i < c.point_count; ++i)
      audit.require(model.particles[c.points[i]].body == (i < c.of_p ? c.p : c.q), "contact ", slot,
                    " refers to a particle of another body");
    audit.require(c.restitution >= 0 && c.restitution <= 1 && c.rolling >= 0 && c.carried >= 0 && is_finite(c.torque) &&
                      c.roll_rows <= 2 && c.spin_rows <= 1 && c.spinning >= 0 && std::isfinite(c.twist) &&
                      c.static_friction >= 0 && is_finite(c.pivot),
                  "contact ", slot, " has no valid restitution, resistance or static friction");
    audit.require(is_finite(c.force()) && is_finite(c.impulse) && c.time >= 0 &&
                      std::abs(dot(c.normal, c.normal) - 1) < 1e-9 && c.friction >= 0 && c.depth <= 0,
                  "contact ", slot, " has no valid plane, force or friction");
  });
}

std::string Contacts::name_of_row(const Model& model, solver::ItemKey key) const {
  const Contact& c = model.contacts[key.slot];
  return text("contact of body ", c.p, " with body ", c.q);
}

}  // namespace iota::ingredient
