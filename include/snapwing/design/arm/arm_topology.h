#pragma once
/// The bistable arm as an optimisation problem in the densities of the columns of its domain.
///
///   min   mean_v [ R_v(u_valley) - R_v(u_peak) ] / f1 + alpha f |u3|    or, in place of R_v(u_valley), the mean of R_v
///                                                                       over a range a..b: [E_v(b) - E_v(a)] / (b - a)
///   s.t.  R_v(u) <= f1 at the peak travels,  R_v(u) >= -f2 at the valley travels,
///         (R_v(u_i) - R_v(u_i+1)) / (u_i+1 - u_i) <= s for neighbours of the slope travels,
///         low <= rotation_v(u) <= high at the rotation travels,
///         strain_v(u) <= limit at the strain travels,   volume <= V(k),   mass <= limit
/// for every projection threshold v (eroded, intermediate, dilated); R is the force of one arm at driven travel u, u3
/// the travel under the force -f, E the potential. The barrier on the way back is the largest fall of E: never less
/// than the one over the range. Derivatives by the adjoint method, solver/sensitivity.h; R(u3) = -f gives du3/drho =
/// -(dR/drho) / (dR/du).

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "snapwing/design/arm/arm_settings.h"
#include "snapwing/design/arm/mechanism.h"
#include "snapwing/design/optim/optimizer.h"
#include "snapwing/design/optim/parametrization.h"

namespace snapwing::design {

class ArmTopology : public OptimizationProblem {
 public:
  /// @param stage  number of the stage whose discretisation is used, and from whose first iteration the continuation of
  ///               volume and sharpness continues
  /// @param newton_tolerance  relative, of each equilibrium
  explicit ArmTopology(const ArmDesignSettings& settings, int stage = 0, double newton_tolerance = 1e-7);
  ~ArmTopology() override;

  int variableCount() const override { return count_; }
  int constraintCount() const override;
  Eigen::VectorXd lower() const override { return Eigen::VectorXd::Zero(count_); }
  Eigen::VectorXd upper() const override { return Eigen::VectorXd::Ones(count_); }
  Evaluated evaluate(const Eigen::VectorXd& x, bool with_derivatives) override;
  void beginIteration(int k, int total) override;
  /// Design variables to start from, (variables x 1) [1].
  Eigen::VectorXd start() const { return Eigen::VectorXd::Constant(count_, settings_.start_density); }
  /// What each constraint bounds, e.g. "R(0.010 m) <= 0.97 N, threshold 0.50".
  std::vector<std::string> constraintNames() const;

  /// Variables as a field on the stage's cells, and back from any stage's: copied to finer cells, averaged to coarser.
  mpm::DensityField variables(const Eigen::VectorXd& x) const;
  Eigen::VectorXd variablesFrom(const mpm::DensityField& field) const;
  /// Projected density of a threshold's variant (0 is the nominal one).
  Eigen::VectorXd density(const Eigen::VectorXd& x, int variant = 0) const;
  mpm::DensityField field(const Eigen::VectorXd& x, int variant = 0) const;
  const std::vector<double>& travels() const { return travels_; }  ///< of the equilibria [m]
  /// Forces of the nominal variant at travels() at the last evaluation [N], volume share, mass of one arm [kg].
  const std::vector<double>& lastForces() const { return last_forces_; }
  double lastVolume() const { return last_volume_; }
  double lastMass() const { return last_mass_; }
  double lastGrey() const { return last_grey_; }        ///< as design::greyLevel [1]
  double sharpness() const { return sharpness_; }       ///< of the projection [1]
  double volumeBound() const { return volume_bound_; }  ///< share of the domain [1]
  int freedomCount() const;                             ///< free coordinates of one equilibrium
  /// How often a variant was traced again from rest, and equilibria solved by Newton iterations, so far.
  int retraces() const;
  long newtonIterations() const;
  /// Seconds so far, summed over the threads: of the states' Newton iterations, of derivatives at equilibria (with the
  /// factor that they need), and of tracing from rest. Assembly, factors and solves are parts of the first two.
  struct Seconds {
    double assembly = 0, factor = 0, solve = 0, derivatives = 0, retraces = 0;
  };
  Seconds seconds() const;

  /// Equilibria that the next evaluation starts from; with them a run resumes bit for bit.
  std::map<std::string, Eigen::VectorXd> warmStates() const;
  void restoreWarmStates(const std::map<std::string, Eigen::VectorXd>& arrays);

 private:
  struct State;
  struct Worker;
  struct Variant;
  struct Bound;
  void makeVariants();
  void makeBounds();
  void makeLanes(Variant& variant) const;
  bool solveVariants(bool with_derivatives, std::string& why);
  void beginVariant(Variant& variant) const;
  bool solveStates(Variant& variant, Worker& worker, bool with_derivatives) const;
  bool solveState(const Variant& variant, Worker& worker, State& state, bool with_derivatives) const;
  bool solvePulled(Variant& variant, Worker& worker) const;
  void sense(const Variant& variant, State& state, const solver::TangentSystem* system,
             const solver::Evaluation& at) const;
  Mechanism::Sensed valleyForce(const Variant& variant, bool with_derivatives) const;
  bool tracePulled(Variant& variant, std::string& why) const;
  bool retrace(Variant& variant) const;
  void addVariant(const Eigen::VectorXd& x, const Variant& variant, int& row, bool with_derivatives,
                  Evaluated& out) const;
  void addSize(const Eigen::VectorXd& x, int row, bool with_derivatives, Evaluated& out);
  int indexOf(double travel) const;
  void buildMaps();

  ArmDesignSettings settings_;
  int stage_;
  double newton_tolerance_;
  int count_ = 0;
  double mass_density_ = 0;
  std::vector<double> travels_;
  std::vector<Bound> bounds_;  ///< of each variant, in the order of their rows
  std::shared_ptr<const DensityFilter> filter_;
  std::shared_ptr<const Patches> patches_;
  std::vector<std::unique_ptr<Variant>> variants_;
  double sharpness_ = 1, volume_bound_ = 1;
  bool retrace_wanted_ = true, restored_ = false;
  std::vector<double> last_forces_;
  double last_volume_ = 0, last_mass_ = 0, last_grey_ = 0;
};

}  // namespace snapwing::design
