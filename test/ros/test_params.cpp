// Strict parameters: every way to be wrong is refused with the key's full name. No master is needed.
#include <gtest/gtest.h>

#include "snapwing/common/error.h"
#include "snapwing/ros/params.h"

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
