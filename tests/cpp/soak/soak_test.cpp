// SPDX-License-Identifier: Apache-2.0
// What `make soak` does for long, at the size of a test suite.
#include "scenes/random_scene.h"
#include "soak/edit_twin.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace iota {
namespace {

TEST(RandomEdits, a_million_agree_with_a_twin_that_only_knows_labels) {
  soak::EditCount counted;
  EXPECT_EQ(soak::compare_edits(1, 1'000'000, counted).value_or(""), "");
  EXPECT_EQ(counted.edits, 1'000'000u);
  EXPECT_GT(counted.joined, 100'000u);
  EXPECT_GT(counted.cut, 100'000u);
  EXPECT_GT(counted.refused, 10'000u);
}

TEST(RandomScenes, stay_finite_whole_and_honest) {
  scenes::Tally tally;
  for (std::uint64_t seed = 1; seed <= 400; ++seed) {
    const auto script = scenes::random_script(seed);
    const auto wrong = scenes::play(script, tally);
    ASSERT_FALSE(wrong) << "seed " << seed << ", " << *wrong << "\n"
                        << scenes::tell(scenes::shrink(script, scenes::same_complaint_as(script)));
  }
  EXPECT_GT(tally.steps, 10'000u);
  EXPECT_GT(tally.edits, 10'000u);
  EXPECT_LT(tally.unconverged, tally.steps / 5) << "scenes that are mostly conflicts test little else";
}

TEST(RandomScenes, that_once_failed_do_not_any_more) {
  scenes::Tally tally;
  // Bodies that woke in a conflict; hinges that joined the two ends of somebody else's rod; joints that hold nobody any
  // more; markers that went while their body was in two halves; springs of joints that were pulled together; laws that are
  // infinite where their ends have met, and a step that failed there.
  for (const std::uint64_t seed : {473, 1742, 3256, 6632, 6660, 7126, 8433, 8916, 11134, 12588, 14898, 47575}) {
    const auto wrong = scenes::play(scenes::random_script(seed), tally);
    EXPECT_FALSE(wrong) << "seed " << seed << ", " << wrong.value_or("");
  }
}

TEST(RandomScenes, that_fail_are_shrunk_to_what_matters_and_told) {
  const auto script = scenes::random_script(3);
  const auto count = [](const std::vector<scenes::Deed>& deeds, scenes::DeedKind kind) {
    return std::count_if(deeds.begin(), deeds.end(), [&](const scenes::Deed& deed) { return deed.kind == kind; });
  };
  ASSERT_GT(count(script, scenes::DeedKind::step), 2);
  const auto least =
      scenes::shrink(script, [&](const auto& tried) { return count(tried, scenes::DeedKind::step) >= 2; });
  EXPECT_EQ(least.size(), 2u);
  const std::string text = scenes::tell(least);
  EXPECT_NE(text.find("{DeedKind::step, 0, 0, " + std::to_string(least[1].seed) + "u},"), std::string::npos) << text;
}

}  // namespace
}  // namespace iota
