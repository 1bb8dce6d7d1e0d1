// SPDX-License-Identifier: Apache-2.0
#include "model/meshes.h"

#include "base/schema.h"
#include "base/text.h"
#include "shape/mesh.h"

#include <stdexcept>
#include <utility>

namespace iota::model {

void Meshes::add_use(std::uint64_t key, const Mesh& mesh, bool is_open) {
  Used& used = by_key_[key];
  if (!used.mesh) used.mesh = std::make_shared<const Mesh>(mesh), used.is_open = is_open;
  ++used.uses;
}

void Meshes::remove_use(std::uint64_t key) {
  const auto found = by_key_.find(key);
  if (found != by_key_.end() && --found->second.uses == 0) by_key_.erase(found);
}

std::shared_ptr<const Mesh> Meshes::find(std::uint64_t key) const {
  const auto found = by_key_.find(key);
  return found == by_key_.end() ? nullptr : found->second.mesh;
}

bool Meshes::is_open(std::uint64_t key) const {
  const auto found = by_key_.find(key);
  return found != by_key_.end() && found->second.is_open;
}

void Meshes::archive(Writer& outer) {
  std::vector<std::byte> bytes;
  Writer writer(bytes);
  writer.value(static_cast<std::uint64_t>(by_key_.size()));
  for (const auto& [key, used] : by_key_) {
    writer.value(key), writer.value(used.uses), writer.value(used.is_open);
    writer.vector(used.mesh->vertices), writer.vector(used.mesh->triangles);
  }
  outer.vector(bytes);
}

void Meshes::archive(SchemaWriter& writer) { writer.vector(std::vector<std::byte>()); }

void Meshes::archive(Reader& outer) {
  std::vector<std::byte> bytes;
  outer.vector(bytes);
  Reader reader(bytes);
  by_key_.clear();
  constexpr std::size_t least = 2 * sizeof(std::uint64_t);
  for (std::size_t left = reader.count(least); left > 0 && reader.ok(); --left) {
    std::uint64_t key = 0;
    Used used;
    Mesh mesh;
    reader.value(key), reader.value(used.uses), reader.value(used.is_open);
    reader.vector(mesh.vertices), reader.vector(mesh.triangles);
    used.mesh = std::make_shared<const Mesh>(std::move(mesh));
    if (!by_key_.emplace(key, std::move(used)).second) reader.fail();
  }
  if (!reader.ok() || !reader.at_end()) outer.fail();
}

std::string complaint_about(std::uint64_t key, const Mesh& mesh, bool is_open) {
  for (const auto& triangle : mesh.triangles)
    for (const std::uint32_t vertex : triangle)
      if (vertex >= mesh.vertices.size()) return text("a triangle has vertex ", vertex, " of ", mesh.vertices.size());
  if (shape::Traits<Mesh>::key(mesh) != key) return "its key is not that of its content";
  try {
    if (is_open)
      shape::Traits<Mesh>::check_triangles(mesh);
    else
      (void)mass_properties(mesh);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return {};
}

}  // namespace iota::model
