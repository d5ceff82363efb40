#pragma once
/// The bistable arm as an optimisation problem in the densities of the cells of its L-shaped domain.
///
///   min   mean_v [ R_v(u_valley) - R_v(u_peak) ] / f1 + alpha f |u3|
///   s.t.  R_v(u) <= f1 at the peak travels,  R_v(u) >= -f2 at the valley travels,
///         (R_v(u_i) - R_v(u_i+1)) / (u_i+1 - u_i) <= s for neighbours of the slope travels,   volume <= V(k)
/// for every projection threshold v (eroded, intermediate, dilated); R is the force of one arm at driven travel u, u3
/// the travel under the force -f. Derivatives by the adjoint method, statics/sensitivity.h; R(u3) = -f gives
/// du3/drho = -(dR/drho) / (dR/du).

#include <memory>
#include <vector>

#include "snapwing/design/arm_settings.h"
#include "snapwing/design/optimizer.h"
#include "snapwing/design/parametrization.h"
#include "snapwing/mpm/density_field.h"
#include "snapwing/statics/arm_problem.h"

namespace snapwing::design {

/// The L-shaped domain of a vehicle's arm, filled with one density. @throws common::Error if cells do not fit
mpm::DensityField armDomain(const common::ArmSettings& arm, double cell_size, double density);

class ArmTopology : public OptimizationProblem {
 public:
  /// @param newton_tolerance  relative, of each equilibrium
  explicit ArmTopology(const ArmDesignSettings& settings, double newton_tolerance = 1e-8);
  ~ArmTopology() override;

  int variableCount() const override { return count_; }
  int constraintCount() const override;
  Eigen::VectorXd lower() const override { return Eigen::VectorXd::Zero(count_); }
  Eigen::VectorXd upper() const override { return Eigen::VectorXd::Ones(count_); }
  Evaluated evaluate(const Eigen::VectorXd& x, bool with_derivatives) override;
  void beginIteration(int k, int total) override;
  Eigen::VectorXd start() const { return Eigen::VectorXd::Constant(count_, settings_.start_density); }

  /// Projected density of a threshold's variant (0 is the nominal one).
  Eigen::VectorXd density(const Eigen::VectorXd& x, int variant = 0) const;
  mpm::DensityField field(const Eigen::VectorXd& x, int variant = 0) const;
  const std::vector<double>& travels() const { return travels_; }
  /// Forces of the nominal variant at travels() at the last evaluation [N], volume share, travel u3 [m].
  const std::vector<double>& lastForces() const { return last_forces_; }
  double lastVolume() const { return last_volume_; }
  double lastGrey() const { return last_grey_; }
  double sharpness() const { return sharpness_; }
  double volumeBound() const { return volume_bound_; }
  /// How often a state had to be traced anew from rest.
  int retraces() const { return retraces_; }

 private:
  struct State;
  struct Variant;
  bool solveVariant(Variant& variant, bool with_derivatives, std::string& why);
  bool solveState(State& state, bool with_derivatives, std::string& why);
  bool solvePulled(Variant& variant, std::string& why);
  bool tracePulled(Variant& variant, std::string& why);
  bool retrace(Variant& variant, std::string& why);
  void addVariant(const Eigen::VectorXd& x, const Variant& variant, int& row, bool with_derivatives,
                  Evaluated& out) const;
  int indexOf(double travel) const;
  void buildMaps();

  ArmDesignSettings settings_;
  double newton_tolerance_;
  std::unique_ptr<statics::ArmProblem> arm_;
  std::unique_ptr<statics::Newton> newton_;
  int count_ = 0;
  std::vector<double> travels_;
  std::shared_ptr<const DensityFilter> filter_;
  std::shared_ptr<const Patches> patches_;
  std::vector<Variant> variants_;
  double sharpness_ = 1, volume_bound_ = 1;
  bool retrace_wanted_ = true;
  int retraces_ = 0;
  std::vector<double> last_forces_;
  double last_volume_ = 0, last_grey_ = 0;
};

}  // namespace snapwing::design
