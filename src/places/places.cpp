// SPDX-License-Identifier: Apache-2.0
#include "places/places.h"

#include "geometry/overlap.h"
#include "math/mat3.h"
#include "shape/shape.h"
#include "shape/shape_list.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

namespace iota {

using geometry::Bounds;

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double close = 1e-6;  ///< of a line's thickness: a ray that comes so near has met it
constexpr int most_marches = 1000;
constexpr std::uint32_t fineness = 24;  ///< of the triangles of a torus: 0.9 % of its wire, 0.03 % of its radius inside

Quaternion conjugate(const Quaternion& q) { return {-q.x, -q.y, -q.z, q.w}; }

/// Whether each line between two points of a shape is in it. Those that are not have triangles of their own, as a hull
/// would close their holes.
bool is_convex(const Shape& shape) {
  return std::visit([]<class S>(const S& s) { return !requires { shape::Traits<S>::triangulate(s, 0u); }; }, shape);
}

Bounds around(const Vec3& center, double radius) {
  const Vec3 r{radius, radius, radius};
  return {center - r, center + r};
}

Vec3 nearest_of_segment(const Vec3& a, const Vec3& b, const Vec3& place) {
  const Vec3 along = b - a;
  const double squared = dot(along, along);
  return squared > 0 ? a + std::clamp(dot(place - a, along) / squared, 0.0, 1.0) * along : a;
}

void require_finite(const Vec3& place) {
  if (!is_finite(place)) throw std::invalid_argument("the place must be finite");
}

double reach_of_box(const Vec3& low, const Vec3& high) {
  const auto most = [](double a, double b) { return std::max(std::abs(a), std::abs(b)); };
  return norm({most(low.x, high.x), most(low.y, high.y), most(low.z, high.z)});
}

}  // namespace

// ----------------------------------------------------------------------------------------------------------- questions

std::optional<Hit> Places::ray(const Vec3& from, const Vec3& direction, double farthest, Only only) {
  require_finite(from);
  const double length = norm(direction);
  if (!(length > 0 && is_finite(direction))) throw std::invalid_argument("the direction of a ray must not be zero");
  const Vec3 unit = (1 / length) * direction;
  std::optional<Hit> first;
  search_along(from, unit, farthest, only, [&](const Known& body) {
    if (const auto met = meet(body, from, unit, farthest)) {
      farthest = *met;
      first = Hit{body.what, from + *met * unit, *met};
    }
    return farthest;
  });
  return first;
}

std::optional<Hit> Places::nearest(const Vec3& place, Only only) {
  require_finite(place);
  std::optional<Hit> best;
  search_near(place, infinity, only, [&](const Known& body) {
    const Near found = near(body, place);
    if (found.distance < (best ? best->distance : infinity)) best = Hit{body.what, found.point, found.distance};
    return best ? std::max(best->distance, 0.0) : infinity;  // within a body, it may be deeper in another one
  });
  return best;
}

std::vector<BodyId> Places::within(const Vec3& place, double radius, Only only) {
  require_finite(place);
  if (!(radius >= 0)) throw std::invalid_argument("the radius must be 0 m or more, not " + std::to_string(radius));
  std::vector<BodyId> found;
  search_near(place, radius, only, [&](const Known& body) {
    if (body.what.fixed == none && near(body, place).distance <= radius) found.push_back(body.what.body);
    return radius;
  });
  std::ranges::sort(found, {}, &BodyId::slot);
  return found;
}

std::vector<Found> Places::overlap(const Shape& shape, const Vec3& position, const Quaternion& orientation, Only only) {
  require_finite(position);
  shape::check(shape);
  if (!is_convex(shape) || !shape::is_solid(shape))
    throw std::invalid_argument("only a convex shape can be asked about, as a box, a sphere or a capsule; not a " +
                                std::string(shape::name(shape)));
  const shape::Bounds box = shape::bounds(shape);
  const Solid probe{.shape = shape, .position = position, .turn = orientation};
  const Vec3 middle = position + rotate(orientation, 0.5 * (box.low + box.high));
  const double reach = 0.5 * norm(box.high - box.low);
  std::vector<Found> found;
  search_near(middle, reach, only, [&](const Known& known) {
    if (is_overlapped(known, probe)) found.push_back(known.what);
    return reach;
  });
  std::ranges::sort(found, {}, [](const Found& each) {
    return std::pair(each.fixed != none, each.fixed != none ? each.fixed : each.body.slot);
  });
  return found;
}

std::uint32_t Places::add_fixed(const Shape& shape, const Vec3& position, const Quaternion& orientation) {
  shape::check(shape);
  return add(make_solid(shape, position, orientation));
}

std::uint32_t Places::add_fixed_surface(Mesh mesh, const Vec3& position, const Quaternion& orientation) {
  for (const auto& triangle : mesh.triangles)
    for (const std::uint32_t vertex : triangle)
      if (vertex >= mesh.vertices.size())
        throw std::invalid_argument("a triangle names vertex " + std::to_string(vertex) + " of " +
                                    std::to_string(mesh.vertices.size()));
  return add({.mesh = std::make_shared<geometry::TriangleTree>(std::move(mesh), false),
              .position = position,
              .turn = orientation});
}

std::uint32_t Places::add(Solid solid) {
  require_finite(solid.position);
  is_fixed_changed_ = true;
  const auto free = std::ranges::find_if(fixed_, [](const auto& each) { return !each; });
  const auto number = static_cast<std::uint32_t>(free - fixed_.begin());
  if (free == fixed_.end()) fixed_.emplace_back();
  fixed_[number] = std::move(solid);
  return number;
}

void Places::remove_fixed(std::uint32_t number) {
  fixed_.at(number).reset();
  is_fixed_changed_ = true;
}

void Places::set_thickness(BodyId body, double radius) {
  if (thickness_.size() <= body.slot) thickness_.resize(body.slot + 1);
  thickness_[body.slot] = {body, radius};
  has_moved_ = true;
}

template <class Visit>
void Places::search_near(const Vec3& place, double within, Only only, Visit visit) {
  refresh();
  if (only) {
    for (const std::uint32_t number : numbers(*only)) visit(known_[number]);
    return;
  }
  for (const std::uint32_t number : endless_) within = visit(known_[number]);
  tree_.near(place, within, [&](std::uint32_t item) { return visit(known_[items_[item]]); });
}

template <class Visit>
void Places::search_along(const Vec3& from, const Vec3& unit, double within, Only only, Visit visit) {
  refresh();
  if (only) {
    for (const std::uint32_t number : numbers(*only)) visit(known_[number]);
    return;
  }
  for (const std::uint32_t number : endless_) within = visit(known_[number]);
  tree_.along(from, unit, within, [&](std::uint32_t item) { return visit(known_[items_[item]]); });
}

std::vector<std::uint32_t> Places::numbers(std::span<const BodyId> only) const {
  std::vector<std::uint32_t> found;
  for (const BodyId id : only) {
    (void)system_.bodies().kind(id);  // throws if it is gone
    if (id.slot < number_.size() && number_[id.slot] != none) found.push_back(number_[id.slot]);
  }
  return found;
}

// ---------------------------------------------------------------------------------------------------------- up to date

void Places::refresh() {
  if (const std::uint32_t version = system_.viewer().scene_version(); version != version_) {
    version_ = version;
    describe_bodies();
    is_fixed_changed_ = true;
  }
  if (is_fixed_changed_) describe_fixed();
  read_places();
  if (!has_moved_ && places_ == before_) return;
  has_moved_ = false;
  const std::vector<std::uint32_t> items = std::exchange(items_, {});
  boxes_.clear(), endless_.clear();
  for (std::uint32_t number = 0; number < known_.size(); ++number) {
    const Known& body = known_[number];
    if (!body.is_active) continue;
    if (std::isinf(body.reach)) {
      endless_.push_back(number);
      continue;
    }
    items_.push_back(number);
    boxes_.push_back(bounds(body));
  }
  if (items_ == items && tree_.size() == items_.size())
    tree_.refit(boxes_);
  else
    tree_.build(boxes_);
  before_ = places_;
}

void Places::describe_bodies() {
  known_.clear(), number_.clear(), particles_.clear(), posed_.clear(), solids_.clear();
  for (const BodyId id : system_.bodies().ids()) {
    if (system_.viewer().is_spark(id)) continue;
    Known body{.what = {id}, .is_active = system_.bodies().kind(id) != BodyKind::inactive};
    describe_solids(body);
    if (body.pose == none) {
      const std::vector<ParticleId> own = system_.bodies().particles(id);
      if (own.empty()) continue;
      body.first = static_cast<std::uint32_t>(particles_.size());
      body.count = static_cast<std::uint32_t>(own.size());
      particles_.insert(particles_.end(), own.begin(), own.end());
    }
    if (number_.size() <= id.slot) number_.resize(id.slot + 1, none);
    number_[id.slot] = static_cast<std::uint32_t>(known_.size());
    known_.push_back(body);
  }
  body_count_ = known_.size(), body_solids_ = solids_.size();
}

void Places::describe_fixed() {
  is_fixed_changed_ = false;
  has_moved_ = true;
  known_.resize(body_count_), solids_.resize(body_solids_);
  for (std::uint32_t number = 0; number < fixed_.size(); ++number) {
    if (!fixed_[number]) continue;
    const Solid& solid = solids_.emplace_back(*fixed_[number]);
    known_.push_back({.what = {{}, number},
                      .first = static_cast<std::uint32_t>(solids_.size() - 1),
                      .count = 1,
                      .pose = fixed_pose,
                      .reach = reach_of(solid)});
  }
}

void Places::describe_solids(Known& body) {
  std::vector<SolidView> views = system_.bodies().solids(body.what.body);
  if (views.empty()) return;
  body.pose = static_cast<std::uint32_t>(posed_.size());
  posed_.push_back(body.what.body);
  body.first = static_cast<std::uint32_t>(solids_.size());
  const Vec3 place = system_.bodies().center_of_mass(body.what.body);
  const Quaternion back = conjugate(system_.bodies().orientation(body.what.body));
  for (SolidView& view : views) {
    const Solid& solid = solids_.emplace_back(
        make_solid(std::move(view.shape), rotate(back, view.position - place), multiply(back, view.orientation)));
    body.reach = std::max(body.reach, reach_of(solid) + norm(solid.position));
  }
  body.count = static_cast<std::uint32_t>(solids_.size()) - body.first;
}

Places::Solid Places::make_solid(Shape shape, const Vec3& position, const Quaternion& turn) {
  Solid solid{.position = position, .turn = turn};
  if (auto* const mesh = std::get_if<Mesh>(&shape)) {
    solid.mesh = std::make_shared<geometry::TriangleTree>(std::move(*mesh));
  } else {
    if (!is_convex(shape))
      solid.outline = std::make_shared<geometry::TriangleTree>(shape::triangulate(shape, fineness));
    solid.shape = std::move(shape);
  }
  return solid;
}

double Places::reach_of(const Solid& solid) {
  if (solid.mesh) return reach_of_box(solid.mesh->box().low, solid.mesh->box().high);
  const shape::Bounds box = shape::bounds(solid.shape);
  return reach_of_box(box.low, box.high);
}

void Places::read_places() {
  const std::size_t points = 3 * particles_.size();
  places_.resize(points + 7 * posed_.size());
  const std::span<double> all(places_);
  system_.many().read(Quantity::position, particles_, all.first(points));
  system_.many().read(Quantity::pose, posed_, all.subspan(points));
}

double Places::thickness(const Known& body) const {
  const std::uint32_t slot = body.what.body.slot;
  if (slot < thickness_.size() && thickness_[slot].id == body.what.body) return thickness_[slot].radius;
  return body.count > 1 ? usual_line_ : usual_ball_;
}

Bounds Places::bounds(const Known& body) const {
  const auto place = [&](std::size_t at) { return Vec3{places_[at], places_[at + 1], places_[at + 2]}; };
  if (body.pose == fixed_pose) return around(solids_[body.first].position, body.reach);
  if (body.pose != none) return around(place(3 * particles_.size() + 7 * body.pose), body.reach);
  const double radius = thickness(body);
  Bounds box = around(place(3 * body.first), radius);
  for (std::uint32_t i = 1; i < body.count; ++i) box = joined(box, around(place(3 * (body.first + i)), radius));
  return box;
}

// ------------------------------------------------------------------------------------------------------------ one body

template <class Visit>
void Places::for_each_line(const Known& body, Visit visit) const {
  const auto place = [&](std::uint32_t i) {
    const double* const at = places_.data() + 3 * (body.first + i);
    return Vec3{at[0], at[1], at[2]};
  };
  if (body.count == 1) return visit(place(0), place(0));
  for (std::uint32_t i = 1; i < body.count; ++i) visit(place(i - 1), place(i));
}

template <class Visit>
void Places::for_each_solid(const Known& body, Visit visit) const {
  if (body.pose == fixed_pose)
    return visit(solids_[body.first], solids_[body.first].position, solids_[body.first].turn);
  const double* const pose = places_.data() + 3 * particles_.size() + 7 * body.pose;
  const Vec3 place{pose[0], pose[1], pose[2]};
  const Quaternion turn{pose[3], pose[4], pose[5], pose[6]};
  for (std::uint32_t i = body.first; i < body.first + body.count; ++i)
    visit(solids_[i], place + rotate(turn, solids_[i].position), multiply(turn, solids_[i].turn));
}

bool Places::holds(const Solid& solid, const Vec3& local) {
  return solid.mesh ? solid.mesh->is_within(local) : shape::is_within(solid.shape, local);
}

Places::Near Places::near(const Known& body, const Vec3& place) const {
  Near best;
  if (body.pose != none) {
    for_each_solid(body, [&](const Solid& solid, const Vec3& origin, const Quaternion& turn) {
      const Vec3 local = rotate(conjugate(turn), place - origin);
      const Vec3 point = solid.mesh ? solid.mesh->closest(local) : shape::closest(solid.shape, local);
      const bool is_within = holds(solid, local);
      const double apart = is_within ? -norm(local - point) : norm(local - point);
      if (apart < best.distance) best = {apart, origin + rotate(turn, point)};
    });
    return best;
  }
  const double radius = thickness(body);
  for_each_line(body, [&](const Vec3& a, const Vec3& b) {
    const Vec3 middle = nearest_of_segment(a, b, place), away = place - middle;
    const double length = norm(away);
    if (length - radius >= best.distance) return;
    best = {length - radius, middle + radius * (length > 0 ? (1 / length) * away : Vec3{0, 1, 0})};
  });
  return best;
}

std::optional<double> Places::meet(const Known& body, const Vec3& from, const Vec3& unit, double farthest) const {
  std::optional<double> first;
  const auto found = [&](std::optional<double> distance) {
    if (distance && *distance <= farthest) first = distance, farthest = *distance;
  };
  if (body.pose != none) {
    for_each_solid(body, [&](const Solid& solid, const Vec3& origin, const Quaternion& turn) {
      const Quaternion back = conjugate(turn);
      const Vec3 local = rotate(back, from - origin), direction = rotate(back, unit);
      found(solid.mesh ? solid.mesh->ray(local, direction, farthest)
                       : shape::ray(solid.shape, local, direction, farthest));
    });
    return first;
  }
  const double radius = thickness(body);
  for_each_line(body, [&](const Vec3& a, const Vec3& b) {
    // Sphere tracing, see shape::ray, from the plane before the line to that behind it.
    const double begin = std::max(std::min(dot(a - from, unit), dot(b - from, unit)) - radius, 0.0);
    const double end = std::max(dot(a - from, unit), dot(b - from, unit)) + radius;
    double gone = begin;
    for (int march = 0; march < most_marches && gone <= std::min(farthest, end); ++march) {
      const Vec3 place = from + gone * unit;
      const double apart = norm(place - nearest_of_segment(a, b, place)) - radius;
      if (apart <= close * radius) return found(gone);
      gone += apart;
    }
  });
  return first;
}

bool Places::is_overlapped(const Known& known, const Solid& probe) const {
  const Quaternion into_probe = conjugate(probe.turn);
  const auto probed = [&](const Vec3& direction) {
    return probe.position + rotate(probe.turn, shape::support(probe.shape, rotate(into_probe, direction)));
  };
  if (known.pose == none) {
    const double radius = thickness(known);
    bool is_met = false;
    for_each_line(known, [&](const Vec3& a, const Vec3& b) {
      const auto line = [&](const Vec3& d) { return (dot(a, d) > dot(b, d) ? a : b) + radius / norm(d) * d; };
      is_met = is_met || geometry::overlap(line, probed);
    });
    return is_met;
  }
  bool is_met = false;
  for_each_solid(known, [&](const Solid& solid, const Vec3& origin, const Quaternion& turn) {
    if (is_met) return;
    const Quaternion back = conjugate(turn);
    const Vec3 middle = rotate(back, probe.position - origin);
    const auto local = [&](const Vec3& direction) { return rotate(back, probed(rotate(turn, direction)) - origin); };
    if (holds(solid, middle)) {
      is_met = true;
    } else if (const Tree& tree = solid.mesh ? solid.mesh : solid.outline) {
      const shape::Bounds box = shape::bounds(probe.shape);
      tree->near(middle, reach_of_box(box.low, box.high), [&](const Vec3& a, const Vec3& b, const Vec3& c) {
        const auto triangle = [&](const Vec3& d) {
          const Vec3 ahead = dot(a, d) > dot(b, d) ? a : b;
          return dot(ahead, d) > dot(c, d) ? ahead : c;
        };
        is_met = is_met || geometry::overlap(triangle, local);
      });
    } else if (std::isinf(known.reach)) {
      // An endless convex one: the probe's point that is farthest on the way to it is in it, or none is.
      is_met = shape::is_within(solid.shape, local(shape::closest(solid.shape, middle) - middle));
    } else {
      is_met = geometry::overlap([&](const Vec3& d) { return shape::support(solid.shape, d); }, local);
    }
  });
  return is_met;
}

}  // namespace iota
