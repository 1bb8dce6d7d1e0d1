// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ingredient/model.h"
#include "laws/pair_laws.h"
#include "math/checks.h"

#include <iota/forces.h>

#include "expression/formula.h"

#include <algorithm>
#include <array>
#include <span>
#include <vector>

/// Names and parameters of laws and fields, of users and in tables.
namespace iota::edit {

template <std::size_t count>
using Names = std::array<std::array<char, 24>, count>;
using LawValues = std::array<double, laws::max_parameters>;

template <std::size_t n>
void put_text(std::array<char, n>& out, std::string_view from, const char* what) {
  if (from.size() >= n)
    throw std::invalid_argument(text(what, " must be shorter than ", n, " bytes, got ", from.size()));
  if (from.find('\0') != std::string_view::npos)
    throw std::invalid_argument(text(what, " must not contain a null character"));
  std::fill(std::copy(from.begin(), from.end(), out.begin()), out.end(), '\0');
}

inline bool is_name(std::string_view name) {
  const auto is_letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; };
  return !name.empty() && is_letter(name.front()) &&
         std::all_of(name.begin(), name.end(), [&](char c) { return is_letter(c) || (c >= '0' && c <= '9'); });
}

/// Parameters declared by a user, for an expression of `variables` or for code.
template <std::size_t count>
void put_parameters(Names<count>& names, std::array<double, count>& values, std::uint32_t& used,
                    const std::vector<LawParameter>& declared, std::span<const char* const> variables) {
  if (declared.size() > count)
    throw std::invalid_argument(text("there can be at most ", count, " parameters, got ", declared.size()));
  for (const LawParameter& parameter : declared) {
    if (!is_name(parameter.name))
      throw std::invalid_argument(text("'", parameter.name, "' cannot be a parameter's name: use letters and digits"));
    for (const char* const variable : variables)
      if (parameter.name == variable)
        throw std::invalid_argument(text("'", parameter.name, "' cannot be a parameter's name: it is a variable"));
    for (std::uint32_t i = 0; i < used; ++i)
      if (parameter.name == names[i].data())
        throw std::invalid_argument(text("parameter '", parameter.name, "' is given twice"));
    put_text(names[used], parameter.name, "the name of a parameter");
    values[used++] = parameter.value;
  }
}

/// Index of a parameter; throws with a list of all names.
template <std::size_t count>
std::uint32_t require_parameter(std::string_view owner, const Names<count>& names, std::uint32_t used,
                                std::string_view name) {
  std::vector<std::string> known;
  for (std::uint32_t i = 0; i < used; ++i) {
    known.emplace_back(names[i].data());
    if (known.back() == name) return i;
  }
  std::string message = text(owner.empty() ? "this law" : owner, " has no parameter '", name, "'");
  if (const std::string near = expression::nearest(name, known); !near.empty())
    message += "; did you mean '" + near + "'?";
  message += known.empty() ? "; it has none" : "; it has ";
  for (std::size_t i = 0; i < known.size(); ++i) message += (i ? ", " : "") + known[i];
  throw std::invalid_argument(message);
}

/// Limit of parameters of a predefined law, SI units: squares of the motion by larger ones would overflow.
inline constexpr double largest_parameter = 1e30;

inline void require_in_range(const char* name, laws::Range range, double value) {
  if (range == laws::Range::positive) require_positive(name, value);
  if (range == laws::Range::not_negative) require_not_negative(name, value);
  if (!std::isfinite(value)) throw std::invalid_argument(text(name, " must be finite, got ", value));
  if (range != laws::Range::any && value > largest_parameter)
    throw std::invalid_argument(text(name, " must be at most ", largest_parameter, ", got ", value));
}

template <std::size_t count>
std::vector<LawParameter> list_parameters(const Names<count>& names, std::uint32_t used, const double* values) {
  std::vector<LawParameter> list;
  for (std::uint32_t i = 0; i < used; ++i) list.push_back({names[i].data(), values[i]});
  return list;
}

/// The same for a law, and for an item with values of its parameters.
inline std::uint32_t require_parameter(const ingredient::Law& law, std::string_view name) {
  return require_parameter(law.name.data(), law.parameters, law.parameter_count, name);
}
inline std::vector<LawParameter> list_parameters(const ingredient::Law& law, const LawValues& values) {
  return list_parameters(law.parameters, law.parameter_count, values.data());
}
inline void require_parameter_value(const ingredient::Law& law, std::uint32_t index, double value) {
  const bool listed = law.kind == ingredient::LawKind::listed;
  require_in_range(law.parameters[index].data(),
                   listed ? laws::pair_law_parameters(law.number)[index].range : laws::Range::any, value);
}
inline void set_parameter(const ingredient::Law& law, LawValues& values, std::uint32_t index, double value) {
  if (index >= law.parameter_count) throw std::invalid_argument("set_parameter: no such parameter");
  require_parameter_value(law, index, value);
  values[index] = value;
}

}  // namespace iota::edit
