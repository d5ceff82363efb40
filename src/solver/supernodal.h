#pragma once
/// Numbers of a supernodal Cholesky factor, without calls of BLAS (internal to the layer).
///
/// The fronts of a planar arm are some tens of rows: there a library's calls, its copies into tiles and its own regions
/// cost more than the arithmetic. Sums run over the columns in their order, without fused multiply-add, so that the
/// bits are the same on every processor of a kind, however wide its vectors are.

#include <cstddef>
#include <vector>

struct cholmod_factor_struct;

namespace snapwing::solver {

struct SparsePattern;
namespace supernodal {
struct Sweep;
}

class SupernodalFactor {
 public:
  /// @param analysis  CHOLMOD's supernodal analysis of `matrix`, in the natural order
  /// @param place     of each given value in the order of the matrix's pattern
  SupernodalFactor(const cholmod_factor_struct& analysis, const SparsePattern& matrix, const std::vector<int>& place);

  /// L L^T of the matrix. @param values  in the given order. @return false if a pivot is not positive
  bool factorize(const std::vector<double>& values);
  /// Right sides in, solutions out, one a column of the matrix's size; several share each sweep over L, and each has
  /// the bits that it would have alone.
  void solve(double* x, int count = 1) const;
  /// As solve() for a preconditioner: a large L is rounded to single precision, half of the memory to go through.
  void solveNear(double* x) const;

  /// Columns that are eliminated together, and the rows below them. A supernode is one or several.
  struct Panel {
    int first = 0, columns = 0;  ///< of the matrix
    int rows = 0;                ///< with those of the diagonal block
    int stride = 0;              ///< from column to column: whole vectors, filled up with zeros
    std::size_t at = 0;          ///< of its values, columns one after the other
    std::size_t row_at = 0;      ///< of its row numbers
    int below() const { return rows - columns; }
  };

 private:
  struct Value {
    int source;      ///< its number as it is given
    unsigned place;  ///< in its panel
  };
  /// What a panel takes from another one: its rows behind its diagonal block that are columns of that one.
  struct Update {
    int panel;             ///< the other one
    int begin, end;        ///< of these rows, counted from the diagonal block's end
    std::size_t relative;  ///< where the places of all rows from `begin` on, in the other one, are listed
  };
  void addPanels(int first, int end, const int* rows, int count);
  void addUpdates(const Panel& panel);
  void load(const std::vector<double>& values);
  bool eliminate(const Panel& panel);
  void update(int number);
  void round(const Panel& panel) const;
  supernodal::Sweep sweep() const;

  int size_ = 0;
  std::vector<Panel> panels_;
  std::vector<int> rows_;          ///< of all panels, ascending in each
  std::vector<int> panel_of_;      ///< of each column
  std::vector<Value> loads_;       ///< of the matrix, panel after panel
  std::vector<int> begin_;         ///< of each panel's values of the matrix
  std::vector<double> values_;     ///< of L, and room behind them that is read but not used
  std::vector<double> inverse_;    ///< 1 / diagonal of L
  std::vector<Update> updates_;    ///< of all panels
  std::vector<int> update_begin_;  ///< of each panel
  std::vector<int> relative_;      ///< a panel's rows in the panels that it is subtracted from
  mutable std::vector<double> work_;
  mutable std::vector<float> rounded_;  ///< values_ for solveNear(); empty before the first one
  mutable bool rounded_now_ = false;    ///< they are those of this factor
};

}  // namespace snapwing::solver
