// SPDX-License-Identifier: Apache-2.0
#include "ingredient/constraint.h"

#include "ingredient/joint_readings.h"
#include "ingredient/joint_rows.h"
#include "ingredient/model.h"
#include "math/mat3.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <sstream>
#include <stdexcept>

namespace iota::ingredient {

using joint::for_each_term;

namespace {

constexpr double straight = 1e-6;  // sine of an angle that counts as zero

/// For any length, also tiny or huge ones.
Vec3 unit(const Vec3& v) {
  const Vec3 scaled = (1 / std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)})) * v;
  return (1 / norm(scaled)) * scaled;
}

/// The directions that one side of a joint can hold: any if it is the world or has four points not in a plane, those in
/// its plane or along its line if it is flat or thin, none if it is a point.
struct Side {
  std::uint32_t body = none;
  int dimensions = 3;
  std::array<Vec3, 3> axes{Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}};
  double extent = 0;  // m

  Side() = default;
  Side(const Model& model, std::uint32_t slot) : body(slot) {
    const model::Body& b = model.bodies[slot];
    dimensions = std::max(b.rank - 1, 0);
    for (int i = 0; i < dimensions; ++i) {
      Vec3 axis = model.position(b.basis[i + 1]) - model.position(b.basis[0]);
      extent = std::max(extent, norm(axis));
      for (int j = 0; j < i; ++j) axis -= dot(axis, axes[j]) * axes[j];
      axes[i] = unit(axis);
    }
  }
  bool is_world() const { return body == none; }
  bool holds(Vec3 direction) const {
    for (int i = 0; i < dimensions; ++i) direction -= dot(direction, axes[i]) * axes[i];
    return dimensions == 3 || norm(direction) < straight;
  }
  std::string what() const {
    constexpr const char* shapes[] = {"a point", "on one line", "flat", "solid"};
    return "body " + std::to_string(body) + " is " + shapes[dimensions];
  }
};

/// The directions that a joint needs on its two sides, checked before any change.
struct Frames {
  std::array<Vec3, place_count> direction{};
  std::uint8_t needed = 0;
  std::array<double, 2> cosines{};
  Constraint::Alignment alignment = Constraint::Alignment::none;
  Constraint::Lock lock = Constraint::Lock::none;
  std::uint8_t aligned = 0;
  std::uint8_t line_side = 0;

  void need(int place, const Vec3& d) { direction[place] = d, needed |= static_cast<std::uint8_t>(1u << place); }
  bool has(int place) const { return needed >> place & 1; }
};

/// A direction normal to z that the thinner side holds, if one of them is thin.
Vec3 common_side(const Side& a, const Side& b, const Vec3& z) {
  const Side& thin = b.dimensions < a.dimensions ? b : a;
  Vec3 x;
  if (thin.dimensions == 2) x = cross(cross(thin.axes[0], thin.axes[1]), z);
  if (norm(x) < straight && (thin.dimensions == 1 || thin.dimensions == 2)) x = thin.axes[0] - dot(thin.axes[0], z) * z;
  return norm(x) < straight ? any_perpendicular(z) : unit(x);
}

/// A common axis, depending on the sides: an axis on one and two directions normal to it on the other; or the angles of
/// the axis with the directions of a thin other side; or the axis on both. False if none of these is possible.
bool plan_alignment(Frames& frames, const Side& a, const Side& b, const Vec3& z, const Vec3& x, const Vec3& y) {
  using Alignment = Constraint::Alignment;
  const auto by_axis_of = [&](const Side& p, const Side& q, int axis, int side) {
    if (!p.holds(z) || !q.holds(x) || !q.holds(y)) return false;
    frames.alignment = axis == a_axis ? Alignment::axis_of_a : Alignment::axis_of_b;
    frames.aligned = 2;
    frames.need(axis, z), frames.need(side, x), frames.need(side + 1, y);
    return true;
  };
  if (by_axis_of(a, b, a_axis, b_side) || by_axis_of(b, a, b_axis, a_side)) return true;
  if (a.holds(z) && b.holds(z)) {
    frames.alignment = Alignment::axes;
    frames.need(a_axis, z), frames.need(b_axis, z);
    return true;
  }
  const auto by_angles = [&](const Side& p, const Side& q, int axis, int side) {
    if (!p.holds(z) || q.dimensions == 0 || q.dimensions == 3) return false;
    frames.alignment = axis == a_axis ? Alignment::axis_of_a : Alignment::axis_of_b;
    frames.need(axis, z);
    frames.aligned = static_cast<std::uint8_t>(q.dimensions);
    if (q.dimensions == 1) {
      frames.need(side, q.axes[0]);
      frames.cosines = {dot(z, q.axes[0]), 0};
    } else {
      const Vec3 other = unit(cross(cross(q.axes[0], q.axes[1]), x));
      frames.need(side, x), frames.need(side + 1, other);
      frames.cosines = {0, dot(z, other)};
    }
    return true;
  };
  return by_angles(a, b, a_axis, b_side) || by_angles(b, a, b_axis, a_side);
}

[[noreturn]] void cannot(const char* kind, const std::string& why) {
  throw std::invalid_argument(std::string(kind) + ": " + why);
}

Frames plan(const ConstraintKindInfo& kind, const JointSpec& spec, const Side& a, const Side& b) {
  Frames frames;
  frames.need(a_origin, {}), frames.need(b_origin, {});
  if (!kind.align && !kind.cross) return frames;
  const Vec3 z = unit(spec.axis);
  const Side& thin = b.dimensions < a.dimensions ? b : a;

  if (kind.cross) {
    const bool any = spec.second_axis == Vec3{};
    const Vec3 second = any ? common_side(a, b, z) : unit(spec.second_axis);
    if (std::abs(dot(z, second)) > straight) cannot(kind.name, "its two axes must be at right angles");
    if (!a.holds(z) || !b.holds(second))
      cannot(kind.name, (a.holds(z) ? b : a).what() +
                            " and does not hold the axis that it should; give it a particle off its line or plane");
    frames.need(a_axis, z), frames.need(b_axis, second);
    if (a.holds(second)) frames.need(a_side, second);
    if (b.holds(z)) frames.need(b_side, z);
    return frames;
  }

  const bool point = thin.dimensions == 0;
  if (point && !kind.line) cannot(kind.name, thin.what() + ", which has no directions; use a ball joint or a nail");
  const Vec3 x = common_side(a, b, z), y = cross(z, x);
  if (!point && !plan_alignment(frames, a, b, z, x, y))
    cannot(kind.name, "neither side holds the axis (" + a.what() + (b.is_world() ? "" : ", " + b.what()) +
                          "); give one of them a massive particle off its line or plane, or join them at two points");
  const bool along_thin = thin.dimensions == 1 && thin.holds(z);  // its rotation about the axis is undefined
  if (!point && !along_thin && (kind.lock || kind.angle)) {
    // References of the angle, or of the last direction that is locked.
    const auto refer = [&](const Side& s, int side) {
      if (!frames.has(side) && s.holds(x)) frames.need(side, x);
    };
    refer(a, a_side), refer(b, b_side);
    if (kind.lock) {
      // y of the side that already holds it, if any.
      const bool y_of_b = frames.has(a_side) && b.holds(y), y_of_a = frames.has(b_side) && a.holds(y);
      if (!y_of_a && !y_of_b)
        cannot(kind.name,
               a.what() + ", " + b.what() +
                   ": they hold no direction across the axis in common; combine() makes one rigid body of them");
      if (y_of_b && (frames.has(b_third) || !y_of_a))
        frames.lock = Constraint::Lock::side_of_a, frames.need(b_third, y);
      else
        frames.lock = Constraint::Lock::third_of_a, frames.need(a_third, y);
    }
  }
  if (kind.line) {
    const bool by_b = b.holds(x) && b.holds(y);
    if (!by_b && !(a.holds(x) && a.holds(y)))
      cannot(kind.name,
             "neither side holds the directions across the axis; give one of them a particle off its line or plane");
    frames.line_side = by_b;
    frames.need(by_b ? b_side : a_side, x), frames.need(by_b ? b_third : a_third, y);
    if (!frames.has(a_axis) && !frames.has(b_axis)) frames.need(by_b ? b_axis : a_axis, z);
  }
  return frames;
}

void require_span(const Model& model, const char* kind, const Side& side, const Vec3& at) {
  if (side.is_world() || model.spans(side.body, at)) return;
  cannot(kind, side.what() + " and does not reach (" + std::to_string(at.x) + ", " + std::to_string(at.y) + ", " +
                   std::to_string(at.z) + "); give it a massive particle off its point, line or plane");
}

/// A place of a constraint: its own marker on a body, or a fixed place in the world.
void add_place(Model& model, Constraint& c, int place, std::uint32_t body, const Vec3& at) {
  const auto bit = static_cast<std::uint8_t>(1u << place);
  if (body == none) {
    c.fixed[place - b_origin] = at;
    c.in_world |= bit;
  } else {
    const std::uint32_t marker = c.particles[place] = model.make_marker(body, at);
    c.owned |= bit;
    // The ends of directions belong to the part of their origin, not to the nearest one.
    const std::uint32_t origin = c.particles[place < b_origin ? a_origin : b_origin];
    model.particles[marker].part = origin == marker ? model.part_at(body, at) : model.particles[origin].part;
  }
}

}  // namespace

std::uint32_t make_constraint(Model& model, const JointSpec& spec) {
  const ConstraintKindInfo& kind = info(spec.kind);
  const Side a(model, spec.a.slot);
  const Side b = spec.b ? Side(model, spec.b.slot) : Side();
  if (kind.screw && (a.dimensions < 2 || b.dimensions < 2))
    cannot(kind.name, (a.dimensions < 2 ? a : b).what() +
                          " and does not show how far it has turned; give it a massive particle off its line");
  const Frames frames = plan(kind, spec, a, b);
  const auto origin_of = [&](const Side& s) {
    return kind.meet || kind.line || kind.plane || s.is_world() ? spec.at : model.center_of_mass(s.body);
  };
  require_span(model, kind.name, a, origin_of(a));
  require_span(model, kind.name, b, origin_of(b));

  Constraint c;
  c.kind = spec.kind;
  c.options = {spec.angle, spec.slide, spec.second_angle};
  c.breaks = spec.breaks;
  c.cosines = frames.cosines;
  c.alignment = frames.alignment, c.aligned = frames.aligned, c.lock = frames.lock, c.line_side = frames.line_side;
  const double extent = std::max(a.extent, b.extent);
  for (int side = 0; side < 2; ++side) {
    const double own = side == 0 ? a.extent : b.extent;
    c.scale[side] = own > 0 ? own : extent > 0 ? extent : 1;
  }
  c.particles.fill(none);
  for (int place = 0; place < place_count; ++place) {
    if (!frames.has(place)) continue;
    const Side& side = place < b_origin ? a : b;
    add_place(model, c, place, side.body, origin_of(side) + c.scale[place >= b_origin] * frames.direction[place]);
  }
  constexpr double turn = 2 * std::numbers::pi;
  if (kind.screw) c.length = spec.lead / turn;
  return Joints::add(model, c);
}

std::uint32_t make_constraint(Model& model, const DistanceSpec& spec) {
  const char* const name = info(spec.kind).name;
  const std::uint32_t p = spec.p.slot, q = spec.q.slot;
  if (model.particles[p].body == model.particles[q].body)
    cannot(name, "particles " + std::to_string(p) + " and " + std::to_string(q) +
                     " are of one rigid body, whose distances never change");
  const double distance = norm(model.position(q) - model.position(p));
  Constraint c;
  c.kind = spec.kind;
  c.length = std::isnan(spec.length) ? distance : spec.length;
  if (!(c.length > 1e-9 && c.length <= 1e9)) {
    std::ostringstream got;
    got << c.length;
    cannot(name, "length must be between 1e-9 and 1e9 m, got " + got.str());
  }
  if (spec.kind == ConstraintKind::rod && are_on_one_ring(model, p, q))
    cannot(name, "particles " + std::to_string(p) + " and " + std::to_string(q) + " are hinged to each other");
  c.breaks = spec.breaks;
  c.scale = {c.length, c.length};
  c.particles.fill(none);
  c.particles[a_origin] = p, c.particles[b_origin] = q;
  return Joints::add(model, c);
}

namespace {

/// The frame of the body or world of a curve or surface, as side a or b.
void make_frame(Model& model, Constraint& c, const Side& side, int origin, const Vec3& at, const Quaternion& q) {
  const int which = origin == b_origin;
  c.scale[which] = side.extent > 0 ? side.extent : 1;
  const std::array<Vec3, 4> directions{Vec3{}, rotate(q, {0, 0, 1}), rotate(q, {1, 0, 0}), rotate(q, {0, 1, 0})};
  for (int i = 0; i < 4; ++i) add_place(model, c, origin + i, side.body, at + c.scale[which] * directions[i]);
}

void require_frame(const char* kind, const Side& side) {
  if (side.dimensions < 3)
    cannot(kind, side.what() + " and holds no frame for a curve or surface; give it a massive particle off its plane");
}

std::shared_ptr<const shape::Surface> make_surface(const Model& model, const SurfaceData& data) {
  if (data.function == 0) return shape::make_surface(shape::from_data(data.shape));
  const auto found = model.surface_functions.find(data.function);
  if (found == model.surface_functions.end()) return std::make_shared<shape::FunctionSurface>(nullptr, 1.0);
  return std::make_shared<shape::FunctionSurface>(found->second.phi, found->second.size);
}

std::shared_ptr<const geometry::Curve> make_curve(const CurveData& curve, std::span<const Vec3> points) {
  if (curve.kind == CurveKind::polyline)
    return std::make_shared<geometry::Polyline>(points, curve.closed != 0, curve.rounding);
  return std::make_shared<geometry::Spline>(points, curve.closed != 0);
}

}  // namespace

ConstraintGeometry make_geometry(const Model& model, const Constraint& c) {
  using Form = ConstraintKindInfo::Form;
  const Form form = info(c.kind).form;
  ConstraintGeometry made;
  if (form == Form::path) made.curve = make_curve(c.curve, {model.curve_points.data() + c.curve.first, c.curve.count});
  if (form == Form::surface || form == Form::surface_pair) made.surfaces[1] = make_surface(model, c.surfaces[1]);
  if (form == Form::surface_pair) made.surfaces[0] = make_surface(model, c.surfaces[0]);
  return made;
}

std::uint32_t make_constraint(Model& model, const PathSpec& spec) {
  const Side b = spec.body ? Side(model, spec.body.slot) : Side();
  require_frame(info(ConstraintKind::path).name, b);
  Constraint c;
  c.kind = ConstraintKind::path;
  c.breaks = spec.breaks;
  c.particles.fill(none);
  c.particles[a_origin] = spec.particle.slot;
  c.curve.kind = spec.curve, c.curve.closed = spec.closed, c.curve.rounding = spec.rounding;
  const Vec3 origin = b.is_world() ? Vec3{} : model.center_of_mass(b.body);
  std::vector<Vec3> local = spec.points;
  for (Vec3& p : local) p -= origin;
  const auto curve = make_curve(c.curve, local);  // throws for bad points before any change
  make_frame(model, c, b, b_origin, origin, {});
  c.curve.first = static_cast<std::uint32_t>(model.curve_points.size());
  c.curve.count = static_cast<std::uint32_t>(local.size());
  model.curve_points.insert(model.curve_points.end(), local.begin(), local.end());
  c.options[1] = spec.slide;
  if (!spec.closed && std::isinf(spec.slide.lower) && std::isinf(spec.slide.upper))
    c.options[1].lower = 0, c.options[1].upper = curve->length();
  c.length = curve->length();
  c.coordinate[1] = curve->nearest(model.position(spec.particle.slot) - origin);
  return Joints::add(model, c);
}

std::uint32_t make_constraint(Model& model, const SurfaceConstraintData& spec) {
  const Side b = spec.body ? Side(model, spec.body.slot) : Side();
  require_frame(info(spec.kind).name, b);
  Constraint c;
  c.kind = spec.kind;
  c.breaks = spec.breaks;
  c.particles.fill(none);
  c.particles[a_origin] = spec.particle.slot;
  c.surfaces[1] = spec.surface.data;
  const auto surface = make_surface(model, c.surfaces[1]);
  // No step is short enough round a sharp edge: a point on it would gain or lose speed there.
  if (info(spec.kind).sign == 0 && surface->skin() > 0)
    cannot(info(spec.kind).name,
           "the shape has sharp edges, and a point that is held on them has no direction there; "
           "give a box or cylinder a rounding, or keep the point inside or outside");
  make_frame(model, c, b, b_origin, spec.surface.position, spec.surface.orientation);
  return Joints::add(model, c);
}

std::uint32_t make_constraint(Model& model, const SurfacePairData& spec) {
  const std::array<Side, 2> sides{Side(model, spec.a.slot), spec.b ? Side(model, spec.b.slot) : Side()};
  Constraint c;
  c.kind = spec.kind;
  c.breaks = spec.breaks;
  c.particles.fill(none);
  for (std::size_t i = 0; i < 2; ++i) {
    require_frame(info(spec.kind).name, sides[i]);
    c.surfaces[i] = spec.surfaces[i].data;
    (void)make_surface(model, c.surfaces[i]);
  }
  for (std::size_t i = 0; i < 2; ++i)
    make_frame(model, c, sides[i], i == 0 ? a_origin : b_origin, spec.surfaces[i].position,
               spec.surfaces[i].orientation);
  return Joints::add(model, c);
}

std::uint32_t make_constraint(Model& model, const SpanSpec& spec) {
  Constraint c;
  c.kind = ConstraintKind::span;
  c.options[static_cast<std::size_t>(JointCoordinate::slide)] = spec.slide;
  c.breaks = spec.breaks;
  c.particles.fill(none);
  c.particles[a_origin] = spec.p.slot, c.particles[b_origin] = spec.q.slot;
  const double distance = norm(model.position(spec.q.slot) - model.position(spec.p.slot));
  c.coordinate[static_cast<std::size_t>(JointCoordinate::slide)] = distance;
  c.scale.fill(distance > 0 ? distance : 1);
  return Joints::add(model, c);
}

namespace {

/// Appends a term to a coupling's list and adds it at the head of its joint's.
void add_term(Model& model, std::uint32_t coupling, CoupledTerm term) {
  Constraint& joint = model.constraints[term.joint];
  term.coupling = coupling, term.next = none, term.next_at_joint = joint.coupled;
  const std::uint32_t slot = joint.coupled = model.coupled_terms.create(term).slot;
  std::uint32_t* end = &model.constraints[coupling].first_term;
  while (*end != none) end = &model.coupled_terms[*end].next;
  *end = slot;
}

std::uint32_t make_coupling(Model& model, ConstraintKind kind, std::span<const CoupledTerm> terms, double length,
                            const BreakLimits& breaks) {
  Constraint c;
  c.kind = kind;
  c.breaks = breaks;
  c.particles.fill(none);
  double sum = 0;
  for (const CoupledTerm& term : terms) sum += term.ratio * calc_coordinate(model, term.joint, term.coordinate).first;
  c.length = std::isnan(length) ? sum : length;
  const std::uint32_t slot = Joints::add(model, c);
  for (const CoupledTerm& term : terms) add_term(model, slot, term);
  const std::size_t points = coupled_points(model, model.constraints[slot]);
  if (points <= most_coupled_points) return slot;
  Joints::destroy(model, slot);
  cannot(info(kind).name, "its bodies have " + std::to_string(points) +
                              " points together (a particle 1, a rod 2, a solid 4), " + "and it may couple " +
                              std::to_string(most_coupled_points) + "; make two of it");
}

}  // namespace

std::uint32_t make_constraint(Model& model, const CouplingSpec& spec) {
  std::vector<CoupledTerm> terms;
  for (const CoupledCoordinate& given : spec.terms)
    terms.push_back({.joint = given.constraint.slot, .ratio = given.ratio, .coordinate = given.coordinate});
  return make_coupling(model, spec.kind, terms, spec.length, spec.breaks);
}

// Pieces between the same two particles are one span with a larger ratio.
std::uint32_t make_constraint(Model& model, const TackleSpec& spec) {
  std::vector<CoupledTerm> terms;
  for (std::size_t i = 0; i + 1 < spec.points.size(); ++i) {
    const ParticleId p = spec.points[i], q = spec.points[i + 1];
    const auto joins_them = [&](const CoupledTerm& term) {
      const Constraint& c = model.constraints[term.joint];
      return (c.particles[a_origin] == p.slot && c.particles[b_origin] == q.slot) ||
             (c.particles[a_origin] == q.slot && c.particles[b_origin] == p.slot);
    };
    if (const auto same = std::find_if(terms.begin(), terms.end(), joins_them); same != terms.end()) {
      same->ratio += 1;
      continue;
    }
    const std::uint32_t span = make_constraint(model, SpanSpec{.p = p, .q = q});
    model.constraints[span].is_part = 1;
    terms.push_back({.joint = span, .ratio = 1, .coordinate = JointCoordinate::slide});
  }
  return make_coupling(model, ConstraintKind::tackle, terms, spec.length, spec.breaks);
}

std::size_t coupled_points(const Model& model, const Constraint& coupling) {
  std::vector<std::uint32_t> bodies;
  for_each_term(model, coupling, [&](const CoupledTerm& term) {
    for (const int side : {0, 1})
      if (const std::uint32_t body = body_of_side(model, model.constraints[term.joint], side); body != none)
        bodies.push_back(body);
  });
  sort_unique(bodies);
  std::size_t points = 0;
  for (const std::uint32_t body : bodies) points += model.bodies[body].rank;
  return points;
}

std::uint32_t body_of_side(const Model& model, const Constraint& c, int side) {
  if (c.first_term != none) {
    std::uint32_t term = c.first_term;
    while (side == 1 && model.coupled_terms[term].next != none) term = model.coupled_terms[term].next;
    return body_of_side(model, model.constraints[model.coupled_terms[term].joint], 0);
  }
  const std::uint32_t origin = c.particles[side == 0 ? a_origin : b_origin];
  return origin == none ? none : model.particles[origin].body;
}

bool is_in_force(const Model& model, const Constraint& c) {
  bool complete = c.active, moves = false;
  const auto look_at = [&](const Constraint& joint) {
    complete = complete && joint.active;
    for (const int side : {0, 1}) {
      const std::uint32_t body = body_of_side(model, joint, side);
      if (body == none) continue;
      complete = complete && model.bodies[body].kind != BodyKind::inactive;
      moves = moves || is_free(model.bodies[body].kind);
    }
  };
  if (c.first_term == none) look_at(c);
  for_each_term(model, c, [&](const CoupledTerm& term) { look_at(model.constraints[term.joint]); });
  return complete && moves;
}

Vec3 calc_axis(const Model& model, const Constraint& c) {
  for (const int axis : {a_axis, b_axis}) {
    if (!c.has(axis)) continue;
    const Vec3 d = position_of(model, c, axis) - position_of(model, c, axis < b_origin ? a_origin : b_origin);
    return (1 / norm(d)) * d;
  }
  return {};
}

Vec3 position_of(const Model& model, const Constraint& c, int place) {
  return c.particles[place] == none ? c.fixed[place - b_origin] : model.position(c.particles[place]);
}

}  // namespace iota::ingredient

namespace iota {

bool has_coordinate(ConstraintKind kind, JointCoordinate coordinate) {
  const ingredient::ConstraintKindInfo& i = ingredient::info(kind);
  return std::array{i.angle, i.slide, i.second_angle}[static_cast<std::size_t>(coordinate)];
}

}  // namespace iota
