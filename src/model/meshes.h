// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/archive.h"

#include <cstdint>
#include <map>
#include <memory>
#include <string>

namespace iota {
class SchemaWriter;
struct Mesh;
}  // namespace iota

namespace iota::model {

/// The triangles of meshes, each mesh once, under the key of its content (shape::Data::key). It is kept while a solid
/// has it, and saved with the tables. Copies of a model share the triangles, which never change.
class Meshes {
 public:
  /// One more solid has the mesh. is_open: it encloses no volume, so that it is of a body that cannot move.
  void add_use(std::uint64_t key, const Mesh& mesh, bool is_open);
  void remove_use(std::uint64_t key);
  /// Null for an unknown key; 0 is that of shapes that are no mesh.
  std::shared_ptr<const Mesh> find(std::uint64_t key) const;
  bool is_open(std::uint64_t key) const;  ///< false for an unknown key

  /// visit(key, mesh, whether it is open, number of solids), in the order of keys.
  template <class Visit>
  void for_each(Visit visit) const {
    for (const auto& [key, used] : by_key_) visit(key, *used.mesh, used.is_open != 0, used.uses);
  }

  void archive(Writer&);
  void archive(Reader&);
  void archive(SchemaWriter&);

 private:
  struct Used {
    std::shared_ptr<const Mesh> mesh;
    std::uint32_t uses = 0, is_open = 0;
  };
  std::map<std::uint64_t, Used> by_key_;
};

/// Why a solid cannot have the mesh, empty if it can: an index without a vertex, a key that is not of its content, a hole
/// in one that is said to be closed.
std::string complaint_about(std::uint64_t key, const Mesh& mesh, bool is_open);

}  // namespace iota::model
