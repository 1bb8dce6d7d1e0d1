// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iota/system.h>

#include <nanobind/nanobind.h>

#include <array>
#include <string>
#include <string_view>
#include <utility>

namespace iota::bindings {

namespace nb = nanobind;

/// The words that a script uses for an enumeration.
template <class Value, std::size_t count>
using Words = std::array<std::pair<std::string_view, Value>, count>;

inline constexpr Words<IntegrationMode, 4> mode_words{{{"plausible", IntegrationMode::plausible},
                                                       {"robust", IntegrationMode::robust},
                                                       {"energy_keeping", IntegrationMode::energy_keeping},
                                                       {"accurate", IntegrationMode::accurate}}};
inline constexpr Words<BodyKind, 5> kind_words{{{"dynamic", BodyKind::dynamic},
                                                {"static", BodyKind::static_},
                                                {"scripted", BodyKind::scripted},
                                                {"inactive", BodyKind::inactive},
                                                {"resting", BodyKind::resting}}};
inline constexpr Words<Touches, 4> touches_words{{{"all", Touches::all},
                                                  {"obstacles", Touches::obstacles},
                                                  {"nothing", Touches::nothing},
                                                  {"sensor", Touches::sensor}}};

/// The value of a word; ValueError that lists the words for any other.
template <class Value, std::size_t count>
Value from_word(const Words<Value, count>& words, std::string_view word, const char* what) {
  std::string known;
  for (const auto& [name, value] : words) {
    if (name == word) return value;
    known += (known.empty() ? "'" : "', '") + std::string(name);
  }
  const std::string text = std::string(what) + " must be one of " + known + "', not '" + std::string(word) + "'";
  throw nb::value_error(text.c_str());
}

template <class Value, std::size_t count>
std::string to_word(const Words<Value, count>& words, Value wanted) {
  for (const auto& [name, value] : words)
    if (value == wanted) return std::string(name);
  return "unknown";
}

/// A word of `mode_words`, `kind_words` or `touches_words`; `from_word` refuses unknown ones with a list of the known words.
struct ModeWord {
  std::string word;
};
struct KindWord {
  std::string word;
};
struct TouchesWord {
  std::string word;
};

inline IntegrationMode to_mode(const ModeWord& mode) { return from_word(mode_words, mode.word, "mode"); }
inline Touches to_touches(const TouchesWord& touches) { return from_word(touches_words, touches.word, "touches"); }
inline BodyKind to_kind(const KindWord& kind) { return from_word(kind_words, kind.word, "kind"); }

}  // namespace iota::bindings

namespace nanobind::detail {

template <class Word>
struct word_caster {
  template <class T>
  using Cast = movable_cast_t<T>;
  template <class T>
  static constexpr bool can_cast() {
    return true;
  }
  explicit operator Word*() { return &value; }
  explicit operator Word&() { return value; }
  explicit operator Word&&() { return std::move(value); }
  Word value;

  bool from_python(handle source, uint8_t, cleanup_list*) noexcept {
    Py_ssize_t size = 0;
    const char* text = PyUnicode_Check(source.ptr()) ? PyUnicode_AsUTF8AndSize(source.ptr(), &size) : nullptr;
    if (!text) {
      PyErr_Clear();
      return false;
    }
    value.word.assign(text, static_cast<std::size_t>(size));
    return true;
  }
  static handle from_cpp(const Word& word, rv_policy, cleanup_list*) noexcept {
    return PyUnicode_FromStringAndSize(word.word.data(), static_cast<Py_ssize_t>(word.word.size()));
  }
};

template <>
struct type_caster<iota::bindings::ModeWord> : word_caster<iota::bindings::ModeWord> {
  using Value = iota::bindings::ModeWord;
  static constexpr auto Name = const_name("typing.Literal['plausible', 'robust', 'energy_keeping', 'accurate']");
};
template <>
struct type_caster<iota::bindings::KindWord> : word_caster<iota::bindings::KindWord> {
  using Value = iota::bindings::KindWord;
  static constexpr auto Name = const_name("typing.Literal['dynamic', 'static', 'scripted', 'inactive', 'resting']");
};
template <>
struct type_caster<iota::bindings::TouchesWord> : word_caster<iota::bindings::TouchesWord> {
  using Value = iota::bindings::TouchesWord;
  static constexpr auto Name = const_name("typing.Literal['all', 'obstacles', 'nothing']");
};

}  // namespace nanobind::detail
