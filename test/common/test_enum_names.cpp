#include <gtest/gtest.h>

#include "snapwing/common/enum_names.h"

namespace snapwing::common {
namespace {

enum class Fruit { APPLE, PEAR };
constexpr EnumNames<Fruit, 2> FRUITS("fruit", {"apple", "pear"});

TEST(EnumNames, ThereAndBackAndARefusalThatNamesAllWords) {
  EXPECT_EQ(FRUITS.value("apple"), Fruit::APPLE);
  EXPECT_EQ(FRUITS.value("pear"), Fruit::PEAR);
  EXPECT_EQ(FRUITS.name(Fruit::PEAR), "pear");
  try {
    FRUITS.value("Pear");
    FAIL() << "accepted";
  } catch (const Error& e) {
    EXPECT_STREQ(e.what(), "fruit is 'Pear'; allowed: apple, pear");
  }
}

}  // namespace
}  // namespace snapwing::common
