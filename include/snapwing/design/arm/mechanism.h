#pragma once
/// A scene with one body whose density is designed, per column of cells: in a planar scene a column is a cell, in a
/// volumetric one the cells above each other along z, so that the design stays an outline that can be cut or printed.

#include <array>
#include <memory>
#include <vector>

#include "snapwing/mpm/density_field.h"
#include "snapwing/scene/scene_problem.h"
#include "snapwing/solver/sensitivity.h"

namespace snapwing::design {

class Mechanism {
 public:
  /// @param body  number of the designed body; its grid must begin at x = y = 0
  /// @throws common::Error naming the port, pin or support that meets no material
  Mechanism(const scene::Scene& scene, int body, int threads);
  ~Mechanism();

  const solver::Problem& problem() const { return compiled_->problem(); }
  int columnCount() const { return static_cast<int>(columns_.size()); }  ///< design variables: columns of cells along z
  /// Centre of a column in the plane [m].
  std::array<double, 2> centre(int column) const;
  /// Filled area in the plane [m2] and volume [m3] of each column of the whole mechanism.
  const Eigen::VectorXd& areas() const { return areas_; }
  const Eigen::VectorXd& volumes() const { return volumes_; }
  /// @param rho  one density per column, in [0, 1]
  void setDensities(const Eigen::VectorXd& rho);
  /// @param rho  (columns x 1) [1]
  mpm::DensityField field(const Eigen::VectorXd& rho) const;
  /// Values of the densities where the field has them; columns that it lacks keep `fallback`.
  Eigen::VectorXd columnsOf(const mpm::DensityField& field, double fallback) const;

  /// Force that holds the control, of the whole [N].
  double force(const solver::Evaluation& at) const { return compiled_->multiplicity() * at.control_force(0); }
  /// Factor from the problem's forces to those of the whole.
  double multiplicity() const { return compiled_->multiplicity(); }
  /// dR/drho per column at a converged point, R = force(at) [N]. @param system  factorized there
  /// @param slope  dz/dp of the path there
  Eigen::VectorXd forceByDensity(const solver::TangentSystem& system, const solver::Evaluation& at,
                                 const Eigen::VectorXd& slope) const;

  /// A value with its derivative by the densities, the equilibrium's own change included.
  struct Sensed {
    double value = 0;
    Eigen::VectorXd by_density;  ///< (columns x 1); empty if not asked for
  };
  /// True if the scene has a monitor of a rotation; the first such one is `rotation`.
  bool turns() const { return rotation_ >= 0; }
  /// Rotation at a converged point [rad], as the check measures it. @param system  null: value alone
  Sensed rotation(const solver::TangentSystem* system, const solver::Evaluation& at) const;
  /// Potential of the whole at a converged point [J], the integral of the force over the travel. Stationary in the free
  /// coordinates, so that its derivative needs no adjoint.
  Sensed potential(const solver::TangentSystem* system, const solver::Evaluation& at) const;

  /// Aggregated strain of the designed body, S = (sum_c s_c^P)^(1/P), s_c = sqrt(rho_c) max(0, stretch_c - 1), where
  /// stretch is the largest principal one at a cell's centre. S is never below the largest s_c.
  struct Strain : Sensed {
    double largest = 0;  ///< max s_c [1]
  };
  /// @param power  P >= 1; @param system  null: value alone
  Strain strain(double power, const solver::TangentSystem* system, const solver::Evaluation& at) const;

 private:
  template <int D>
  void build(const mpm::Discretisation<D>& solid, const scene::Scene& scene);
  template <int D>
  Strain strainOf(const mpm::Discretisation<D>& solid, double power, const solver::TangentSystem* system,
                  const solver::Evaluation& at) const;
  solver::Sensitivity sensitivity(const solver::TangentSystem& system, const solver::Evaluation& at) const {
    return {compiled_->terms(), system, at, compiled_->cellCount()};
  }
  Eigen::VectorXd sumColumns(const Eigen::VectorXd& by_cell) const;

  std::unique_ptr<scene::CompiledScene> compiled_;
  int body_, rotation_ = -1;  ///< of the monitors
  double cell_size_ = 0;
  std::array<int, 2> cells_{};
  std::vector<std::array<int, 2>> columns_;  ///< place of each
  std::vector<int> column_of_cell_;          ///< -1: another body's
  std::vector<double> cell_densities_;
  Eigen::VectorXd areas_, volumes_;
};

}  // namespace snapwing::design
