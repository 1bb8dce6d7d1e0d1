// SPDX-License-Identifier: Apache-2.0
// The entities of a world for viewers: the latest record of each, and those that a client has not received yet.
// A slow client is sent the latest record of each changed entity; a new client is sent all.
#pragma once

#include "net/out_queue.h"

#include <iota_protocol.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

namespace iota::net {

inline constexpr std::size_t entity_kind_count = std::tuple_size_v<protocol::EntityKinds>;

/// Index of a kind in protocol::EntityKinds.
template <class Entity, std::size_t I = 0>
constexpr std::uint8_t entity_kind() {
  if constexpr (std::is_same_v<Entity, std::tuple_element_t<I, protocol::EntityKinds>>)
    return I;
  else
    return entity_kind<Entity, I + 1>();
}

std::string_view entity_kind_name(std::uint8_t kind);
std::optional<std::uint8_t> entity_kind_of(std::string_view name);

/// Changes of entities, in order: records, and ids of destroyed ones.
class EntityChanges {
 public:
  void set(std::uint8_t kind, protocol::Id id, std::span<const std::uint8_t> record);
  void destroy(std::uint8_t kind, protocol::Id id);
  /// How large the body in a slot is drawn, m; 0: not known. Not sent: it decides how exactly its poses are.
  void set_size(std::uint32_t slot, float size) { sizes_.emplace_back(slot, size); }
  const std::vector<std::pair<std::uint32_t, float>>& sizes() const { return sizes_; }
  bool empty() const { return items_.empty() && sizes_.empty(); }
  void append(const EntityChanges& later);

  /// visit(kind, id, record): without a record the entity was destroyed.
  template <class Visit>
  void for_each(Visit visit) const {
    for (const Item& item : items_) visit(item.kind, item.id, std::span(bytes_).subspan(item.begin, item.size));
  }

 private:
  struct Item {
    std::uint8_t kind = 0;
    protocol::Id id;
    std::size_t begin = 0, size = 0;
  };
  std::vector<Item> items_;
  std::vector<std::uint8_t> bytes_;
  std::vector<std::pair<std::uint32_t, float>> sizes_;
};

class EntityStore {
 public:
  void apply(const EntityChanges& changes);

  /// Rises with each change of an entity.
  std::uint64_t version() const { return version_; }
  /// The messages that update a client from `version` to the present; 0: a new client. Shared by all clients of the
  /// same version.
  const std::vector<Frame>& frames_since(std::uint64_t version);
  /// The present or last entity in each slot of a kind.
  std::span<const std::uint32_t> generations(std::uint8_t kind) const { return generations_[kind]; }

 private:
  static constexpr std::uint32_t none = 0xffffffff;
  struct Entry {
    std::uint8_t kind = 0;
    protocol::Id id;
    std::uint64_t version = 0;  ///< of its last change
    std::uint32_t older = none, newer = none;
    std::vector<std::uint8_t> record;  ///< empty: destroyed
  };
  Entry& entry_at(std::uint8_t kind, std::uint32_t slot);
  void move_to_newest(std::uint32_t index);

  std::vector<Entry> entries_;
  std::array<std::vector<std::uint32_t>, entity_kind_count> index_of_;     ///< by slot
  std::array<std::vector<std::uint32_t>, entity_kind_count> generations_;  ///< by slot
  std::uint32_t newest_ = none;
  std::uint64_t version_ = 0;

  std::uint64_t framed_from_ = 0, framed_to_ = 0;
  std::vector<Frame> frames_;
};

}  // namespace iota::net
