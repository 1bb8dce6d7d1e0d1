// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/archive.h"
#include "base/side_table.h"
#include "base/slack.h"
#include "base/slot_table.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <vector>

namespace iota::model {

inline constexpr std::uint32_t none = 0xffffffff;

/// Two particles joined by an item. Each of them has a list of all items that end at it. A link is slot * count + end:
/// the end of the next item at this particle.
struct Ends {
  static constexpr std::uint32_t count = 2;
  std::uint32_t p = none, q = none;
  std::array<std::uint32_t, count> next{none, none}, previous{none, none};

  std::uint32_t at(std::uint32_t end) const { return end == 0 ? p : q; }
  void set(std::uint32_t end, std::uint32_t particle) { (end == 0 ? p : q) = particle; }
};

/// The same with a third particle between the two.
struct ThreeEnds {
  static constexpr std::uint32_t count = 3;
  std::array<std::uint32_t, count> particles{none, none, none};  ///< the middle one is the second
  std::array<std::uint32_t, count> next{none, none, none}, previous{none, none, none};

  std::uint32_t at(std::uint32_t end) const { return particles[end]; }
  void set(std::uint32_t end, std::uint32_t particle) { particles[end] = particle; }
};

/// The head of the list of items at a particle.
struct ListHead {
  std::uint32_t first = none;
};

/// A table of items that join particles (they inherit `Ends` or `ThreeEnds`), with the lists of the particles: visiting
/// the items of one particle costs only their number.
template <class T, class IdType>
class EndTable : private SlotTable<T, IdType> {
  using Items = SlotTable<T, IdType>;
  static constexpr std::uint32_t count = T::count;

 public:
  using Items::contains, Items::for_each, Items::id, Items::ids, Items::is_alive, Items::size, Items::slot_count;
  using Items::operator[];

  /// Returns the slot.
  std::uint32_t create(const T& item) {
    const std::uint32_t slot = Items::create(item).slot;
    if (next_.size() < std::size_t{count} * slot_count()) {
      for (std::uint32_t end = 0; end < count; ++end) reserve_a_quarter(next_), next_.push_back(none);
    }
    for (std::uint32_t end = 0; end < count; ++end) link(slot, end);
    return slot;
  }
  void destroy(std::uint32_t slot) {
    for (std::uint32_t end = 0; end < count; ++end) unlink(slot, end);
    Items::destroy(slot);
  }

  bool ends_at(std::uint32_t particle) const { return heads.has(particle); }
  /// visit(slot); it may destroy that item.
  template <class Visit>
  void for_each_of(std::uint32_t particle, Visit visit) const {
    for (std::uint32_t link = heads[particle].first, next; link != none; link = next)
      next = next_[link], visit(link / count);
  }
  /// The items of q become p's: moved(slot). Those that would join p to itself go to drop(slot), which destroys them.
  template <class Moved, class Drop>
  void redirect(std::uint32_t q, std::uint32_t p, Moved moved, Drop drop) {
    while (heads.has(q)) {
      const std::uint32_t slot = heads[q].first / count, end = heads[q].first % count;
      bool has_p = false;
      for (std::uint32_t other = 0; other < count; ++other) has_p = has_p || (*this)[slot].at(other) == p;
      if (has_p) {
        drop(slot);
        continue;
      }
      unlink(slot, end);
      (*this)[slot].set(end, p);
      link(slot, end);
      moved(slot);
    }
  }

  /// `particles`: number of slots of their table.
  template <class Archive>
  void archive(Archive& ar, std::uint32_t particles) {
    Items::archive(ar);
    heads.archive(ar, particles);
    if constexpr (std::is_same_v<Archive, Reader>) {
      next_.resize(std::size_t{count} * slot_count());
      for (std::uint32_t link = 0; link < next_.size(); ++link) next_[link] = (*this)[link / count].next[link % count];
    }
  }
  /// Whether the links beside the items are theirs.
  bool has_links_of_items() const {
    bool are_same = next_.size() == std::size_t{count} * slot_count();
    for_each([&](std::uint32_t slot, const T& item) {
      for (std::uint32_t end = 0; are_same && end < count; ++end)
        are_same = next_[count * slot + end] == item.next[end];
    });
    return are_same;
  }

  SideTable<ListHead> heads;  ///< of the particles that have a list

 private:
  void set_next(std::uint32_t link, std::uint32_t next) {
    (*this)[link / count].next[link % count] = next_[link] = next;
  }
  /// Puts one end of an item at the front of its particle's list.
  void link(std::uint32_t slot, std::uint32_t end) {
    T& item = (*this)[slot];
    const std::uint32_t link = count * slot + end;
    std::uint32_t& first = heads.make(item.at(end)).first;
    set_next(link, first), item.previous[end] = none;
    if (first != none) (*this)[first / count].previous[first % count] = link;
    first = link;
  }
  void unlink(std::uint32_t slot, std::uint32_t end) {
    const T& item = (*this)[slot];
    const std::uint32_t before = item.previous[end], after = item.next[end];
    if (after != none) (*this)[after / count].previous[after % count] = before;
    if (before != none)
      set_next(before, after);
    else if (after != none)
      heads.at(item.at(end)).first = after;
    else
      heads.erase(item.at(end));
  }

  /// The next link of each, as in its item: a walk along a list of large items waits for the memory of each of them otherwise.
  std::vector<std::uint32_t> next_;
};

}  // namespace iota::model
