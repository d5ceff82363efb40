#include "snapwing/common/loan.h"

#ifdef SNAPWING_CHECK_LOANS

#include <cxxabi.h>

#include <cstdio>
#include <cstdlib>

namespace snapwing::common {

Lender::~Lender() {
  const int loans = loans_.load();
  if (loans == 0) return;
  int status = 0;
  const char* const plain = type_.load()->name();
  char* const readable = abi::__cxa_demangle(plain, nullptr, nullptr, &status);
  std::fprintf(stderr, "snapwing: an object of type %s is destroyed while %d of its users remain\n",
               status == 0 ? readable : plain, loans);
  std::abort();
}

}  // namespace snapwing::common

#endif
