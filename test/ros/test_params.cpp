// Strict parameters: every way to be wrong is refused with the key's full name. No master is needed.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "params.h"
#include "snapwing/common/error.h"

namespace snapwing::nodes {
namespace {

XmlRpc::XmlRpcValue tree() {
  XmlRpc::XmlRpcValue values;
  values["rate"] = 50.0;
  values["count"] = 3;
  values["flag"] = true;
  values["word"] = std::string("boom");
  return values;
}

template <class Call>
std::string refusedKey(Call call) {
  try {
    call();
  } catch (const common::SettingError& error) {
    EXPECT_NE(std::string(error.what()).find(error.key()), std::string::npos);
    return error.key();
  }
  return "accepted";
}

TEST(Params, ReadsWhatIsThere) {
  Params params(tree(), "/node");
  EXPECT_EQ(params.number("rate", {1, 100}, "Hz"), 50.0);
  EXPECT_EQ(params.number("count", {1, 100}, "1"), 3.0);  // a whole number is a number
  EXPECT_EQ(params.integer("count", 1, 5), 3);
  EXPECT_TRUE(params.boolean("flag"));
  EXPECT_EQ(params.choice("word", {"free", "boom"}), "boom");
  EXPECT_EQ(params.numberOr("other", 7.5, {0, 10}, "m"), 7.5);
  params.finish();
  EXPECT_NE(params.summary().find("other: 7.5 (default)"), std::string::npos);
}

TEST(Params, RefusesWrongTypeRangeAndMissing) {
  Params params(tree(), "/node");
  EXPECT_EQ(refusedKey([&] { params.number("rate", {60, 100}, "Hz"); }), "/node/rate");
  EXPECT_EQ(refusedKey([&] { params.number("word", {0, 1}, "1"); }), "/node/word");
  EXPECT_EQ(refusedKey([&] { params.number("flag", {0, 1}, "1"); }), "/node/flag");
  EXPECT_EQ(refusedKey([&] { params.integer("rate", 0, 100); }), "/node/rate");
  EXPECT_EQ(refusedKey([&] { params.integer("count", 4, 100); }), "/node/count");
  EXPECT_EQ(refusedKey([&] { params.boolean("count"); }), "/node/count");
  EXPECT_EQ(refusedKey([&] { params.text("rate"); }), "/node/rate");
  EXPECT_EQ(refusedKey([&] { params.choice("word", {"free", "held"}); }), "/node/word");
  EXPECT_EQ(refusedKey([&] { params.number("absent", {0, 1}, "1"); }), "/node/absent");
}

TEST(Params, ShowsTheValueThatIsOutOfRange) {
  XmlRpc::XmlRpcValue values;
  values["share"] = 1.0000001;
  Params params(values, "/node");
  try {
    params.number("share", {0, 1}, "1");
    ADD_FAILURE() << "was accepted";
  } catch (const common::SettingError& error) {
    EXPECT_NE(std::string(error.what()).find("1.0000001"), std::string::npos) << error.what();
  }
}

/// @param depth  of lists and structs within
XmlRpc::XmlRpcValue anything(std::mt19937& random, int depth) {
  const auto pick = [&](int most) { return std::uniform_int_distribution<int>(0, most)(random); };
  XmlRpc::XmlRpcValue value;
  const double doubles[] = {0.5, -1e300, std::nan(""), INFINITY, 1.0000001};
  switch (pick(depth > 0 ? 7 : 4)) {
    case 0:
      return XmlRpc::XmlRpcValue(pick(200) - 100);
    case 1:
      return XmlRpc::XmlRpcValue(doubles[pick(4)]);
    case 2:
      return XmlRpc::XmlRpcValue(pick(1) == 1);
    case 3:
      return XmlRpc::XmlRpcValue(std::string(pick(3), static_cast<char>(pick(255))));
    case 4:
      return value;  // invalid: null
    case 5:
      value.setSize(pick(3));
      for (int k = 0; k < value.size(); ++k) value[k] = anything(random, depth - 1);
      return value;
    default:
      for (int k = pick(3); k >= 0; --k)
        value[std::string(1, static_cast<char>('a' + pick(3)))] = anything(random, depth - 1);
      return value;
  }
}

/// Whatever the server holds, a getter gives a value in its range or names the key.
TEST(Params, AnythingIsTakenOrRefused) {
  std::mt19937 random(7);
  int taken = 0, refused = 0;
  for (int trial = 0; trial < 20000; ++trial) {
    XmlRpc::XmlRpcValue values;
    values["a"] = anything(random, 2);
    if (trial % 3 > 0) values["b"] = anything(random, 1);
    Params params(values, "/node");
    const auto count = [&](const auto& read) {
      try {
        read();
        ++taken;
      } catch (const common::SettingError& error) {
        EXPECT_EQ(error.key().rfind("/node/", 0), 0u);
        ++refused;
      }
    };
    for (const char* key : {"a", "b"}) {
      count([&] {
        const double number = params.number(key, {-1, 1}, "m");
        EXPECT_TRUE(number >= -1 && number <= 1);
      });
      count([&] { EXPECT_LE(std::abs(params.integer(key, -9, 9)), 9); });
      count([&] { params.boolean(key); });
      count([&] { EXPECT_FALSE(params.text(key).empty()); });
      count([&] { EXPECT_EQ(params.choice(key, {"x", "y"}).size(), 1u); });
    }
    count([&] { params.finish(); });
  }
  EXPECT_GT(taken, 1000);
  EXPECT_GT(refused, 1000);
}

TEST(Params, RefusesUnknownKey) {
  Params params(tree(), "/node");
  params.number("rate", {1, 100}, "Hz");
  params.integer("count", 0, 9);
  params.boolean("flag");
  EXPECT_EQ(refusedKey([&] { params.finish(); }), "/node/word");
}

TEST(Params, NoParametersAtAll) {
  Params params(XmlRpc::XmlRpcValue(), "/node");
  EXPECT_EQ(params.textOr("frame", "arm"), "arm");
  EXPECT_EQ(refusedKey([&] { params.text("vehicle_file"); }), "/node/vehicle_file");
}

}  // namespace
}  // namespace snapwing::nodes
