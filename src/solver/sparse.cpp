#include "snapwing/solver/sparse.h"

#include <cholmod.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <mutex>

#include "serial_regions.h"
#include "snapwing/common/error.h"
#include "supernodal.h"

// OpenBLAS's own entry point; its header clashes with others, so that only this one function is declared.
extern "C" void openblas_set_num_threads(int count);

namespace snapwing::solver {

double secondsNow() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

namespace {

/// What one column below the diagonal adds to a product with x, and its mirror.
void multiplyColumn(const SparsePattern& pattern, int column, const double* values, const double* x, double* y) {
  const int* row = pattern.row.data();
  const double own = x[column];
  const int end = pattern.start[column + 1];
  int k = pattern.start[column];
  double sum = values[k] * own;  // the diagonal comes first
  // In pairs: neighbours have two coordinates each or more.
  for (++k; k + 1 < end; k += 2) {
    const int one = row[k], other = row[k + 1];
    const double a = values[k], b = values[k + 1];
    sum += a * x[one] + b * x[other];
    y[one] += a * own;
    y[other] += b * own;
  }
  if (k < end) {
    y[row[k]] += values[k] * own;
    sum += values[k] * x[row[k]];
  }
  y[column] += sum;
}

/// Whether a column and its neighbour have the same rows below both diagonals, as those of one node have.
bool twins(const SparsePattern& pattern, int column) {
  const int* start = pattern.start.data() + column;
  const int *rows = pattern.row.data() + start[0] + 1, *others = pattern.row.data() + start[1] + 1;
  const int count = start[2] - start[1] - 1;
  if (start[1] - start[0] != count + 2 || rows[0] != column + 1) return false;
  int different = 0;
  for (int k = 0; k < count; ++k) different |= rows[k + 1] ^ others[k];
  return different == 0;
}

/// A column and its twin at once, so that rows, x and y are read once for both. Each sum keeps the order, and the
/// pairs, of multiplyColumn().
void multiplyTwins(const SparsePattern& pattern, int column, const double* values, const double* x, double* y) {
  const int first = pattern.start[column], second = pattern.start[column + 1];
  const int count = pattern.start[column + 2] - second - 1;
  const int* row = pattern.row.data() + second + 1;
  const double *a = values + first + 2, *b = values + second + 1;
  const double own = x[column], next = x[column + 1];
  double sum = values[first] * own, twin_sum = values[second] * next;
  double waiting = values[first + 1] * next;  // half of a pair, which the twin has not
  y[column + 1] += values[first + 1] * own;
  int k = 0;
  for (; k + 1 < count; k += 2) {
    const int one = row[k], other = row[k + 1];
    sum += waiting + a[k] * x[one];
    waiting = a[k + 1] * x[other];
    twin_sum += b[k] * x[one] + b[k + 1] * x[other];
    y[one] = (y[one] + a[k] * own) + b[k] * next;
    y[other] = (y[other] + a[k + 1] * own) + b[k + 1] * next;
  }
  if (k < count) {
    const int last = row[k];
    waiting += a[k] * x[last];
    twin_sum += b[k] * x[last];
    y[last] = (y[last] + a[k] * own) + b[k] * next;
  }
  y[column] += sum + waiting;
  y[column + 1] += twin_sum;
}

}  // namespace

Eigen::VectorXd SparsePattern::multiply(const std::vector<double>& values, const Eigen::VectorXd& x) const {
  Eigen::VectorXd y = Eigen::VectorXd::Zero(size);
  for (int column = 0; column < size; ++column) {
    if (column + 1 < size && twins(*this, column)) {
      multiplyTwins(*this, column++, values.data(), x.data(), y.data());
    } else {
      multiplyColumn(*this, column, values.data(), x.data(), y.data());
    }
  }
  return y;
}

namespace {

/// Up to so many operations the own factor is the faster one, CHOLMOD's with BLAS beyond [1].
constexpr double OWN_UP_TO = 8e9;

/// Shares of zeros that a supernode of so many columns may hold. The own factor, whose panels cost no calls, wants few;
/// CHOLMOD more than its own choice.
void mergeSupernodes(cholmod_common& common, bool own) {
  constexpr std::size_t COLUMNS[2][3] = {{16, 48, 96}, {4, 16, 48}};
  constexpr double ZEROS[2][3] = {{0.8, 0.2, 0.1}, {0.3, 0.1, 0.05}};
  std::copy_n(COLUMNS[own ? 1 : 0], 3, common.nrelax);
  std::copy_n(ZEROS[own ? 1 : 0], 3, common.zrelax);
}

}  // namespace

/// Holds the matrix in the order of elimination: CHOLMOD would otherwise transpose it twice for each factor.
struct Cholesky::Impl {
  cholmod_common common;
  cholmod_sparse matrix;
  SparsePattern pattern;   ///< permuted
  std::vector<int> place;  ///< of each value of the caller's pattern
  std::vector<int> order;  ///< caller's row of each permuted row
  std::vector<double> permuted;
  cholmod_factor* factor = nullptr;
  std::unique_ptr<SupernodalFactor> own;  ///< holds the numbers in place of `factor` where fronts are small
  cholmod_factor* indefinite = nullptr;
  cholmod_factor* active = nullptr;
  // Work space that CHOLMOD keeps between solves.
  mutable cholmod_dense *solution = nullptr, *work_y = nullptr, *work_e = nullptr;

  cholmod_factor* analyse(int supernodal) {
    common.supernodal = supernodal;
    cholmod_factor* result = cholmod_analyze(&matrix, &common);
    if (result == nullptr)
      throw common::Error("sparse analysis failed (CHOLMOD status " + std::to_string(common.status) + ")");
    return result;
  }
  void setPattern() {
    std::memset(&matrix, 0, sizeof(matrix));
    matrix.nrow = matrix.ncol = pattern.size;
    matrix.nzmax = pattern.row.size();
    matrix.p = pattern.start.data();
    matrix.i = pattern.row.data();
    matrix.x = permuted.data();
    matrix.stype = -1;
    matrix.itype = CHOLMOD_INT;
    matrix.xtype = CHOLMOD_REAL;
    matrix.dtype = CHOLMOD_DOUBLE;
    matrix.sorted = 1;
    matrix.packed = 1;
  }
  void setValues(const std::vector<double>& values) {
    for (std::size_t k = 0; k < values.size(); ++k) permuted[place[k]] = values[k];
  }
  bool factorize(const std::vector<double>& values) {
    if (own) return own->factorize(values);
    setValues(values);
    cholmod_factorize(&matrix, factor, &common);
    return common.status == CHOLMOD_OK && factor->minor == factor->n;
  }
  bool findOrder();
  void permute();
  template <class Sweep>
  Eigen::VectorXd solveOwn(const Eigen::VectorXd& right, const Sweep& sweep) const;
  Eigen::MatrixXd inOrder(const Eigen::MatrixXd& given) const;    ///< rows in the order of elimination
  Eigen::MatrixXd asGiven(const Eigen::MatrixXd& ordered) const;  ///< and back
};

/// Finds the fill-reducing order. Most matrices have the pattern of the one before (a curve's, its features', those of
/// a design's equilibria), whose order is kept.
/// @return true if fronts are small enough for the own factor
bool Cholesky::Impl::findOrder() {
  // METIS, which finds the separators, draws from the C library's one random sequence, seeded at each start: two
  // orderings at once would share it, and the order of elimination, so the last digits, would hang on the threads'
  // timing.
  static std::mutex ordering;
  static SparsePattern last;
  static std::vector<int> last_order;
  static bool last_own = false;
  const std::lock_guard<std::mutex> alone(ordering);
  if (last.size != pattern.size || last.start != pattern.start || last.row != pattern.row) {
    factor = analyse(CHOLMOD_SIMPLICIAL);
    last = pattern;
    last_order.assign(static_cast<const int*>(factor->Perm), static_cast<const int*>(factor->Perm) + pattern.size);
    last_own = common.fl < OWN_UP_TO;
    cholmod_free_factor(&factor, &common);
  }
  order = last_order;
  return last_own;
}

namespace {

struct Entry {
  int column, row, source;
};

/// In the order of a number below n; entries with the same one keep theirs.
std::vector<Entry> sortedBy(int Entry::*number, int n, const std::vector<Entry>& list) {
  std::vector<int> next(n + 1, 0);
  for (const Entry& entry : list) ++next[entry.*number + 1];
  for (int k = 0; k < n; ++k) next[k + 1] += next[k];
  std::vector<Entry> sorted(list.size());
  for (const Entry& entry : list) sorted[next[entry.*number]++] = entry;
  return sorted;
}

}  // namespace

/// Makes the fill-reducing order the matrix's own.
void Cholesky::Impl::permute() {
  const int n = pattern.size;
  std::vector<int> rank(n);
  for (int k = 0; k < n; ++k) rank[order[k]] = k;
  std::vector<Entry> list;
  list.reserve(pattern.row.size());
  for (int c = 0; c < n; ++c) {
    for (int k = pattern.start[c]; k < pattern.start[c + 1]; ++k) {
      const int a = rank[c], b = rank[pattern.row[k]];
      list.push_back({std::min(a, b), std::max(a, b), k});
    }
  }
  list = sortedBy(&Entry::column, n, sortedBy(&Entry::row, n, list));
  std::fill(pattern.start.begin(), pattern.start.end(), 0);
  for (std::size_t k = 0; k < list.size(); ++k) {
    ++pattern.start[list[k].column + 1];
    pattern.row[k] = list[k].row;
    place[list[k].source] = static_cast<int>(k);
  }
  for (int c = 0; c < n; ++c) pattern.start[c + 1] += pattern.start[c];
}

Cholesky::Cholesky(const SparsePattern& pattern) : impl_(std::make_unique<Impl>()) {
  const double begin = secondsNow();
  openblas_set_num_threads(1);
  Impl& s = *impl_;
  s.pattern = pattern;
  cholmod_start(&s.common);
  s.common.print = 0;
  s.common.try_catch = 1;
  s.common.nmethods = 1;
  s.common.method[0].ordering = pattern.size > 300 ? CHOLMOD_NESDIS : CHOLMOD_AMD;
  s.common.postorder = 1;
  s.common.quick_return_if_not_posdef = 1;
  s.permuted.assign(pattern.row.size(), 0.0);
  s.place.resize(pattern.row.size());
  s.setPattern();
  if (pattern.size > 0) {
    const bool own = s.findOrder();
    s.permute();
    s.common.method[0].ordering = CHOLMOD_NATURAL;
    s.common.postorder = 0;
    mergeSupernodes(s.common, own);
    s.factor = s.analyse(CHOLMOD_SUPERNODAL);
    if (own) s.own = std::make_unique<SupernodalFactor>(*s.factor, s.pattern, s.place);
  }
  seconds_analysis_ = secondsNow() - begin;
}

Cholesky::~Cholesky() {
  cholmod_free_factor(&impl_->factor, &impl_->common);
  cholmod_free_factor(&impl_->indefinite, &impl_->common);
  cholmod_free_dense(&impl_->solution, &impl_->common);
  cholmod_free_dense(&impl_->work_y, &impl_->common);
  cholmod_free_dense(&impl_->work_e, &impl_->common);
  cholmod_finish(&impl_->common);
}

bool Cholesky::factorize(const std::vector<double>& values) {
  if (impl_->pattern.size == 0) return true;
  const double begin = secondsNow();
  const SerialRegions one_thread;
  ++factorizations_;
  const bool good = impl_->factorize(values);
  impl_->active = good ? impl_->factor : nullptr;
  seconds_factor_ += secondsNow() - begin;
  return good;
}

int Cholesky::factorizeIndefinite(const std::vector<double>& values) {
  if (impl_->pattern.size == 0) return 0;
  const double begin = secondsNow();
  const SerialRegions one_thread;
  ++factorizations_;
  impl_->setValues(values);
  Impl& s = *impl_;
  if (s.indefinite == nullptr) s.indefinite = s.analyse(CHOLMOD_SIMPLICIAL);
  s.common.final_ll = 0;
  cholmod_factorize(&s.matrix, s.indefinite, &s.common);
  seconds_factor_ += secondsNow() - begin;
  s.active = nullptr;
  if (s.common.status < CHOLMOD_OK || s.indefinite->minor != s.indefinite->n || s.indefinite->is_ll) return -1;
  int negative = 0;
  const auto* start = static_cast<const int*>(s.indefinite->p);
  const auto* entries = static_cast<const double*>(s.indefinite->x);
  for (std::size_t j = 0; j < s.indefinite->n; ++j) {
    const double pivot = entries[start[j]];
    if (!std::isfinite(pivot) || pivot == 0) return -1;
    if (pivot < 0) ++negative;
  }
  s.active = s.indefinite;
  return negative;
}

void Cholesky::drop() { impl_->active = nullptr; }

bool Cholesky::definite() const { return impl_->active != nullptr && impl_->active == impl_->factor; }

Eigen::MatrixXd Cholesky::Impl::inOrder(const Eigen::MatrixXd& given) const {
  Eigen::MatrixXd result(given.rows(), given.cols());
  for (int c = 0; c < given.cols(); ++c) {
    for (int k = 0; k < pattern.size; ++k) result(k, c) = given(order[k], c);
  }
  return result;
}

Eigen::MatrixXd Cholesky::Impl::asGiven(const Eigen::MatrixXd& ordered) const {
  Eigen::MatrixXd result(ordered.rows(), ordered.cols());
  for (int c = 0; c < ordered.cols(); ++c) {
    for (int k = 0; k < pattern.size; ++k) result(order[k], c) = ordered(k, c);
  }
  return result;
}

/// One right side with the own factor: the only copies are the two that permute.
template <class Sweep>
Eigen::VectorXd Cholesky::Impl::solveOwn(const Eigen::VectorXd& right, const Sweep& sweep) const {
  Eigen::VectorXd x(right.size()), result(right.size());
  for (int k = 0; k < pattern.size; ++k) x(k) = right(order[k]);
  sweep(x.data());
  for (int k = 0; k < pattern.size; ++k) result(order[k]) = x(k);
  return result;
}

Eigen::VectorXd Cholesky::solve(const Eigen::VectorXd& right) const {
  if (!impl_->own || !definite()) return solve(Eigen::MatrixXd(right)).col(0);
  const double begin = secondsNow();
  Eigen::VectorXd x = impl_->solveOwn(right, [this](double* values) { impl_->own->solve(values); });
  seconds_solve_ += secondsNow() - begin;
  return x;
}

Eigen::MatrixXd Cholesky::solve(const Eigen::MatrixXd& right) const {
  return impl_->asGiven(solvePermuted(impl_->inOrder(right)));
}

Eigen::VectorXd Cholesky::precondition(const Eigen::VectorXd& right) const {
  if (!impl_->own || !definite()) return solve(right);
  const double begin = secondsNow();
  Eigen::VectorXd x = impl_->solveOwn(right, [this](double* values) { impl_->own->solveNear(values); });
  seconds_solve_ += secondsNow() - begin;
  return x;
}

Eigen::MatrixXd Cholesky::solvePermuted(const Eigen::MatrixXd& right) const {
  if (impl_->pattern.size == 0) return right;
  if (impl_->active == nullptr) throw common::Error("solve without a factor");
  const double begin = secondsNow();
  if (impl_->own && definite()) {
    Eigen::MatrixXd x = right;
    impl_->own->solve(x.data(), static_cast<int>(x.cols()));
    seconds_solve_ += secondsNow() - begin;
    return x;
  }
  const SerialRegions one_thread;
  cholmod_dense b;
  std::memset(&b, 0, sizeof(b));
  b.nrow = b.d = right.rows();
  b.ncol = right.cols();
  b.nzmax = right.size();
  b.x = const_cast<double*>(right.data());
  b.xtype = CHOLMOD_REAL;
  b.dtype = CHOLMOD_DOUBLE;
  const Impl& s = *impl_;
  cholmod_solve2(CHOLMOD_A, s.active, &b, nullptr, &s.solution, nullptr, &s.work_y, &s.work_e, &impl_->common);
  const Eigen::MatrixXd result =
      Eigen::Map<const Eigen::MatrixXd>(static_cast<const double*>(s.solution->x), right.rows(), right.cols());
  seconds_solve_ += secondsNow() - begin;
  return result;
}

double Cholesky::factorCostInSolves() const {
  // Fitted to planar and volumetric arms of 2 to 77 thousand unknowns: small fronts run at memory's speed.
  return 6 + impl_->common.fl / (52 * std::max(impl_->common.lnz, 1.0));
}

double Cholesky::factorEntries() const { return impl_->common.lnz; }

}  // namespace snapwing::solver
