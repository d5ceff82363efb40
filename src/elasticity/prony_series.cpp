#include "snapwing/elasticity/prony_series.h"

#include <cmath>
#include <string>

#include "snapwing/common/elementary.h"
#include "snapwing/common/error.h"
#include "snapwing/common/plain_text.h"
#include "snapwing/common/require.h"

namespace snapwing::elasticity {

double PronySeries::slow() const {
  double rest = 1;
  for (const Branch& branch : branches) rest -= branch.share;
  return rest;
}

double PronySeries::relaxation(double t) const {
  double sum = slow();
  for (const Branch& branch : branches) sum += branch.share * common::exp(-t / branch.time);
  return sum;
}

double PronySeries::storage(double omega) const {
  double sum = slow();
  for (const Branch& branch : branches) {
    const double x = omega * branch.time;
    sum += branch.share * x * x / (1 + x * x);
  }
  return sum;
}

double PronySeries::loss(double omega) const { return omega * slow() * viscousTime(omega); }

double PronySeries::viscousTime(double omega) const {
  double sum = 0;
  for (const Branch& branch : branches) {
    const double x = omega * branch.time;
    sum += branch.share * branch.time / (1 + x * x);
  }
  return sum / slow();
}

void PronySeries::validate() const {
  for (std::size_t k = 0; k < branches.size(); ++k) {
    const common::Require require("relaxation term " + std::to_string(k));
    const Branch& branch = branches[k];
    require(branch.share > 0 && branch.share < 1, "share", branch.share, "> 0 and < 1");
    require.positive("time", branch.time, " s");
  }
  if (!(slow() > 0)) {
    throw common::Error("relaxation: the shares' sum is " + common::toText(1 - slow()) + "; allowed: less than 1");
  }
}

RelaxationStep::RelaxationStep(double x) {
  constexpr double SMALL = 0.02;  // below, series: digits cancel
  const double gone = -common::expm1(-x);
  decay = common::exp(-x);
  mean = gone / x;
  ramp = x < SMALL ? 0.5 + x * (-1.0 / 6 + x * (1.0 / 24 + x * (-1.0 / 120 + x * (1.0 / 720 - x / 5040))))
                   : (1 - mean) / x;
  first = -0.5 * common::expm1(-2 * x);
  mixed = 0.5 * gone * mean;
  last = x < SMALL ? x * (1.0 / 3 + x * (-1.0 / 4 + x * (7.0 / 60 + x * (-1.0 / 24 + x * 31.0 / 2520))))
                   : (x - 2 * gone + first) / (x * x);
}

}  // namespace snapwing::elasticity
