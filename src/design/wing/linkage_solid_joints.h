#pragma once
/// Joints, drive and friction of the solid linkage with their derivatives by X; see
/// snapwing/design/wing/linkage_solid.h.

#include <string>
#include <vector>

#include "linkage_solid_mesh.h"

namespace snapwing::design {

template <int D>
class SolidJoints {
 public:
  SolidJoints(const FourBar& layout, const WingBars& bars, const SolidSettings& settings, const SolidMesh<D>& mesh);

  const solver::ConstraintRows& rows() const { return H_; }
  const std::vector<std::string>& names() const { return names_; }
  Eigen::VectorXd driven(double theta) const;    ///< h [m]
  Eigen::VectorXd friction(double theta) const;  ///< f [N]
  /// d(H u - h)/dX at fixed u, (rows x 4).
  Eigen::MatrixXd rowsByX(double theta, const Eigen::VectorXd& u) const;
  /// d(H^T lambda - f)/dX at fixed lambda, (dofs x 4).
  Eigen::MatrixXd forcesByX(double theta, const Eigen::VectorXd& lambda) const;

 private:
  /// A couple of friction on a bar: dead forces F and -F at t +- grip, F = M i e^(i phi) / conj(d).
  struct Couple {
    int bar;
    double t, moment;
    double phi;
    Eigen::RowVector4d dphi;
  };
  std::vector<Couple> couples(double theta) const;
  Complex forceOf(const Couple& c) const;
  void addRow(const NodeWeights& weights, int axis, double sign, int row);
  int newRow(const std::string& name);
  void join(const std::string& name, int first, double t_first, int second, double t_second);
  void ground(const std::string& name, int bar, double t) { join(name, bar, t, -1, 0); }
  void weld();

  FourBar layout_;
  WingBars bars_;
  SolidSettings settings_;
  const SolidMesh<D>& mesh_;
  std::vector<Eigen::Triplet<double>> entries_;
  std::vector<std::string> names_;
  solver::ConstraintRows H_;
  int weld_row_ = 0;
};

}  // namespace snapwing::design
