// SPDX-License-Identifier: Apache-2.0
// What `make soak` does for long, at the size of a test suite.
#include "scenes/random_heap.h"
#include "scenes/random_scene.h"
#include "soak/edit_twin.h"
#include "source_folder.h"
#include "tests/cpp/amount.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>

namespace iota {
namespace {

TEST(RandomEdits, agree_with_a_twin_that_only_knows_labels) {
  const std::uint64_t count = sampled(1'000'000);
  soak::EditCount counted;
  EXPECT_EQ(soak::compare_edits(1, count, counted).value_or(""), "");
  EXPECT_EQ(counted.edits, count);
  EXPECT_GT(counted.joined, count / 10);
  EXPECT_GT(counted.cut, count / 10);
  EXPECT_GT(counted.refused, count / 100);
}

TEST(RandomHeaps, stay_whole_and_finite_and_make_no_motion_from_nothing) {
  const std::uint64_t count = sampled(200);
  scenes::HeapTally tally;
  for (std::uint64_t seed = 1; seed <= count; ++seed)
    EXPECT_EQ(scenes::play_heap(seed, tally).value_or(""), "") << "seed " << seed;
  EXPECT_GT(tally.edits, 30 * count);
  EXPECT_GT(tally.approximate, count);
  EXPECT_LT(tally.unsolved, tally.steps / 5) << "heaps that are mostly conflicts test little else";
}

/// An island that takes its step in parts had a share of the budget by the islands of the step before. By what round-off left of a row
/// that moves nothing bodies were shot away, and by sweeps that could not close joints between what does not move. Restored
/// copies went on in another way where static particles held others, heaps had bodies that do not move, or what drives a conflict
/// jumped. The program ended where two points were joined in a heap in which round-off couples the masses of two bodies.
TEST(RandomHeaps, that_once_failed_do_not_any_more) {
  scenes::HeapTally tally;
  for (const std::uint64_t seed : {700398u, 1000u, 1250u, 2246u, 2332u, 3094u, 3811u, 5447u, 5994u, 6249u, 6311u, 8780u,
                                   3000073u, 3100797u, 3101407u, 3102321u, 21392u})
    EXPECT_EQ(scenes::play_heap(seed, tally).value_or(""), "") << seed;
}

TEST(RandomScenes, stay_finite_whole_and_honest) {
  const std::uint64_t count = sampled(400);
  scenes::Tally tally;
  for (std::uint64_t seed = 1; seed <= count; ++seed) {
    const auto script = scenes::random_script(seed);
    const auto wrong = scenes::play(script, tally);
    ASSERT_FALSE(wrong) << "seed " << seed << ", " << *wrong << "\n"
                        << scenes::tell(scenes::shrink(script, scenes::same_complaint_as(script)));
  }
  EXPECT_GT(tally.steps, 25 * count);
  EXPECT_GT(tally.edits, 25 * count);
  EXPECT_LT(tally.unconverged, tally.steps / 5) << "scenes that are mostly conflicts test little else";
}

/// Scripts of calls, as `tell` prints them: they stay what they are when the random ones become others. Bodies that woke
/// in a conflict; hinges that joined the two ends of somebody else's rod; joints that no longer hold anybody; markers that
/// went while their body was in two halves; springs of joints that were pulled together; laws that are infinite where their
/// ends have met, and a step that failed there; a conflict on a nail that made a fifth of its energy in a step.
TEST(Scripts, that_once_failed_do_not_any_more) {
  int played = 0;
  scenes::Tally tally;
  for (const auto& file : std::filesystem::directory_iterator(source_folder() / "tests/cpp/soak/scenes")) {
    std::ifstream in(file.path());
    std::ostringstream lines;
    lines << in.rdbuf();
    EXPECT_EQ(scenes::play(lines.str(), tally).value_or(""), "") << file.path().filename();
    ++played;
  }
  EXPECT_GE(played, 12);
  EXPECT_EQ(tally.refused, 0u) << "scripts hold only what the system did";
}

TEST(Scripts, say_where_they_go_wrong) {
  scenes::Tally tally;
  const std::string start = "body\nparticle 0.1 0 0 0 1 0 0 0\n";
  EXPECT_EQ(scenes::play(start + "step 0.01\n", tally), std::nullopt);
  EXPECT_EQ(scenes::play(start + "nail 7.1\n", tally), "line 3 (nail 7.1): particle 7 is gone: it was destroyed");
  EXPECT_EQ(scenes::play(start + "nial 0.1\n", tally), "line 3 (nial 0.1): no such verb: nial");
  EXPECT_EQ(scenes::play(start + "set_mass 0.1\n", tally), "line 3 (set_mass 0.1): the line is too short");
  EXPECT_EQ(scenes::play(start + "nail 0.1 5\n", tally), "line 3 (nail 0.1 5): the line is too long");
}

TEST(RandomScenes, are_printed_as_scripts_that_do_the_same) {
  scenes::Tally random, told;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const auto script = scenes::random_script(seed);
    ASSERT_EQ(scenes::play(script, random).value_or(""), "");
    ASSERT_EQ(scenes::play(scenes::tell(script), told).value_or(""), "") << "seed " << seed;
    EXPECT_EQ(told.steps, random.steps);
    EXPECT_EQ(told.unconverged, random.unconverged);
    EXPECT_EQ(told.gap, random.gap) << "to the last bit";
  }
}

TEST(RandomScenes, that_fail_are_reduced_and_printed) {
  const auto script = scenes::random_script(3);
  const auto count = [](const std::vector<scenes::Deed>& deeds, scenes::DeedKind kind) {
    return std::count_if(deeds.begin(), deeds.end(), [&](const scenes::Deed& deed) { return deed.kind == kind; });
  };
  ASSERT_GT(count(script, scenes::DeedKind::step), 2);
  const auto least =
      scenes::shrink(script, [&](const auto& tried) { return count(tried, scenes::DeedKind::step) >= 2; });
  EXPECT_EQ(least.size(), 2u);
  const std::string text = scenes::tell(least);
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 2) << text;
  EXPECT_EQ(text.rfind("step 0.0", 0), 0u) << text;
}

}  // namespace
}  // namespace iota
