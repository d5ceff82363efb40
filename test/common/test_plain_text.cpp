#include <gtest/gtest.h>
#include <sys/stat.h>

#include <cmath>
#include <cstdio>
#include <fstream>
#include <limits>
#include <random>
#include <thread>

#include "snapwing/common/error.h"
#include "snapwing/common/plain_text.h"
#include "snapwing/common/provenance.h"
#include "snapwing/common/settings_reader.h"

namespace snapwing::common {
namespace {

std::string temporary(const std::string& name) { return ::testing::TempDir() + "snapwing_text_" + name; }

TEST(PlainText, NumbersFillTheirText) {
  double value = 7;
  for (const char* text : {"1", "-1.5", "+.5", "5.", "1e-3", "1.0E+3", "010", "1e-400"})
    EXPECT_TRUE(parseNumber(text, &value)) << text;
  EXPECT_EQ(value, 0) << "too small for a double";
  ASSERT_TRUE(parseNumber("+1.25e2", &value));
  EXPECT_EQ(value, 125);
  for (const char* text : {"", " 1", "1 ", "1abc", "0,85", "1e", "e3", ".", "-", "--1", "+-1", "0x10", "1_000", "inf",
                           "nan", "1e400", "1.2.3", "1e3.5"}) {
    EXPECT_FALSE(parseNumber(text, &value)) << text;
  }
  EXPECT_EQ(value, 125) << "untouched by what is no number";
  EXPECT_FALSE(parseNumber("-1" + std::string(400, '0'), &value));
  EXPECT_FALSE(parseNumber("1" + std::string(400, '0') + "e-9", &value));
  ASSERT_TRUE(parseNumber("0." + std::string(400, '0') + "1e+9", &value));
  EXPECT_EQ(value, 0);
  int whole = 7;
  ASSERT_TRUE(parseInteger("-12", &whole));
  EXPECT_EQ(whole, -12);
  for (const char* text : {"", "1.0", "1e3", "0x10", "2147483648", "1 ", "+"})
    EXPECT_FALSE(parseInteger(text, &whole)) << text;
  for (const char* text : {"010", "-00", "+08.5"}) EXPECT_TRUE(hasLeadingZero(text)) << text;
  for (const char* text : {"0", "0.5", "-0.5", "10", "", "-"}) EXPECT_FALSE(hasLeadingZero(text)) << text;
}

TEST(PlainText, ShownNumbersReadBackAsThemselves) {
  EXPECT_EQ(toText(1.0000001), "1.0000001");
  EXPECT_EQ(toText(0.08), "0.08");
  EXPECT_EQ(toText(std::nan("")), "nan");
  std::mt19937_64 random(7);
  for (int k = 0; k < 1000; ++k) {
    const double exponent = std::uniform_real_distribution<double>(-300, 300)(random);
    const double value = std::uniform_real_distribution<double>(-1, 1)(random) * std::pow(10.0, exponent);
    double back = 0;
    ASSERT_TRUE(parseNumber(toText(value), &back)) << toText(value);
    EXPECT_EQ(back, value);
  }
}

TEST(PlainText, OneKindOfLineEnd) {
  EXPECT_EQ(plainText("\xef\xbb\xbf"
                      "a\r\nb\rc\n\r",
                      "f"),
            "a\nb\nc\n\n");
  EXPECT_THROW(plainText(std::string("\xff\xfe"
                                     "a\0",
                                     4),
                         "f"),
               FileError);
  EXPECT_THROW(plainText(std::string("a\0b", 3), "f"), FileError);
}

TEST(PlainText, CsvRowsKeepTheirLineNumbers) {
  const std::string path = temporary("rows.csv");
  std::ofstream(path, std::ios::binary) << "\xef\xbb\xbf# remark\r\n\r\ni, \"j\" ,rho\r\n1,\"a,b\",\r\n";
  const std::vector<TextRow> rows = readCsv(path);
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(rows[0].line, 3);
  EXPECT_EQ(rows[0].fields, (std::vector<std::string>{"i", "j", "rho"}));
  EXPECT_EQ(rows[1].fields, (std::vector<std::string>{"1", "a,b", ""}));
}

/// What a shell gives for <(...) can be read once; whoever looks twice must get the same.
TEST(PlainText, APipeIsReadOnce) {
  const std::string path = temporary("pipe");
  std::remove(path.c_str());
  ASSERT_EQ(::mkfifo(path.c_str(), 0600), 0);
  std::thread writer([&] { std::ofstream(path) << "file: part.csv\n"; });
  const std::string first = readFile(path);
  writer.join();
  EXPECT_EQ(first, "file: part.csv\n");
  EXPECT_EQ(readFile(path), first);
  SettingsReader reader = SettingsReader::fromFile(path);
  EXPECT_NE(reader.resolvePath(reader.text("file")), ::testing::TempDir() + "part.csv")
      << "a pipe has no folder: relative to the working folder";
}

}  // namespace
}  // namespace snapwing::common
