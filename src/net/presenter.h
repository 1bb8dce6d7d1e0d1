// SPDX-License-Identifier: Apache-2.0
// Converts the engine's scene changes and the script's looks to records of entities for viewers. Keeps the records sent
// last, so that only differences are sent.
#pragma once

#include "net/entity_store.h"

#include <iota/scene.h>
#include <iota_protocol.h>

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace iota::net {

class Presenter {
 public:
  /// The parts of a visual, with which bodies or ties are drawn, in all styles. A part of kind "solid" stands for the
  /// body's own shape, and gives its material: the first for its first solid, the last for all further ones; other parts are drawn
  /// beside them. After a change of a visual all bodies have to be described again.
  void set_visual(const std::string& name, std::vector<protocol::Part> parts);
  /// Draws a body with a visual; the body must be in the engine's next changes.
  void assign(BodyId body, const std::string& name, bool odd);

  /// Whether the next changes must be complete.
  bool needs_all() const { return needs_all_; }
  /// Bodies that must be in the next changes.
  const std::vector<BodyId>& assigned() const { return assigned_; }

  using NameOf = std::function<std::string(BodyId)>;
  /// Converts the engine's changes to those of entities. name_of: the script's name of a body, empty without one.
  EntityChanges present(const SceneChanges& changes, const NameOf& name_of = {});
  /// Sentences since the last call about things that could not be drawn exactly.
  std::vector<std::string> take_warnings() { return std::exchange(warnings_, {}); }

  /// The body of a viewer's id; nothing if it no longer exists.
  std::optional<BodyId> body(protocol::Id id) const;
  /// The viewers' id of a body; null if it has not been sent.
  protocol::Id id_of(BodyId body) const;

 private:
  struct Told {
    std::uint32_t generation = 0;
    bool is_there = false, is_listed = false;
    std::vector<std::uint8_t> record;
  };
  /// A visual as the script gave it.
  struct Given {
    std::vector<protocol::Part> parts;
    bool is_solid = false;
  };
  struct Assignment {
    std::string name;
    bool odd = false;
  };
  struct DrawnAs {
    BodyId id;
    std::uint32_t visual = protocol::no_visual;
  };
  /// A visual as viewers were told.
  struct Visual {
    std::uint32_t slot = 0, uses = 0;
    float size = 0;  ///< of what is drawn, m
  };

  /// Sends an entity unless it is unchanged. A new thing in a slot gets a new generation.
  template <class Entity>
  void tell(std::uint32_t slot, Entity entity, bool is_other = false);
  template <class Entity>
  void forget(std::uint32_t slot);
  template <class Entity>
  std::vector<Told>& told() {
    return told_[entity_kind<Entity>()];
  }

  /// visit(items, entity_of), items: the changes of things that are one entity each, entity_of(item): its record. All
  /// kinds that the engine describes, except bodies, which have visuals.
  template <class Visit>
  void for_each_simple_kind(const SceneChanges& changes, Visit visit) const;
  void present_body(const DrawnBody& body, const NameOf& name_of);
  void forget_body(std::uint32_t slot);

  std::uint32_t visual_of(const DrawnBody& body, const Assignment* assignment);
  std::vector<protocol::Part> parts_of_solids(const DrawnBody& body, const Given* like);
  std::vector<protocol::Part> parts_along_lines(const DrawnBody& body, const Given* like) const;
  std::uint32_t use_tie_visual(std::size_t kind);
  std::uint32_t use_visual(std::string_view name, const std::vector<protocol::Part>& parts);
  void release_visual(std::uint32_t slot);
  protocol::Vec3 rounded(const Vec3& v) const;
  protocol::Anchor anchored(const Anchor& anchor) const;

  std::map<std::string, Given, std::less<>> given_;
  std::map<BodyId, Assignment> assignments_;
  std::vector<BodyId> assigned_;
  bool needs_all_ = true;
  double quantum_ = 1e-6;    ///< finer than visible, m
  double usual_radius_ = 0;  ///< with which the ties are drawn, m; 0: not known yet

  std::array<std::vector<Told>, entity_kind_count> told_;  ///< by slot
  std::vector<DrawnAs> bodies_;                            ///< by slot
  std::map<std::vector<std::uint8_t>, Visual> visuals_;    ///< by their records
  std::vector<std::map<std::vector<std::uint8_t>, Visual>::iterator> visuals_by_slot_;
  std::vector<std::uint32_t> free_visuals_;
  std::array<std::uint32_t, 3> tie_visuals_{protocol::no_visual, protocol::no_visual, protocol::no_visual};

  EntityChanges out_;
  std::vector<std::string> warnings_;
};

}  // namespace iota::net
