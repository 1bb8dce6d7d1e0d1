// SPDX-License-Identifier: Apache-2.0
#include "edit/command_list.h"

#include "base/text.h"
#include "edit/commands.h"
#include "edit/letter_a_commands.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <map>
#include <stdexcept>
#include <type_traits>
#include <variant>

namespace iota::edit {

namespace {

// ------------------------------------------------------------------------------------------------------- own commands

/// The same from all compilers: they differ in spaces, and in braces around a text that is an argument.
template <class T>
std::string name_of() {
  std::string_view text = __PRETTY_FUNCTION__;
  text = text.substr(text.find("T = ") + 4);
  text = text.substr(0, text.find_first_of(";]"));
  std::string name;
  for (std::size_t at = 0; at < text.size();) {
    constexpr std::string_view prefixes[] = {
        "iota::edit::", "iota::ingredient::", "iota::model::", "iota::", "struct "};
    const auto skipped = std::ranges::find_if(prefixes, [&](auto each) { return text.substr(at).starts_with(each); });
    if (skipped != std::end(prefixes))
      at += skipped->size();
    else if (const char c = text[at++]; c != ' ')
      name += c;
  }
  const std::size_t begin = name.find('"'), end = name.rfind('"');
  if (begin == end) return name;
  return name.substr(0, name.find('<') + 1) + name.substr(begin + 1, end - begin - 1) + ">";
}

template <class T>
void add_layout(std::string& layout) {
  if constexpr (std::is_same_v<T, bool>) {
    layout += "u1";
  } else if constexpr (std::is_enum_v<T>) {
    layout += text("u", sizeof(T));
  } else if constexpr (std::is_arithmetic_v<T>) {
    layout += std::is_floating_point_v<T> ? 'f' : std::is_signed_v<T> ? 'i' : 'u';
    layout += text(sizeof(T));
  } else if constexpr (iota::detail::is_array<T>) {
    for (std::size_t i = 0; i < std::tuple_size_v<T>; ++i) add_layout<typename T::value_type>(layout);
  } else if constexpr (iota::detail::is_list<T>) {
    layout += '[';
    add_layout<typename T::value_type>(layout);
    layout += ']';
  } else if constexpr (iota::detail::is_variant<T>) {
    layout += '<';
    [&]<std::size_t... i>(std::index_sequence<i...>) {
      (((i > 0 ? void(layout += '|') : void()), add_layout<std::variant_alternative_t<i, T>>(layout)), ...);
    }(std::make_index_sequence<std::variant_size_v<T>>{});
    layout += '>';
  } else if constexpr (!std::is_empty_v<T>) {
    T value{};
    for_each_field(value, [&]<class Field>(Field&) { add_layout<std::remove_const_t<Field>>(layout); });
  }
}

struct Entry {
  std::string name, layout;
};

template <class C>
std::vector<std::byte> default_bytes() {
  std::vector<std::byte> bytes;
  Writer writer(bytes);
  if constexpr (!std::is_empty_v<C>) {
    const C command{};
    serialize(writer, command);
  }
  return bytes;
}

struct Own {
  std::vector<Entry> entries;
  std::vector<std::vector<std::byte>> defaults;
  std::map<std::string, std::size_t, std::less<>> index_of;
};

const Own& own() {
  static const Own all = [] {
    Own made;
    for_each_command_type([&]<class C>() {
      Entry entry{name_of<C>(), {}};
      add_layout<C>(entry.layout);
      made.index_of.emplace(entry.name, made.entries.size());
      made.entries.push_back(std::move(entry));
      made.defaults.push_back(default_bytes<C>());
    });
    return made;
  }();
  return all;
}

// ---------------------------------------------------------------------------------------------------------- other ones

[[noreturn]] void fail_list() {
  throw std::invalid_argument("this recording is damaged: its list of commands is no such list");
}

std::vector<Entry> entries_of(std::string_view list) {
  std::vector<Entry> entries;
  while (!list.empty()) {
    const std::size_t end = list.find('\n'), space = list.find(' ');
    if (end == std::string_view::npos || space >= end || entries.size() == 256) fail_list();
    entries.push_back({std::string(list.substr(0, space)), std::string(list.substr(space + 1, end - space - 1))});
    list.remove_prefix(end + 1);
  }
  return entries;
}

/// Walks over values by their layout.
class Walk {
 public:
  explicit Walk(std::span<const std::byte> bytes) : bytes_(bytes) {}

  std::size_t at() const { return at_; }
  bool at_end() const { return at_ == bytes_.size(); }
  std::uint64_t number(std::size_t size) {
    if (bytes_.size() - at_ < size) throw std::invalid_argument("a command of the recording is cut short or damaged");
    std::uint64_t value = 0;
    std::memcpy(&value, bytes_.data() + at_, std::min(size, sizeof value));
    at_ += size;
    return value;
  }

  void skip_all(std::string_view layout) {
    while (!layout.empty()) skip_one(layout, 0);
  }

 private:
  /// Skips a value, and removes its layout.
  void skip_one(std::string_view& layout, int depth) {
    const std::string_view all = layout;
    remove_one(layout, depth);
    const std::string_view one = all.substr(0, all.size() - layout.size());
    if (one[0] == '[') {
      const std::string_view item = one.substr(1, one.size() - 2);
      const std::uint64_t count = number(8);
      if (item.empty() || count > bytes_.size() - at_)
        throw std::invalid_argument("a list of the recording is damaged");
      for (std::uint64_t i = 0; i < count; ++i) skip_within(item, depth);
    } else if (one[0] == '<') {
      std::uint64_t chosen = number(1);
      std::string_view rest = one.substr(1, one.size() - 2);
      for (;; --chosen) {
        std::string_view end = rest;
        while (!end.empty() && end[0] != '|') remove_one(end, depth);
        if (chosen == 0) return skip_within(rest.substr(0, rest.size() - end.size()), depth);
        if (end.empty()) throw std::invalid_argument("a choice of the recording is damaged");
        rest = end.substr(1);
      }
    } else {
      (void)number(static_cast<std::size_t>(one[1] - '0'));
    }
  }
  void skip_within(std::string_view layout, int depth) {
    while (!layout.empty()) skip_one(layout, depth + 1);
  }
  static void remove_one(std::string_view& layout, int depth) {
    if (layout.size() < 2 || depth > 8) fail_list();
    if (layout[0] == '[' || layout[0] == '<') {
      const char end = layout[0] == '[' ? ']' : '>';
      layout.remove_prefix(1);
      while (!layout.empty() && layout[0] != end) {
        if (layout[0] == '|' && end == '>')
          layout.remove_prefix(1);
        else
          remove_one(layout, depth + 1);
      }
      if (layout.empty()) fail_list();
      layout.remove_prefix(1);
    } else {
      if (std::string_view("uif").find(layout[0]) == std::string_view::npos || layout[1] < '1' || layout[1] > '8')
        fail_list();
      layout.remove_prefix(2);
    }
  }

  std::span<const std::byte> bytes_;
  std::size_t at_ = 0;
};

std::size_t index_by_name(const Entry& other) {
  const auto found = own().index_of.find(other.name);
  if (found == own().index_of.end())
    throw std::invalid_argument(
        text("this recording has the command ", other.name, ", which this version of Iota does not have"));
  if (!own().entries[found->second].layout.starts_with(other.layout))
    throw std::invalid_argument(
        text("this recording has the command ", other.name, ", which has other fields in this version of Iota"));
  return found->second;
}

}  // namespace

const std::string& own_commands() {
  static const std::string list = [] {
    std::string lines;
    for (const Entry& entry : own().entries) lines += entry.name + " " + entry.layout + "\n";
    return lines;
  }();
  return list;
}

std::vector<std::byte> in_own_commands(std::string_view list, std::span<const std::byte> commands) {
  if (list == own_commands()) return {commands.begin(), commands.end()};
  const std::vector<Entry> others = entries_of(list);
  std::vector<std::byte> translated;
  Walk walk(commands);
  while (!walk.at_end()) {
    const std::uint64_t number = walk.number(1);
    if (number >= others.size())
      throw std::invalid_argument("a command of the recording has a number that is not in its list");
    const std::size_t index = index_by_name(others[number]);
    const std::size_t begin = walk.at();
    walk.skip_all(others[number].layout);
    translated.push_back(static_cast<std::byte>(index));
    const auto fields = commands.subspan(begin, walk.at() - begin);
    translated.insert(translated.end(), fields.begin(), fields.end());
    const std::vector<std::byte>& defaults = own().defaults[index];
    Walk known(defaults);
    known.skip_all(others[number].layout);
    translated.insert(translated.end(), defaults.begin() + static_cast<std::ptrdiff_t>(known.at()), defaults.end());
  }
  return translated;
}

std::string_view commands_of_letter_a() { return letter_a_commands; }

}  // namespace iota::edit
