// SPDX-License-Identifier: Apache-2.0
#include "contact/touches.h"

#include "geometry/box_tree.h"

#include <algorithm>
#include <cmath>

namespace iota::contact {

namespace {

geometry::Bounds box_of_line(const Line& line, const Vec3& anchor) {
  const Vec3 reach{line.radius, line.radius, line.radius};
  return geometry::joined({line.a - anchor - reach, line.a - anchor + reach},
                          {line.b - anchor - reach, line.b - anchor + reach});
}

geometry::Bounds grown(geometry::Bounds box, double by) {
  const Vec3 reach{by, by, by};
  return {box.low - reach, box.high + reach};
}

const Vec3& anchor_of(const Outline& outline) {
  return outline.solids.empty() ? outline.lines.front().a : outline.solids.front().position;
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
  const auto known = hulls_.find(form.get());
  if (known != hulls_.end() && !known->second.form.expired())
    return known->second.polytope ? &*known->second.polytope : nullptr;
  std::erase_if(hulls_, [](const auto& each) { return each.second.form.expired(); });
  Hull& hull = hulls_[form.get()];
  hull.form = form;
  hull.polytope = form->mesh->is_closed() ? try_polytope(form->mesh->mesh()) : std::nullopt;
  return hull.polytope ? &*hull.polytope : nullptr;
}

TouchFinder::Part& TouchFinder::add(Parts& parts) {
  if (parts.count == parts.parts.size()) parts.parts.emplace_back();
  Part& part = parts.parts[parts.count++];
  part.solid = nullptr, part.line = nullptr, part.hull = nullptr;
  part.is_placed = false;
  return part;
}

void TouchFinder::list(const Outline& outline, const Vec3& anchor, Parts& parts) {
  parts.count = parts.convex = 0;
  for (const Solid& solid : outline.solids) {
    Part& part = add(parts);
    part.solid = &solid;
    if (solid.form->mesh) part.hull = hull_of(solid.form);
    part.is_convex = part.hull || (!solid.form->mesh && !solid.form->is_endless && is_convex(solid.form->shape));
    if (part.is_convex) part.box = bounds(solid, anchor), ++parts.convex;
  }
  for (const Line& line : outline.lines) {
    Part& part = add(parts);
    part.line = &line;
    part.is_convex = true, part.box = box_of_line(line, anchor), ++parts.convex;
  }
}

void TouchFinder::place(Part& part, const Vec3& spin, const Vec3& anchor) {
  if (part.is_placed) return;
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
  if (!a.is_polytope() || !b.is_polytope()) return round_.add_touches(a, b, anchor, within, found);
  TouchWriter writer(a, b, anchor, within, found);
  add_touches_of_polytopes(a, b, way, writer, clipper_);
}

void TouchFinder::find(const Outline& first, const Vec3& spin_of_first, const Outline& second,
                       const Vec3& spin_of_second, double within, std::vector<Touch>& found, const Vec3& way) {
  if ((first.solids.empty() && first.lines.empty()) || (second.solids.empty() && second.lines.empty())) return;
  const std::size_t before = found.size();
  const Vec3 anchor = anchor_of(second);
  list(first, anchor, first_), list(second, anchor, second_);
  if (first_.convex < first_.count || second_.convex < second_.count)
    find_corners(spin_of_first, spin_of_second, within, found);
  for (std::size_t i = 0; i < first_.count; ++i) {
    if (!first_.parts[i].is_convex) continue;
    const geometry::Bounds box = grown(first_.parts[i].box, within);
    for (std::size_t k = 0; k < second_.count; ++k)
      if (second_.parts[k].is_convex && geometry::overlap(box, second_.parts[k].box)) {
        place(first_.parts[i], spin_of_first, anchor), place(second_.parts[k], spin_of_second, anchor);
        find(first_.parts[i], second_.parts[k], anchor, within, way, found);
      }
  }
  if (!first.lines.empty() || !second.lines.empty()) drop_duplicates(found, before);
}

/// Parts that are not convex have no planes between them and others: corners of each against surfaces of the other.
void TouchFinder::find_corners(const Vec3& spin_of_first, const Vec3& spin_of_second, double within,
                               std::vector<Touch>& found) {
  enum Which { convex, others, closed, all };
  const auto choose = [](const Parts& parts, Which which, PartList& list) {
    list.clear();
    for (std::size_t k = 0; k < parts.count; ++k) {
      const Part& part = parts.parts[k];
      const bool is_open = part.solid && (part.solid->form->is_endless ||
                                          (part.solid->form->mesh && !part.solid->form->mesh->is_closed()));
      if (which == convex ? !part.is_convex : which == others ? part.is_convex : which == closed && is_open) continue;
      if (part.line) list.lines.push_back(part.line);
      if (part.solid) list.solids.push_back(part.solid);
    }
  };
  const auto look = [&](Which of_first, Which of_second, const CornerFinder::Names& names) {
    choose(first_, of_first, listed_), choose(second_, of_second, other_listed_);
    if (names.is_turned)
      corners_.find(other_listed_, spin_of_second, listed_, within, names, found);
    else
      corners_.find(listed_, spin_of_first, other_listed_, within, names, found);
  };
  constexpr std::uint32_t of_convex = 6u << 28;
  look(all, others, {});
  look(others, convex, {false, of_convex});
  look(others, closed, {true, of_convex});
}

}  // namespace iota::contact
