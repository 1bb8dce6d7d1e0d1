// SPDX-License-Identifier: Apache-2.0
#include "island/cut_search.h"

#include <algorithm>

namespace iota::island {

void CutSearch::find(const model::Model& model, std::span<const std::uint32_t> suspects, std::size_t most,
                     FunctionRef<bool(std::uint32_t)> is_member, std::vector<std::uint32_t>& cut_off) {
  if (suspects.size() < 2) return;
  if (floods_.size() < suspects.size()) floods_.resize(suspects.size());
  flood_of_.resize(model.articulates.slot_count(), none);
  joined_.resize(suspects.size());
  open_ = suspects.size();
  for (std::uint32_t f = 0; f < suspects.size(); ++f) {
    Flood& flood = floods_[f];
    flood.found.assign(1, suspects[f]);
    flood.next = flood.bodies = 0, flood.is_open = true;
    flood_of_[suspects[f]] = joined_[f] = f;
  }
  // Each may visit twice as many bodies as before, until one is left that goes on: it is the rest.
  for (std::size_t now = 4; open_ > 1 && now / 2 < most; now *= 2)
    for (std::uint32_t f = 0; f < suspects.size() && open_ > 1; ++f)
      while (floods_[f].is_open && open_ > 1) {
        Flood& flood = floods_[f];
        if (flood.next == flood.found.size()) {
          flood.is_open = false, --open_;
        } else if (flood.bodies + model.articulates[flood.found[flood.next]].count <= std::min(now, most)) {
          visit_next(model, f, is_member);
        } else {
          break;
        }
      }
  // The open flood is the rest; if all are complete, the largest one is.
  std::uint32_t rest = none;
  if (open_ == 0)
    for (std::uint32_t f = 0; f < suspects.size(); ++f)
      if (joined_[f] == f && (rest == none || floods_[f].bodies > floods_[rest].bodies)) rest = f;
  for (std::uint32_t f = 0; f < suspects.size(); ++f) {
    const Flood& flood = floods_[f];
    for (const std::uint32_t a : flood.found) flood_of_[a] = none;
    if (joined_[f] == f && f != rest && !flood.is_open)
      cut_off.insert(cut_off.end(), flood.found.begin(), flood.found.end());
  }
}

void CutSearch::visit_next(const model::Model& model, std::uint32_t f, FunctionRef<bool(std::uint32_t)> is_member) {
  const std::uint32_t articulate = floods_[f].found[floods_[f].next++];
  floods_[f].bodies += model.articulates[articulate].count;
  if (!model.has_ties()) return;
  std::uint32_t own = f;  // the flood that has what this one has found
  const auto reach = [&](std::uint32_t body) {
    const std::uint32_t a = model.bodies[body].articulate;
    if (a == articulate || !is_member(a)) return;
    std::uint32_t& other = flood_of_[a];
    if (other == none) {
      other = own;
      floods_[own].found.push_back(a);
      return;
    }
    std::uint32_t root = other;
    while (joined_[root] != root) root = joined_[root] = joined_[joined_[root]];
    other = root;
    if (root == own) return;
    const bool is_larger = floods_[own].found.size() > floods_[root].found.size();
    join(is_larger ? root : own, is_larger ? own : root);
    own = is_larger ? own : root;
  };
  model.for_each_body_of(articulate, [&](std::uint32_t body) {
    model.for_each_particle_of(body, [&](std::uint32_t p) { model.visit_tied(p, model::Model::Ties::all, reach); });
  });
}

// The bodies that both have visited come first.
void CutSearch::join(std::uint32_t from, std::uint32_t into) {
  Flood &gone = floods_[from], &flood = floods_[into];
  const auto first = gone.found.begin(), unvisited = first + static_cast<std::ptrdiff_t>(gone.next);
  flood.found.insert(flood.found.begin() + static_cast<std::ptrdiff_t>(flood.next), first, unvisited);
  flood.next += gone.next;
  flood.found.insert(flood.found.end(), unvisited, gone.found.end());
  flood.bodies += gone.bodies;
  gone.found.clear();
  joined_[from] = into;
  open_ -= gone.is_open && flood.is_open;
  flood.is_open = flood.is_open || gone.is_open;
  gone.is_open = false;
}

}  // namespace iota::island
