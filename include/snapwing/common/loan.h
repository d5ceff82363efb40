#pragma once
/// Loans: a reference to what another object owns and that must stay there. Builds with SNAPWING_CHECK_LOANS (debug and
/// sanitized ones by default, see CMakeLists.txt) count them and end the program where an owner goes while it is
/// lent; elsewhere a loan is a pointer.

#include <memory>
#include <type_traits>

#ifdef SNAPWING_CHECK_LOANS
#include <atomic>
#include <typeinfo>
#endif

namespace snapwing::common {

#ifdef SNAPWING_CHECK_LOANS

/// Base of what can be lent. Loans stay with the object: a copy begins without any.
class Lender {
 public:
  Lender() = default;
  Lender(const Lender& /*other*/) {}
  Lender& operator=(const Lender& /*other*/) { return *this; }
  void lent(const std::type_info& type) const {
    type_.store(&type);
    ++loans_;
  }
  void returned() const { --loans_; }

 protected:
  /// Prints what was still lent and aborts, if anything was.
  ~Lender();

 private:
  mutable std::atomic<int> loans_{0};
  mutable std::atomic<const std::type_info*> type_{nullptr};  ///< as which it was lent last
};

#else

class Lender {
 protected:
  ~Lender() = default;
};

#endif

/// What its holder needs of a Lender while it lives. May be copied; never null.
template <class T>
class Loan {
 public:
  Loan(T& lender) : lender_(&lender) { count(); }  // NOLINT(google-explicit-constructor): used like a reference
  /// A temporary is gone before the loan is of use.
  Loan(std::remove_const_t<T>&&) = delete;
#ifdef SNAPWING_CHECK_LOANS
  Loan(const Loan& other) : lender_(other.lender_) { count(); }
  Loan& operator=(const Loan& other) {
    other.count();
    lender_->returned();
    lender_ = other.lender_;
    return *this;
  }
  ~Loan() { lender_->returned(); }
#endif

  T& operator*() const { return *lender_; }
  T* operator->() const { return lender_; }

 private:
  void count() const {
#ifdef SNAPWING_CHECK_LOANS
    lender_->lent(typeid(T));
#endif
  }

  T* lender_;
};

}  // namespace snapwing::common
