#include <gtest/gtest.h>

#include "snapwing/common/settings_reader.h"
#include "snapwing/vehicle/vehicle_text.h"

namespace snapwing::vehicle {
namespace {

constexpr char TEXT[] =
    "name: a  # b\narm:\n  # table_file: no\n  table_file: old.h5  # of old\n\nwing:\n  table_file: w.h5\n";

TEST(VehicleText, AValueIsReplacedInItsSectionAlone) {
  EXPECT_EQ(withValue(TEXT, "arm", "table_file", "new.h5"),
            "name: a  # b\narm:\n  # table_file: no\n  table_file: new.h5\n\nwing:\n  table_file: w.h5\n");
  EXPECT_EQ(withValue(TEXT, "name", "name", "c").substr(0, 8), "name: c\n");
  EXPECT_EQ(withValue(TEXT, "arm", "table", "x"), TEXT) << "a key that only begins so";
  EXPECT_EQ(withValue("arm: {table_file: old.h5}\n", "arm", "table_file", "x"), "arm: {table_file: old.h5}\n");
}

TEST(VehicleText, AnyTextIsReadBackAsItWas) {
  for (const char* value :
       {"plain", "a b", "it's: #1", "null",     "True",           "- x", "\"q\"", "{x}", "a\\b", "*star", "&amp", "!t",
        "%p",    "@a",  "x: y",     "\xc3\xa9", "tab\tline\nend", "#",   " ",     "1e5", ".inf", "~"}) {
    const std::string text = withValue("name: old\n", "name", "name", value);
    EXPECT_EQ(common::SettingsReader::fromText(text, "text").text("name"), value) << text;
  }
}

TEST(VehicleText, AKeyGoesWithItsLines) {
  EXPECT_EQ(withoutKeys(TEXT, {"arm"}), "name: a  # b\nwing:\n  table_file: w.h5\n");
  EXPECT_EQ(withoutKeys(TEXT, {"wings"}), TEXT);
}

}  // namespace
}  // namespace snapwing::vehicle
