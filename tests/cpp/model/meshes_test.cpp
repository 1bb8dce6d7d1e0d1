// SPDX-License-Identifier: Apache-2.0
#include "model/meshes.h"
#include "ingredient/model.h"
#include "ingredient/tables.h"
#include "shape/mesh.h"

#include <iota/system.h>

#include <gtest/gtest.h>

namespace iota::model {
namespace {

Mesh box(double size) {
  std::vector<Vec3> corners;
  for (const double x : {0.0, size})
    for (const double y : {0.0, size})
      for (const double z : {0.0, size}) corners.push_back({x, y, z});
  return convex_hull(corners);
}

std::uint64_t key_of(const Mesh& mesh) { return shape::Traits<Mesh>::key(mesh); }

std::vector<std::byte> saved(Meshes& meshes) {
  std::vector<std::byte> bytes;
  Writer writer(bytes);
  meshes.archive(writer);
  return bytes;
}

TEST(Meshes, a_mesh_is_kept_once_and_as_long_as_a_solid_has_it) {
  Meshes meshes;
  const Mesh mesh = box(1);
  meshes.add_use(key_of(mesh), mesh, false);
  meshes.add_use(key_of(mesh), mesh, false);
  meshes.remove_use(key_of(mesh));
  ASSERT_TRUE(meshes.find(key_of(mesh)));
  EXPECT_EQ(*meshes.find(key_of(mesh)), mesh);
  meshes.remove_use(key_of(mesh));
  EXPECT_FALSE(meshes.find(key_of(mesh)));
}

TEST(Meshes, saved_ones_are_read_again_and_cut_ones_refused) {
  Meshes meshes;
  for (const double size : {1.0, 2.0}) meshes.add_use(key_of(box(size)), box(size), false);
  const std::vector<std::byte> bytes = saved(meshes);
  Meshes read;
  Reader reader(bytes);
  read.archive(reader);
  EXPECT_TRUE(reader.ok() && reader.at_end());
  EXPECT_EQ(saved(read), bytes);
  for (std::size_t length = 0; length < bytes.size(); length += 7) {
    Reader cut{std::span(bytes).first(length)};
    read.archive(cut);
    EXPECT_FALSE(cut.ok()) << length;
  }
}

TEST(Meshes, a_mesh_that_no_solid_can_have_is_told) {
  const Mesh good = box(1);
  EXPECT_EQ(complaint_about(key_of(good), good, false), "");
  EXPECT_NE(complaint_about(key_of(good) + 1, good, false), "");
  Mesh open = good;
  open.triangles.pop_back();
  EXPECT_NE(complaint_about(key_of(open), open, false).find("not closed"), std::string::npos);
  EXPECT_EQ(complaint_about(key_of(open), open, true), "");
  Mesh torn = good;
  torn.triangles[0][0] = 99;
  EXPECT_NE(complaint_about(key_of(torn), torn, false).find("99"), std::string::npos);
}

TEST(Meshes, a_snapshot_takes_them_to_another_system_and_undo_brings_them_back) {
  System system;
  const Mesh mesh = box(0.5);
  const BodyId body = system.bodies().create(mesh, {.position = Vec3{1, 2, 3}});
  System other;
  other.restore(system.snapshot());
  ASSERT_EQ(other.bodies().solids(body).size(), 1u);
  EXPECT_EQ(std::get<Mesh>(other.bodies().solids(body)[0].shape), mesh);

  system.edits().begin();
  system.bodies().destroy(body);
  system.edits().end();
  system.edits().undo();
  EXPECT_EQ(std::get<Mesh>(system.bodies().solids(body)[0].shape), mesh);
}

TEST(Meshes, tables_with_a_mesh_too_few_or_too_many_are_told) {
  Model model;
  const Mesh mesh = box(1);
  model.meshes.add_use(key_of(mesh), mesh, false);
  EXPECT_FALSE(ingredient::validate(model).empty());
  model.meshes.remove_use(key_of(mesh));
  EXPECT_TRUE(ingredient::validate(model).empty());
}

}  // namespace
}  // namespace iota::model
