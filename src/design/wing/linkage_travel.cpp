// Dead points over the travel: the diagonal D = |B - x1| is the only thing that moves, and it is known in closed form.
#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

#include "snapwing/common/error.h"
#include "snapwing/design/wing/linkage_four_bar.h"

namespace snapwing::design {

namespace {

constexpr double TURN = 2 * M_PI;

/// Angle from the ground bar to the crank as theta grows.
struct Diagonal {
  double crank, ground, start, sign;
  explicit Diagonal(const FourBar& bar)
      : crank(bar.crankLength()),
        ground(bar.auxiliary.norm()),
        start(std::atan2(bar.joint1.y(), bar.joint1.x()) - std::atan2(bar.auxiliary.y(), bar.auxiliary.x())),
        sign(bar.crank_sign) {}
  double at(double theta) const {
    const double square = crank * crank + ground * ground - 2 * crank * ground * std::cos(start + sign * theta);
    return std::sqrt(std::max(square, 0.0));
  }
  /// First theta >= 0 at which the angle from ground to crank is `angle` (modulo a turn).
  double firstAt(double angle) const {
    const double way = std::fmod(sign * (angle - start), TURN);
    return way < 0 ? way + TURN : way;
  }
  /// First theta at which D has the given length; infinite if never.
  double firstWith(double length) const {
    const double c = (crank * crank + ground * ground - length * length) / (2 * crank * ground);
    if (std::abs(c) > 1) return std::numeric_limits<double>::infinity();
    return std::min(firstAt(std::acos(c)), firstAt(-std::acos(c)));
  }
};

double transmissionAngle(double a, double b, double diagonal) {
  const double mu = std::acos(std::clamp((a * a + b * b - diagonal * diagonal) / (2 * a * b), -1.0, 1.0));
  return std::min(mu, M_PI - mu);
}

}  // namespace

TravelCheck checkTravel(const FourBar& bar, double largest) {
  bar.validate();
  if (!(largest > 0) || !std::isfinite(largest)) {
    throw common::Error("linkage: the largest rotation is " + std::to_string(largest) + " rad; allowed: above 0");
  }
  const double a = bar.couplerLength(), b = bar.rockerLength();
  const Diagonal diagonal(bar);
  std::vector<double> extremes{0.0, largest};
  for (const double angle : {0.0, M_PI}) {
    if (diagonal.firstAt(angle) < largest) extremes.push_back(diagonal.firstAt(angle));
  }
  TravelCheck check;
  check.smallest_transmission = std::numeric_limits<double>::infinity();
  for (const double theta : extremes) {
    const double length = diagonal.at(theta), mu = transmissionAngle(a, b, length);
    check.largest_bar_mismatch = std::max({check.largest_bar_mismatch, length - (a + b), std::abs(a - b) - length});
    if (mu < check.smallest_transmission) {
      check.smallest_transmission = mu;
      check.smallest_transmission_at = theta;
    }
  }
  const double dead = std::min(diagonal.firstWith(a + b), diagonal.firstWith(std::abs(a - b)));
  check.closes = check.largest_bar_mismatch == 0 && !(dead <= largest);
  check.dead_point = dead <= largest ? dead : std::numeric_limits<double>::quiet_NaN();
  return check;
}

std::string TravelCheck::verdict(double margin) const {
  std::ostringstream text;
  if (!closes) {
    text << "dead point at " << dead_point << " rad: the two assembly modes meet and the loop opens by up to "
         << largest_bar_mismatch << " m";
  } else if (smallest_transmission < margin) {
    text << "no dead point, but the transmission angle falls to " << smallest_transmission << " rad at "
         << smallest_transmission_at << " rad; wanted: at least " << margin << " rad";
  } else {
    text << "no dead point and no branch change; smallest transmission angle " << smallest_transmission << " rad at "
         << smallest_transmission_at << " rad";
  }
  return text.str();
}

}  // namespace snapwing::design
