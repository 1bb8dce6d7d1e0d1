// SPDX-License-Identifier: Apache-2.0
#include "net/presenter.h"

#include "contact/outline.h"
#include "math/mat3.h"
#include "shape/shape_list.h"

#include <gtest/gtest.h>
#include <iota/system.h>

#include <algorithm>
#include <map>
#include <random>
#include <string>
#include <utility>
#include <vector>

namespace iota::net {
namespace {

/// The slots that changes set and destroy, by kind.
struct Told {
  std::map<std::string, std::vector<std::uint32_t>> set, destroyed;
  std::map<std::string, std::uint32_t> generation;  ///< of the last one set

  explicit Told(const EntityChanges& changes) {
    changes.for_each([&](std::uint8_t kind, protocol::Id id, std::span<const std::uint8_t> record) {
      const std::string name(entity_kind_name(kind));
      (record.empty() ? destroyed : set)[name].push_back(id.slot);
      generation[name] = id.generation;
    });
  }
};

const std::vector<std::string> simple_kinds{"nail", "particle_set", "tie"};

/// One of each thing that is one entity, in slot 3, as the engine describes it.
SceneChanges one_of_each(bool is_whole) {
  SceneChanges changes;
  changes.is_whole = is_whole;
  const Anchor world{{}, {1, 2, 3}};
  changes.ties.set.push_back({3, DrawnTie::Kind::rope, 0.5, world, world});
  changes.nails.set.push_back({3, world});
  changes.particle_sets.set.push_back({3, true, 100});
  return changes;
}

SceneChanges all_gone() {
  SceneChanges changes;
  changes.is_whole = false;
  for (auto* const gone : {&changes.ties.gone, &changes.nails.gone, &changes.particle_sets.gone})
    *gone = {3, 7};  // nothing was ever told of 7
  return changes;
}

TEST(Presenter, tells_each_thing_once_until_it_changes) {
  Presenter presenter;
  const Told first(presenter.present(one_of_each(true)));
  for (const std::string& kind : simple_kinds) EXPECT_EQ(first.set.at(kind), std::vector<std::uint32_t>{3}) << kind;
  EXPECT_TRUE(presenter.present(one_of_each(false)).empty());
  SceneChanges moved = one_of_each(false);
  moved.nails.set[0].at.point.x = 5;
  const Told second(presenter.present(moved));
  EXPECT_EQ(second.set.size(), 1u);
  EXPECT_EQ(second.generation.at("nail"), first.generation.at("nail"));
}

TEST(Presenter, knows_how_large_a_body_is_drawn) {
  System system;
  const BodyId box = system.bodies().create(Shape(Box{{0.1, 0.3, 0.2}}));
  Presenter presenter;
  const auto sizes = presenter.present(system.viewer().take_scene_changes()).sizes();
  ASSERT_EQ(sizes.size(), 1U);
  EXPECT_EQ(sizes[0].first, box.slot);
  EXPECT_FLOAT_EQ(sizes[0].second, 0.3F);
}

TEST(Presenter, reports_a_destroyed_entity_once_and_its_slot_gets_another_generation) {
  Presenter presenter;
  const Told first(presenter.present(one_of_each(true)));
  const Told gone(presenter.present(all_gone()));
  for (const std::string& kind : simple_kinds)
    EXPECT_EQ(gone.destroyed.at(kind), std::vector<std::uint32_t>{3}) << kind;
  EXPECT_TRUE(presenter.present(all_gone()).empty());
  const Told again(presenter.present(one_of_each(false)));
  for (const std::string& kind : simple_kinds) EXPECT_GT(again.generation.at(kind), first.generation.at(kind)) << kind;
}

TEST(Presenter, destroys_entities_that_a_complete_list_lacks) {
  Presenter presenter;
  (void)presenter.present(one_of_each(true));
  SceneChanges partial;
  partial.is_whole = false;
  EXPECT_TRUE(presenter.present(partial).empty());
  const Told gone(presenter.present(SceneChanges{}));
  for (const std::string& kind : simple_kinds)
    EXPECT_EQ(gone.destroyed.at(kind), std::vector<std::uint32_t>{3}) << kind;
}

TEST(Presenter, knows_a_body_by_the_id_that_viewers_have_until_it_is_gone) {
  Presenter presenter;
  const auto present = [&](BodyId id) {
    SceneChanges changes;
    changes.is_whole = false;
    DrawnBody body;
    body.id = id;
    body.particles = 1;
    changes.bodies.set.push_back(body);
    (void)presenter.present(changes);
  };
  present({2, 1});
  const protocol::Id old = presenter.id_of({2, 1});
  EXPECT_EQ(presenter.body(old), (BodyId{2, 1}));
  present({2, 5});  // another one in the same slot
  EXPECT_EQ(presenter.body(old), std::nullopt);
  EXPECT_EQ(presenter.id_of({2, 1}), protocol::Id{});
  EXPECT_EQ(presenter.body(presenter.id_of({2, 5})), (BodyId{2, 5}));
  SceneChanges gone;
  gone.is_whole = false;
  gone.bodies.gone.push_back(2);
  (void)presenter.present(gone);
  EXPECT_EQ(presenter.id_of({2, 5}), protocol::Id{});
}

/// The entities of one kind by slot.
template <class Entity>
std::map<std::uint32_t, Entity> entities(const EntityChanges& changes) {
  std::map<std::uint32_t, Entity> found;
  changes.for_each([&](std::uint8_t kind, protocol::Id id, std::span<const std::uint8_t> record) {
    if (kind == entity_kind<Entity>() && !record.empty())
      found[id.slot] = protocol::decode_records<Entity>(record).value->at(0);
  });
  return found;
}

/// The shape of a part, as long as its body says.
Shape shape_of(const protocol::Shape& wire, float length) {
  if (wire.kind == "mesh") {
    Mesh mesh;
    for (std::size_t i = 0; i < wire.vertices.size(); i += 3)
      mesh.vertices.push_back({wire.vertices[i], wire.vertices[i + 1], wire.vertices[i + 2]});
    for (std::size_t i = 0; i < wire.triangles.size(); i += 3)
      mesh.triangles.push_back({wire.triangles[i], wire.triangles[i + 1], wire.triangles[i + 2]});
    return mesh;
  }
  shape::Data data;
  shape::for_each_shape([&](const Shape& shape) {
    if (shape::name(shape) != wire.kind) return;
    data.kind = shape::to_data(shape).kind;
    const std::vector<std::string> names = shape::size_names(shape);
    for (std::size_t i = 0; i < wire.sizes.size(); ++i)
      data.sizes[i] = names[i] == "length" && length > 0 ? length : wire.sizes[i];
  });
  return shape::from_data(data);
}

struct Varied {
  System system{SystemOptions{.gravity = {}}};
  std::mt19937 random{8};

  double number(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random); }
  Vec3 place() { return {number(-1, 1), number(-1, 1), number(-1, 1)}; }
  ParticleId add_particle(BodyId body, const Vec3& at) {
    return system.particles().create(body, at, number(0.1, 3), place());
  }
  void add_solids() {
    const Mesh hull = convex_hull(std::vector<Vec3>{{0, 0, 0}, {0.7, 0, 0}, {0, 0.5, 0}, {0, 0, 0.3}});
    for (const Shape& shape :
         {Shape(Sphere{0.3}), Shape(Box{{0.6, 0.4, 0.2}, 0.05}), Shape(Cylinder{0.2, 0.7}), Shape(Capsule{0.1, 0.5}),
          Shape(Torus{0.3, 0.1, 0.2}), Shape(Ellipsoid{{0.5, 0.3, 0.2}}), Shape(Cone{0.2, 0.5}), Shape(hull)}) {
      const auto add = [&] {
        return system.bodies().create(
            shape, {.position = place(), .orientation = {number(0, 1), number(0, 1), 0.3, 0.2}, .spin = place()});
      };
      (void)add();
      (void)system.edits().combine(add(), add());
    }
  }
  void add_particles(int i) {
    const BodyId body = system.bodies().create();
    const Vec3 at = place();
    const ParticleId first = add_particle(body, at);
    for (int p = 0; p < i % 5; ++p) {
      const ParticleId next = add_particle(body, at + 0.3 * place());
      if (i % 7 == 1) (void)system.cosmetic_bonds().create(first, next);
    }
    if (i % 3 == 0) system.particles().set_attributes(first, {.radius = number(0.01, 0.2)});
    if (i % 4 == 0) system.bodies().set_radius(body, number(0.01, 0.2));
  }
};

TEST(Presenter, draws_the_outline_that_acts) {
  Varied scene;
  System& system = scene.system;
  scene.add_solids();
  for (int i = 0; i < 60; ++i) scene.add_particles(i);
  (void)system.step(0.02, 20);
  Presenter presenter;
  const EntityChanges changes = presenter.present(system.viewer().take_scene_changes());
  const auto bodies = entities<protocol::BodyEntity>(changes);
  const auto visuals = entities<protocol::VisualEntity>(changes);
  Places places = system.places();
  int compared = 0;
  for (const BodyId body : system.bodies().ids()) {
    const protocol::BodyEntity& entity = bodies.at(body.slot);
    const Vec3 center = system.bodies().center_of_mass(body);
    const Quaternion frame = system.bodies().orientation(body);
    contact::Outline drawn;
    for (const protocol::Part& part : visuals.at(entity.visual).parts) {
      const Vec3 offset{part.offset[0], part.offset[1], part.offset[2]};
      const Quaternion turn{part.rotation[0], part.rotation[1], part.rotation[2], part.rotation[3]};
      drawn.solids.push_back({contact::make_form(shape_of(part.shape, entity.length)), 0,
                              center + rotate(frame, offset), multiply(frame, turn)});
    }
    for (int i = 0; i < 40; ++i, ++compared) {
      const Vec3 at = center + 0.6 * scene.place();
      EXPECT_NEAR(near(drawn, at).distance, places.nearest(at, std::span(&body, 1))->distance, 3e-6)
          << "body " << body.slot << " drawn as " << visuals.at(entity.visual).name;
    }
  }
  EXPECT_GT(compared, 2000);
}

TEST(Presenter, draws_each_solid_of_a_body_in_a_material_of_its_own_with_what_is_beside_them) {
  System system;
  const BodyId arm = system.bodies().create(Shape(Capsule{0.1, 1}), {.position = {0, 0, 0}});
  for (const double x : {0.5, -0.5})
    (void)system.edits().combine(arm, system.bodies().create(Shape(Sphere{0.2}), {.position = {x, 0, 0}}));
  const auto part = [](const std::string& kind, const std::string& material) {
    protocol::Part made;
    made.style = "*", made.material = material, made.shape.kind = kind, made.rotation = {0, 0, 0, 1};
    if (kind == "sphere") made.shape.sizes = {0.05F};
    return made;
  };
  const auto drawn_as = [&](const std::vector<protocol::Part>& parts) {
    Presenter presenter;
    presenter.set_visual("arm", parts);
    presenter.assign(arm, "arm", false);
    const EntityChanges changes = presenter.present(system.viewer().take_scene_changes(true));
    const std::uint32_t visual = entities<protocol::BodyEntity>(changes).at(arm.slot).visual;
    std::vector<std::string> drawn;
    for (const protocol::Part& each : entities<protocol::VisualEntity>(changes).at(visual).parts)
      drawn.push_back(each.shape.kind + " of " + each.material);
    return drawn;
  };
  using Drawn = std::vector<std::string>;
  // The last material is that of all further solids.
  EXPECT_EQ(drawn_as({part("solid", "steel"), part("sphere", "glass"), part("solid", "brass")}),
            (Drawn{"capsule of steel", "sphere of brass", "sphere of brass", "sphere of glass"}));
  protocol::Part unseen = part("solid", "paint");
  unseen.color = 0xFF000000;
  EXPECT_EQ(drawn_as({unseen, part("sphere", "glass")}), (Drawn{"sphere of glass"}));
  EXPECT_EQ(drawn_as({unseen}).size(), 3u) << "something is drawn";
}

}  // namespace
}  // namespace iota::net
