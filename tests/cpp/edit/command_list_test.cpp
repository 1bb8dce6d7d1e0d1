// SPDX-License-Identifier: Apache-2.0
#include "edit/command_list.h"

#include "edit/door.h"

#include <gtest/gtest.h>
#include <iota/system.h>

#include <set>
#include <sstream>
#include <string>

namespace iota::edit {
namespace {

std::vector<std::byte> some_commands() {
  std::vector<std::byte> bytes;
  write(bytes, Step{0.25});
  write(bytes, SetSolver{"exact"});
  write(bytes, CreateBody{});
  write(bytes, CreateSolid{});
  write(bytes, Step{0.5});
  return bytes;
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

TEST(CommandList, names_each_command_once_and_the_same_for_all_compilers) {
  std::set<std::string> names;
  std::istringstream lines(own_commands());
  for (std::string line; std::getline(lines, line);) {
    const std::string name = line.substr(0, line.find(' '));
    EXPECT_TRUE(names.insert(name).second) << name;
    EXPECT_EQ(name.find_first_of("{}\"= ,:"), std::string::npos) << name;
  }
  EXPECT_EQ(names.size(), std::tuple_size_v<AllCommands>);
  EXPECT_TRUE(names.contains("Step") && names.contains("Destroy<body>"));
}

TEST(CommandList, commands_with_other_numbers_are_found_by_their_names) {
  std::string list = replaced(own_commands(), "Step f8\n", "");
  list += "Step f8\n";
  std::vector<std::byte> other = some_commands();
  const std::size_t step = sizeof(double) + 1;
  other.front() = other[other.size() - step] = static_cast<std::byte>(std::tuple_size_v<AllCommands> - 1);
  // All others have moved down by one.
  std::vector<std::byte> moved;
  for (const auto& command : {SetSolver{"exact"}}) write(moved, command);
  other[step] = static_cast<std::byte>(index_of<SetSolver> - 1);
  other[step + moved.size()] = static_cast<std::byte>(index_of<CreateBody> - 1);
  std::vector<std::byte> body;
  write(body, CreateBody{});
  other[step + moved.size() + body.size()] = static_cast<std::byte>(index_of<CreateSolid> - 1);
  EXPECT_EQ(in_own_commands(list, other), some_commands());
}

TEST(CommandList, a_field_that_has_come_since_gets_its_default) {
  const std::string list = replaced(own_commands(), "SetRest f8f8\n", "SetRest f8\n");
  std::vector<std::byte> own, older;
  SetRest rest{};
  write(own, rest);
  older.assign(own.begin(), own.begin() + 1 + sizeof(double));
  EXPECT_EQ(in_own_commands(list, older), own);
}

TEST(CommandList, what_this_program_does_not_have_is_refused_by_name) {
  const auto refusal = [](const std::string& list) {
    try {
      (void)in_own_commands(list, some_commands());
    } catch (const std::invalid_argument& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_EQ(refusal(replaced(own_commands(), "Step f8\n", "Leap f8\n")),
            "this recording has the command Leap, which this version of Iota does not have");
  EXPECT_EQ(refusal(replaced(own_commands(), "Step f8\n", "Step f4f4\n")),
            "this recording has the command Step, which has other fields in this version of Iota");
  for (const char* const list : {"x", "Step\n", "Step f8", "Step [f8\n", "Step q8\n", "Step <\n", "Step f\n"})
    EXPECT_NE(refusal(list), "") << list;
  for (const std::size_t cut : {1U, 5U, 12U}) {
    std::vector<std::byte> commands = some_commands();
    commands.resize(commands.size() - cut);
    const std::string list = own_commands() + "Other f8\n";
    EXPECT_THROW((void)in_own_commands(list, commands), std::invalid_argument);
  }
}

TEST(CommandList, the_commands_of_letter_a_are_still_there) {
  EXPECT_NO_THROW((void)in_own_commands(std::string(commands_of_letter_a()) + "Other f8\n", some_commands()));
}

}  // namespace
}  // namespace iota::edit
