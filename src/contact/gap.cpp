// SPDX-License-Identifier: Apache-2.0
#include "contact/gap.h"

#include "contact/closest.h"
#include "math/mat3.h"
#include "shape/shape_list.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <variant>

namespace iota::contact {

namespace {

/// A convex piece of an outline: all points within `radius` of the set that the support tells.
struct Piece {
  FunctionRef<Vec3(const Vec3& direction)> support;
  double radius = 0;
  Vec3 middle;  ///< some place of it
};

const geometry::TriangleTree* triangles_of(const Form& form) {
  return form.mesh ? form.mesh.get() : form.surface.get();
}
Vec3 middle_of(const Form& form) { return 0.5 * (form.box.low + form.box.high); }
double reach_of(const Form& form) { return 0.5 * norm(form.box.high - form.box.low); }

/// visit(piece): a solid of a convex shape, not an endless one. Balls and capsules are points and segments with a radius, which
/// are exact.
template <class Visit>
void with_piece(const Solid& solid, Visit visit) {
  const Shape& shape = solid.form->shape;
  if (const auto* const s = std::get_if<Sphere>(&shape))
    return visit(Piece{[&](const Vec3&) { return solid.position; }, s->radius, solid.position});
  if (const auto* const c = std::get_if<Capsule>(&shape)) {
    const Vec3 half = rotate(solid.turn, {0.5 * c->length, 0, 0});
    return visit(Piece{[&](const Vec3& d) { return solid.position + (dot(half, d) > 0 ? half : -half); }, c->radius,
                       solid.position});
  }
  const Quaternion back = conjugate(solid.turn);
  visit(Piece{[&](const Vec3& d) { return to_world(solid, support(*solid.form, rotate(back, d))); }, 0,
              to_world(solid, middle_of(*solid.form))});
}
template <class Visit>
void with_piece(const Line& line, Visit visit) {
  visit(Piece{[&](const Vec3& d) { return dot(line.a, d) > dot(line.b, d) ? line.a : line.b; }, line.radius, line.a});
}
template <class Visit>
void with_piece(const std::array<Vec3, 3>& triangle, Visit visit) {
  const auto& [a, b, c] = triangle;
  visit(Piece{[&](const Vec3& d) {
                const Vec3& ahead = dot(a, d) > dot(b, d) ? a : b;
                return dot(ahead, d) > dot(c, d) ? ahead : c;
              },
              0, a});
}

/// From the second piece to the first one, which is moved.
struct Between {
  double distance;
  Vec3 normal, on_first, on_second;
};
Between between(const Piece& first, const Vec3& move, const Piece& second) {
  const Closest cores =
      closest([&](const Vec3& d) { return Support{first.support(d) + move}; },
              [&](const Vec3& d) { return Support{second.support(d)}; }, first.middle + move - second.middle);
  const double apart = cores.distance - first.radius - second.radius;
  const Vec3 on_first = cores.on_first - first.radius * cores.normal,
             on_second = cores.on_second + second.radius * cores.normal;
  return {std::max(0.0, apart), cores.normal, apart > 0 ? on_first : on_second, on_second};
}

/// The distance of a piece from a half-space, moved.
Between between(const Piece& first, const Vec3& move, const Solid& half_space) {
  const Vec3 normal = outwards(half_space);
  const Vec3 lowest = first.support(-normal) + move - first.radius * normal;
  const double apart = dot(normal, lowest - half_space.position);
  return {std::max(0.0, apart), normal, lowest, lowest - std::max(0.0, apart) * normal};
}

/// Keeps the least gap of two outlines.
class GapFinder {
 public:
  void add(const auto& first, const Solid& second, bool is_swapped) {
    const Form& form = *second.form;
    if (form.is_endless)
      return with_piece(first, [&](const Piece& piece) { take(between(piece, {}, second), is_swapped); });
    const geometry::TriangleTree* const tree = triangles_of(form);
    if (!tree) return add_pieces(first, second, is_swapped);
    with_piece(first, [&](const Piece& piece) { add_triangles(piece, bounds(first, {}), second, *tree, is_swapped); });
  }
  void add_pieces(const auto& first, const auto& second, bool is_swapped) {
    with_piece(first, [&](const Piece& one) {
      with_piece(second, [&](const Piece& other) { take(between(one, {}, other), is_swapped); });
    });
  }
  /// Solids that are both endless or of triangles.
  void add_both(const Solid& first, const Solid& second) {
    if (first.form->is_endless && second.form->is_endless) return add_half_spaces(first, second);
    if (first.form->is_endless || second.form->is_endless) {
      const bool is_swapped = first.form->is_endless;
      const Solid &half_space = is_swapped ? first : second, &other = is_swapped ? second : first;
      for (const Vec3& corner : triangles_of(*other.form)->vertices())
        with_piece(Line{0, 0, 0, to_world(other, corner), to_world(other, corner)},
                   [&](const Piece& point) { take(between(point, {}, half_space), is_swapped); });
      return;
    }
    const auto size = [](const Solid& solid) { return triangles_of(*solid.form)->mesh().triangles.size(); };
    const bool is_swapped = size(first) > size(second);
    const Solid &fewer = is_swapped ? second : first, &more = is_swapped ? first : second;
    const Mesh& mesh = triangles_of(*fewer.form)->mesh();
    if (is_within(*fewer.form, to_local(fewer, to_world(more, triangles_of(*more.form)->vertices().front()))))
      return take_place(to_world(more, triangles_of(*more.form)->vertices().front()));
    for (const auto& corners : mesh.triangles) {
      std::array<Vec3, 3> triangle;
      for (std::size_t k = 0; k < 3; ++k) triangle[k] = to_world(fewer, mesh.vertices[corners[k]]);
      const geometry::Bounds box =
          geometry::joined(geometry::around(triangle[0], triangle[1]), geometry::around(triangle[2], triangle[2]));
      with_piece(triangle,
                 [&](const Piece& piece) { add_triangles(piece, box, more, *triangles_of(*more.form), is_swapped); });
    }
  }
  const Gap& least() const { return least_; }
  bool may_be_nearer(const geometry::Bounds& a, const geometry::Bounds& b) const {
    return geometry::distance(a, b) < least_.distance;
  }

 private:
  void add_triangles(const Piece& piece, const geometry::Bounds& box, const Solid& solid,
                     const geometry::TriangleTree& tree, bool is_swapped) {
    const Vec3 inside = to_local(solid, piece.middle);
    if (is_within(*solid.form, inside)) return take_place(piece.middle);
    const double reach = 0.5 * norm(box.high - box.low), bound = norm(inside - tree.closest(inside));
    tree.near(to_local(solid, 0.5 * (box.low + box.high)), std::min(bound, least_.distance) + reach,
              [&](const Vec3& a, const Vec3& b, const Vec3& c) {
                const std::array triangle{to_world(solid, a), to_world(solid, b), to_world(solid, c)};
                with_piece(triangle, [&](const Piece& other) { take(between(piece, {}, other), is_swapped); });
              });
  }
  void add_half_spaces(const Solid& first, const Solid& second) {
    constexpr double opposite = 1e-12;
    const Vec3 n = outwards(second);
    const double apart = dot(n, first.position - second.position);
    if (!(norm(n + outwards(first)) < opposite && apart > 0)) return take_place(first.position);
    take({apart, n, first.position, first.position - apart * n}, false);
  }
  void take(const Between& found, bool is_swapped) {
    if (!(found.distance < least_.distance)) return;
    least_ = {found.distance, is_swapped ? found.on_second : found.on_first,
              is_swapped ? found.on_first : found.on_second};
  }
  void take_place(const Vec3& place) { take({0, {}, place, place}, false); }

  Gap least_;
};

/// How far a piece may go before it touches; nothing if it does not within the limit.
std::optional<Cast> advance(const Piece& probe, const Vec3& unit, double size, double limit, auto between_at) {
  constexpr double touching = 1e-9, surely = 1e-6;  // of the size
  constexpr int most_steps = 200;
  double gone = 0;
  Between now{};
  for (int step = 0; step < most_steps; ++step) {
    now = between_at(probe, gone * unit);
    if (now.distance <= touching * size) return Cast{gone, now.on_second};
    const double closing = -dot(unit, now.normal);
    if (!(closing > 0)) return {};
    gone += now.distance / closing;
    if (gone > limit) return {};
  }
  return now.distance <= surely * size ? std::optional(Cast{gone, now.on_second}) : std::nullopt;
}

}  // namespace

Gap gap(const Outline& first, const Outline& second) {
  GapFinder finder;
  const auto is_simple = [](const Solid& solid) { return !solid.form->is_endless && !triangles_of(*solid.form); };
  for (const Solid& one : first.solids) {
    for (const Solid& other : second.solids) {
      if (!one.form->is_endless && !other.form->is_endless && !finder.may_be_nearer(bounds(one, {}), bounds(other, {})))
        continue;
      if (is_simple(one))
        finder.add(one, other, false);
      else if (is_simple(other))
        finder.add(other, one, true);
      else
        finder.add_both(one, other);
    }
    for (const Line& line : second.lines) finder.add(line, one, true);
  }
  for (const Line& line : first.lines) {
    for (const Solid& other : second.solids) finder.add(line, other, false);
    for (const Line& other : second.lines)
      if (finder.may_be_nearer(bounds(line, {}), bounds(other, {}))) finder.add_pieces(line, other, false);
  }
  return finder.least();
}

std::optional<Cast> cast(const Outline& outline, const Solid& probe, const Vec3& unit, double farthest) {
  std::optional<Cast> first;
  const double size = norm(probe.form->box.high - probe.form->box.low);
  const auto limit = [&] { return first ? first->distance : farthest; };
  with_piece(probe, [&](const Piece& piece) {
    const auto advance_to = [&](const auto& part) {
      const auto met = advance(piece, unit, size, limit(),
                               [&](const Piece& moved, const Vec3& move) { return between(moved, move, part); });
      if (met && !(met->distance >= limit() && first)) first = met;
    };
    const auto add = [&](const auto& part) { with_piece(part, advance_to); };
    for (const Line& line : outline.lines) add(line);
    for (const Solid& solid : outline.solids) {
      const Form& form = *solid.form;
      if (form.is_endless) {
        advance_to(solid);
        continue;
      }
      const geometry::TriangleTree* const tree = triangles_of(form);
      if (!tree) {
        add(solid);
        continue;
      }
      const Vec3 start = to_local(solid, piece.middle), way = rotate(conjugate(solid.turn), unit);
      if (is_within(form, start)) {
        first = Cast{0, piece.middle};
        continue;
      }
      tree->along(start, way, reach_of(*probe.form), limit(), [&](const Vec3& a, const Vec3& b, const Vec3& c) {
        add(std::array{to_world(solid, a), to_world(solid, b), to_world(solid, c)});
        return limit();
      });
    }
  });
  return first;
}

}  // namespace iota::contact
