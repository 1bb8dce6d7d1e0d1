// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/disjoint_sets.h"
#include "base/text.h"
#include "model/structure.h"

#include <algorithm>
#include <array>
#include <map>
#include <string>
#include <vector>

namespace iota::model {

/// Checks a model. All counts in records are counted here again, independently of edits. Links are
/// checked first: tables read from bytes may contain any number, and all other checks follow slots and
/// lists.
class Audit {
 public:
  explicit Audit(const Structure&);
  bool is_good() const { return complaints_.empty(); }

  /// @name Links: slots are alive, lists end, and enumerators are in their range
  ///@{
  void check_links();  ///< of the structure
  /// Lists with a way back, by numbers of links below link_count: the first of each, and the ones before and after a
  /// link, or `none`. As each link is after at most one other, and the first after none, lists end.
  template <class IsAlive, class Next, class Previous>
  void check_lists(const char* what, const std::vector<std::uint32_t>& firsts, std::uint32_t link_count,
                   IsAlive is_alive, Next next, Previous previous);
  template <class T, class IdType>
  void check_ends(const char* what, const EndTable<T, IdType>& items) {
    check_ends(what, items, model_.particles);
  }
  template <class T, class IdType>
  void check_ends(const char* what, const EndTable<T, IdType>& items, const auto& owners);
  /// The text in an array of characters has its end in it.
  template <std::size_t n>
  void require_text(const char* what, std::uint32_t slot, const std::array<char, n>& characters) {
    require(std::find(characters.begin(), characters.end(), '\0') != characters.end(), what, " ", slot,
            " has a text without an end");
  }
  bool require_shape(const char* what, std::uint32_t slot, const shape::Data&);
  ///@}

  template <class... Parts>
  void require(bool condition, const Parts&... parts) {
    if (!condition) complaints_.push_back(text(parts...));
  }
  /// Every value of a side table belongs to an existing item.
  void require_owners(const char* what, const auto& values, const auto& owners) {
    values.for_each([&](std::uint32_t slot, const auto&) {
      require(owners.is_alive(slot), what, " of ", slot, ", which does not live");
    });
  }
  /// They are particles, each another one.
  template <class T>
  void require_ends(const char* what, std::uint32_t slot, const T& item);
  /// Every end of an item is only in the list of its particle.
  template <class T, class IdType>
  void require_listed(const char* what, const EndTable<T, IdType>& items);
  /// `group` exists, or is `none`.
  void require_group(const char* what, std::uint32_t slot, std::uint32_t group);
  /// An item uses one of another kind, for instance a "law"; that one counts its uses.
  void use(const char* kind, std::uint32_t slot) { ++counts_[{kind, slot}].found; }
  void require_uses(const char* kind, std::uint32_t slot, std::uint32_t count) { counts_[{kind, slot}].told = count; }

  /// An item needs a particle as an unknown of its own.
  void use_particle(std::uint32_t particle) { ++uses_[particle]; }
  /// Two bodies are joined in one articulate other than by a hinge.
  void join(std::uint32_t body_a, std::uint32_t body_b) { connected_.join(body_a, body_b); }

  /// Particles, rings, bodies, articulates and their lists; then the counts.
  void check_structure();
  void check_counts();
  std::vector<std::string> complaints() && { return std::move(complaints_); }

 private:
  void check_meshes();
  void check_particles();
  void check_structure_lists();
  /// Singly linked lists, each item in one; for_each_first(lead_to) calls that with the first item of each.
  template <class Table, class Heads>
  void check_chains(const char* what, const Table& items, Heads for_each_first);
  void check_rings();
  void check_bodies();
  void check_articulates();

  const Structure& model_;
  std::vector<std::string> complaints_;
  std::vector<std::uint32_t> uses_;  // of each particle
  struct Count {
    std::uint32_t found = 0, told = 0;
  };
  std::map<std::pair<std::string, std::uint32_t>, Count> counts_;
  std::vector<std::uint32_t> in_body_, in_ring_, in_articulate_;
  DisjointSets connected_;  // of bodies
};

template <class IsAlive, class Next, class Previous>
void Audit::check_lists(const char* what, const std::vector<std::uint32_t>& firsts, std::uint32_t link_count,
                        IsAlive is_alive, Next next, Previous previous) {
  const auto there = [&](std::uint32_t link) { return link < link_count && is_alive(link); };
  for (const std::uint32_t first : firsts)
    require(first == none || (there(first) && previous(first) == none), "a list of ", what, " begins at ", first,
            ", which is not its first");
  for (std::uint32_t link = 0; link < link_count; ++link) {
    if (!is_alive(link)) continue;
    const std::uint32_t after = next(link), before = previous(link);
    require((after == none || (there(after) && previous(after) == link)) &&
                (before == none || (there(before) && next(before) == link)),
            "a list of ", what, " has ", link, " between ", before, " and ", after);
  }
}

template <class T, class IdType>
void Audit::check_ends(const char* what, const EndTable<T, IdType>& items, const auto& owners) {
  items.for_each([&](std::uint32_t slot, const T& item) {
    for (std::uint32_t end = 0; end < T::count; ++end)
      require(owners.is_alive(item.at(end)), what, " ", slot, " joins ", item.at(end), ", which does not live");
  });
  require(items.has_links_of_items(), "the lists of ", what, "s do not follow from these");
  std::vector<std::uint32_t> firsts;
  items.heads.for_each([&](std::uint32_t, const ListHead& head) { firsts.push_back(head.first); });
  check_lists(
      text(what, "s").c_str(), firsts, T::count * items.slot_count(),
      [&](std::uint32_t link) { return items.is_alive(link / T::count); },
      [&](std::uint32_t link) { return items[link / T::count].next[link % T::count]; },
      [&](std::uint32_t link) { return items[link / T::count].previous[link % T::count]; });
}

template <class T>
void Audit::require_ends(const char* what, std::uint32_t slot, const T& item) {
  for (std::uint32_t end = 0; end < T::count; ++end) {
    require(model_.particles.is_alive(item.at(end)), what, " ", slot, " joins ", item.at(end), ", which does not live");
    for (std::uint32_t other = 0; other < end; ++other)
      require(item.at(other) != item.at(end), what, " ", slot, " joins ", item.at(end), " to itself");
  }
}

template <class T, class IdType>
void Audit::require_listed(const char* what, const EndTable<T, IdType>& items) {
  require_owners("lists", items.heads, model_.particles);
  std::uint32_t listed = 0;
  items.heads.for_each([&](std::uint32_t slot, const ListHead& head) {
    for (std::uint32_t link = head.first; link != none; link = items[link / T::count].next[link % T::count]) {
      const bool good = items.is_alive(link / T::count) && items[link / T::count].at(link % T::count) == slot;
      require(good, "particle ", slot, " lists ", what, " ", link / T::count, ", which does not end there");
      if (!good || ++listed > T::count * items.size()) return;
    }
  });
  require(listed == T::count * items.size(), "the particles list ", listed, " ends of ", items.size(), " ", what, "s");
}

}  // namespace iota::model
