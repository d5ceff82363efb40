#pragma once
/// Bodies on background grids as one vector of nodal displacements: elastic energy, its gradient and its Hessian.
///
///   E(u) = sum_cells m_c sum_particles w_p W(F_p, rho_c),   F_p = I + sum_a u_a (grad N_a)^T
///
/// Discretisation is constant after setup and may be shared by threads; Assembly is the mutable part. Sums run in a
/// fixed order (cells of one colour share no node), so results have the same bits for any number of threads.

#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "snapwing/elasticity/constitutive_model.h"
#include "snapwing/mpm/block_matrix.h"
#include "snapwing/mpm/grid.h"

namespace snapwing::mpm {

/// One integral over a cell: particles and the law (or part of a law) that they carry.
struct Term {
  int rule = 0;
  int model = 0;
};

struct Cell {
  int kind = 0;        ///< which list of terms
  double density = 1;  ///< rho in [0, 1]
  double measure = 0;  ///< h^D, times the thickness if planar [m3]
};

/// Values of one evaluation. Energy and gradient and blocks are only valid as far as the order asked for.
struct Assembly {
  double energy = 0;           ///< [J]
  Eigen::VectorXd gradient;    ///< dE/du [N], D per node
  std::vector<double> blocks;  ///< d2E/du2 [N/m] in the order of the pattern
  bool add_blocks = false;     ///< the blocks are added to what is there; more may stand behind them
  double force_scale = 0;      ///< [N] 2-norm of the cells' nodal forces before they cancel
  double min_det_f = std::numeric_limits<double>::infinity();  ///< over all particles
  int min_det_f_cell = -1;
  bool finite = false;  ///< false: det F <= 0 at some particle, or NaN
};

template <int D>
class Discretisation {
 public:
  using Model = elasticity::ConstitutiveModel<D>;

  int addModel(std::shared_ptr<const Model> model);
  int addRule(QuadratureRule<D> rule);
  int addKind(std::vector<Term> terms);
  /// Starts a body on its own grid. Nodes are numbered as cells need them: nothing is stored for empty space.
  int addBody(const Grid<D>& grid);
  /// Adds a cell of the last body; the order of cells in a body is free. @return cell number
  int addCell(const Index<D>& at, const Cell& cell);
  /// Builds pattern and colours; nothing may be added afterwards.
  void finish();

  int nodeCount() const { return static_cast<int>(position_.size()); }
  int dofCount() const { return D * nodeCount(); }
  int cellCount() const { return static_cast<int>(cells_.size()); }
  int bodyCount() const { return static_cast<int>(grids_.size()); }
  const Cell& cell(int number) const { return cells_[number]; }
  const Index<D>& cellAt(int number) const { return cell_at_[number]; }
  int cellBody(int number) const { return cell_body_[number]; }
  const int* cellNodes(int number) const { return nodes_.data() + static_cast<std::size_t>(number) * stencil_; }
  int stencil() const { return stencil_; }
  const Grid<D>& grid(int body) const { return grids_[body]; }
  const std::vector<Term>& terms(int kind) const { return kinds_[kind]; }
  const QuadratureRule<D>& rule(int number) const { return rules_[number]; }
  const Model& model(int number) const { return *models_[number]; }
  /// Rest position of a node [m].
  const Vector<D>& position(int node) const { return position_[node]; }
  int nodeBody(int node) const { return node_body_[node]; }
  const BlockPattern<D>& pattern() const { return pattern_; }
  /// New densities, one per cell, in [0, 1]. @throws common::Error
  void setDensities(const std::vector<double>& densities);

  /// Weights (node, weight) of the displacement at a point of a body; empty if no cell holds it.
  std::vector<std::pair<int, double>> interpolate(int body, const Vector<D>& point) const;
  /// Displacement [m] at a point [m] of a body.
  Vector<D> displacementAt(int body, const Vector<D>& point, const Eigen::VectorXd& u) const;
  /// Node of a body at a number of its grid, or -1 where no cell needs it.
  int findNode(int body, int grid_node) const { return node_of_grid_[body][grid_node]; }
  /// Cell of a body at a grid index, or -1.
  int findCell(int body, const Index<D>& at) const;

  /// @param u        nodal displacements [m], (dofCount x 1), x0 y0 (z0) x1 ...
  /// @param threads  >= 1
  void assemble(const Eigen::VectorXd& u, elasticity::Order order, int threads, Assembly& out) const;

  /// sum over particles of m w (d2E/(drho_c du) . v): derivative by each cell's density of dE/du . v, and of E itself
  /// if v is empty. (cellCount x 1), [N m] for v in m.
  Eigen::VectorXd densityDerivative(const Eigen::VectorXd& u, const Eigen::VectorXd& v) const;

  /// Deformation gradient at the centre of a cell.
  elasticity::Matrix<D> deformationGradient(int cell, const Eigen::VectorXd& u) const;
  /// Largest of sqrt(rho) (s - 1) over the cells, s the largest principal stretch at a cell's centre and rho its
  /// density, so that what is nearly empty does not count: the strain that the arm's design limits. Never negative.
  double largestStrain(const Eigen::VectorXd& u) const;

 private:
  struct Scratch;
  struct CellResult;
  /// Sums over a rule's particles that do not depend on the displacements.
  struct RuleTable {
    std::vector<double> laplace;  ///< [a][b]: sum w Ga.Gb
    std::vector<double> outer;    ///< [a][i D + k][b]: sum w Ga_i Gb_k; empty if no cell needs it
  };
  void numberNodes();
  void colourCells();
  void prepareCells();
  void buildTable(int rule, bool outer);
  template <int S>
  void assembleCells(const Eigen::VectorXd& u, elasticity::Order order, int threads, Assembly& out) const;
  template <int S>
  CellResult evaluateCell(int cell, const Eigen::VectorXd& u, elasticity::Order order, Scratch& scratch) const;
  template <int S>
  double cellDensityDerivative(int cell, const Eigen::VectorXd& u, const Eigen::VectorXd& v) const;
  template <int S>
  void scatter(int cell, elasticity::Order order, const Scratch& scratch, Assembly& out) const;

  std::vector<std::shared_ptr<const Model>> models_;
  std::vector<QuadratureRule<D>> rules_;
  std::vector<std::vector<Term>> kinds_;
  std::vector<Grid<D>> grids_;
  std::vector<std::vector<int>> node_of_grid_;  ///< per body: grid node -> node or -1
  std::vector<std::vector<int>> cell_of_grid_;  ///< per body: grid cell -> cell or -1
  std::vector<RuleTable> tables_;
  std::vector<Cell> cells_;
  std::vector<elasticity::DensityInterpolation::Value> prepared_;  ///< cells x most_terms_
  int most_terms_ = 1;
  std::vector<Index<D>> cell_at_;
  std::vector<int> cell_body_;
  std::vector<int> nodes_;  ///< cells x stencil
  int stencil_ = 0;
  std::vector<Vector<D>> position_;
  std::vector<int> node_body_;
  BlockPattern<D> pattern_;
  std::vector<int> block_of_pair_;  ///< cells x stencil (stencil + 1) / 2: block of local nodes a >= b
  std::vector<std::vector<int>> colours_;
};

}  // namespace snapwing::mpm
