#include <gtest/gtest.h>

#include <memory>
#include <type_traits>

#include "snapwing/common/loan.h"

namespace snapwing::common {
namespace {

struct Owner : Lender {
  int value = 7;
};

struct User {
  explicit User(const Owner& lent) : owner(lent) {}
  Loan<const Owner> owner;
};

TEST(Loan, ReadsWhatItsOwnerHasNow) {
  Owner owner;
  const User user(owner), copy(user);
  owner.value = 8;
  EXPECT_EQ(user.owner->value, 8);
  EXPECT_EQ((*copy.owner).value, 8);
}

TEST(Loan, IsNotMadeOfATemporary) {
  EXPECT_TRUE((std::is_constructible_v<Loan<const Owner>, Owner&>));
  EXPECT_FALSE((std::is_constructible_v<Loan<const Owner>, Owner>));
}

#ifdef SNAPWING_CHECK_LOANS

TEST(Loan, OwnerThatGoesFirstEndsTheProgram) {
  const auto owner_goes_first = [] {
    auto owner = std::make_unique<Owner>();
    const User user(*owner), copy(user);
    owner.reset();
  };
  EXPECT_DEATH(owner_goes_first(), "Owner is destroyed while 2 of its users remain");
}

TEST(Loan, OwnerMayGoAfterItsUsersAndACopyAtAnyTime) {
  auto first = std::make_unique<Owner>(), second = std::make_unique<Owner>();
  User user(*first);
  { const Owner copy(*first); }
  user = User(*second);
  first.reset();
  EXPECT_EQ(user.owner->value, 7);
}

#endif

}  // namespace
}  // namespace snapwing::common
