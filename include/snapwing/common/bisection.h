#pragma once
/// Bisection: slow, and sure wherever a function changes its sign, or an answer from no to yes.

namespace snapwing::common {

/// Where something begins to be: it is not at `low` (taken for granted, not asked) and is at `high`.
struct Bracket {
  double low = 0, high = 0;
  double middle() const { return 0.5 * (low + high); }
};

/// The bracket halved `halvings` times, or until it is at most `width` wide. @param is  asked of a number in the
/// bracket
template <typename Is>
Bracket bisect(Bracket in, const Is& is, int halvings, double width = 0) {
  for (int i = 0; i < halvings && in.high - in.low > width; ++i) {
    const double middle = in.middle();
    (is(middle) ? in.high : in.low) = middle;
  }
  return in;
}

/// Place between `low` and `high` at which `f` changes its sign, given that it does: `halvings` times, or until the
/// bracket is at most `width` wide. An end at which f is exactly zero is found, whichever way f leaves it.
template <typename Function>
double bisect(const Function& f, double low, double high, int halvings, double width = 0) {
  const double begin = f(low);
  const bool rising = begin < 0 || (begin == 0 && f(high) > 0);
  return bisect(
             Bracket{low, high}, [&](double x) { return (f(x) < 0) != rising; }, halvings, width)
      .middle();
}

}  // namespace snapwing::common
