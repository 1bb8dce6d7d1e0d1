// SPDX-License-Identifier: Apache-2.0
#include "contact/touches.h"

#include "contact/apart.h"
#include "contact/gap.h"
#include "contact/ring_parts.h"
#include "geometry/box_tree.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <variant>

namespace iota::contact {

namespace {

const Vec3& anchor_of(const Outline& outline) {
  return outline.solids.empty() ? outline.lines.front().a : outline.solids.front().position;
}

constexpr std::uint32_t of_edges = 8u << 28;  ///< numbers of features

/// A corner of a mesh, or of a body on a face, touches also as a place of an edge.
void add_unless_known(const Touch& touch, double size, std::vector<Touch>& found) {
  constexpr double same = 1e-3;  // of the size, and below a cosine of 1
  const bool is_known = std::any_of(found.begin(), found.end(), [&](const Touch& other) {
    return norm(other.place - touch.place) < same * size && std::abs(dot(other.normal, touch.normal)) > 1 - same;
  });
  if (!is_known) found.push_back(touch);
}

/// Lines share points, so that they may find the same touch twice.
void drop_duplicates(std::vector<Touch>& found, std::size_t begin) {
  const auto is_same = [](const Touch& a, const Touch& b) {
    return a.part == b.part && a.feature == b.feature && a.other_part == b.other_part &&
           a.other_feature == b.other_feature && a.is_turned == b.is_turned;
  };
  std::size_t end = begin;
  for (std::size_t k = begin; k < found.size(); ++k) {
    bool is_known = false;
    for (std::size_t i = begin; i < end && !is_known; ++i) is_known = is_same(found[i], found[k]);
    if (!is_known) found[end++] = found[k];
  }
  found.resize(end);
}

}  // namespace

const Polytope* TouchFinder::hull_of(const std::shared_ptr<const Form>& form) {
  const std::optional<Polytope>& hull = hulls_.of(
      form, [&] { return form->mesh->is_closed() ? try_polytope(form->mesh->mesh()) : std::optional<Polytope>(); });
  return hull ? &*hull : nullptr;
}

TouchFinder::Part& TouchFinder::add(Parts& parts) {
  if (parts.count == parts.parts.size()) parts.parts.emplace_back();
  Part& part = parts.parts[parts.count++];
  part.solid = nullptr, part.line = nullptr, part.hull = nullptr;
  part.is_placed = false;
  return part;
}

void TouchFinder::list(const Outline& outline, const Vec3& anchor, Parts& parts) {
  parts.count = 0, parts.kinds = 0;
  for (const Solid& solid : outline.solids) {
    Part& part = add(parts);
    part.solid = &solid;
    if (solid.form->mesh) part.hull = hull_of(solid.form);
    part.kind = kind_of(solid, part.hull != nullptr);
    parts.kinds |= part.kind;
    if (part.is_met()) part.box = bounds(solid, anchor);
  }
  for (const Line& line : outline.lines) {
    Part& part = add(parts);
    part.line = &line, part.kind = Part::rod, part.box = bounds(line, anchor);
    parts.kinds |= part.kind;
  }
}

TouchFinder::Part::Kind TouchFinder::kind_of(const Solid& solid, bool is_hull) {
  const Form& form = *solid.form;
  if (form.is_endless || (form.mesh && !form.mesh->is_closed())) return Part::open;
  if (form.mesh) return is_hull ? Part::body : Part::mesh;
  if (std::holds_alternative<Torus>(form.shape)) return Part::ring;
  return std::holds_alternative<Sphere>(form.shape) || std::holds_alternative<Capsule>(form.shape) ? Part::rod
                                                                                                   : Part::body;
}

void TouchFinder::place(Part& part, const Vec3& spin, const Vec3& anchor) {
  if (part.is_placed || part.kind == Part::ring) return;
  part.is_placed = true;
  part.placed.spin = spin;
  if (part.line)
    place_part(*part.line, anchor, part.placed);
  else
    place_part(*part.solid, part.hull, anchor, part.placed);
}

void TouchFinder::find(Part& first, Part& second, const Vec3& anchor, double within, const Vec3& way,
                       std::vector<Touch>& found) {
  const ConvexPart &a = first.placed, &b = second.placed;
  if (first.kind == Part::ring || second.kind == Part::ring) {
    if (second.kind == Part::body)
      return add_touches_of_ring(*first.solid, *second.solid, b, false, anchor, within, found);
    if (first.kind == Part::body)
      return add_touches_of_ring(*second.solid, *first.solid, a, true, anchor, within, found);
    return RingToucher::add_touches(first.solid, first.kind == Part::rod ? &a : nullptr, second.solid,
                                    second.kind == Part::rod ? &b : nullptr, anchor, within, found);
  }
  if (!a.is_polytope() || !b.is_polytope()) return round_.add_touches(a, b, anchor, within, found);
  TouchWriter writer(a, b, anchor, within, found);
  add_touches_of_polytopes(a, b, way, writer, clipper_);
}

void TouchFinder::find_on_face(const ConvexPart& first, const ConvexPart& second, const Vec3& normal,
                               const Vec3& anchor, double within, std::vector<Touch>& found) {
  if (!first.is_polytope() || !second.is_polytope())
    return round_.add_on_face_of_second(first, second, normal, anchor, within, found);
  Axis axis{.second = face_along(second, normal), .is_farthest = false};
  if (axis.second == Polytope::none) return;
  TouchWriter writer(first, second, anchor, within, found);
  clipper_.add_touches(axis, writer, 4);
}

template <class MayTouch, class Visit>
void TouchFinder::for_each_near(const Vec3& anchor, const Vec3& spin_of_first, const Vec3& spin_of_second,
                                double within, MayTouch may_touch, Visit visit) {
  for (std::size_t i = 0; i < first_.count; ++i) {
    if (!first_.parts[i].is_met()) continue;
    const geometry::Bounds box = geometry::grown(first_.parts[i].box, within);
    for (std::size_t k = 0; k < second_.count; ++k)
      if (second_.parts[k].is_met() && geometry::overlap(box, second_.parts[k].box) &&
          may_touch(first_.parts[i], second_.parts[k])) {
        place(first_.parts[i], spin_of_first, anchor), place(second_.parts[k], spin_of_second, anchor);
        visit(first_.parts[i], second_.parts[k]);
      }
  }
}

namespace {

bool is_nothing(const Outline& outline) { return outline.solids.empty() && outline.lines.empty(); }

}  // namespace

void TouchFinder::find(const Outline& first, const Vec3& spin_of_first, const Outline& second,
                       const Vec3& spin_of_second, double within, std::vector<Touch>& found, const Vec3& way) {
  if (is_nothing(first) || is_nothing(second)) return;
  const bool are_single = first.solids.size() == 1 && second.solids.size() == 1;
  if (are_single && are_clearly_apart(first.solids[0], second.solids[0], within)) return;
  const std::size_t before = found.size();
  const Vec3 anchor = anchor_of(second);
  list(first, anchor, first_), list(second, anchor, second_);
  const bool has_meshes = (first_.kinds | second_.kinds) >= Part::mesh;
  if (has_meshes) find_corners(spin_of_first, spin_of_second, within, found);
  const auto may_touch = [&](const Part& one, const Part& other) {
    return are_single || !one.solid || !other.solid || !are_clearly_apart(*one.solid, *other.solid, within);
  };
  for_each_near(anchor, spin_of_first, spin_of_second, within, may_touch,
                [&](Part& one, Part& other) { find(one, other, anchor, within, way, found); });
  if (has_meshes) {
    find_on_edges(first_, spin_of_first, second_, true, anchor, within, found);
    find_on_edges(second_, spin_of_second, first_, false, anchor, within, found);
    find_between_edges(anchor, within, found);
  }
  if (!first.lines.empty() || !second.lines.empty()) drop_duplicates(found, before);
}

double TouchFinder::reach(const Part& part, const Vec3& direction, const Vec3& anchor) {
  if (part.kind != Part::ring) return dot(direction, farthest(part.placed, direction)) + part.placed.radius;
  const Vec3 far = support(*part.solid->form, rotate(conjugate(part.solid->turn), direction));
  return dot(direction, part.solid->position - anchor + rotate(part.solid->turn, far));
}

bool TouchFinder::may_meet(const MeshEdges::Edge& edge, const Vec3& a, const Vec3& b, const Vec3& outwards,
                           const Part& body, const Vec3& anchor, double within) {
  const double of_a = dot(outwards, a), of_b = dot(outwards, b);
  const double below = edge.has_two() ? 0 : within;  // an edge where a face ends has two outsides
  return -reach(body, -outwards, anchor) - std::max(of_a, of_b) <= within &&
         reach(body, outwards, anchor) - std::min(of_a, of_b) >= -below;
}

void TouchFinder::find_on_edges(Parts& bodies, const Vec3& spin, const Parts& meshes, bool are_meshes_second,
                                const Vec3& anchor, double within, std::vector<Touch>& found) {
  constexpr double deep = 1e-4;  // of the size
  for (std::size_t m = 0; m < meshes.count; ++m) {
    const Part& mesh = meshes.parts[m];
    if (mesh.is_met() || !mesh.solid->form->mesh) continue;
    const Solid& solid = *mesh.solid;
    const MeshEdges& edges = edges_of(solid);
    const Vec3 position = solid.position - anchor;
    const Quaternion back = conjugate(solid.turn);
    for (std::size_t k = 0; k < bodies.count; ++k) {
      Part& body = bodies.parts[k];
      if (!body.is_met()) continue;
      const geometry::Bounds box = geometry::grown(body.box, within);
      const Vec3 middle = rotate(back, 0.5 * (box.low + box.high) - position);
      const double reach = 0.5 * norm(box.high - box.low);
      edges.overlapping(
          geometry::grown({middle, middle}, reach), [&](std::uint32_t number, const MeshEdges::Edge& edge) {
            const Vec3 a = position + rotate(solid.turn, edge.a), b = position + rotate(solid.turn, edge.b);
            if (!geometry::overlap(box, geometry::around(a, b))) return;
            place(body, spin, anchor);
            if (!may_meet(edge, a, b, rotate(solid.turn, edge.outwards()), body, anchor, within)) return;
            set_edge(solid, number, a, b);
            on_edge_.clear();
            if (are_meshes_second)
              find(body, edge_, anchor, within, {}, on_edge_);
            else
              find(edge_, body, anchor, within, {}, on_edge_);
            const auto may_push = [&](const Touch& touch) {
              return edge.may_push(rotate(back, touch.is_turned == are_meshes_second ? -touch.normal : touch.normal));
            };
            const auto is_deep = [&](const Touch& touch) { return touch.gap < -deep * reach; };
            if (std::ranges::any_of(on_edge_, is_deep) && std::ranges::none_of(on_edge_, may_push))
              add_out_of_edge(edge, a, b, solid, body, are_meshes_second, anchor, within, found);
            for (Touch& touch : on_edge_) {
              if (!may_push(touch)) continue;
              std::uint32_t& feature = are_meshes_second ? touch.other_feature : touch.feature;
              if (feature < of_edges) feature = edge_.placed.line.feature;  // a round body names corners of a rod
              add_unless_known(touch, reach, found);
            }
          });
    }
  }
}

// The shortest way out of a box that has an edge in it near its own corner leads through the mesh: the box sank into the face.
void TouchFinder::add_out_of_edge(const MeshEdges::Edge& edge, const Vec3& a, const Vec3& b, const Solid& mesh,
                                  const Part& body, bool is_mesh_second, const Vec3& anchor, double within,
                                  std::vector<Touch>& found) {
  if (!body.solid || body.kind == Part::ring || !edge.has_two()) return;
  const Outline line{.lines = {{.a = a, .b = b}}};
  double least = std::numeric_limits<double>::infinity();
  Vec3 out, on_edge;
  for (std::size_t face = 0; face < 2; ++face) {
    const Vec3 normal = rotate(mesh.turn, edge.normal_of_face(face));
    if (!(dot(normal, body.placed.middle - a) > 0)) continue;  // it is behind the face
    const double above = std::max(dot(normal, a), dot(normal, b)) + reach(body, -normal, anchor);
    Solid lifted = *body.solid;
    lifted.position += above * normal - anchor;
    const std::optional<Cast> met = cast(line, lifted, -normal, above);
    if (met && above - met->distance < least) least = above - met->distance, out = normal, on_edge = met->point;
  }
  if (!(least < std::numeric_limits<double>::infinity())) return;
  const ConvexPart thin;
  const FeatureName of_body{body.placed.number, 0};
  const Vec3 on_body = on_edge - least * out;
  TouchWriter writer(thin, thin, anchor, within, found);
  if (is_mesh_second)
    writer.add_edges(on_body, on_edge, out, of_body, edge_.placed.line);
  else
    writer.add_edges(on_edge, on_body, -out, edge_.placed.line, of_body);
}

void TouchFinder::prepare(const Outline& outline) {
  for (const Solid& solid : outline.solids)
    if (solid.form->mesh && !hull_of(solid.form)) (void)edges_of(solid);
}

const MeshEdges& TouchFinder::edges_of(const Solid& solid) {
  return edges_.of(solid.form, [&] { return MeshEdges(solid.form->mesh->mesh(), solid.form->mesh->is_closed()); });
}

void TouchFinder::find_between_edges(const Vec3& anchor, double within, std::vector<Touch>& found) {
  const auto is_edged = [](const Part& part) { return !part.is_met() && part.solid->form->mesh; };
  for (std::size_t i = 0; i < first_.count; ++i)
    for (std::size_t k = 0; k < second_.count; ++k)
      if (const Part &one = first_.parts[i], &other = second_.parts[k]; is_edged(one) && is_edged(other))
        add_touches_of_edges({*one.solid, edges_of(*one.solid)}, {*other.solid, edges_of(*other.solid)}, of_edges,
                             anchor, within, found);
}

void TouchFinder::set_edge(const Solid& solid, std::uint32_t number, const Vec3& a, const Vec3& b) {
  edge_.solid = &solid, edge_.kind = Part::rod;
  ConvexPart& rod = edge_.placed;
  rod.radius = 0, rod.spin = {}, rod.is_line = true, rod.number = solid.number;
  rod.line = {solid.number, of_edges + 3 * number};
  rod.end = {solid.number, of_edges + 3 * number + 1}, rod.other_end = {solid.number, of_edges + 3 * number + 2};
  set_segment(a, b, rod);
}

void TouchFinder::find_on_faces(const Outline& first, const Vec3& spin_of_first, const Outline& second,
                                const Vec3& spin_of_second, const Vec3& normal, double within,
                                std::vector<Touch>& found) {
  if (is_nothing(first) || is_nothing(second)) return;
  const std::size_t before = found.size();
  const Vec3 anchor = anchor_of(second);
  list(first, anchor, first_), list(second, anchor, second_);
  const auto has_faces = [](const Part& one, const Part& other) {
    return one.kind != Part::ring && other.kind != Part::ring;
  };
  for_each_near(anchor, spin_of_first, spin_of_second, within, has_faces, [&](const Part& one, const Part& other) {
    find_on_face(one.placed, other.placed, normal, anchor, within, found);
  });
  if (!first.lines.empty() || !second.lines.empty()) drop_duplicates(found, before);
}

/// Parts that are not convex have no planes between them and others: corners of each against surfaces of the other.
void TouchFinder::find_corners(const Vec3& spin_of_first, const Vec3& spin_of_second, double within,
                               std::vector<Touch>& found) {
  const auto choose = [](const Parts& parts, unsigned kinds, PartList& list) {
    list.clear();
    for (std::size_t k = 0; k < parts.count; ++k) {
      const Part& part = parts.parts[k];
      if (!(part.kind & kinds)) continue;
      if (part.line) list.lines.push_back(part.line);
      if (part.solid) list.solids.push_back(part.solid);
    }
  };
  const auto look = [&](unsigned of_first, unsigned of_second, const CornerFinder::Names& names) {
    if (!(first_.kinds & of_first) || !(second_.kinds & of_second)) return;
    choose(first_, of_first, listed_), choose(second_, of_second, other_listed_);
    if (names.is_turned)
      corners_.find(other_listed_, spin_of_second, listed_, within, names, found);
    else
      corners_.find(listed_, spin_of_first, other_listed_, within, names, found);
  };
  // The same for both outlines, but that what is static is the second one: corners of open meshes, of rooms, are left out there.
  constexpr unsigned meshes = Part::mesh | Part::open, convex = Part::rod | Part::body;
  constexpr std::uint32_t of_rings = 5u << 28, of_convex = 6u << 28, of_bodies = 7u << 28;
  look(convex | meshes | Part::ring, meshes, {});
  look(meshes, Part::ring, {false, of_rings});
  look(meshes, convex, {false, of_convex});
  look(meshes, convex | Part::ring | Part::mesh, {true, of_convex});
  look(Part::ring, Part::mesh, {true, of_rings});
  look(convex, Part::mesh, {true, of_bodies});
}

}  // namespace iota::contact
