// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "contact/outline.h"
#include "geometry/box_tree.h"

#include <cstdint>
#include <vector>

namespace iota::contact {

/// Outlines by their numbers, and a tree of the boxes of those that are shown.
class OutlineTree {
 public:
  std::uint32_t count() const { return static_cast<std::uint32_t>(entries_.size()); }  ///< numbers, also unused ones
  bool has(std::uint32_t number) const { return number < count() && entries_[number].is_used; }
  const Outline& operator[](std::uint32_t number) const { return entries_[number].outline; }
  Outline& operator[](std::uint32_t number) { return entries_[number].outline; }
  /// A new outline without parts, instead of a former one of this number.
  Outline& make(std::uint32_t number);
  void remove(std::uint32_t number);
  /// Its parts are at other places: the tree gets its box.
  void show(std::uint32_t number);
  void hide(std::uint32_t number);
  void clear();
  /// Call it after changes, before the questions.
  void update() { tree_.update(); }

  /// Calls visit(number, outline) with outlines by rising distance of their boxes, endless ones first, while that is at
  /// most `within`, m. visit returns the new limit.
  template <class Visit>
  void near(const Vec3& place, double within, Visit visit) const {
    within = visit_endless(within, visit);
    tree_.near(place, within, [&](std::uint32_t number) { return visit(number, entries_[number].outline); });
  }
  /// Calls visit(number) with each shown outline whose box overlaps this one, endless ones too. See for_each_pair.
  template <class Visit>
  void overlapping(const geometry::Bounds& box, Visit visit) const {
    for (const std::uint32_t number : endless_) visit(number);
    tree_.overlapping(box, visit);
  }
  /// As `near`, along a ray, or where a ball goes of this radius, m.
  template <class Visit>
  void along(const Vec3& from, const Vec3& unit, double width, double within, Visit visit) const {
    within = visit_endless(within, visit);
    tree_.along(from, unit, width, within,
                [&](std::uint32_t number) { return visit(number, entries_[number].outline); });
  }
  /// Calls visit(number, number) with each two shown outlines whose boxes overlap, once, and with each endless one and
  /// every other. Boxes are larger than the outlines, by a fifth of their longest edge on each side. The order depends on
  /// the history.
  template <class Visit>
  void for_each_pair(Visit visit) const {
    tree_.for_each_pair(visit);
    for (const std::uint32_t one : endless_)
      for (std::uint32_t other = 0; other < count(); ++other)
        if (entries_[other].is_shown && other != one && (!entries_[other].is_endless || one < other)) visit(one, other);
  }

 private:
  struct Entry {
    Outline outline;
    bool is_used = false, is_shown = false, is_endless = false;
  };
  template <class Visit>
  double visit_endless(double within, Visit& visit) const {
    for (const std::uint32_t number : endless_) within = visit(number, entries_[number].outline);
    return within;
  }

  std::vector<Entry> entries_;
  geometry::BoxTree tree_;
  std::vector<std::uint32_t> endless_;  ///< those without a finite box
};

}  // namespace iota::contact
