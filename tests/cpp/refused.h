// SPDX-License-Identifier: Apache-2.0
// Calls that a system refuses.
#pragma once

#include <iota/system.h>

#include <gtest/gtest.h>

#include <cstdint>
#include <functional>
#include <stdexcept>
#include <string>

namespace iota {

/// That a call throws std::invalid_argument with these words, and changes nothing.
inline void expect_refused(const System& system, const std::function<void()>& call, const char* words) {
  const std::uint64_t before = system.state_hash();
  try {
    call();
    ADD_FAILURE() << "not refused: " << words;
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string(error.what()).find(words), std::string::npos) << error.what();
  }
  EXPECT_EQ(system.state_hash(), before) << words;
}

}  // namespace iota
