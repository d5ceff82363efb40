#include "snapwing/elasticity/taylor_tape.h"

#include <algorithm>
#include <cstddef>

#include "neo_hookean_point.h"
#include "snapwing/common/elementary.h"
#include "snapwing/common/wide.h"

#define SNAPWING_INLINE inline __attribute__((always_inline))

namespace snapwing::elasticity {

namespace {

/// All points' numbers as one value; the compiler divides it into what the processor has.
typedef double Wide __attribute__((vector_size(LANES * sizeof(double)), aligned(sizeof(Lanes)), may_alias));
static_assert(sizeof(Wide) == sizeof(Lanes));

/// The coefficients of one point's nodes.
class State {
 public:
  State(Lanes* state, std::size_t inverses, int nodes)
      : inverses_(reinterpret_cast<Wide*>(state)), values_(inverses_ + inverses), nodes_(nodes) {}
  SNAPWING_INLINE Wide& inverse(int place) const { return inverses_[place]; }
  SNAPWING_INLINE Wide& at(int order, TaylorTape::Node node) const {
    return values_[static_cast<std::ptrdiff_t>(order) * nodes_ + node];
  }
  /// sum += x_first y_(order - first) + ... + x_last y_(order - last)
  SNAPWING_INLINE void convolve(int order, int first, int last, TaylorTape::Node x, TaylorTape::Node y,
                                Wide& sum) const {
    const Wide *left = &at(first, x), *right = &at(order - first, y);
    for (int n = first; n <= last; ++n, left += nodes_, right -= nodes_) sum += *left * *right;
  }
  /// Of two products with the same left factor.
  SNAPWING_INLINE void convolveTwo(int order, const TaylorTape::Product& one, const TaylorTape::Product& two,
                                   Wide (&sums)[2]) const {
    const Wide *left = &at(0, one.left), *first = &at(order, one.right), *second = &at(order, two.right);
    Wide a{}, b{};
    for (int n = 0; n <= order; ++n, left += nodes_, first -= nodes_, second -= nodes_) {
      const Wide common = *left;
      a += common * *first;
      b += common * *second;
    }
    sums[0] = a, sums[1] = b;
  }
  /// sum += first x_first y_(order - first) + ... + last x_last y_(order - last): of a derivative x'
  SNAPWING_INLINE void convolveSlope(int order, int first, int last, TaylorTape::Node x, TaylorTape::Node y,
                                     Wide& sum) const {
    const Wide *left = &at(first, x), *right = &at(order - first, y);
    double weight = first;
    for (int n = first; n <= last; ++n, left += nodes_, right -= nodes_, weight += 1) sum += weight * (*left * *right);
  }

 private:
  Wide *inverses_, *values_;
  int nodes_;
};

}  // namespace

/// What an operation does to a state; all static, so that each pass is compiled as a whole for each width.
struct TaylorTape::Run {
  static SNAPWING_INLINE void sum(const Operation& op, int order, const State& s, Wide& to) {
    Wide total = Wide{} + (order == 0 ? op.a : 0.0);
    for (const Product& p : op.products) {
      Wide product{};
      s.convolve(order, 0, order, p.left, p.right, product);
      total += p.factor * product;
    }
    for (const Share& share : op.shares) total += share.factor * s.at(order, share.node);
    to = total;
  }
  /// Two sums of one product each with the same left factor.
  static SNAPWING_INLINE bool pairs(const Operation& one, const Operation& two) {
    return one.products.size() == 1 && two.products.size() == 1 && one.products[0].left == two.products[0].left;
  }
  static SNAPWING_INLINE void sumPair(const Operation& one, const Operation& two, int order, const State& s,
                                      Wide& first, Wide& second) {
    Wide products[2] = {};
    s.convolveTwo(order, one.products[0], two.products[0], products);
    first = one.products[0].factor * products[0];
    second = two.products[0].factor * products[1];
    for (const Share& share : one.shares) first += share.factor * s.at(order, share.node);
    for (const Share& share : two.shares) second += share.factor * s.at(order, share.node);
  }
  static SNAPWING_INLINE void root(const Operation& op, int order, const State& s) {
    Wide lower{};
    s.convolveSlope(order, 1, order - 1, op.to, op.to + 1, lower);
    lower *= 2.0 / order;
    const Wide exponential = s.at(0, op.to + 1);
    s.at(order, op.to) = -(op.b * s.at(order, op.of) + op.a * lower) * s.inverse(op.inverse);
    s.at(order, op.to + 1) = 2.0 * s.at(order, op.to) * exponential + lower;
  }
  static SNAPWING_INLINE void apply(const Operation& op, int order, const State& s) {
    Wide& to = s.at(order, op.to);
    Wide lower{};
    switch (op.kind) {
      case Kind::SUM:
        return sum(op, order, s, to);
      case Kind::QUOTIENT:
        sum(op, order, s, to);
        s.convolve(order, 0, order - 1, op.to, op.of, lower);
        to = (to - lower) * s.inverse(op.inverse);
        return;
      case Kind::LOG:
        s.convolveSlope(order, 1, order - 1, op.to, op.of, lower);
        to = (s.at(order, op.of) - lower * (1.0 / order)) * s.inverse(op.inverse);
        return;
      case Kind::ROOT:
        return root(op, order, s);
    }
  }
  static SNAPWING_INLINE void change(const Operation& op, const State& s, Wide* d) {
    Wide value{};
    for (const Product& p : op.products) {
      value += p.factor * (s.at(0, p.left) * d[p.right] + d[p.left] * s.at(0, p.right));
    }
    for (const Share& share : op.shares) value += share.factor * d[share.node];
    switch (op.kind) {
      case Kind::SUM:
        d[op.to] = value;
        return;
      case Kind::QUOTIENT:
        d[op.to] = (value - s.at(0, op.to) * d[op.of]) * s.inverse(op.inverse);
        return;
      case Kind::LOG:
        d[op.to] = d[op.of] * s.inverse(op.inverse);
        return;
      case Kind::ROOT:
        d[op.to] = -(op.b * d[op.of]) * s.inverse(op.inverse);
        d[op.to + 1] = 2.0 * d[op.to] * s.at(0, op.to + 1);
        return;
    }
  }

  SNAPWING_WIDE static void remainder(const Operation* ops, std::size_t count, int order, const State& s) {
    for (std::size_t k = 0; k < count; ++k) apply(ops[k], order, s);
  }
  SNAPWING_WIDE static void results(const Operation* ops, std::size_t count, int order, const State& s, Lanes* to) {
    Wide* all = reinterpret_cast<Wide*>(to);
    std::size_t k = 0;
    for (; k + 2 <= count; k += 2) {
      if (!pairs(ops[k], ops[k + 1])) break;
      sumPair(ops[k], ops[k + 1], order, s, all[k], all[k + 1]);
    }
    for (; k < count; ++k) sum(ops[k], order, s, all[k]);
  }
  SNAPWING_WIDE static void complete(const Operation* ops, std::size_t count, int order, const State& s, int nodes,
                                     Lanes* change_of) {
    Wide* d = reinterpret_cast<Wide*>(change_of);
    for (std::size_t k = 0; k < count; ++k) change(ops[k], s, d);
    for (int n = 0; n < nodes; ++n) s.at(order, n) += d[n];
  }

  /// Values that are transcendental.
  static void startOne(const Operation& op, Lanes* s) {
    for (int l = 0; l < LANES; ++l) {
      const double argument = s[op.of].at[l];
      if (op.kind == Kind::LOG) s[op.to].at[l] = common::log(argument);
      if (op.kind != Kind::ROOT) continue;
      NeoHookeanModuli moduli;
      moduli.mu = op.a, moduli.lambda = op.b;
      ThicknessStretch root;
      root.find(moduli, argument);
      s[op.to].at[l] = root.t;
      s[op.to + 1].at[l] = root.grown + 1;
    }
  }
  static void invert(const Operation& op, const State& s) {
    const Wide denominator = op.kind == Kind::ROOT ? 2 * op.a * s.at(0, op.to + 1) + op.b : s.at(0, op.of);
    s.inverse(op.inverse) = 1.0 / denominator;
  }
};

TaylorTape::TaylorTape(int inputs) : inputs_(inputs), nodes_(inputs) {}

int TaylorTape::inverseOf(Node denominator) {
  const auto known = std::find(inverses_.begin(), inverses_.end(), denominator);
  if (known == inverses_.end() || denominator < 0) {
    inverses_.push_back(denominator);
    return static_cast<int>(inverses_.size()) - 1;
  }
  return static_cast<int>(known - inverses_.begin());
}

TaylorTape::Node TaylorTape::sum(const std::vector<Product>& products, const std::vector<Share>& shares,
                                 double constant) {
  operations_.push_back({Kind::SUM, nodes_, 0, -1, constant, 0, products, shares});
  return nodes_++;
}

TaylorTape::Node TaylorTape::quotient(const std::vector<Share>& numerator, double constant, Node denominator) {
  operations_.push_back({Kind::QUOTIENT, nodes_, denominator, inverseOf(denominator), constant, 0, {}, numerator});
  return nodes_++;
}

TaylorTape::Node TaylorTape::log(Node argument) {
  operations_.push_back({Kind::LOG, nodes_, argument, inverseOf(argument)});
  return nodes_++;
}

TaylorTape::Node TaylorTape::exponentialRoot(double a, double b, Node argument) {
  operations_.push_back({Kind::ROOT, nodes_, argument, inverseOf(-1), a, b});
  nodes_ += 2;
  return nodes_ - 2;
}

void TaylorTape::result(const std::vector<Product>& products, const std::vector<Share>& shares) {
  results_.push_back({Kind::SUM, -1, 0, -1, 0, 0, products, shares});
}

void TaylorTape::start(Lanes* state, Lanes* results) const {
  const State s(state, inverses_.size(), nodes_);
  for (const Operation& op : operations_) {
    if (op.kind == Kind::LOG || op.kind == Kind::ROOT) Run::startOne(op, inputsOf(state));
    if (op.inverse >= 0) Run::invert(op, s);
    if (op.kind == Kind::SUM || op.kind == Kind::QUOTIENT) Run::remainder(&op, 1, 0, s);
  }
  Run::results(results_.data(), results_.size(), 0, s, results);
}

void TaylorTape::remainder(int order, Lanes* state, Lanes* results) const {
  Lanes* inputs = inputsOf(state) + static_cast<std::ptrdiff_t>(order) * nodes_;
  std::fill(inputs, inputs + inputs_, Lanes{});
  const State s(state, inverses_.size(), nodes_);
  Run::remainder(operations_.data(), operations_.size(), order, s);
  Run::results(results_.data(), results_.size(), order, s, results);
}

void TaylorTape::complete(int order, Lanes* state, Lanes* change) const {
  Run::complete(operations_.data(), operations_.size(), order, State(state, inverses_.size(), nodes_), nodes_, change);
}

}  // namespace snapwing::elasticity
