// SPDX-License-Identifier: Apache-2.0
#include "edit/history.h"

#include <gtest/gtest.h>

namespace iota::edit {
namespace {

Snapshot state(std::size_t bytes, int number) {
  return {std::vector<std::byte>(bytes, static_cast<std::byte>(number))};
}

TEST(History, gives_back_the_newest_state_first_and_forgets_the_oldest) {
  History history;
  for (int i = 0; i < 70; ++i) history.push(state(8, i));
  EXPECT_EQ(history.size(), History::most);
  for (int i = 69; i >= 6; --i) EXPECT_EQ(history.pop(), state(8, i));
  EXPECT_EQ(history.pop(), std::nullopt);
}

TEST(History, keeps_no_more_bytes_than_its_limit) {
  History history;
  constexpr std::size_t third = History::most_bytes / 3 + 1;
  for (int i = 0; i < 4; ++i) history.push(state(third, i));
  EXPECT_EQ(history.size(), 2u);
  history.push(state(16, 9));
  EXPECT_EQ(history.pop(), state(16, 9));
  EXPECT_EQ(history.pop()->bytes[0], std::byte{3});
  history.clear();
  for (int i = 0; i < 2; ++i) history.push(state(third, i));
  EXPECT_EQ(history.size(), 2u) << "bytes of states that are gone do not count";
}

}  // namespace
}  // namespace iota::edit
