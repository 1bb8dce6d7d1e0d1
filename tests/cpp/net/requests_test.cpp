// SPDX-License-Identifier: Apache-2.0
#include "net/requests.h"

#include <gtest/gtest.h>

namespace iota::net {
namespace {

TEST(Requests, an_answer_reaches_the_one_who_waits_for_it_and_no_other) {
  Requests requests;
  std::string first, second;
  const auto a =
      requests.add({0, "/a", "x=1", protocol::Role::host, false}, [&](const Answer& told) { first = told.body; });
  const auto b =
      requests.add({0, "/b", "", protocol::Role::viewer, true}, [&](const Answer& told) { second = told.body; });
  const auto taken = requests.take();
  ASSERT_EQ(taken.size(), 2U);
  EXPECT_EQ(taken[0].number, a);
  EXPECT_EQ(taken[0].query, "x=1");
  EXPECT_TRUE(taken[1].is_post);
  EXPECT_TRUE(requests.take().empty());
  requests.answer(b, {200, "text/plain", "for b"});
  EXPECT_EQ(first, "");
  EXPECT_EQ(second, "for b");
}

TEST(Requests, a_second_answer_and_one_that_comes_too_late_have_no_effect) {
  Requests requests;
  int calls = 0;
  const auto once = requests.add({}, [&](const Answer&) { ++calls; });
  requests.answer(once, {});
  requests.answer(once, {});
  const auto gone = requests.add({}, [&](const Answer&) { ++calls; });
  requests.remove(gone);
  requests.answer(gone, {});
  EXPECT_EQ(calls, 1);
  EXPECT_EQ(requests.take().size(), 1U) << "one that nobody waits for is not taken";
}

TEST(Requests, only_the_paths_that_were_named_are_for_the_program) {
  Requests requests;
  EXPECT_FALSE(requests.serves("/metrics"));
  requests.serve({"/metrics"});
  EXPECT_TRUE(requests.serves("/metrics"));
  EXPECT_FALSE(requests.serves("/metrics/"));
  EXPECT_FALSE(requests.is_open("/metrics"));
  requests.serve({"/where"}, true);
  EXPECT_TRUE(requests.is_open("/where"));
}

}  // namespace
}  // namespace iota::net
