#include "snapwing/statics/sparse.h"

#include <cholmod.h>
#include <omp.h>

#include <chrono>
#include <cmath>
#include <cstring>

#include "snapwing/common/error.h"

// OpenBLAS's own entry point; its header clashes with others, so that only this one function is declared.
extern "C" void openblas_set_num_threads(int count);

namespace snapwing::statics {

double secondsNow() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

Eigen::VectorXd SparsePattern::multiply(const std::vector<double>& values, const Eigen::VectorXd& x) const {
  Eigen::VectorXd y = Eigen::VectorXd::Zero(size);
  for (int column = 0; column < size; ++column) {
    for (int k = start[column]; k < start[column + 1]; ++k) {
      y(row[k]) += values[k] * x(column);
      if (row[k] != column) y(column) += values[k] * x(row[k]);
    }
  }
  return y;
}

namespace {

/// CHOLMOD opens a parallel region for every supernode, whatever OMP_NUM_THREADS says; on small supernodes the threads
/// cost more than the work (three quarters of a planar factorization). While this lives, regions run on one thread.
class OneThread {
 public:
  OneThread() : levels_(omp_get_max_active_levels()) { omp_set_max_active_levels(0); }
  ~OneThread() { omp_set_max_active_levels(levels_); }
  OneThread(const OneThread&) = delete;
  OneThread& operator=(const OneThread&) = delete;

 private:
  int levels_;
};

}  // namespace

struct Cholesky::Impl {
  cholmod_common common;
  cholmod_sparse matrix;
  SparsePattern pattern;
  cholmod_factor* factor = nullptr;
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
  void setValues(const std::vector<double>& values) { matrix.x = const_cast<double*>(values.data()); }
};

Cholesky::Cholesky(const SparsePattern& pattern) : impl_(std::make_unique<Impl>()) {
  const double begin = secondsNow();
  openblas_set_num_threads(1);
  Impl& s = *impl_;
  s.pattern = pattern;
  cholmod_start(&s.common);
  s.common.print = 0;
  s.common.try_catch = 1;
  s.common.nmethods = 1;
  s.common.method[0].ordering = pattern.size > 300 ? CHOLMOD_METIS : CHOLMOD_AMD;
  s.common.postorder = 1;
  s.common.quick_return_if_not_posdef = 1;
  cholmod_sparse& m = s.matrix;
  std::memset(&m, 0, sizeof(m));
  m.nrow = m.ncol = pattern.size;
  m.nzmax = pattern.row.size();
  m.p = s.pattern.start.data();
  m.i = s.pattern.row.data();
  m.stype = -1;
  m.itype = CHOLMOD_INT;
  m.xtype = CHOLMOD_REAL;
  m.dtype = CHOLMOD_DOUBLE;
  m.sorted = 1;
  m.packed = 1;
  std::vector<double> zeros(pattern.row.size(), 0.0);
  s.setValues(zeros);
  if (pattern.size > 0) s.factor = s.analyse(CHOLMOD_SUPERNODAL);
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
  const OneThread one_thread;
  ++factorizations_;
  impl_->setValues(values);
  cholmod_factorize(&impl_->matrix, impl_->factor, &impl_->common);
  const bool good = impl_->common.status == CHOLMOD_OK && impl_->factor->minor == impl_->factor->n;
  impl_->active = good ? impl_->factor : nullptr;
  seconds_factor_ += secondsNow() - begin;
  return good;
}

int Cholesky::factorizeIndefinite(const std::vector<double>& values) {
  if (impl_->pattern.size == 0) return 0;
  const double begin = secondsNow();
  const OneThread one_thread;
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

Eigen::VectorXd Cholesky::solve(const Eigen::VectorXd& right) const { return solve(Eigen::MatrixXd(right)).col(0); }

Eigen::MatrixXd Cholesky::solve(const Eigen::MatrixXd& right) const {
  if (impl_->pattern.size == 0) return right;
  if (impl_->active == nullptr) throw common::Error("solve without a factor");
  const double begin = secondsNow();
  const OneThread one_thread;
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

double Cholesky::reciprocalCondition() const {
  return impl_->active == nullptr ? 0.0 : cholmod_rcond(impl_->active, &impl_->common);
}

double Cholesky::factorEntries() const { return impl_->common.lnz; }

}  // namespace snapwing::statics
