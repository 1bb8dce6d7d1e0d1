// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "contact/outline_tree.h"
#include "model/structure.h"

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <tuple>
#include <vector>

namespace iota::contact {

/// The outlines of the bodies of a structure where they are, by the bodies' slots: of all bodies except sparks.
/// Inactive ones are hidden: only questions that name them find them.
class Outlines {
 public:
  /// `structure` must outlive it, and may be assigned another one.
  explicit Outlines(model::Structure& structure) : structure_(structure) { due_.is_on = described_.is_on = true; }
  Outlines(const Outlines&) = delete;
  Outlines& operator=(const Outlines&) = delete;

  /// The outlines of now, after this number of steps. Describes the bodies that have changed since the last call, and
  /// looks where those are that may have moved: after an edit all but frozen ones that it has not flagged; after a step those that
  /// are not asleep, frozen or static. Frozen and, after a step, static ones cost nothing.
  const OutlineTree& refresh(std::uint64_t steps);
  /// The structure's list of flagged articulates is about to be taken.
  void lose_flags() { lacks_flags_ = lacks_flags_ || edits_ != structure_.edits; }

  /// @name Some bodies, without the tree
  ///@{
  /// Call it before the following ones. Costs nothing if no body has changed.
  void describe();
  bool has(std::uint32_t body) const { return tree_.has(body); }
  /// The bodies with an outline that steps may move, in order: all but frozen and static ones. Some may be frozen since the
  /// last `refresh`.
  const std::vector<std::uint32_t>& movable() const { return movable_; }
  /// The static bodies with an outline, in order.
  const std::vector<std::uint32_t>& fixed() const { return fixed_; }
  /// Rises with each change of these two lists.
  std::uint64_t lists_version() const { return lists_version_; }
  /// The bodies that were described, or lost their outline, since the last call of `forget_described`.
  const std::vector<std::uint32_t>& described() const { return described_.slots(); }
  void forget_described() { described_.clear(); }
  /// All of a body is at most so far from its first particle, m, where it was placed last; negative: it has no outline, or no
  /// particle. See contact::reach.
  double reach(std::uint32_t body) const { return body < reaches_.size() ? reaches_[body] : -1; }
  /// The outline where the body is now. The tree has it elsewhere until the next `refresh`.
  const Outline& placed(std::uint32_t body) {
    place(body);
    return tree_[body];
  }
  /// As it was placed last.
  const Outline& described(std::uint32_t body) const { return tree_[body]; }
  ///@}

 private:
  using FormKey = std::tuple<std::uint32_t, std::array<double, 4>, std::uint64_t>;

  /// Who may move a body: nothing, steps, or edits alone.
  enum class Mover : std::uint8_t { nothing, steps, edits };
  void describe_changed();
  Mover mover_of(std::uint32_t body) const;
  void list(std::span<const std::uint32_t> changed);
  void take_out_frozen();
  void expect_flagged();
  void look_for(std::uint32_t body, bool spares_frozen);
  bool is_described() const;
  void describe(std::uint32_t body);
  void add_lines(std::uint32_t body, Outline&);
  void place(std::uint32_t body);
  std::shared_ptr<const Form> form_of(const shape::Data&);

  model::Structure& structure_;
  OutlineTree tree_;
  std::vector<BodyKind> kinds_;                         ///< by slot: when the body was placed last
  std::vector<double> reaches_;                         ///< by slot
  std::vector<Mover> movers_;                           ///< by slot; nothing: frozen, or without an outline
  std::vector<std::uint32_t> movable_, fixed_;          ///< by steps; by edits alone
  model::ChangedSlots due_;                             ///< bodies that are looked for in any case
  std::vector<std::uint32_t> aging_;                    ///< bodies with balls whose radius changes by itself
  std::map<FormKey, std::weak_ptr<const Form>> forms_;  ///< with triangles: these are shared
  double usual_radius_ = 0;
  model::ChangedSlots described_;
  std::vector<std::uint32_t> scratch_;
  std::uint64_t steps_ = 0, edits_ = 0, lists_version_ = 0;
  std::uint32_t version_ = 0;
  bool is_edited_ = true;     ///< since the last call
  bool lacks_flags_ = false;  ///< of edits since the last call
  bool is_stale_ = true;      ///< the tree lacks a description
};

}  // namespace iota::contact
