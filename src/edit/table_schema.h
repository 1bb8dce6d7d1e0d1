// SPDX-License-Identifier: Apache-2.0
// The schema of the tables of a model, by which snapshots of other versions are read.
#pragma once

#include "base/schema.h"

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace iota::edit {

/// The schema of this program.
const Schema& own_schema();
const std::string& own_schema_text();

/// The tables that a program with another schema has written, as this one writes them. Throws std::invalid_argument.
std::vector<std::byte> in_own_schema(std::string_view schema, std::span<const std::byte> tables);

/// Whether a snapshot has the tables of this program.
bool has_own_tables(std::span<const std::byte> snapshot);

/// The schema of snapshots of letter I, which did not contain it.
std::string_view schema_of_letter_i();

}  // namespace iota::edit
