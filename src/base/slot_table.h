// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/archive.h"
#include "base/slack.h"

#include <cstdint>
#include <type_traits>
#include <vector>

namespace iota {

/// Objects by value under ids of slot + generation. Generations are odd while the slot is alive, so a zero generation is
/// never alive and an old id never matches a reused slot. Slots are reused last-in first-out (deterministic).
template <class T, class IdType>
class SlotTable {
  static_assert(std::is_trivially_copyable_v<T>, "tables are saved as bytes");

 public:
  IdType create(const T& value) {
    std::uint32_t slot;
    if (free_.empty()) {
      slot = static_cast<std::uint32_t>(items_.size());
      reserve_a_quarter(items_), reserve_a_quarter(generations_);
      items_.push_back(value);
      generations_.push_back(1);
    } else {
      slot = free_.back();
      free_.pop_back();
      items_[slot] = value;
      ++generations_[slot];
    }
    ++alive_count_;
    return {slot, generations_[slot]};
  }

  void destroy(std::uint32_t slot) {
    ++generations_[slot];
    free_.push_back(slot);
    --alive_count_;
  }

  bool is_alive(std::uint32_t slot) const { return slot < items_.size() && is_used(slot); }
  bool contains(IdType id) const { return is_alive(id.slot) && generations_[id.slot] == id.generation; }
  IdType id(std::uint32_t slot) const { return {slot, generations_[slot]}; }

  T& operator[](std::uint32_t slot) { return items_[slot]; }
  const T& operator[](std::uint32_t slot) const { return items_[slot]; }

  std::uint32_t slot_count() const { return static_cast<std::uint32_t>(items_.size()); }
  std::uint32_t size() const { return alive_count_; }

  template <class Visit>
  void for_each(Visit visit) const {
    for (std::uint32_t slot = 0; slot < slot_count(); ++slot)
      if (is_used(slot)) visit(slot, items_[slot]);
  }
  template <class Visit>
  void for_each(Visit visit) {
    for (std::uint32_t slot = 0; slot < slot_count(); ++slot)
      if (is_used(slot)) visit(slot, items_[slot]);
  }

  /// Ids of all live objects, in the order of slots.
  std::vector<IdType> ids() const {
    std::vector<IdType> list;
    list.reserve(size());
    for_each([&](std::uint32_t slot, const T&) { list.push_back(id(slot)); });
    return list;
  }

  /// Only live objects are saved: a heap of 1000 bodies that fell had room for seven times its contacts, 17 of 21 MB.
  template <class Archive>
  void archive(Archive& ar) {
    constexpr bool reads = std::is_same_v<Archive, Reader>;
    if (reads || free_.empty()) {
      ar.vector(items_);
    } else {
      std::vector<T> alive;
      alive.reserve(alive_count_);
      for_each([&](std::uint32_t, const T& item) { alive.push_back(item); });
      ar.vector(alive);
    }
    ar.vector(generations_);
    ar.vector(free_);
    ar.value(alive_count_);
    if (reads) spread();
    if (is_consistent()) return;
    ar.fail();
    *this = {};
  }

 private:
  bool is_used(std::uint32_t slot) const { return generations_[slot] & 1u; }
  /// Live objects alone, in the order of slots, to their slots. Earlier versions have saved all.
  void spread() {
    if (items_.size() != alive_count_ || items_.size() >= generations_.size()) return;
    std::size_t next = items_.size();
    items_.resize(generations_.size());
    for (auto slot = static_cast<std::uint32_t>(items_.size()); slot-- > 0;)
      if (is_used(slot) && next > 0) items_[slot] = items_[--next];
  }
  /// Whether each slot is alive or in the free list exactly once: bytes from outside may be inconsistent.
  bool is_consistent() const {
    if (items_.size() != generations_.size() || alive_count_ + free_.size() != items_.size()) return false;
    std::vector<bool> is_free(items_.size(), false);
    for (const std::uint32_t slot : free_) {
      if (slot >= items_.size() || is_alive(slot) || is_free[slot]) return false;
      is_free[slot] = true;
    }
    std::uint32_t alive = 0;
    for (const std::uint32_t generation : generations_) alive += generation & 1u;
    return alive == alive_count_;
  }

  std::vector<T> items_;
  std::vector<std::uint32_t> generations_;
  std::vector<std::uint32_t> free_;
  std::uint32_t alive_count_ = 0;
};

}  // namespace iota
