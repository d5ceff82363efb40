#pragma once
/// Bisection by sign: slow, and sure wherever a function changes its sign.

namespace snapwing::common {

/// Place between `low` and `high` at which `f` changes its sign, given that it does: `halvings` times, or until the
/// bracket is at most `width` wide. An end at which f is exactly zero is found, whichever way f leaves it.
template <typename Function>
double bisect(const Function& f, double low, double high, int halvings, double width = 0) {
  const double begin = f(low);
  const bool rising = begin < 0 || (begin == 0 && f(high) > 0);
  for (int i = 0; i < halvings && high - low > width; ++i) {
    const double middle = 0.5 * (low + high);
    ((f(middle) < 0) == rising ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

}  // namespace snapwing::common
