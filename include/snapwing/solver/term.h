#pragma once
/// One energy of a problem, on full coordinates y: nodal displacements of the solids, then the coordinates of rigid
/// bodies. In y energies are local, the mass is constant and joints are linear. Only `Coordinates` is nonlinear.
///
/// A term is constant after construction and may be shared by threads. It only ADDS to the sum that it is given. Its
/// Hessian is the derivative of its gradient; quantities for which that would not hold are fixed during a solve.

#include <Eigen/Core>
#include <algorithm>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "snapwing/elasticity/constitutive_model.h"
#include "snapwing/mpm/discretisation.h"
#include "snapwing/solver/hessian_layout.h"
#include "snapwing/solver/residual_series.h"

namespace snapwing::solver {

using elasticity::Order;

/// Data that a term stores at a step's start: a lagged matrix, internal variables.
struct Memory {
  virtual ~Memory() = default;
};

/// A time step: constant during a solve, owned by the stepper.
struct Step {
  double h = 0;            ///< [s] > 0
  double kappa = 0;        ///< [1/s2] weight of the mass: 1/h^2 backward Euler, 2/h^2 midpoint
  Eigen::VectorXd y0, v0;  ///< at the start: full coordinates [m] and their rates [m/s], (full x 1)
  Eigen::VectorXd p0;      ///< controls at the start, (controls x 1)
  /// Stored energies are evaluated as sum w (E(y0 + s d) - E(y0)) / s over these (s, w), d = y - y0: (1/2, 1) is the
  /// midpoint rule, Gauss points conserve energy. Empty: at the end point.
  std::vector<std::pair<double, double>> path;
  /// Term::keep of each term, in the problem's order; empty: no term stores anything.
  std::vector<std::shared_ptr<const Memory>> kept{};
};

/// Where a term is evaluated; views, valid during the call.
struct Point {
  const Eigen::VectorXd& y;    ///< full coordinates [m]
  const Eigen::VectorXd& p;    ///< controls, each in its own unit
  const Step* step = nullptr;  ///< null in statics
  int threads = 1;
  const Memory* kept = nullptr;                  ///< what the evaluated term stored at the step's start
  const Eigen::VectorXd* multipliers = nullptr;  ///< of the constraints [N], for ConstraintTerm; null: zeros
};

class Term;

/// Work space that terms add to.
struct Sum {
  double energy = 0;            ///< [J]
  double stored = 0;            ///< [J] of Role::STORED only
  Eigen::VectorXd gradient;     ///< dE/dy [N], (full x 1)
  Eigen::VectorXd control;      ///< dE/dp at fixed y [J per unit of the control], (controls x 1)
  std::vector<double> hessian;  ///< d2E/dy2 [N/m] in the order of the layout
  double force = 0;             ///< [N] largest force before terms cancel, over the terms
  double rounding = 0;          ///< [N] error of a force by rounding of the coordinates, largest over the terms
  bool finite = true;           ///< false: some energy is infinite (inverted element); the rest is then not valid
  double min_det_f = std::numeric_limits<double>::infinity();
  int min_det_f_cell = -1;                    ///< number of the cell in the term `worst`
  const Term* worst = nullptr;                ///< the term with the smallest det F
  std::vector<mpm::Assembly> solids;          ///< work space by region, with each solid's own gradient
  std::vector<int> region_place;              ///< index of each region's first value in `hessian`
  const std::vector<int>* couples = nullptr;  ///< likewise of each couple of the evaluated term

  /// Sets to zero what an evaluation of this order fills.
  void reset(const HessianLayout& layout, int controls, Order order);
  /// Reports a term's largest force before terms cancel, and its rounding error [N].
  void noteForce(double newtons) { force = std::max(force, newtons); }
  void noteRounding(double newtons) { rounding = std::max(rounding, newtons); }
  /// Adds value * row row^T to the Hessian of the evaluated term's couple number `couple`.
  /// @param value  [N/m]; @param row  [1], in the order of the couple's coordinates
  void addRankOne(int couple, double value, const Eigen::VectorXd& row);
};

class Term {
 public:
  enum class Role {
    STORED,       ///< elastic energies: averaged along a step's path
    LOAD,         ///< external loads
    INERTIA,      ///< of a step
    DISSIPATION,  ///< of a step
    CONSTRAINT,   ///< kept constraints; added by TermProblem itself
  };
  virtual ~Term() = default;
  virtual std::string name() const = 0;
  virtual Role role() const = 0;
  /// Region of the layout whose node blocks the term writes; -1: none.
  virtual int region() const { return -1; }
  /// Further sets of full coordinates that the term couples; constant. Default: none.
  virtual std::vector<std::vector<int>> couples() const { return {}; }
  /// Adds energy [J], and by `order` gradient [N] and Hessian [N/m], to `sum`.
  virtual void evaluate(const Point& at, Order order, Sum& sum) const = 0;
  /// Adds (d2E/dy dp) dp to by_y [N] and (d2E/dp dy) dy + (d2E/dp2) dp to by_p [J per unit of the control].
  /// Default: the term depends on no control. @param dy  (full x 1) [m]; @param dp  (controls x 1)
  virtual void controlTangent(const Point& at, const Eigen::VectorXd& dy, const Eigen::VectorXd& dp,
                              Eigen::VectorXd& by_y, Eigen::VectorXd& by_p) const;
  /// Whether dE/dy is affine in y and p in statics: its power series have no remainders. Default: what acts in motion
  /// alone.
  virtual bool linearInStatics() const { return role() == Role::INERTIA || role() == Role::DISSIPATION; }
  /// Power series of dE/dy in statics, up to an order. Null: none, or not needed.
  virtual std::unique_ptr<ForceSeries> series(int order) const;
  /// Data to store at a step's start, called once per step and returned as Point::kept. Null: nothing.
  virtual std::shared_ptr<const Memory> keep(const Point& start) const;
  /// Adds d(dE/dy . v)/d(density) of each cell [J], or dE/d(density) if v is null. Default: the term has no density.
  /// @param v  (full x 1) [m]; @param by_cell  (cells x 1)
  virtual void densityDerivative(const Point& at, const Eigen::VectorXd* v, Eigen::VectorXd& by_cell) const;
  /// Text for messages, e.g. "cell 12 of body 0 at (...) m". @param place  number of a cell
  virtual std::string describe(int place) const;
};

}  // namespace snapwing::solver
