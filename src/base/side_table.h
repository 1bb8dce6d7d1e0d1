// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/archive.h"
#include "base/slack.h"

#include <cstdint>
#include <type_traits>
#include <vector>

namespace iota {

/// Values of some items of a slot table, by the items' slots. Costs four bytes for each slot up to the highest
/// one with a value. Many threads may read, and write to existing values, at the same time.
template <class T>
class SideTable {
  static_assert(std::is_trivially_copyable_v<T>, "tables are saved as bytes");
  static constexpr std::uint32_t absent = 0xffffffff;

 public:
  bool is_empty() const { return values_.empty(); }
  std::uint32_t size() const { return static_cast<std::uint32_t>(values_.size()); }
  bool has(std::uint32_t slot) const { return slot < index_of_.size() && index_of_[slot] != absent; }

  /// The value of an item, or a default value if it has none.
  const T& operator[](std::uint32_t slot) const {
    static const T standard{};
    return has(slot) ? values_[index_of_[slot]] : standard;
  }
  T* find(std::uint32_t slot) { return has(slot) ? &values_[index_of_[slot]] : nullptr; }
  const T* find(std::uint32_t slot) const { return has(slot) ? &values_[index_of_[slot]] : nullptr; }
  /// The item must have a value.
  T& at(std::uint32_t slot) { return values_[index_of_[slot]]; }
  const T& at(std::uint32_t slot) const { return values_[index_of_[slot]]; }

  /// The value of an item; makes a default one if it has none.
  T& make(std::uint32_t slot) {
    if (!has(slot)) {
      if (index_of_.size() <= slot) index_of_.resize(slot + std::size_t{1}, absent);
      index_of_[slot] = size();
      reserve_a_quarter(values_), reserve_a_quarter(owners_);
      values_.push_back({}), owners_.push_back(slot);
    }
    return at(slot);
  }
  /// Copies the value of `from`, if it has one, to `to`.
  void copy(std::uint32_t from, std::uint32_t to) {
    if (!has(from)) return;
    const T value = at(from);
    make(to) = value;
  }
  /// Does nothing if the item has no value. The last value moves into the gap.
  void erase(std::uint32_t slot) {
    if (!has(slot)) return;
    const std::uint32_t index = index_of_[slot];
    index_of_[slot] = absent;
    if (index + 1 < size()) {
      values_[index] = values_.back(), owners_[index] = owners_.back();
      index_of_[owners_[index]] = index;
    }
    values_.pop_back(), owners_.pop_back();
  }

  /// Keeps its room.
  void clear() {
    for (const std::uint32_t slot : owners_) index_of_[slot] = absent;
    values_.clear(), owners_.clear();
  }

  template <class Visit>
  void for_each(Visit visit) const {
    for (std::uint32_t index = 0; index < size(); ++index) visit(owners_[index], values_[index]);
  }

  /// `slots`: number of slots of the item table; values of higher slots are refused.
  template <class Archive>
  void archive(Archive& ar, std::uint32_t slots) {
    ar.vector(values_), ar.vector(owners_);
    index_of_.clear();
    bool good = values_.size() == owners_.size();
    for (std::uint32_t index = 0; good && index < size(); ++index) {
      good = owners_[index] < slots && !has(owners_[index]);
      if (!good) break;
      if (index_of_.size() <= owners_[index]) index_of_.resize(owners_[index] + std::size_t{1}, absent);
      index_of_[owners_[index]] = index;
    }
    if (!good) ar.fail(), values_.clear(), owners_.clear(), index_of_.clear();
  }

 private:
  std::vector<T> values_;
  std::vector<std::uint32_t> owners_;    // of each value
  std::vector<std::uint32_t> index_of_;  // of each slot's value; not saved
};

}  // namespace iota
