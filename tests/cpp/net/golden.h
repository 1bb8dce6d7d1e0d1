// SPDX-License-Identifier: Apache-2.0
// Golden frames of protocol/golden/.
#pragma once

#include "source_folder.h"

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

namespace iota::test {

inline std::filesystem::path golden_folder() { return source_folder() / "protocol" / "golden"; }

inline std::vector<std::uint8_t> read_hex(const std::filesystem::path& file) {
  std::ifstream in(file);
  std::string digits;
  in >> digits;
  std::vector<std::uint8_t> bytes;
  for (std::size_t i = 0; i + 1 < digits.size(); i += 2) {
    bytes.push_back(static_cast<std::uint8_t>(std::stoi(digits.substr(i, 2), nullptr, 16)));
  }
  return bytes;
}

inline std::vector<std::uint8_t> golden(const std::string& name) { return read_hex(golden_folder() / (name + ".hex")); }

}  // namespace iota::test
