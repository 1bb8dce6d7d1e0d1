// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ingredient/model.h"

#include <span>
#include <tuple>

namespace iota::ingredient {

/// Keeps ingredients attached to their places during an edit that may merge, split or destroy the bodies that they are
/// attached to. It is made before the edit, and reattaches them after it.
class Attachments {
 public:
  Attachments(const Model& model, std::span<const std::uint32_t> bodies) {
    for_each_type<Ingredients>(
        [&]<class I>() { std::get<Remembered<I>>(memories_).memory = I::remember(model, bodies); });
  }
  void reattach(Model& model) const {
    for_each_type<Ingredients>([&]<class I>() { I::reattach(model, std::get<Remembered<I>>(memories_).memory); });
  }

 private:
  template <class I>
  struct Remembered {
    typename I::Memory memory;
  };
  template <class List>
  struct Memories;
  template <class... I>
  struct Memories<std::tuple<I...>> {
    using Type = std::tuple<Remembered<I>...>;
  };
  Memories<Ingredients>::Type memories_;
};

/// Destroys items that an edit of some bodies (all alive) has made meaningless, with notes.
inline void clean_up(Model& model, std::span<const std::uint32_t> bodies, std::vector<std::string>& notes) {
  for_each_type<Ingredients>([&]<class I>() { I::clean_up(model, bodies, notes); });
}

/// Before an island with the body is built or follows a change.
inline void prepare(Model& model, std::uint32_t body) {
  for_each_type<Ingredients>([&]<class I>() { I::prepare(model, body); });
}

}  // namespace iota::ingredient
