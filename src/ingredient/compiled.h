// SPDX-License-Identifier: Apache-2.0
// Common to laws and fields: records with a text of the user, each compiled beside the table that is saved.
#pragma once

#include "expression/formula.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace iota::ingredient {

/// Whether a text from an untrusted archive is terminated.
template <std::size_t n>
bool has_end(const std::array<char, n>& text) {
  return std::find(text.begin(), text.end(), '\0') != text.end();
}

template <std::size_t n, std::size_t count>
std::vector<std::string> names_of(const std::array<std::array<char, n>, count>& names, std::uint32_t used) {
  std::vector<std::string> list;
  for (const auto& name : std::span(names).first(used)) list.emplace_back(name.data());
  return list;
}

/// The slot of a new record. If compile(slot) throws, there is none, and the exception is passed on.
template <class Table, class Record, class Compile>
std::uint32_t create_compiled(Table& table, const Record& record, Compile compile) {
  const std::uint32_t slot = table.create(record).slot;
  try {
    compile(slot);
  } catch (...) {
    table.destroy(slot);
    throw;
  }
  return slot;
}

/// Calls compile(slot) for all records; false from the first on that is not valid or does not compile.
template <class Table, class IsValid, class Compile>
bool compile_all(const Table& table, IsValid is_valid, Compile compile) {
  bool good = true;
  table.for_each([&](std::uint32_t slot, const auto& record) {
    good = good && is_valid(record);
    if (!good) return;
    try {
      compile(slot);
    } catch (const std::invalid_argument&) {
      good = false;
    }
  });
  return good;
}

}  // namespace iota::ingredient
