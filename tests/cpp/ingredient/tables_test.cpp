// SPDX-License-Identifier: Apache-2.0
// All tables to bytes and back.
#include "ingredient/tables.h"

#include "tests/cpp/ingredient/everything.h"

#include <gtest/gtest.h>

#include <random>

namespace iota::ingredient {
namespace {

using model::Everything;
using model::Model;

std::vector<std::byte> bytes_of(Model& model) {
  std::vector<std::byte> bytes;
  Writer writer(bytes);
  model.archive(writer);
  return bytes;
}

TEST(Tables, come_back_from_their_bytes_as_they_were) {
  Everything e;
  const std::vector<std::byte> bytes = bytes_of(e.model);
  Model again;
  Reader reader(bytes);
  again.archive(reader);
  ASSERT_TRUE(reader.ok() && reader.at_end());
  EXPECT_EQ(bytes_of(again), bytes);
  EXPECT_EQ(again.hash(), e.model.hash());
  EXPECT_EQ(validate(again), std::vector<std::string>{});
}

TEST(Tables, of_each_ingredient_are_its_own) {
  Everything e;
  std::size_t together = 0;
  for_each_type<Ingredients>([&]<class I>() {
    std::vector<std::byte> bytes;
    Writer writer(bytes);
    static_cast<OwnTables<I>&>(e.model).archive(writer, e.model);
    together += bytes.size();
    // Read into a model that has everything: only what was written may be read.
    Model other = e.model;
    Reader reader(bytes);
    static_cast<OwnTables<I>&>(other).archive(reader, other);
    EXPECT_TRUE(reader.ok() && reader.at_end()) << bytes.size() << " bytes";
    EXPECT_EQ(bytes_of(other), bytes_of(e.model)) << "reading what was written changes nothing";
  });
  EXPECT_GT(together, 1000u);
  EXPECT_LT(together, bytes_of(e.model).size()) << "points, bodies and articulates belong to no ingredient";
}

TEST(Tables, that_are_cut_short_are_noticed_wherever_that_is) {
  Everything e;
  const std::vector<std::byte> bytes = bytes_of(e.model);
  std::mt19937 random(31);
  for (int i = 0; i < 200; ++i) {
    const std::size_t size = i == 0 ? bytes.size() - 1 : random() % bytes.size();
    const std::vector<std::byte> part(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size));
    Model model;
    Reader reader(part);
    model.archive(reader);
    ASSERT_FALSE(reader.ok()) << size << " bytes of " << bytes.size();
  }
}

}  // namespace
}  // namespace iota::ingredient
