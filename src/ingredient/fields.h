// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ingredient/ingredient.h"
#include "laws/field_law.h"

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

namespace iota::ingredient {

enum class FieldKind : std::uint32_t { listed, expression, function };

/// A force on each single particle.
struct Field {
  FieldKind kind = FieldKind::listed;
  std::uint32_t number = 0;    ///< of a listed one
  std::uint32_t group = none;  ///< none: all particles
  std::uint32_t parameter_count = 0;
  std::uint8_t active = 1, replaces_gravity = 0;
  std::array<std::uint8_t, 6> padding{};
  std::uint64_t function = 0;  ///< key of the function, which is outside of the tables
  std::array<double, laws::max_field_parameters> parameters{};
  std::array<std::array<char, 24>, laws::max_field_parameters> names{};
  std::array<char, 32> name{};
  std::array<char, 1000> text{};
};

/// Forces on each single particle, evaluated once a step and held.
class Fields : public NoAnswers {
 public:
  struct Tables {
    SlotTable<Field, FieldId> fields;

    const auto& table_of(FieldId) const { return fields; }
    template <class Archive>
    void archive(Archive& ar, const Structure&) {
      fields.archive(ar);
      if constexpr (std::is_same_v<Archive, Reader>)
        if (!ar.ok() || !compile()) ar.fail();
    }

    std::uint32_t make_field(const Field&);  ///< throws expression::ExpressionError for a text that is not a field
    const laws::FieldLaw& compiled_field(std::uint32_t field) const { return *compiled_[field]; }

   private:
    bool compile();  // after a restore; false if a record is not a field
    void compile(std::uint32_t field);
    std::vector<std::shared_ptr<const laws::FieldLaw>> compiled_;  // by slot; not saved, made from the table
  };
  static bool replaces_gravity(const Model&);
  static void validate(const Model&, model::Audit&);
};

}  // namespace iota::ingredient
