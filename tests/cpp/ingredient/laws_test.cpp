// SPDX-License-Identifier: Apache-2.0
// The tables of laws and fields, and what is compiled from them.
#include "expression/formula.h"
#include "ingredient/bonds.h"
#include "ingredient/tables.h"
#include "tests/cpp/model/small_model.h"

#include <gtest/gtest.h>

#include <cstring>
#include <set>
#include <string>

namespace iota::model {
namespace {

template <class Record>
Record with_text(const char* text) {
  Record record;
  std::strncpy(record.text.data(), text, record.text.size() - 1);
  return record;
}

TEST(LawTable, begins_with_every_listed_law_under_its_own_name) {
  const Model model;
  std::set<std::string> names;
  for (std::uint32_t slot = 0; slot < laws::pair_law_count; ++slot) {
    const ingredient::Law& law = model.laws[slot];
    EXPECT_EQ(law.kind, ingredient::LawKind::listed);
    EXPECT_EQ(law.number, slot);
    EXPECT_EQ(std::string(law.name.data()), laws::pair_law_name(slot));
    EXPECT_TRUE(law.has_derivative());
    names.insert(law.name.data());
  }
  EXPECT_EQ(names.size(), static_cast<std::size_t>(laws::pair_law_count)) << "a name is given twice";
  EXPECT_STREQ(model.laws[ingredient::spring_law].name.data(), "spring");
  EXPECT_STREQ(model.laws[ingredient::drag_law].name.data(), "drag");
  EXPECT_EQ(model.laws[ingredient::scripted_law].kind, ingredient::LawKind::scripted);
  EXPECT_FALSE(model.laws[ingredient::scripted_law].has_derivative());
}

TEST(LawTable, refuses_a_text_that_is_no_law_and_keeps_its_slot_free) {
  Model model;
  ingredient::Law good = with_text<ingredient::Law>("force = -3*r"), bad = with_text<ingredient::Law>("force = -3*");
  good.kind = bad.kind = ingredient::LawKind::expression;
  const std::uint32_t count = model.laws.size();
  EXPECT_THROW(model.make_law(bad), expression::ExpressionError);
  EXPECT_EQ(model.laws.size(), count);
  const std::uint32_t slot = model.make_law(good);
  EXPECT_EQ(model.laws.size(), count + 1);
  (void)model.compiled(slot);
}

TEST(LawTable, is_compiled_again_from_saved_text) {
  Model model, restored;
  ingredient::Law law = with_text<ingredient::Law>("energy = k*r^2");
  law.kind = ingredient::LawKind::expression, law.parameter_count = 1;
  std::strncpy(law.parameters[0].data(), "k", 2);
  const std::uint32_t slot = model.make_law(law);
  std::vector<std::byte> bytes;
  Writer writer(bytes);
  model.archive(writer);
  Reader reader(bytes);
  restored.archive(reader);
  ASSERT_TRUE(reader.ok() && reader.at_end());
  const auto energy_at = [slot](Model& of) {
    const std::uint32_t body_p = of.make_body(BodyKind::dynamic, 0), body_q = of.make_body(BodyKind::dynamic, 0);
    ingredient::Bond bond;
    bond.law = slot, bond.parameters[0] = 5;
    bond.p = of.make_particle(body_p, {0, 0, 0}, 1, {}), bond.q = of.make_particle(body_q, {0, 3, 0}, 1, {});
    return ingredient::Bonds::energy(of, ingredient::Bonds::add(of, bond));
  };
  EXPECT_DOUBLE_EQ(energy_at(model), 5 * 9);
  EXPECT_DOUBLE_EQ(energy_at(restored), 5 * 9);
}

TEST(FieldTable, replaces_gravity_only_while_it_is_active) {
  Model model;
  ingredient::Field field = with_text<ingredient::Field>("fy = 1");
  field.kind = ingredient::FieldKind::expression, field.replaces_gravity = 1;
  const std::uint32_t slot = model.make_field(field);
  EXPECT_EQ(model.acting_gravity(), Vec3{});
  model.fields[slot].active = 0;
  EXPECT_EQ(model.acting_gravity(), model.gravity);
}

TEST(FieldTable, refuses_a_text_that_is_no_field_and_keeps_its_slot_free) {
  Model model;
  ingredient::Field field = with_text<ingredient::Field>("fy = ");
  field.kind = ingredient::FieldKind::expression;
  EXPECT_THROW(model.make_field(field), expression::ExpressionError);
  EXPECT_EQ(model.fields.size(), 0u);
}

}  // namespace
}  // namespace iota::model
