// SPDX-License-Identifier: Apache-2.0
#include "edit/joint_pose.h"

#include "base/sort_unique.h"
#include "edit/constraints.h"
#include "ingredient/joint_readings.h"
#include "math/checks.h"
#include "math/mat3.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <span>
#include <tuple>
#include <utility>
#include <vector>

namespace iota::edit {

using model::none;

namespace {

/// Moves one coordinate of one joint to a value.
class CoordinateSetter {
 public:
  CoordinateSetter(Editor& e, std::uint32_t joint, JointCoordinate which)
      : e_(e), model_(e.model), joint_(joint), which_(which), index_(static_cast<std::size_t>(which)) {}

  void set(double value) {
    const double change = value - now();
    if (change == 0) return;
    remember();
    const auto side = free_side();
    if (side && move_rigidly(*side, change, value)) return;
    restore();
    if (drive(value)) return;
    const double reached = now();
    restore();
    throw std::invalid_argument(text(name(), " cannot be ", value, ": what hangs on joint ", joint_,
                                     " follows no further than about ", reached));
  }

 private:
  static constexpr double met = 1e-9;  // rad, or of the joint's size

  auto& joint() { return model_.constraints[joint_]; }
  const char* name() const { return std::array{"angle", "slide", "second angle"}[index_]; }
  double now() const { return ingredient::calc_coordinate(model_, joint_, which_).first; }
  double scale() {
    return which_ == JointCoordinate::slide ? std::max({joint().scale[0], joint().scale[1], 1e-3 * joint().length})
                                            : 1.0;
  }

  struct Side {
    std::vector<std::uint32_t> bodies;
    double sign;  // factor of its motion
  };

  /// The bodies that move rigidly with this joint: those attached to a, or to b if a's cannot move. None in a loop.
  std::optional<Side> free_side() {
    if (joint().kind == ConstraintKind::path) return std::nullopt;  // a curve also turns
    if (joint().coupled != none) return std::nullopt;               // coupled joints have to move, too
    const std::uint32_t a = body_of_side(model_, joint(), 0), b = body_of_side(model_, joint(), 1);
    joint().active = 0;  // so that the search stops at it
    std::optional<Side> found;
    for (const auto& [from, to, sign] : {std::tuple{a, b, 1.0}, std::tuple{b, a, -1.0}}) {
      if (found || from == none) continue;
      std::vector<std::uint32_t> bodies = model_.tied_bodies(std::array{from}, model::Model::Ties::constraints);
      const bool in_loop = to != none && std::find(bodies.begin(), bodies.end(), to) != bodies.end();
      if (!in_loop && std::none_of(bodies.begin(), bodies.end(), [&](std::uint32_t body) { return is_held(body); }))
        found = Side{std::move(bodies), sign};
    }
    joint().active = 1;
    return found;
  }
  bool is_held(std::uint32_t body) const {
    bool held = !model::is_free(model_.bodies[body].kind) || model_.is_tied_to_world(body);
    model_.for_each_particle_of(body,
                                [&](std::uint32_t p) { held = held || model_.is_pinned(model_.particles[p].ring); });
    return held;
  }

  Vec3 place(int which) { return position_of(model_, joint(), which); }

  bool move_rigidly(const Side& side, double change, double value) {
    using enum ingredient::Place;
    const bool of_b = which_ == JointCoordinate::second_angle ? true : !joint().has(a_axis);
    const Vec3 origin = place(of_b ? b_origin : a_origin), end = place(of_b ? b_axis : a_axis);
    if (!joint().has(of_b ? b_axis : a_axis)) return false;
    const Vec3 axis = (1 / norm(end - origin)) * (end - origin);
    const double angle = which_ == JointCoordinate::slide ? 0 : side.sign * change;
    const Vec3 shift = which_ == JointCoordinate::slide ? (side.sign * change) * axis : Vec3{};
    const Vec3 half = std::sin(angle / 2) * axis;
    const Quaternion turn{half.x, half.y, half.z, std::cos(angle / 2)};
    e_.orientations.refresh(model_);
    std::vector<std::uint32_t> rings;
    for (const std::uint32_t body : side.bodies) {
      model_.for_each_particle_of(body, [&](std::uint32_t p) { rings.push_back(model_.particles[p].ring); });
      model_.bodies[body].orientation = multiply(turn, model_.bodies[body].orientation);
    }
    sort_unique(rings);
    for (const std::uint32_t slot : rings) {
      auto& ring = model_.rings[slot];
      ring.position = origin + rotate(turn, ring.position - origin) + shift;
      ring.velocity = rotate(turn, ring.velocity);
    }
    return finish(side.bodies, value);
  }

  /// Call it after positions have changed. False if the coordinate is wrong.
  bool finish(std::span<const std::uint32_t> bodies, double value) {
    joint().coordinate[index_] = value;  // an angle is then counted from here
    if (e_.batch) e_.batch->forget_coordinates(joint_);
    for (const std::uint32_t body : bodies) refresh_coordinates_of(e_, body);
    e_.orientations.forget();
    e_.mark_velocity_dirty(joint().particles[ingredient::a_origin]);
    return std::abs(now() - value) <= 1e3 * met * scale();
  }

  /// Moves the coordinate in small steps by a stop on both sides, closed like a conflict: by the least motion.
  bool drive(double value) {
    const double start = now();
    const int steps = std::clamp(static_cast<int>(std::ceil(std::abs(value - start) / (0.1 * scale()))), 1, 10000);
    const auto options = joint().options;
    const auto compliances = take_compliances();  // what yields moves along as if it were exact
    bool good = true;
    for (int i = 1; i <= steps && good; ++i) {
      const double aim = start + (value - start) * i / steps;
      for (auto& o : joint().options) o.motor_max = o.friction = o.stiffness = o.damping = 0;
      joint().options[index_].lower = joint().options[index_].upper = aim;
      if (i == 1) mark();
      e_.islands.update(model_, e_.parallel);
      auto* const island = e_.islands.of_articulate(model_.bodies[body_of_side(model_, joint(), 0)].articulate);
      good = island && island->project(model_, true) && std::abs(now() - aim) <= 1e3 * met * scale();
      joint().coordinate[index_] = now();
    }
    joint().options = options;
    for (const auto& [slot, compliance] : compliances) model_.constraints[slot].compliance = compliance;
    mark();
    return good && finish(bodies_, value);
  }

  /// Makes all joints of the bodies that may move exact. Returns what they had.
  std::vector<std::pair<std::uint32_t, Compliance>> take_compliances() {
    std::vector<std::pair<std::uint32_t, Compliance>> before;
    for (const std::uint32_t body : bodies_)
      model_.for_each_particle_of(body, [&](std::uint32_t p) {
        model_.for_each_constraint_of(p, [&](std::uint32_t slot, int) {
          auto& c = model_.constraints[slot];
          if (!c.compliance.is_exact()) before.push_back({slot, std::exchange(c.compliance, {})});
        });
      });
    return before;
  }

  void mark() {
    for (const int origin : {ingredient::a_origin, ingredient::b_origin})
      if (joint().particles[origin] != none) model_.mark_particle(joint().particles[origin]);
    e_.structure_changed();
  }

  struct State {
    std::uint32_t ring;
    Vec3 position, velocity;
  };
  void remember() {
    for (const int side : {0, 1})
      if (const std::uint32_t body = body_of_side(model_, joint(), side); body != none) bodies_.push_back(body);
    bodies_ = model_.tied_bodies(bodies_);
    e_.orientations.refresh(model_);
    for (const std::uint32_t body : bodies_) {
      orientations_.push_back(model_.bodies[body].orientation);
      model_.for_each_particle_of(body, [&](std::uint32_t p) {
        const std::uint32_t ring = model_.particles[p].ring;
        states_.push_back({ring, model_.rings[ring].position, model_.rings[ring].velocity});
      });
    }
    coordinate_ = joint().coordinate[index_];
  }
  void restore() {
    for (const State& s : states_)
      model_.rings[s.ring].position = s.position, model_.rings[s.ring].velocity = s.velocity;
    for (std::size_t i = 0; i < bodies_.size(); ++i) model_.bodies[bodies_[i]].orientation = orientations_[i];
    joint().coordinate[index_] = coordinate_;
    for (const std::uint32_t body : bodies_) refresh_coordinates_of(e_, body);
    e_.orientations.forget();
  }

  Editor& e_;
  model::Model& model_;
  std::uint32_t joint_;
  JointCoordinate which_;
  std::size_t index_;
  std::vector<std::uint32_t> bodies_;  // that may move
  std::vector<Quaternion> orientations_;
  std::vector<State> states_;
  double coordinate_ = 0;
};

}  // namespace

void apply(Editor& e, const SetCoordinateValue& c) {
  const std::uint32_t slot = e.require(c.constraint);
  const auto& constraint = e.model.constraints[slot];
  const auto index = static_cast<std::size_t>(c.coordinate);
  const char* const name = std::array{"angle", "slide", "second angle"}[index];
  if (!has_coordinate(constraint.kind, c.coordinate)) throw std::invalid_argument(text("this joint has no ", name));
  if (!constraint.active) throw std::invalid_argument(text("joint ", slot, " is switched off: its ", name, " is free"));
  require_number(name, c.value);
  const CoordinateOptions& o = constraint.options[index];
  if (c.value < o.lower || c.value > o.upper)
    throw std::invalid_argument(
        text(name, " must be within its limits, ", o.lower, " and ", o.upper, ", got ", c.value));
  CoordinateSetter(e, slot, c.coordinate).set(c.value);
}

}  // namespace iota::edit
