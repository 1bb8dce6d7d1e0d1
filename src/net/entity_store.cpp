// SPDX-License-Identifier: Apache-2.0
#include "net/entity_store.h"

#include <algorithm>
#include <iterator>
#include <memory>
#include <string>
#include <utility>

namespace iota::net {
namespace {

/// A message of records ends above this many bytes.
constexpr std::size_t usual_bytes = 1 << 20;
constexpr std::size_t most_ids = 1 << 17;

template <std::size_t... I>
constexpr std::array<std::string_view, entity_kind_count> names_of(std::index_sequence<I...>) {
  return {std::tuple_element_t<I, protocol::EntityKinds>::kind_name...};
}

}  // namespace

std::string_view entity_kind_name(std::uint8_t kind) {
  static constexpr auto names = names_of(std::make_index_sequence<entity_kind_count>());
  return names[kind];
}

void EntityChanges::set(std::uint8_t kind, protocol::Id id, std::span<const std::uint8_t> record) {
  items_.push_back({kind, id, bytes_.size(), record.size()});
  bytes_.insert(bytes_.end(), record.begin(), record.end());
}

void EntityChanges::destroy(std::uint8_t kind, protocol::Id id) { items_.push_back({kind, id, bytes_.size(), 0}); }

void EntityChanges::append(const EntityChanges& later) {
  for (Item item : later.items_) {
    item.begin += bytes_.size();
    items_.push_back(item);
  }
  bytes_.insert(bytes_.end(), later.bytes_.begin(), later.bytes_.end());
  sizes_.insert(sizes_.end(), later.sizes_.begin(), later.sizes_.end());
}

std::optional<std::uint8_t> entity_kind_of(std::string_view name) {
  for (std::uint8_t kind = 0; kind < entity_kind_count; ++kind)
    if (entity_kind_name(kind) == name) return kind;
  return std::nullopt;
}

void EntityStore::apply(const EntityChanges& changes) {
  changes.for_each([&](std::uint8_t kind, protocol::Id id, std::span<const std::uint8_t> record) {
    Entry& entry = entry_at(kind, id.slot);
    entry.id = id;
    entry.record.assign(record.begin(), record.end());
    entry.version = ++version_;
    generations_[kind][id.slot] = id.generation;
    move_to_newest(index_of_[kind][id.slot]);
  });
}

EntityStore::Entry& EntityStore::entry_at(std::uint8_t kind, std::uint32_t slot) {
  std::vector<std::uint32_t>& index_of = index_of_[kind];
  if (index_of.size() <= slot) {
    index_of.resize(slot + std::size_t{1}, none);
    generations_[kind].resize(slot + std::size_t{1});
  }
  if (index_of[slot] == none) {
    index_of[slot] = static_cast<std::uint32_t>(entries_.size());
    entries_.push_back({.kind = kind});
  }
  return entries_[index_of[slot]];
}

void EntityStore::move_to_newest(std::uint32_t index) {
  if (index == newest_) return;
  Entry& entry = entries_[index];
  if (entry.newer != none) entries_[entry.newer].older = entry.older;
  if (entry.older != none) entries_[entry.older].newer = entry.newer;
  entry.older = newest_;
  entry.newer = none;
  if (newest_ != none) entries_[newest_].newer = index;
  newest_ = index;
}

const std::vector<Frame>& EntityStore::frames_since(std::uint64_t version) {
  if (framed_from_ == version && framed_to_ == version_) return frames_;
  framed_from_ = version, framed_to_ = version_;
  frames_.clear();

  std::vector<const Entry*> changed;
  for (std::uint32_t i = newest_; i != none && entries_[i].version > version; i = entries_[i].older) {
    if (version > 0 || !entries_[i].record.empty()) changed.push_back(&entries_[i]);
  }
  std::ranges::sort(changed, {}, [](const Entry* e) { return std::pair(e->kind, e->id.slot); });

  std::array<std::vector<protocol::Id>, entity_kind_count> gone;
  protocol::EntitiesSet set;
  const auto finish_set = [&] {
    if (!set.records.empty()) frames_.push_back(make_frame(set));
    set.records.clear();
  };
  for (const Entry* entry : changed) {
    if (entry->record.empty()) {
      gone[entry->kind].push_back(entry->id);
      continue;
    }
    const std::string_view kind = entity_kind_name(entry->kind);
    if (set.kind != kind || set.records.size() > usual_bytes) finish_set();
    set.kind = kind;
    set.records.insert(set.records.end(), entry->record.begin(), entry->record.end());
  }
  finish_set();
  // Destructions are last, in reverse order of kinds, so that no drawn entity lacks its visual.
  for (std::size_t kind = entity_kind_count; kind-- > 0;) {
    const std::vector<protocol::Id>& ids = gone[kind];
    for (std::size_t from = 0; from < ids.size(); from += most_ids) {
      const auto begin = ids.begin() + static_cast<std::ptrdiff_t>(from);
      const auto end = ids.begin() + static_cast<std::ptrdiff_t>(std::min(from + most_ids, ids.size()));
      frames_.push_back(make_frame(protocol::EntitiesDestroyed{
          std::string(entity_kind_name(static_cast<std::uint8_t>(kind))), std::vector(begin, end)}));
    }
  }
  return frames_;
}

}  // namespace iota::net
