#pragma once
/// Loans: references to objects that must outlive them. Builds with SNAPWING_CHECK_LOANS (debug and sanitized ones by
/// default, see CMakeLists.txt) count the loans of each object and abort if it is destroyed while lent. In other builds
/// a loan is a pointer.

#include <memory>
#include <type_traits>

#ifdef SNAPWING_CHECK_LOANS
#include <atomic>
#include <typeinfo>
#endif

namespace snapwing::common {

#ifdef SNAPWING_CHECK_LOANS

/// Base of objects that can be lent. A copy starts without loans.
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
  /// Prints the type and aborts if the object is still lent.
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

/// Reference to a Lender that must outlive it. May be copied; never null.
template <class T>
class Loan {
 public:
  Loan(T& lender) : lender_(&lender) { count(); }  // NOLINT(google-explicit-constructor): used like a reference
  /// A temporary would be destroyed before the loan is used.
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
