#pragma once
/// What the local searches of the wing design share: the best point of a run, and the unit they work in.

#include <functional>
#include <string>

#include "snapwing/design/wing/wing_design.h"

namespace snapwing::design {

constexpr double SEARCH_UNIT = 0.01;  ///< [m] lengths are scaled to centimetres, so that all numbers are of order one

constexpr char CANCELLED_RUN[] = "cancelled";

/// Evaluates points of one run, keeps the last (objective and constraints come from one evaluation) and the best.
class WingRun {
 public:
  WingRun(const WingProblem& problem, const std::function<bool()>& cancelled)
      : problem_(problem), cancelled_(cancelled) {}
  /// @return null if the point cannot be evaluated, or if the run is cancelled
  const WingEvaluation* at(const Eigen::Vector4d& X);
  const LocalResult& best() const { return best_; }
  bool halted() const { return halted_; }

 private:
  void remember();
  const WingProblem& problem_;
  const std::function<bool()>& cancelled_;
  bool halted_ = false;
  Eigen::Vector4d X_ = Eigen::Vector4d::Zero();
  WingEvaluation last_;
  bool finite_ = false;
  LocalResult best_;
};

/// The design layer's own MMA. @return what ended it
std::string runOwnMma(const WingProblem& problem, const Eigen::Vector4d& start, WingRun* run);

}  // namespace snapwing::design
