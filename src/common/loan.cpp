#include "snapwing/common/loan.h"

#ifdef SNAPWING_CHECK_LOANS

#include <cstdio>
#include <cstdlib>

namespace snapwing::common {

Lender::~Lender() {
  const int loans = loans_.load();
  if (loans == 0) return;
  std::fprintf(stderr, "snapwing: an object of type %s is destroyed while %d of its users remain\n",
               type_.load()->name(), loans);
  std::abort();
}

}  // namespace snapwing::common

#endif
