// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ingredient/ingredient.h"
#include "laws/pair_law.h"

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

namespace iota::ingredient {

enum class LawKind : std::uint32_t {
  listed,      ///< of laws::PairLaws
  expression,  ///< its text
  scripted,    ///< each bond has its own function
  radial,      ///< compiled code for one bond
  batch,       ///< a function for all bonds at once
};

/// A law of force for bonds. The first ones, in fixed slots, are the predefined ones and `scripted`.
struct Law {
  LawKind kind = LawKind::listed;
  std::uint32_t number = 0;  ///< of a listed law
  std::uint32_t parameter_count = 0;
  std::uint32_t uses = 0;      ///< number of bonds with it
  std::uint64_t function = 0;  ///< key of the compiled code, which is outside of the tables
  std::array<double, laws::max_parameters> standard{};
  std::array<std::array<char, 24>, laws::max_parameters> parameters{};  ///< names
  std::array<char, 32> name{};
  std::array<char, 1000> text{};

  bool has_derivative() const { return kind == LawKind::listed || kind == LawKind::expression; }
};
inline constexpr std::uint32_t spring_law = 0, drag_law = 1, scripted_law = laws::pair_law_count;

/// The laws of force of bonds and pairs.
class Laws : public NoAnswers {
 public:
  static void validate(const Model&, model::Audit&);

  struct Tables {
    Tables();  ///< with the predefined ones

    SlotTable<Law, LawId> laws;

    const auto& table_of(LawId) const { return laws; }
    template <class Archive>
    void archive(Archive& ar, const Structure&) {
      laws.archive(ar);
      if constexpr (std::is_same_v<Archive, Reader>)
        if (!ar.ok() || !compile()) ar.fail();
    }

    std::uint32_t make_law(const Law&);  ///< throws expression::ExpressionError for a text that is not a law
    /// Ready for use; only laws with a derivative have one.
    const laws::PairLaw& compiled(std::uint32_t law) const { return *compiled_[law]; }

   private:
    bool compile();  // after a restore; false if a record is not a law
    void compile(std::uint32_t law);
    std::vector<std::shared_ptr<const laws::PairLaw>> compiled_;  // by slot; not saved, made from the table
  };
};

}  // namespace iota::ingredient
