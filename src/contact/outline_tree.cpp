// SPDX-License-Identifier: Apache-2.0
#include "contact/outline_tree.h"

#include <vector>

namespace iota::contact {

Outline& OutlineTree::make(std::uint32_t number) {
  if (count() <= number) entries_.resize(number + std::size_t{1});
  Entry& entry = entries_[number];
  entry.outline.solids.clear(), entry.outline.lines.clear();
  entry.is_used = true;
  return entry.outline;
}

void OutlineTree::remove(std::uint32_t number) {
  if (!has(number)) return;
  hide(number);
  entries_[number] = {};
}

void OutlineTree::show(std::uint32_t number) {
  Entry& entry = entries_[number];
  const geometry::Bounds box = bounds(entry.outline);
  const bool is_endless = !(is_finite(box.low) && is_finite(box.high));
  if (entry.is_shown && is_endless != entry.is_endless) hide(number);
  if (is_endless && !entry.is_shown) endless_.push_back(number);
  if (!is_endless) tree_.set(number, box);
  entry.is_shown = true, entry.is_endless = is_endless;
}

void OutlineTree::hide(std::uint32_t number) {
  Entry& entry = entries_[number];
  if (!entry.is_shown) return;
  if (entry.is_endless)
    std::erase(endless_, number);
  else
    tree_.remove(number);
  entry.is_shown = false;
}

void OutlineTree::clear() {
  for (std::uint32_t number = 0; number < count(); ++number) remove(number);
}

}  // namespace iota::contact
