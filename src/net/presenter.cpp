// SPDX-License-Identifier: Apache-2.0
#include "net/presenter.h"

#include "net/fit_text.h"
#include "shape/shape.h"
#include "shape/shape_list.h"

#include <iota/system.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace iota::net {
namespace {

/// Lengths are rounded to this share of the scene's size, at most 1e-6 m: finer than visible. So a point of a moved
/// body keeps the same number, and is not sent again.
constexpr double finest = 1e-6;
constexpr std::size_t most_triangles = 50'000;
constexpr std::size_t most_record_bytes = 8 << 20;
constexpr std::size_t max_name = 63;  // of a body, bytes
constexpr const char* every_style = "*";
constexpr double of_body = 0.1;  // length of a look that fits its body, m: any value
/// The color of movable solids without a look. The page's own paint has the color of its ground, so they would hardly be
/// seen in front of it.
constexpr std::uint32_t slate = 0x5f88b0;
constexpr std::array tie_names{"spring", "rope", "rod"};

/// 0 for values that are not finite, so that an invalid world is shown as far as possible.
float round_to(double step, double value) {
  return std::isfinite(value) ? static_cast<float>(std::round(value / step) * step) + 0.0F : 0.0F;
}
protocol::Quat to_wire(const Quaternion& q) {
  return {round_to(finest, q.x), round_to(finest, q.y), round_to(finest, q.z), round_to(finest, q.w)};
}
float size(double value) { return std::isfinite(value) ? static_cast<float>(value) : 0.0F; }

/// Its name and its sizes, as in protocol/shapes.json; a mesh has vertices and triangles instead.
protocol::Shape to_wire(const Shape& shape) {
  protocol::Shape wire{std::string(shape::name(shape)), {}, {}, {}};
  const std::size_t count = shape::size_names(shape).size();
  const shape::Data data = shape::to_data(shape);
  for (std::size_t i = 0; i < count; ++i) wire.sizes.push_back(size(data.sizes[i]));
  const Mesh* const mesh = std::get_if<Mesh>(&shape);
  if (mesh == nullptr) return wire;
  for (const Vec3& v : mesh->vertices)
    for (const double x : {v.x, v.y, v.z}) wire.vertices.push_back(size(x));
  for (const auto& triangle : mesh->triangles)
    wire.triangles.insert(wire.triangles.end(), triangle.begin(), triangle.end());
  return wire;
}

/// The radius of a round shape, or of the tube of a torus, m, found by the name of the size. 0 for any other shape.
double radius_of(const protocol::Shape& wire) {
  double radius = 0;
  shape::for_each_shape([&](const Shape& shape) {
    if (shape::name(shape) != wire.kind) return;
    const std::vector<std::string> names = shape::size_names(shape);
    auto found = std::ranges::find(names, "tube");
    if (found == names.end()) found = std::ranges::find(names, "radius");
    const auto index = static_cast<std::size_t>(found - names.begin());
    if (index < std::min(names.size(), wire.sizes.size())) radius = wire.sizes[index];
  });
  return radius;
}

/// A zero length for any size of the scene.
protocol::Part make_part(std::string style, protocol::Shape shape, std::string material) {
  protocol::Part part;
  part.style = std::move(style), part.shape = std::move(shape), part.material = std::move(material);
  part.rotation = {0, 0, 0, 1};
  part.color = protocol::no_color;
  return part;
}

/// The paint of solids without a look.
protocol::Part paint_without_look(BodyKind kind) {
  protocol::Part part = make_part(every_style, {}, "paint");
  if (kind != BodyKind::static_) part.color = slate;
  return part;
}

protocol::BodyKind kind_of(BodyKind kind) {
  switch (kind) {
    case BodyKind::static_: return protocol::BodyKind::static_;
    case BodyKind::scripted: return protocol::BodyKind::scripted;
    case BodyKind::inactive: return protocol::BodyKind::inactive;
    default: return protocol::BodyKind::dynamic;  // a resting one looks the same
  }
}

protocol::TieKind kind_of(DrawnTie::Kind kind) {
  return std::array{protocol::TieKind::spring, protocol::TieKind::rope,
                    protocol::TieKind::rod}[static_cast<std::size_t>(kind)];
}

Vec3 rotated(const Quaternion& q, const Vec3& v) {
  const Vec3 u{q.x, q.y, q.z}, t = 2 * cross(u, v);
  return v + q.w * t + cross(u, t);
}

/// 0xRRGGBB. levels: of each of the three, without 0.
std::uint32_t to_wire(const Color& color, double levels) {
  std::uint32_t rgb = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const double share = std::round(std::clamp<double>(color[i], 0, 1) * levels);
    rgb = rgb << 8 | static_cast<std::uint32_t>(share * 255 / levels);
  }
  return rgb;
}

/// The color is rounded, so that many share a visual.
protocol::Part ball(double radius, const Color& color) {
  protocol::Part part = make_part(every_style, to_wire(Sphere{radius}), "paint");
  part.color = to_wire(color, 7);
  return part;
}

/// Instead of that of its look: its own, or that of its only particle.
std::uint32_t color_of(const DrawnBody& body, bool is_assigned) {
  if (body.color) return *body.color;
  return body.attributes && !is_assigned ? to_wire(body.attributes->color, 255) : protocol::no_color;
}

std::pair<Vec3, Box> box_around(const Mesh& mesh) {
  Vec3 low = mesh.vertices.front(), high = low;
  for (const Vec3& v : mesh.vertices) {
    low = {std::min(low.x, v.x), std::min(low.y, v.y), std::min(low.z, v.z)};
    high = {std::max(high.x, v.x), std::max(high.y, v.y), std::max(high.z, v.z)};
  }
  return {0.5 * (low + high), Box{high - low}};
}

/// About the longest extent of what a visual draws, m; 0 if that is not known.
float extent_of(const std::vector<protocol::Part>& parts) {
  float extent = 0;
  for (const protocol::Part& part : parts) {
    float own = size(2 * radius_of(part.shape));
    for (const float length : part.shape.sizes) own = std::max(own, length);
    for (const float coordinate : part.shape.vertices) own = std::max(own, 2 * std::abs(coordinate));
    if (own > 0) extent = std::max(extent, own + 2 * std::hypot(part.offset[0], part.offset[1], part.offset[2]));
  }
  return extent;
}

/// Parts with a length are as long as a rod, on whose line they belong: with unequal masses its middle is not at its
/// center of mass. The place is rounded, so that equal rods share a visual.
std::vector<protocol::Part> on_line(std::vector<protocol::Part> parts, const DrawnBody& body) {
  if (body.particles != 2 || body.lines.size() != 1 || !body.solids.empty()) return parts;
  const DrawnLine& line = body.lines[0];
  const float x = round_to(finest * line.length, line.center.x);
  if (x == 0) return parts;
  for (protocol::Part& part : parts)
    shape::for_each_shape([&](const Shape& shape) {
      if (shape::name(shape) != part.shape.kind) return;
      const std::vector<std::string> names = shape::size_names(shape);
      if (std::ranges::find(names, "length") != names.end()) part.offset[0] += x;
    });
  return parts;
}

/// The styles for which a visual has parts, and the first part of each.
std::vector<std::pair<std::string, const protocol::Part*>> first_parts(const std::vector<protocol::Part>& parts) {
  std::vector<std::pair<std::string, const protocol::Part*>> first;
  for (const protocol::Part& part : parts)
    if (std::ranges::find(first, part.style, [](const auto& known) { return known.first; }) == first.end())
      first.emplace_back(part.style, &part);
  return first;
}

bool is_wholly_transparent(std::uint32_t color) { return color != protocol::no_color && color >> 24 == 255; }

bool stands_for_solid(const protocol::Part& part) { return part.shape.kind == "solid"; }

/// How the solids of a body are drawn in one style. materials: those of the solids in their order; the last one is that of all
/// further ones. beside: parts that are drawn with them.
struct Dress {
  std::vector<const protocol::Part*> materials, beside;
};

/// Without a part that stands for solids, the first part gives its material and none is drawn.
Dress dress_of(const std::vector<protocol::Part>& parts, const std::string& style, const protocol::Part& first) {
  Dress dress;
  for (const protocol::Part& part : parts)
    if (part.style == style) (stands_for_solid(part) ? dress.materials : dress.beside).push_back(&part);
  if (dress.materials.empty()) return {{&first}, {}};
  return dress;
}

}  // namespace

// ------------------------------------------------------------------------------------------------------- the script's

void Presenter::set_visual(const std::string& name, std::vector<protocol::Part> parts) {
  const auto [place, is_new] = given_.try_emplace(name);
  Given& known = place->second;
  if (!is_new && known.parts == parts) return;
  known.is_solid = std::ranges::any_of(parts, stands_for_solid);
  known.parts = std::move(parts);
  // Bodies of a new visual are not assigned to it yet.
  needs_all_ = needs_all_ || !is_new || std::ranges::find(tie_names, name) != tie_names.end();
}

void Presenter::assign(BodyId body, const std::string& name, bool odd) {
  assignments_[body] = {name, odd};
  assigned_.push_back(body);
}

// ------------------------------------------------------------------------------------------------------------ telling

template <class Entity>
void Presenter::tell(std::uint32_t slot, Entity entity, bool is_other) {
  constexpr std::uint8_t kind = entity_kind<Entity>();
  if (told_[kind].size() <= slot) told_[kind].resize(slot + std::size_t{1});
  Told& known = told_[kind][slot];
  if (!known.is_there || is_other) ++known.generation;
  entity.id = {slot, known.generation};
  std::vector<std::uint8_t> record;
  protocol::append_record(entity, record);
  known.is_listed = true;
  if (known.is_there && known.record == record) return;
  known.is_there = true;
  out_.set(kind, entity.id, record);
  known.record = std::move(record);
}

template <class Entity>
void Presenter::forget(std::uint32_t slot) {
  constexpr std::uint8_t kind = entity_kind<Entity>();
  if (slot >= told_[kind].size() || !told_[kind][slot].is_there) return;
  Told& known = told_[kind][slot];
  known.is_there = false;
  known.record.clear();
  out_.destroy(kind, {slot, known.generation});
}

EntityChanges Presenter::present(const SceneChanges& changes, const NameOf& name_of) {
  out_ = {};
  if (changes.is_whole)
    for (std::vector<Told>& kind : told_)
      for (Told& known : kind) known.is_listed = false;
  if (changes.is_whole && changes.extent > 0) quantum_ = finest * std::min(1.0, changes.extent);
  if (needs_all_ || usual_radius_ != changes.usual_radius) {
    needs_all_ = false;
    usual_radius_ = changes.usual_radius;
    for (std::size_t kind = 0; kind < tie_names.size(); ++kind) {
      const std::uint32_t before = tie_visuals_[kind];
      tie_visuals_[kind] = use_tie_visual(kind);
      if (before != protocol::no_visual) release_visual(before);
    }
  }
  assigned_.clear();
  for (const DrawnBody& body : changes.bodies.set) present_body(body, name_of);
  for (const auto& [body, articulate] : changes.memberships) tell(body, protocol::MembershipEntity{{}, articulate});
  for_each_simple_kind(changes, [&](const auto& items, auto entity_of) {
    for (const auto& item : items.set) tell(item.slot, entity_of(item));
  });

  for (const std::uint32_t slot : changes.bodies.gone) forget_body(slot);
  if (changes.is_whole)
    for (std::uint32_t slot = 0; slot < bodies_.size(); ++slot)
      if (!told<protocol::BodyEntity>()[slot].is_listed) forget_body(slot);
  for_each_simple_kind(changes, [&](const auto& items, auto entity_of) {
    using Entity = decltype(entity_of(items.set.front()));
    for (const std::uint32_t slot : items.gone) forget<Entity>(slot);
    if (changes.is_whole)  // what is not in a complete list no longer exists
      for (std::uint32_t slot = 0; slot < told<Entity>().size(); ++slot)
        if (!told<Entity>()[slot].is_listed) forget<Entity>(slot);
  });
  return std::move(out_);
}

template <class Visit>
void Presenter::for_each_simple_kind(const SceneChanges& changes, Visit visit) const {
  visit(changes.ties, [&](const DrawnTie& tie) {
    return protocol::TieEntity{{},
                               kind_of(tie.kind),
                               tie_visuals_[static_cast<std::size_t>(tie.kind)],
                               size(std::max(tie.length, 0.0)),
                               anchored(tie.a),
                               anchored(tie.b)};
  });
  visit(changes.nails, [&](const DrawnNail& nail) { return protocol::NailEntity{{}, anchored(nail.at)}; });
  visit(changes.particle_sets,
        [](const DrawnParticleSet& set) { return protocol::ParticleSetEntity{{}, set.active, set.capacity}; });
}

void Presenter::present_body(const DrawnBody& body, const NameOf& name_of) {
  const std::uint32_t slot = body.id.slot;
  if (bodies_.size() <= slot) bodies_.resize(slot + std::size_t{1});
  DrawnAs& drawn = bodies_[slot];
  const bool is_other = body.is_new || drawn.id != body.id;
  const auto assignment = assignments_.find(body.id);
  const bool is_assigned = assignment != assignments_.end();
  const std::uint32_t visual = visual_of(body, is_assigned ? &assignment->second : nullptr);
  const double length = body.particles == 2 && body.lines.size() == 1 ? body.lines[0].length : 0;
  tell(slot,
       protocol::BodyEntity{{},
                            kind_of(body.kind),
                            visual,
                            is_assigned && assignment->second.odd,
                            size(length),
                            color_of(body, is_assigned),
                            name_of ? fit_text(name_of(body.id), max_name) : std::string()},
       is_other);
  out_.set_size(slot, length > 0                      ? size(length)
                      : visual != protocol::no_visual ? visuals_by_slot_[visual]->second.size
                                                      : 0.0F);
  if (drawn.visual != protocol::no_visual) release_visual(drawn.visual);
  drawn = {body.id, visual};
}

void Presenter::forget_body(std::uint32_t slot) {
  forget<protocol::BodyEntity>(slot);
  forget<protocol::MembershipEntity>(slot);
  if (slot >= bodies_.size() || bodies_[slot].visual == protocol::no_visual) return;
  release_visual(bodies_[slot].visual);
  bodies_[slot] = {};
}

std::optional<BodyId> Presenter::body(protocol::Id id) const {
  const std::vector<Told>& told = told_[entity_kind<protocol::BodyEntity>()];
  if (id.slot >= told.size() || !told[id.slot].is_there || told[id.slot].generation != id.generation)
    return std::nullopt;
  return bodies_[id.slot].id;
}

protocol::Id Presenter::id_of(BodyId body) const {
  const std::vector<Told>& told = told_[entity_kind<protocol::BodyEntity>()];
  if (body.slot >= bodies_.size() || bodies_[body.slot].id != body || !told[body.slot].is_there) return {};
  return {body.slot, told[body.slot].generation};
}

// ------------------------------------------------------------------------------------------------------------ visuals

/// All parts: the shapes of solids in the materials of the body's visual, or the visual's own shapes, otherwise a
/// default look of its particles.
std::uint32_t Presenter::visual_of(const DrawnBody& body, const Assignment* assignment) {
  const auto named = assignment ? given_.find(assignment->name) : given_.end();
  const Given* const own = named == given_.end() ? nullptr : &named->second;
  if (!body.solids.empty() && (!assignment || body.solids.size() > 1 || (own && own->is_solid)))
    return use_visual("(solid)", parts_of_solids(body, own));
  if (assignment && !own) return protocol::no_visual;
  if (own && ((body.particles <= 2 && body.balls.empty()) || !body.solids.empty()))
    return own->is_solid ? protocol::no_visual : use_visual(assignment->name, on_line(own->parts, body));
  if (body.particles == 1)
    return use_visual("(particle)",
                      {make_part(every_style, to_wire(Sphere{body.radius}), body.attributes ? "paint" : "brass")});
  if (body.particles == 2 && body.balls.empty())
    return use_visual("(rod)",
                      on_line({make_part(every_style, to_wire(Capsule{body.radius, of_body}), "steel")}, body));
  return use_visual("(body)", parts_along_lines(body, own));
}

std::vector<protocol::Part> Presenter::parts_of_solids(const DrawnBody& body, const Given* like) {
  const protocol::Part paint = paint_without_look(body.kind);
  std::vector<protocol::Part> parts;
  for (const auto& [style, first] :
       like ? first_parts(like->parts) : std::vector{std::pair{std::string(every_style), &paint}}) {
    const Dress dress = like ? dress_of(like->parts, style, *first) : Dress{{first}, {}};
    std::size_t number = 0;
    for (const DrawnSolid& solid : body.solids) {
      const Mesh* const mesh = std::get_if<Mesh>(&solid.shape);
      const protocol::Part& own = *dress.materials[std::min(number++, dress.materials.size() - 1)];
      if (!dress.beside.empty() && is_wholly_transparent(own.color)) continue;
      protocol::Part& part = parts.emplace_back(make_part(style, {}, own.material));
      part.color = own.color;
      part.offset = rounded(solid.position);
      part.rotation = to_wire(solid.orientation);
      if (mesh && mesh->triangles.size() > most_triangles) {
        const auto [center, box] = box_around(*mesh);
        part.shape = to_wire(box);
        part.offset = rounded(solid.position + rotated(solid.orientation, center));
        warnings_.push_back("the page draws meshes of at most " + std::to_string(most_triangles) +
                            " triangles, that of body " + std::to_string(body.id.slot) + " has " +
                            std::to_string(mesh->triangles.size()) +
                            ": its box is drawn instead. Make it coarser, or give the body another look");
      } else {
        part.shape = to_wire(solid.shape);
      }
    }
    for (const protocol::Part* const part : dress.beside) parts.push_back(*part);
  }
  return parts;
}

/// Capsules along the lines of a body, with the radius of its visual's shapes.
std::vector<protocol::Part> Presenter::parts_along_lines(const DrawnBody& body, const Given* like) const {
  const protocol::Part plain = make_part(every_style, to_wire(Capsule{body.radius, of_body}), "steel");
  std::vector<protocol::Part> parts;
  for (const auto& [style, first] :
       like ? first_parts(like->parts) : std::vector{std::pair{std::string(every_style), &plain}}) {
    const double drawn = radius_of(first->shape), radius = drawn > 0 ? drawn : body.radius;
    const std::size_t before = parts.size();
    const auto add = [&, first = first](protocol::Shape shape) -> protocol::Part& {
      protocol::Part& part = parts.emplace_back(make_part(style, std::move(shape), first->material));
      part.color = first->color;
      return part;
    };
    for (const DrawnLine& line : body.lines) {
      if (!(line.length > 0)) continue;
      protocol::Part& part = add(to_wire(Capsule{radius, line.length}));
      part.offset = rounded(line.center);
      part.rotation = to_wire(line.turn);
    }
    for (const DrawnBall& drawn : body.balls) {
      protocol::Part& part = parts.emplace_back(ball(drawn.radius, drawn.color));
      part.style = style;
      part.offset = rounded(drawn.center);
    }
    if (parts.size() == before) add(to_wire(Sphere{radius}));
  }
  return parts;
}

std::uint32_t Presenter::use_tie_visual(std::size_t kind) {
  const auto own = given_.find(tie_names[kind]);
  if (own != given_.end()) return use_visual(tie_names[kind], own->second.parts);
  switch (static_cast<DrawnTie::Kind>(kind)) {
    case DrawnTie::Kind::spring:
      return use_visual("spring",
                        {make_part(every_style, to_wire(Torus{0.8 * usual_radius_, 0.12 * usual_radius_}), "steel")});
    case DrawnTie::Kind::rope:
      return use_visual("rope", {make_part(every_style, to_wire(Cylinder{0.35 * usual_radius_, of_body}), "rope")});
    default:
      return use_visual("rod", {make_part(every_style, to_wire(Cylinder{0.4 * usual_radius_, of_body}), "steel")});
  }
}

/// Slot of the visual; each use has to be released.
std::uint32_t Presenter::use_visual(std::string_view name, const std::vector<protocol::Part>& parts) {
  protocol::VisualEntity visual{{}, std::string(name), parts};
  std::vector<std::uint8_t> record;
  protocol::append_record(visual, record);
  if (record.size() > most_record_bytes) {
    warnings_.push_back("the visual " + std::string(name) +
                        " has more shapes than a page can be told: nothing is drawn for it");
    return protocol::no_visual;
  }
  const auto [known, is_new] = visuals_.try_emplace(std::move(record));
  if (is_new) {
    if (free_visuals_.empty()) {
      known->second.slot = static_cast<std::uint32_t>(visuals_by_slot_.size());
      visuals_by_slot_.push_back(known);
    } else {
      known->second.slot = free_visuals_.back();
      free_visuals_.pop_back();
      visuals_by_slot_[known->second.slot] = known;
    }
    known->second.size = extent_of(parts);
    tell(known->second.slot, std::move(visual));
  }
  ++known->second.uses;
  return known->second.slot;
}

void Presenter::release_visual(std::uint32_t slot) {
  const auto visual = visuals_by_slot_[slot];
  if (--visual->second.uses > 0) return;
  forget<protocol::VisualEntity>(slot);
  visuals_.erase(visual);
  free_visuals_.push_back(slot);
}

protocol::Vec3 Presenter::rounded(const Vec3& v) const {
  return {round_to(quantum_, v.x), round_to(quantum_, v.y), round_to(quantum_, v.z)};
}

protocol::Anchor Presenter::anchored(const Anchor& anchor) const {
  return {anchor.body ? anchor.body.slot : protocol::no_body, rounded(anchor.point)};
}

}  // namespace iota::net
