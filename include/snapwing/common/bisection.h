#pragma once
/// Bisection of a sign change, or of a change from false to true.

namespace snapwing::common {

/// Bracket of a change from false at `low` (assumed, not evaluated) to true at `high`.
struct Bracket {
  double low = 0, high = 0;
  double middle() const { return 0.5 * (low + high); }
};

/// The bracket halved `halvings` times, or until it is at most `width` wide. @param is  predicate of a number in the
/// bracket
template <typename Is>
Bracket bisect(Bracket in, const Is& is, int halvings, double width = 0) {
  for (int i = 0; i < halvings && in.high - in.low > width; ++i) {
    const double middle = in.middle();
    (is(middle) ? in.high : in.low) = middle;
  }
  return in;
}

/// Root of `f` between `low` and `high`, where f must have different signs, by `halvings` halvings or until the bracket
/// is at most `width` wide. An end at which f is exactly zero is found, whatever the sign of f beside it.
template <typename Function>
double bisect(const Function& f, double low, double high, int halvings, double width = 0) {
  const double begin = f(low);
  const bool rising = begin < 0 || (begin == 0 && f(high) > 0);
  return bisect(
             Bracket{low, high}, [&](double x) { return (f(x) < 0) != rising; }, halvings, width)
      .middle();
}

}  // namespace snapwing::common
