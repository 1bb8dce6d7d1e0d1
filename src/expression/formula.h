// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

/// Algebraic expressions of users: parsed with errors that show the place, differentiated symbolically, and compiled to
/// programs (program.h). Standard library only.
namespace iota::expression {

/// The text is not a valid expression. `what()` says why and shows the line with a caret under the place.
struct ExpressionError : std::invalid_argument {
  ExpressionError(const std::string& problem, std::string_view text, std::size_t position);
  std::size_t position;  ///< in bytes from the start of the text
};

enum class Op : std::uint8_t {
  constant,
  input,  ///< a variable or parameter
  negate,
  square_root,
  exponential,
  logarithm,
  sine,
  cosine,
  tangent,
  hyperbolic_tangent,
  absolute,
  sign,   ///< -1, 0, 1
  floor,  ///< largest integer not above it
  add,
  subtract,
  multiply,
  divide,
  power,
  whole_power,  ///< exponent in `value`
  minimum,
  maximum,
  less,        ///< 1 where a < b, else 0
  less_equal,  ///< 1 where a <= b, else 0
  select,      ///< b where a is not zero, else c
};

/// Index of a node in its formula.
using Node = std::uint32_t;

/// Expressions over common inputs, as one graph in which equal parts are one node. Children come before their parents.
class Formula {
 public:
  struct Entry {
    Op op;
    Node a = 0, b = 0, c = 0;  ///< an input's number is in a
    double value = 0;
  };

  /// `seldom`: inputs that errors list only for a text that has one of them.
  explicit Formula(std::vector<std::string> inputs, std::vector<std::string> seldom = {})
      : inputs_(std::move(inputs)), seldom_(std::move(seldom)) {}

  Node constant(double value);
  Node input(std::uint32_t number);
  /// Simplifies if that is exact: constants are folded, neutral elements dropped.
  Node make(Op op, Node a, Node b = 0, Node c = 0);
  Node whole_power(Node a, int exponent);

  /// d `of` / d input.
  Node derivative(Node of, std::uint32_t input);
  /// `of` with an input replaced by a node that does not depend on it.
  Node substitute(Node of, std::uint32_t input, Node by);
  bool depends_on(Node node, std::uint32_t input) const;

  const std::vector<std::string>& inputs() const { return inputs_; }
  const std::vector<std::string>& seldom() const { return seldom_; }
  const Entry& operator[](Node node) const { return entries_[node]; }
  std::size_t size() const { return entries_.size(); }

 private:
  Node intern(const Entry&);
  Node derive(const Entry&, std::span<const Node> derivatives);

  std::vector<std::string> inputs_, seldom_;
  std::vector<Entry> entries_;
  std::map<std::tuple<Op, Node, Node, Node, std::uint64_t>, Node> known_;
};

/// One operation on numbers: the reference; all other evaluations agree with it bit by bit.
double apply(Op op, double a, double b, double c);

/// `name = expression` of a text, in order. A later expression may use the names of earlier ones.
struct Definition {
  std::string name;
  Node node;
  std::size_t position;  ///< of the name in the text
};

/// Parses "name = expression; name = expression ...", also with line breaks between. Operators + - * / ^ (or **), comparisons
/// < > <= >= (1 or 0), functions sqrt exp log sin cos tan tanh abs sign floor min max pow step(x) (1 for x >= 0) and
/// where(condition, a, b); pi. Throws ExpressionError for anything else, unknown names (with the nearest known one), more
/// than 100 levels of nesting or 20 000 nodes.
std::vector<Definition> parse(std::string_view text, Formula& formula);

/// Throws std::invalid_argument for a parameter that a text does not have.
void require_mentioned(std::string_view text, std::span<const std::string> parameters);

/// The word of `known` nearest to `word`; empty if none is near.
std::string nearest(std::string_view word, std::span<const std::string> known);

}  // namespace iota::expression
