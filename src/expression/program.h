// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "expression/formula.h"

#include <cstdint>
#include <span>
#include <vector>

namespace iota::expression {

/// Outputs of a formula as a short list of operations over blocks of lanes: each operation is one loop that the
/// compiler vectorizes, so that a block shares the cost of interpreting. Values that are equal in all lanes are
/// computed once. Plain data after `compile`; may run on several threads, each with its own workspace.
class Program {
 public:
  static constexpr std::size_t block = 64;  ///< lanes: registers of a typical law stay in the first-level cache

  /// Scratch memory; grows to the needs of the largest program and is reused.
  using Workspace = std::vector<double>;

  Program() = default;
  /// `is_uniform`: for each input of the formula, whether it has one value for all lanes.
  Program(Formula& formula, std::span<const Node> outputs, const std::vector<bool>& is_uniform);

  /// lanes[i] and uniforms[i] are those of input i; unused ones may be null or anything. outputs[k]: `count` numbers.
  void run(std::size_t count, const double* const* lanes, const double* uniforms, double* const* outputs,
           Workspace& workspace) const;

  /// All inputs in `inputs`, one lane: the same bits as `run`.
  void run_one(const double* inputs, double* outputs, Workspace& workspace) const;

  std::size_t operation_count() const { return uniform_.size() + lane_.size(); }  ///< for reports

 private:
  enum class Where : std::uint8_t { uniform, lane_input, lane };
  struct Operand {
    std::uint32_t index = 0;
    Where where = Where::uniform;
  };
  struct Operation {
    Op op = Op::constant;
    std::uint32_t out = 0;
    Operand a, b, c;
  };
  void run_block(std::size_t count, const double* const* lanes, std::size_t first, const double* uniforms,
                 double* registers) const;

  std::vector<double> uniform_start_;  // constants, and space for inputs and results
  std::vector<Operation> uniform_, lane_;
  std::vector<std::uint32_t> uniform_inputs_;  // number of the formula's input behind the first uniform slots
  std::vector<Operand> outputs_;
  std::size_t register_count_ = 0;
};

}  // namespace iota::expression
