// SPDX-License-Identifier: Apache-2.0
// The commands of recordings by name and by the types of their fields. With the list of an older program, its commands are
// translated into those of the present one.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace iota::edit {

/// A line for each command of this program, in order of their numbers: its name, a space, the types of its fields. u, i, f and a digit: a
/// number of so many bytes; [x]: a list of x, after its length; <x|y>: a number and one of these; else one after the other.
const std::string& own_commands();

/// Commands of a program with another list as this one writes them. A command has to have the same fields, and may have more
/// at its end now, which get their defaults. Throws std::invalid_argument for a command that this program does not have or has with other
/// fields, and for damaged bytes.
std::vector<std::byte> in_own_commands(std::string_view list, std::span<const std::byte> commands);

/// The list of recordings of letter A, which did not contain it.
std::string_view commands_of_letter_a();

}  // namespace iota::edit
