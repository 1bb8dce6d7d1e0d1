// SPDX-License-Identifier: Apache-2.0
#include "expression/formula.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <numbers>
#include <numeric>
#include <optional>

namespace iota::expression {

namespace {

constexpr int deepest = 100;
constexpr std::size_t largest = 20000;  // nodes

struct Function {
  std::string_view name;
  int arguments;
  Op op;
};

/// The list of functions. `call` expands pow, step and others that consist of several operations.
constexpr std::array functions{
    Function{"sqrt", 1, Op::square_root},
    Function{"exp", 1, Op::exponential},
    Function{"log", 1, Op::logarithm},
    Function{"sin", 1, Op::sine},
    Function{"cos", 1, Op::cosine},
    Function{"tan", 1, Op::tangent},
    Function{"tanh", 1, Op::hyperbolic_tangent},
    Function{"abs", 1, Op::absolute},
    Function{"sign", 1, Op::sign},
    Function{"floor", 1, Op::floor},
    Function{"step", 1, Op::less_equal},
    Function{"min", 2, Op::minimum},
    Function{"max", 2, Op::maximum},
    Function{"pow", 2, Op::power},
    Function{"where", 3, Op::select},
};

bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; }
bool is_digit(char c) { return c >= '0' && c <= '9'; }

/// Whether a text has a name.
bool mentions(std::string_view text, std::string_view name) {
  const auto is_in_a_word = [&](std::size_t at) {
    return at < text.size() && (is_letter(text[at]) || is_digit(text[at]));
  };
  for (std::size_t at = text.find(name); at != std::string_view::npos; at = text.find(name, at + 1))
    if (!(at > 0 && is_in_a_word(at - 1)) && !is_in_a_word(at + name.size())) return true;
  return false;
}

std::string show(std::string_view text, std::size_t position) {
  const std::size_t before = text.substr(0, position).rfind('\n');
  const std::size_t start = before == std::string_view::npos ? 0 : before + 1;
  const std::size_t end = std::min(text.find('\n', position), text.size());
  // Only a part of a long line, around the place, is shown.
  const std::size_t from = position - start > 60 ? position - 60 : start, to = std::min(end, position + 40);
  std::string line(text.substr(from, to - from));
  for (char& c : line)
    if (static_cast<unsigned char>(c) < ' ') c = ' ';
  // The caret counts characters, not bytes.
  const auto characters = std::count_if(line.begin(), line.begin() + static_cast<std::ptrdiff_t>(position - from),
                                        [](char c) { return (static_cast<unsigned char>(c) & 0xc0) != 0x80; });
  return "\n  " + line + "\n  " + std::string(static_cast<std::size_t>(characters), ' ') + "^";
}

/// Recursive descent; every level of nesting passes through `comparison`.
class Parser {
 public:
  Parser(std::string_view text, Formula& formula) : text_(text), formula_(formula) {}

  std::vector<Definition> definitions() {
    std::vector<Definition> all;
    for (skip_separators(); position_ < text_.size(); skip_separators()) {
      const std::size_t start = position_;
      const std::string name(word());
      if (name.empty() || !take('=') || peek() == '=')
        fail("expected 'name = expression'", name.empty() ? start : position_);
      refuse_taken(name, start);
      const Node node = comparison();
      names_.push_back({name, node, start});
      all.push_back(names_.back());
      skip_blanks();
      if (position_ < text_.size() && text_[position_] != ';' && text_[position_] != '\n') fail_unexpected();
    }
    if (all.empty()) fail("there is no expression here", 0);
    return all;
  }

 private:
  [[noreturn]] void fail(const std::string& problem, std::size_t position) const {
    throw ExpressionError(problem, text_, position);
  }
  [[noreturn]] void fail_unexpected() const {
    if (position_ >= text_.size()) fail("the expression ends too early", position_);
    const char c = text_[position_];
    if (c == ')') fail("there is no '(' for this ')'", position_);
    if (c == '=') fail("only one '=' is possible here; comparisons are < > <= >=", position_);
    if (static_cast<unsigned char>(c) >= 0x80) fail("only plain letters, digits and operators are possible", position_);
    fail(std::string("'") + c + "' is not expected here", position_);
  }

  void skip_blanks() {
    while (position_ < text_.size() &&
           (text_[position_] == ' ' || text_[position_] == '\t' || text_[position_] == '\r' ||
            (text_[position_] == '\n' && depth_of_brackets_ > 0)))
      ++position_;
  }
  void skip_separators() {
    for (skip_blanks(); peek() == ';' || peek() == '\n'; skip_blanks()) ++position_;
  }
  char peek() const { return position_ < text_.size() ? text_[position_] : '\0'; }
  bool take(char c) {
    skip_blanks();
    if (peek() != c) return false;
    ++position_;
    return true;
  }
  std::string_view word() {
    skip_blanks();
    const std::size_t start = position_;
    if (is_letter(peek()))
      while (is_letter(peek()) || is_digit(peek())) ++position_;
    return text_.substr(start, position_ - start);
  }

  void refuse_taken(const std::string& name, std::size_t position) const {
    const auto& inputs = formula_.inputs();
    if (std::find(inputs.begin(), inputs.end(), name) != inputs.end())
      fail("'" + name + "' is a variable or parameter already", position);
    if (std::any_of(names_.begin(), names_.end(), [&](const auto& d) { return d.name == name; }))
      fail("'" + name + "' is defined twice", position);
    if (name == "pi" || std::any_of(functions.begin(), functions.end(), [&](const auto& f) { return f.name == name; }))
      fail("'" + name + "' has a meaning already", position);
  }

  Node guarded(Node node) const {
    if (formula_.size() > largest) fail("the expression is too large: more than 20 000 operations", position_);
    return node;
  }

  Node comparison() {
    if (++depth_ > deepest) fail("nested deeper than 100 levels", position_);
    Node left = sum();
    skip_blanks();
    if (peek() == '<' || peek() == '>') {
      const bool swapped = text_[position_++] == '>';
      Op op = Op::less;
      if (peek() == '=') ++position_, op = Op::less_equal;
      const Node right = sum();
      left = guarded(swapped ? formula_.make(op, right, left) : formula_.make(op, left, right));
      skip_blanks();
      if (peek() == '<' || peek() == '>') fail("comparisons cannot be chained; use brackets", position_);
    }
    --depth_;
    return left;
  }

  Node sum() {
    Node left = product();
    while (true) {
      if (take('+'))
        left = guarded(formula_.make(Op::add, left, product()));
      else if (take('-'))
        left = guarded(formula_.make(Op::subtract, left, product()));
      else
        return left;
    }
  }

  Node product() {
    Node left = unary();
    while (true) {
      if (take('*'))
        left = guarded(formula_.make(Op::multiply, left, unary()));
      else if (take('/'))
        left = guarded(formula_.make(Op::divide, left, unary()));
      else
        return left;
    }
  }

  Node unary() {
    if (++depth_ > deepest) fail("nested deeper than 100 levels", position_);
    Node node = 0;
    if (take('-'))
      node = guarded(formula_.make(Op::negate, unary()));
    else if (take('+'))
      node = unary();
    else
      node = power();
    --depth_;
    return node;
  }

  /// Binds tighter than the sign before it, and to the right: -2^2 = -4, 2^-1 = 0.5, 2^3^2 = 2^9.
  Node power() {
    const Node base = atom();
    skip_blanks();
    const bool stars = text_.substr(position_, 2) == "**";
    if (!stars && peek() != '^') return base;
    position_ += stars ? 2 : 1;
    return guarded(formula_.make(Op::power, base, unary()));
  }

  Node atom() {
    skip_blanks();
    const std::size_t start = position_;
    if (take('(')) {
      ++depth_of_brackets_;
      const Node node = comparison();
      close(start);
      return node;
    }
    if (is_digit(peek()) || peek() == '.') return number();
    const std::string name(word());
    if (name.empty()) fail_unexpected();
    skip_blanks();
    if (peek() == '(') return call(name, start);
    return named(name, start);
  }

  void close(std::size_t opened) {
    skip_blanks();
    if (peek() == '\0') fail("this '(' is never closed", opened);
    if (!take(')')) fail_unexpected();
    --depth_of_brackets_;
  }

  Node number() {
    double value = 0;
    const auto [end, error] = std::from_chars(text_.data() + position_, text_.data() + text_.size(), value);
    if (error == std::errc::result_out_of_range) fail("this number is too large or too small", position_);
    if (error != std::errc{}) fail("this is not a number", position_);
    const std::size_t start = position_;
    position_ = static_cast<std::size_t>(end - text_.data());
    if (is_letter(peek()) || peek() == '.') fail("this is not a number; a product needs a '*'", start);
    return guarded(formula_.constant(value));
  }

  Node named(const std::string& name, std::size_t start) {
    const auto definition = std::find_if(names_.begin(), names_.end(), [&](const auto& d) { return d.name == name; });
    if (definition != names_.end()) return definition->node;
    const auto& inputs = formula_.inputs();
    const auto found = std::find(inputs.begin(), inputs.end(), name);
    if (found != inputs.end()) return guarded(formula_.input(static_cast<std::uint32_t>(found - inputs.begin())));
    if (name == "pi") return formula_.constant(std::numbers::pi);

    const auto& seldom = formula_.seldom();
    const auto is_mentioned = [&](const std::string& word) { return mentions(text_, word); };
    const bool lists_all = std::any_of(seldom.begin(), seldom.end(), is_mentioned);
    std::vector<std::string> known;
    for (const std::string& input : inputs)
      if (lists_all || std::find(seldom.begin(), seldom.end(), input) == seldom.end()) known.push_back(input);
    for (const auto& d : names_) known.push_back(d.name);
    std::string text = "unknown name '" + name + "'";
    for (const Function& f : functions)
      if (f.name == name) text = "'" + name + "' is a function: write " + name + "(...)";
    if (const std::string near = nearest(name, known); !near.empty()) text += "; did you mean '" + near + "'?";
    text += known.empty() ? "" : text.back() == '?' ? " Known are" : ". Known are";
    for (std::size_t i = 0; i < known.size(); ++i) text += (i ? ", " : " ") + known[i];
    fail(text, start);
  }

  Node call(const std::string& name, std::size_t start) {
    const std::size_t bracket = position_;
    const auto function =
        std::find_if(functions.begin(), functions.end(), [&](const auto& f) { return f.name == name; });
    if (function == functions.end()) {
      std::vector<std::string> known;
      for (const Function& f : functions) known.emplace_back(f.name);
      const std::string near = nearest(name, known);
      std::string text = "unknown function '" + name + "'";
      if (!near.empty()) text += "; did you mean '" + near + "'?";
      text += " Known are";
      for (std::size_t i = 0; i < known.size(); ++i) text += (i ? ", " : " ") + known[i];
      fail(text, start);
    }
    take('(');
    ++depth_of_brackets_;
    std::array<Node, 3> arguments{};
    int count = 0;
    skip_blanks();
    if (peek() != ')') do {
        const Node argument = comparison();
        if (count < 3) arguments[static_cast<std::size_t>(count)] = argument;
        ++count;
      } while (take(','));
    close(bracket);
    if (count != function->arguments)
      fail(name + " takes " + std::to_string(function->arguments) +
               (function->arguments == 1 ? " argument" : " arguments") + ", not " + std::to_string(count),
           start);
    if (name == "step") return guarded(formula_.make(Op::less_equal, formula_.constant(0), arguments[0]));
    return guarded(formula_.make(function->op, arguments[0], arguments[1], arguments[2]));
  }

  std::string_view text_;
  Formula& formula_;
  std::size_t position_ = 0;
  int depth_ = 0, depth_of_brackets_ = 0;
  std::vector<Definition> names_;
};

}  // namespace

ExpressionError::ExpressionError(const std::string& problem, std::string_view text, std::size_t at)
    : std::invalid_argument("expression, at character " + std::to_string(at + 1) + ": " + problem + show(text, at)),
      position(at) {}

void require_mentioned(std::string_view text, std::span<const std::string> parameters) {
  for (const std::string& parameter : parameters)
    if (!mentions(text, parameter))
      throw std::invalid_argument("the expression '" + std::string(text) + "' has no parameter '" + parameter + "'");
}

std::vector<Definition> parse(std::string_view text, Formula& formula) { return Parser(text, formula).definitions(); }

std::string nearest(std::string_view word, std::span<const std::string> known) {
  // Distance in single-letter edits: two, or half of a short word, may be wrong.
  std::string best;
  std::size_t least = std::min<std::size_t>(2, word.size() / 2) + 1;
  for (const std::string& other : known) {
    std::vector<std::size_t> row(other.size() + 1);
    std::iota(row.begin(), row.end(), std::size_t{0});
    for (std::size_t i = 0; i < word.size(); ++i) {
      std::size_t diagonal = row[0];
      row[0] = i + 1;
      for (std::size_t j = 0; j < other.size(); ++j) {
        const std::size_t above = row[j + 1];
        row[j + 1] = std::min({above + 1, row[j] + 1, diagonal + (word[i] != other[j])});
        diagonal = above;
      }
    }
    if (row.back() < least) least = row.back(), best = other;
  }
  return best;
}

}  // namespace iota::expression
