#pragma once
/// Solids on background grids: elastic energy, gradient and Hessian as functions of all nodal displacements.
///
///   E(u) = sum_cells m_c sum_particles w_p W(F_p, rho_c),   F_p = I + sum_a u_a (grad N_a)^T
///
/// m_c: Cell::measure, w_p: QuadratureRule::weight. A Discretisation is constant after finish(), except setDensities(),
/// and may be shared by threads; Assembly is the mutable part. Sums run in a fixed order (cells of one colour share no
/// node), so that results have the same bits for any number of threads.

#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "snapwing/elasticity/constitutive_model.h"
#include "snapwing/mpm/block_matrix.h"
#include "snapwing/mpm/grid.h"

namespace snapwing::mpm {

/// One integral over a cell: a quadrature rule and the law (or part of a law) at its particles.
struct Term {
  int rule = 0;   ///< of addRule()
  int model = 0;  ///< of addModel()
};

struct Cell {
  int kind = 0;        ///< list of terms, of addKind()
  double density = 1;  ///< rho in [0, 1]
  double measure = 0;  ///< h^D, times the thickness if planar [m3]
};

/// Result of one evaluation. Gradient and blocks are valid only if the order includes them.
struct Assembly {
  double energy = 0;           ///< [J]
  Eigen::VectorXd gradient;    ///< dE/du [N], (dofCount x 1)
  std::vector<double> blocks;  ///< d2E/du2 [N/m] in the order of the pattern
  bool add_blocks = false;     ///< adds the blocks to the existing values; the vector may be longer
  double force_scale = 0;      ///< [N] 2-norm of the cells' nodal forces before they cancel
  double min_det_f = std::numeric_limits<double>::infinity();  ///< smallest over all particles [1]
  int min_det_f_cell = -1;                                     ///< its cell
  bool finite = false;                                         ///< false: det F <= 0 at some particle, or NaN
};

template <int D>
class Discretisation {
 public:
  using Model = elasticity::ConstitutiveModel<D>;

  /// Setup. Each returns the number of the added object.
  int addModel(std::shared_ptr<const Model> model);
  /// @throws common::Error for another kernel than that of earlier rules
  int addRule(QuadratureRule<D> rule);
  int addKind(std::vector<Term> terms);
  /// Starts a body on its own grid. Only nodes of cells are stored, not those of empty space.
  /// @throws common::Error for a grid without cells
  int addBody(const Grid<D>& grid);
  /// Adds a cell of the last body, in any order. @param at  index in the body's grid
  int addCell(const Index<D>& at, const Cell& cell);
  /// Builds pattern and colours; nothing may be added afterwards. @throws common::Error if there is no cell
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
  /// Sets the densities, one per cell, in [0, 1]. @throws common::Error for a wrong count or value
  void setDensities(const std::vector<double>& densities);

  /// Interpolation of the displacement at a point [m] of a body: (node, weight [1]); empty if no cell contains it.
  std::vector<std::pair<int, double>> interpolate(int body, const Vector<D>& point) const;
  /// Displacement [m] at a point [m] of a body; zero if no cell contains it.
  Vector<D> displacementAt(int body, const Vector<D>& point, const Eigen::VectorXd& u) const;
  /// Node at a node number of the body's grid, or -1 if no cell has it.
  int findNode(int body, int grid_node) const { return node_of_grid_[body][grid_node]; }
  /// Cell of a body at a grid index, or -1.
  int findCell(int body, const Index<D>& at) const;

  /// Evaluates energy, gradient and Hessian.
  /// @param u        nodal displacements [m], at least (dofCount x 1), x0 y0 (z0) x1 ...
  /// @param threads  >= 1
  void assemble(const Eigen::VectorXd& u, elasticity::Order order, int threads, Assembly& out) const;

  /// Derivative of dE/du . v with respect to each cell's density, or of E if v is empty. (cellCount x 1) [J]
  /// @param u, v  [m], (dofCount x 1)
  Eigen::VectorXd densityDerivative(const Eigen::VectorXd& u, const Eigen::VectorXd& v) const;

  /// Deformation gradient at the centre of a cell [1].
  elasticity::Matrix<D> deformationGradient(int cell, const Eigen::VectorXd& u) const;
  /// Rotation of the solid at each node: orthogonal part of the mean deformation gradient of its cells, weighed by
  /// their densities; I where that gradient has no positive determinant. @param u  [m], (dofCount x 1)
  std::vector<elasticity::Matrix<D>> nodeRotations(const Eigen::VectorXd& u) const;

 private:
  struct Scratch;
  struct LaneScratch;
  struct CellResult;
  /// Cells of one colour and kind, all linear or none, worked on side by side; the last one fills what is left.
  struct Batch {
    int cells[elasticity::LANES];
    int count;
    bool linear;
  };
  /// Sums over a rule's particles that do not depend on the displacements.
  struct RuleTable {
    std::vector<double> laplace;  ///< [a][b]: sum w Ga.Gb
    std::vector<double> outer;    ///< [a][i D + k][b]: sum w Ga_i Gb_k; empty if no cell needs it
  };
  void numberNodes();
  void colourCells();
  void dealCells();
  std::vector<Batch> dealColour(const std::vector<int>& cells) const;
  bool inLanes(int kind, elasticity::Order order) const;
  void prepareCells();
  void buildTable(int rule, bool outer);
  bool linearCell(int cell) const;
  std::vector<double> linearHessian(int kind) const;
  void prepareLinearCells();
  void startBlocks(Assembly& out) const;
  template <int S>
  void assembleCells(const Eigen::VectorXd& u, elasticity::Order order, int threads, Assembly& out) const;
  template <int S>
  CellResult evaluateCell(int cell, const Eigen::VectorXd& u, elasticity::Order order, Scratch& scratch) const;
  template <int S>
  void evaluateBatch(const Batch& batch, const Eigen::VectorXd& u, elasticity::Order order, LaneScratch& scratch,
                     CellResult* results) const;
  template <int S>
  void evaluateLinear(const Batch& batch, const Eigen::VectorXd& u, LaneScratch& scratch, CellResult* results) const;
  template <int S>
  void addShared(const Batch& batch, int term, LaneScratch& scratch) const;
  template <int S>
  void scatterBatch(const Batch& batch, elasticity::Order order, const LaneScratch& scratch, const CellResult* results,
                    Assembly& out) const;
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
  std::vector<int> block_of_pair_;           ///< cells x stencil (stencil + 1) / 2: block of local nodes a >= b
  std::vector<std::vector<int>> colours_;    ///< the cells of each
  std::vector<std::vector<Batch>> batches_;  ///< per colour
  std::vector<std::vector<double>> linear_;  ///< per kind: of linearHessian(), if it has linear cells
  std::vector<double> linear_blocks_;        ///< Hessian of all linear cells; empty if there is none
};

}  // namespace snapwing::mpm
