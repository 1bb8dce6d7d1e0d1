// SPDX-License-Identifier: Apache-2.0
#include "base/seal.h"

#include "base/archive.h"

#include <bit>
#include <cstring>
#include <stdexcept>
#include <string>

namespace iota {

static_assert(std::endian::native == std::endian::little, "sealed bytes are in the machine's own byte order");

namespace {

constexpr std::size_t size_of_head = sizeof Seal::mark + sizeof(std::uint64_t),
                      size_of_checksum = sizeof(std::uint64_t);

// By words of eight bytes, the last one filled up with zeros; byte by byte it took a third of a save. Each step maps the
// state one to one, so any change of a single word changes the result; the shift spreads the top bits, which a product
// would not.
std::uint64_t checksum(std::span<const std::byte> bytes) {
  constexpr std::size_t width = sizeof(std::uint64_t);
  std::uint64_t state = 0;
  const auto add = [&](const std::byte* from, std::size_t size) {
    std::uint64_t word = 0;
    std::memcpy(&word, from, size);
    state = (state ^ word) * 0x9E3779B97F4A7C15u;
    state ^= state >> 32;
  };
  const std::size_t whole = bytes.size() / width * width;
  for (std::size_t i = 0; i < whole; i += width) add(bytes.data() + i, width);
  add(bytes.data() + whole, bytes.size() - whole);
  return state;
}

[[noreturn]] void refuse(const Seal& seal, const char* why) {
  throw std::invalid_argument("this is not a " + std::string(seal.name) + ": " + why);
}

}  // namespace

std::vector<std::byte> seal(const Seal& seal, std::span<const std::byte> content) {
  std::vector<std::byte> bytes = begin_seal(seal, content.size());
  bytes.insert(bytes.end(), content.begin(), content.end());
  end_seal(bytes);
  return bytes;
}

std::vector<std::byte> begin_seal(const Seal& seal, std::size_t expected) {
  std::vector<std::byte> bytes;
  bytes.reserve(size_of_head + expected + size_of_checksum);
  Writer writer(bytes);
  writer.value(seal.mark), writer.value(std::uint64_t{0});
  return bytes;
}

void end_seal(std::vector<std::byte>& bytes) {
  const std::uint64_t size = bytes.size() - size_of_head;
  std::memcpy(bytes.data() + sizeof Seal::mark, &size, sizeof size);
  Writer(bytes).value(checksum(bytes));
}

std::span<const std::byte> unseal(const Seal& seal, std::span<const std::byte> bytes) {
  Reader reader(bytes);
  std::array<char, 8> mark;
  std::uint64_t size = 0, expected = 0;
  reader.value(mark), reader.value(size);
  if (mark != seal.mark) refuse(seal, "it does not start as one of this version of Iota");
  if (!reader.ok() || reader.remaining() < sizeof expected || size != reader.remaining() - sizeof expected)
    refuse(seal, "its length is wrong, it may have been cut short");
  const auto content = bytes.subspan(size_of_head, size);
  Reader(bytes.last(sizeof expected)).value(expected);
  if (checksum(bytes.first(bytes.size() - sizeof expected)) != expected) refuse(seal, "its checksum is wrong");
  return content;
}

}  // namespace iota
