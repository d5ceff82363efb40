#pragma once
/// A linear function of the full coordinates, row . y [m]: a distance, a travel, the position of a body along an axis.

#include <Eigen/Core>
#include <utility>
#include <vector>

namespace snapwing::solver {

class Row {
 public:
  Row() = default;
  /// @param entries  (full coordinate, coefficient [1]); at least one, none twice. @throws common::Error
  explicit Row(std::vector<std::pair<int, double>> entries);

  /// The function's value [m]. @param y  full coordinates [m], (full x 1)
  double dot(const Eigen::VectorXd& y) const {
    double sum = 0;
    for (std::size_t k = 0; k < coordinates_.size(); ++k) sum += values_(static_cast<int>(k)) * y(coordinates_[k]);
    return sum;
  }
  /// Sum of |coefficient * coordinate| [m]: times the machine epsilon, the rounding error of the function.
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
  const Eigen::VectorXd& values() const { return values_; }  ///< coefficients [1], in the order of coordinates()

 private:
  std::vector<int> coordinates_;
  Eigen::VectorXd values_;
};

}  // namespace snapwing::solver
