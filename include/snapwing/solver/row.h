#pragma once
/// A linear function of the full coordinates, row . y: a distance, a travel, the place of a body along an axis.

#include <Eigen/Core>
#include <utility>
#include <vector>

namespace snapwing::solver {

class Row {
 public:
  Row() = default;
  /// @param entries  (full coordinate, coefficient [1]); at least one, none twice. @throws common::Error
  explicit Row(std::vector<std::pair<int, double>> entries);

  /// The function's value. @param y  (full coordinates x 1)
  double dot(const Eigen::VectorXd& y) const {
    double sum = 0;
    for (std::size_t k = 0; k < coordinates_.size(); ++k) sum += values_(static_cast<int>(k)) * y(coordinates_[k]);
    return sum;
  }
  /// Sum of |coefficient * coordinate|: what rounding of the function is a share of.
  double size(const Eigen::VectorXd& y) const {
    double sum = 0;
    for (std::size_t k = 0; k < coordinates_.size(); ++k)
      sum += std::abs(values_(static_cast<int>(k)) * y(coordinates_[k]));
    return sum;
  }
  /// gradient += times * row
  void addTo(double times, Eigen::VectorXd& gradient) const {
    for (std::size_t k = 0; k < coordinates_.size(); ++k)
      gradient(coordinates_[k]) += times * values_(static_cast<int>(k));
  }
  double norm() const { return values_.norm(); }  ///< of the coefficients [1]
  const std::vector<int>& coordinates() const { return coordinates_; }
  const Eigen::VectorXd& values() const { return values_; }

 private:
  std::vector<int> coordinates_;
  Eigen::VectorXd values_;
};

}  // namespace snapwing::solver
