// SPDX-License-Identifier: Apache-2.0
#include "base/seal.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <stdexcept>
#include <vector>

namespace iota {
namespace {

constexpr Seal test_seal{{'I', 'O', 'T', 'A', 'T', 'S', 'T', '1'}, "test"};

std::vector<std::byte> content_of(std::size_t size) {
  std::vector<std::byte> content;
  for (std::size_t i = 0; i < size; ++i) content.push_back(static_cast<std::byte>(7 * i));
  return content;
}

TEST(Seal, gives_back_content_of_any_length) {
  for (std::size_t size = 0; size < 40; ++size) {
    const std::vector<std::byte> content = content_of(size), sealed = seal(test_seal, content);
    const auto back = unseal(test_seal, sealed);
    EXPECT_TRUE(std::equal(back.begin(), back.end(), content.begin(), content.end()));
  }
}

TEST(Seal, notices_the_change_of_any_bit) {
  for (const std::size_t size : {0, 1, 8, 37}) {
    std::vector<std::byte> sealed = seal(test_seal, content_of(size));
    for (std::size_t bit = 0; bit < 8 * sealed.size(); ++bit) {
      const auto flip = static_cast<std::byte>(1 << bit % 8);
      sealed[bit / 8] ^= flip;
      EXPECT_THROW((void)unseal(test_seal, sealed), std::invalid_argument);
      sealed[bit / 8] ^= flip;
    }
  }
}

// As when two numbers change their signs: a sum of products alone would not show it.
TEST(Seal, notices_changes_of_the_top_bits_of_two_words) {
  constexpr std::size_t header = 16, words = 5;
  std::vector<std::byte> sealed = seal(test_seal, content_of(8 * words));
  const auto flip_top_of = [&](std::size_t word) { sealed[header + 8 * word + 7] ^= std::byte{0x80}; };
  for (std::size_t i = 0; i < words; ++i)
    for (std::size_t j = 0; j < i; ++j) {
      flip_top_of(i), flip_top_of(j);
      EXPECT_THROW((void)unseal(test_seal, sealed), std::invalid_argument);
      flip_top_of(i), flip_top_of(j);
    }
}

TEST(Seal, of_another_version_is_refused) {
  Seal older = test_seal;
  older.mark.back() = '0';
  EXPECT_THROW((void)unseal(test_seal, seal(older, content_of(8))), std::invalid_argument);
}

}  // namespace
}  // namespace iota
