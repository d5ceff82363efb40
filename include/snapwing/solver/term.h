#pragma once
/// One energy of a problem, on full coordinates y: nodal displacements of the solids, then what rigid bodies add. There
/// bodies' energies are local, the mass is constant and joints are linear; `Coordinates` alone is curved.
///
/// A term is constant after it was built, may be used by several threads, and only ADDS to the sum that it is given.
/// Its Hessian is the derivative of its gradient; what cannot be so is held fixed during a solve.

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

namespace snapwing::solver {

using elasticity::Order;

/// What a term keeps of a step's start: a lagged matrix, internal variables.
struct Memory {
  virtual ~Memory() = default;
};

/// A step in time as the terms see it: constant during a solve, owned by the stepper.
struct Step {
  double h = 0;            ///< [s] > 0
  double kappa = 0;        ///< [1/s2] weight of the mass: 1/h^2 backward Euler, 2/h^2 midpoint
  Eigen::VectorXd y0, v0;  ///< at the start: full coordinates [m] and their rates [m/s]
  Eigen::VectorXd p0;      ///< controls at the start
  /// Stored energies count as sum w (E(y0 + s d) - E(y0)) / s over these (s, w), d = y - y0: (1/2, 1) is the midpoint
  /// rule, Gauss points conserve energy. Empty: at the end point.
  std::vector<std::pair<double, double>> path;
  /// What each term of the problem kept of the start, in their order; empty: no term keeps anything.
  std::vector<std::shared_ptr<const Memory>> kept{};
};

/// Where a term is evaluated; views, valid during the call.
struct Point {
  const Eigen::VectorXd& y;    ///< full coordinates [m]
  const Eigen::VectorXd& p;    ///< controls, each in its own unit
  const Step* step = nullptr;  ///< null in statics
  int threads = 1;
  const Memory* kept = nullptr;                  ///< of the step's start, by the term that is evaluated
  const Eigen::VectorXd* multipliers = nullptr;  ///< of constraints [N], for the term that they make; null: zeros
};

class Term;

/// Work space that terms add to.
struct Sum {
  double energy = 0;            ///< [J]
  double stored = 0;            ///< [J] of Role::STORED alone
  Eigen::VectorXd gradient;     ///< dE/dy [N], (full x 1)
  Eigen::VectorXd control;      ///< dE/dp at fixed y, (controls x 1)
  std::vector<double> hessian;  ///< d2E/dy2 [N/m] in the order of the layout
  double force = 0;             ///< [N] largest force before terms cancel, over the terms
  double rounding = 0;          ///< [N] what rounding of the coordinates leaves of a force, largest over the terms
  bool finite = true;           ///< false: some energy is infinite; the rest is not valid then
  double min_det_f = std::numeric_limits<double>::infinity();
  int min_det_f_cell = -1;                    ///< place of the term `worst`
  const Term* worst = nullptr;                ///< whose particle has the smallest det F
  std::vector<mpm::Assembly> solids;          ///< work space by region, with each solid's own gradient
  std::vector<int> region_place;              ///< of each region's first value in `hessian`
  const std::vector<int>* couples = nullptr;  ///< the same of the couples of the term that is evaluated

  /// Zeros, as far as the order needs them.
  void reset(const HessianLayout& layout, int controls, Order order);
  /// A term's largest force before terms cancel, and what rounding leaves of it [N].
  void noteForce(double newtons) { force = std::max(force, newtons); }
  void noteRounding(double newtons) { rounding = std::max(rounding, newtons); }
  /// Adds `value` times row row^T to a couple, `row` in the order of its coordinates.
  void addRankOne(int couple, double value, const Eigen::VectorXd& row);
};

class Term {
 public:
  enum class Role {
    STORED,       ///< elastic energies: averaged along a step's path
    LOAD,         ///< dead loads
    INERTIA,      ///< of a step
    DISSIPATION,  ///< of a step
    CONSTRAINT,   ///< equations that are kept, which the problem adds itself
  };
  virtual ~Term() = default;
  virtual std::string name() const = 0;
  virtual Role role() const = 0;
  /// Region of the layout whose node blocks it writes, -1: none.
  virtual int region() const { return -1; }
  /// Sets of full coordinates that it couples besides; constant. Default: none.
  virtual std::vector<std::vector<int>> couples() const { return {}; }
  /// Adds energy, and gradient and Hessian as far as the order asks for them.
  virtual void evaluate(const Point& at, Order order, Sum& sum) const = 0;
  /// Adds (d2E/dy dp) dp to by_y and (d2E/dp dy) dy + (d2E/dp2) dp to by_p. Default: no control in it.
  virtual void controlTangent(const Point& at, const Eigen::VectorXd& dy, const Eigen::VectorXd& dp,
                              Eigen::VectorXd& by_y, Eigen::VectorXd& by_p) const;
  /// What it keeps of a step's start, once a step: handed back as Point::kept. Null: nothing.
  virtual std::shared_ptr<const Memory> keep(const Point& start) const;
  /// Adds d(dE/dy . v)/d(density) of each cell, [N m] for v in m; dE/d(density) if v is null. Default: no density.
  virtual void densityDerivative(const Point& at, const Eigen::VectorXd* v, Eigen::VectorXd& by_cell) const;
  /// Words for a place, e.g. "cell 12 of body 0 at (...) m".
  virtual std::string describe(int place) const;
};

}  // namespace snapwing::solver
