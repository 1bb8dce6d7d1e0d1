// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace iota {

/// Kind of sealed bytes: eight bytes that name it and the version of its format, and a word for errors.
struct Seal {
  std::array<char, 8> mark;
  std::string_view name;
};

/// The mark, the length of the content, the content, and a checksum of these (64 bits); in the machine's byte order.
std::vector<std::byte> seal(const Seal&, std::span<const std::byte> content);
/// The same without a copy: the content is added to the bytes of the first, and the second ends them. expected: size of the
/// content, for which there is room.
std::vector<std::byte> begin_seal(const Seal&, std::size_t expected);
void end_seal(std::vector<std::byte>&);

/// The content. Throws std::invalid_argument for bytes that are not from `seal`, are truncated or damaged.
std::span<const std::byte> unseal(const Seal&, std::span<const std::byte> bytes);

}  // namespace iota
