// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/slot_table.h"

#include <algorithm>
#include <compare>
#include <cstdint>
#include <vector>

namespace iota::ingredient {

/// A slot table of items that have a member `body`, with the lists of the bodies: visiting the items of one body costs
/// only their number.
template <class T, class IdType>
class BodyTable : public SlotTable<T, IdType> {
  using Items = SlotTable<T, IdType>;

 public:
  IdType create(const T& item) {
    const IdType id = Items::create(item);
    by_body_.insert(find_from({item.body, id.slot}), {item.body, id.slot});
    return id;
  }
  void destroy(std::uint32_t slot) {
    by_body_.erase(find_from({(*this)[slot].body, slot}));
    Items::destroy(slot);
  }
  void move(std::uint32_t slot, std::uint32_t body) {
    by_body_.erase(find_from({(*this)[slot].body, slot}));
    (*this)[slot].body = body;
    by_body_.insert(find_from({body, slot}), {body, slot});
  }
  /// visit(slot, item): in the order of slots.
  template <class Visit>
  void for_each_of(std::uint32_t body, Visit visit) const {
    if (by_body_.empty()) return;
    for (auto at = find_from({body, 0}); at != by_body_.end() && at->body == body; ++at)
      visit(at->slot, (*this)[at->slot]);
  }
  bool has_any(std::uint32_t body) const {
    const auto at = find_from({body, 0});
    return at != by_body_.end() && at->body == body;
  }
  template <class Archive>
  void archive(Archive& ar) {
    Items::archive(ar);
    by_body_.clear();
    this->for_each([&](std::uint32_t slot, const T& item) { by_body_.push_back({item.body, slot}); });
    std::sort(by_body_.begin(), by_body_.end());
  }

 private:
  struct Entry {
    std::uint32_t body, slot;
    friend auto operator<=>(const Entry&, const Entry&) = default;
  };
  std::vector<Entry>::const_iterator find_from(const Entry& entry) const {
    return std::lower_bound(by_body_.begin(), by_body_.end(), entry);
  }

  std::vector<Entry> by_body_;  // in order; not saved
};

}  // namespace iota::ingredient
