#pragma once
/// Taylor arithmetic: a function is written down once, as operations on a tape. Along any path of its arguments,
/// x(t) = sum x_k t^k, the tape then finds the coefficients of the function, order by order [Griewank, Walther 2008,
/// ch. 13]. Several points are worked on side by side.
///
/// A coefficient of order k depends linearly on the arguments' own of that order, and on lower ones. Where those of
/// order k are not known before the function's are (a series of equilibria), they come in two parts: remainder(), with
/// x_k = 0, and complete(), which adds what x_k changes.

#include <cstddef>
#include <vector>

#include "snapwing/elasticity/point_lanes.h"

namespace snapwing::elasticity {

class TaylorTape {
 public:
  using Node = int;
  struct Share {
    double factor;
    Node node;
  };
  struct Product {
    double factor;
    Node left, right;
  };

  /// @param inputs  number of arguments: nodes 0 .. inputs - 1
  explicit TaylorTape(int inputs);

  /// Each adds an operation on earlier nodes and returns the node of its result.
  /// constant + sum of products + sum of shares.
  Node sum(const std::vector<Product>& products, const std::vector<Share>& shares = {}, double constant = 0);
  /// (constant + sum of shares) / denominator
  Node quotient(const std::vector<Share>& numerator, double constant, Node denominator);
  Node log(Node argument);
  /// The root r of a (e^2r - 1) + b (argument + r) = 0, a > 0, b >= 0.
  Node exponentialRoot(double a, double b, Node argument);
  /// A result of the function: a sum whose lower coefficients nothing asks for.
  void result(const std::vector<Product>& products, const std::vector<Share>& shares);

  int results() const { return static_cast<int>(results_.size()); }
  int nodes() const { return nodes_; }  ///< numbers that each order of a point has
  /// Numbers of a point's state up to an order: inverses of denominators, then [order][node].
  std::size_t room(int order) const { return inverses_.size() + static_cast<std::size_t>(order + 1) * nodes_; }
  /// Where a state has its inputs of order 0.
  Lanes* inputsOf(Lanes* state) const { return state + inverses_.size(); }
  bool empty() const { return results_.empty(); }

  /// Values of order 0 of all nodes, and the results.
  /// @param state  of room() numbers, its inputs given
  void start(Lanes* state, Lanes* results) const;
  /// Coefficients of an order >= 1 with zero inputs; lower ones are complete.
  void remainder(int order, Lanes* state, Lanes* results) const;
  /// Adds what the inputs of this order change. @param change  work space, (nodes), its inputs given
  void complete(int order, Lanes* state, Lanes* change) const;

 private:
  enum class Kind { SUM, QUOTIENT, LOG, ROOT };
  struct Operation {
    Kind kind;
    Node to;                             ///< a root is followed by its exponential
    Node of = 0;                         ///< argument, or denominator
    int inverse = -1;                    ///< place of 1 / denominator
    double a = 0, b = 0;                 ///< of a root; a: constant of a sum or numerator
    std::vector<Product> products = {};  ///< of a sum
    std::vector<Share> shares = {};      ///< of a sum or numerator
  };
  struct Run;
  int inverseOf(Node denominator);

  int inputs_, nodes_;
  std::vector<Node> inverses_;  ///< denominators; -1: of a root
  std::vector<Operation> operations_, results_;
};

}  // namespace snapwing::elasticity
