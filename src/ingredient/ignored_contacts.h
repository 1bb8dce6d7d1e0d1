// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ingredient/ingredient.h"

#include <iota/materials.h>

#include <vector>

namespace iota::ingredient {

/// Two parties that do not touch each other. The first one is not greater than the second one.
struct IgnoredPair {
  ContactParty a, b;
  friend auto operator<=>(const IgnoredPair&, const IgnoredPair&) = default;
};

/// A command: begins or ends to ignore.
struct IgnoreContacts {
  ContactParty a, b;
  bool ignores;
};

/// Exceptions from contact that the script asks for. See Contacts::ignore.
class IgnoredContacts : public NoAnswers {
 public:
  struct Tables {
    std::vector<IgnoredPair> ignored_contacts;  ///< sorted

    template <class Archive>
    void archive(Archive& ar, const Structure&) {
      ar.vector(ignored_contacts);
    }
  };
  static void validate(const Model&, model::Audit&);

  /// Before an edit: the particles of bodies that have exceptions. Pieces get those of the whole.
  struct Kept {
    BodyId body;
    std::vector<ParticleId> particles;
  };
  using Memory = std::vector<Kept>;
  static Memory remember(const Model&, std::span<const std::uint32_t> bodies);
  static void reattach(Model&, const Memory&);
  /// A body has joined or left a group.
  static void change_member(Model&, std::uint32_t body, GroupId);
  /// A group will be destroyed, with the exceptions that name it. It still has its members.
  static void forget_group(Model&, GroupId);

  using Commands = std::tuple<IgnoreContacts>;
  static void apply(Model&, const IgnoreContacts&);

  /// Whether there is an exception for two bodies.
  static bool include(const Model&, std::uint32_t body, std::uint32_t other);
};

/// Whether a body is the party, or one of its group.
bool belongs(const Model&, std::uint32_t body, const ContactParty&);

}  // namespace iota::ingredient
