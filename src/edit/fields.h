// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "edit/editor.h"

/// Commands for fields, pairwise forces, and the groups of particles on which they act.
namespace iota::edit {

struct CreateGroup {
  std::string name;
};
struct SetMember {
  GroupId group;
  ParticleId particle;
  bool member;
};
struct CreateField {
  std::string name, text;
  std::vector<LawParameter> parameters;
  GroupId group;  ///< null: all particles
  bool replaces_gravity;
  std::uint64_t function;  ///< key of its function; 0: the text is the name or the expression of the field
};
struct SetFieldParameter {
  FieldId field;
  std::uint32_t index;
  double value;
};
struct SetFieldActive {
  static constexpr std::string_view queued_as = "set_active";
  FieldId field;
  bool active;
};
struct CreatePairs {
  LawId law;
  GroupId group;  ///< null: all particles
  GroupId other;  ///< null: none
  bool shifted;
  double cutoff;
  std::array<double, max_law_parameters> parameters;
};
struct SetPairsParameter {
  PairsId pairs;
  std::uint32_t index;
  double value;
};
struct SetPairsActive {
  static constexpr std::string_view queued_as = "set_active";
  PairsId pairs;
  bool active;
};

GroupId apply(Editor&, const CreateGroup&);
void apply(Editor&, const SetMember&);
void apply(Editor&, const Destroy<GroupId>&);
FieldId apply(Editor&, const CreateField&);
void apply(Editor&, const SetFieldParameter&);
void apply(Editor&, const SetFieldActive&);
void apply(Editor&, const Destroy<FieldId>&);
PairsId apply(Editor&, const CreatePairs&);
void apply(Editor&, const SetPairsParameter&);
void apply(Editor&, const SetPairsActive&);
void apply(Editor&, const Destroy<PairsId>&);

/// The group of a record of a field or a pairwise force; unset for all particles.
std::optional<GroupId> group_at(const model::Model&, std::uint32_t slot);

}  // namespace iota::edit
