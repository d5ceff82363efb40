#include <gtest/gtest.h>

#include <fstream>

#include "snapwing/common/error.h"
#include "snapwing/common/settings_reader.h"

namespace snapwing::common {
namespace {

SettingsReader reader(const std::string& text) { return SettingsReader::fromText(text, "test.yaml"); }

/// Message of the SettingError or FileError that `action` must throw.
template <class Action>
std::string messageOf(Action action) {
  try {
    action();
  } catch (const Error& e) {
    return e.what();
  }
  return "nothing was thrown";
}

void expectParts(const std::string& message, const std::vector<std::string>& parts) {
  for (const std::string& part : parts)
    EXPECT_NE(message.find(part), std::string::npos) << message << " lacks " << part;
}

TEST(SettingsReader, ReadsWhatIsThere) {
  SettingsReader r = reader("a: 1.5\nb: {c: word, d: [1, 2]}\ne: true\nf: 7");
  EXPECT_DOUBLE_EQ(r.number("a", {0, 2}, "m"), 1.5);
  SettingsReader b = r.map("b");
  EXPECT_EQ(b.text("c"), "word");
  EXPECT_EQ(b.numbers("d", 2, {}, "m"), (std::vector<double>{1, 2}));
  b.finish();
  EXPECT_TRUE(r.boolean("e"));
  EXPECT_EQ(r.integer("f", 0, 10), 7);
  r.finish();
}

TEST(SettingsReader, UnknownKeyIsNamedWithItsPath) {
  SettingsReader r = reader("outer: {known: 1, unkown: 2}");
  SettingsReader outer = r.map("outer");
  outer.number("known", {}, "");
  expectParts(messageOf([&] { outer.finish(); }), {"test.yaml", "outer.unkown", "known"});
}

TEST(SettingsReader, KeysThatMayBeLeftOutAreNamedAmongTheAllowedButTakenOnlyIfRead) {
  SettingsReader r = reader("a: 1\nbb: 2");
  r.number("a", {0, 2}, "m");
  EXPECT_FALSE(r.has("b"));
  expectParts(messageOf([&] { r.finish(); }), {"'bb'", "a, b"});
  SettingsReader looked = reader("b: 2");
  EXPECT_TRUE(looked.has("b"));
  EXPECT_THROW(looked.finish(), SettingError);
}

TEST(SettingsReader, MissingMistypedAndOutOfRangeAreNamed) {
  SettingsReader r = reader("a: {thickness: -0.002, name: 'x', quoted: '3', nan: .nan, flag: yes, half: 1.5}");
  SettingsReader a = r.map("a");
  expectParts(messageOf([&] { a.number("gone", {0, 1}, "m"); }), {"a.gone", "missing", "[0, 1] m"});
  expectParts(messageOf([&] { a.number("thickness", {1e-4, 1}, "m"); }), {"a.thickness", "-0.002", "[0.0001, 1] m"});
  expectParts(messageOf([&] { a.number("name", {}, "m"); }), {"a.name", "'x'"});
  expectParts(messageOf([&] { a.number("quoted", {}, "m"); }), {"a.quoted", "'3'"});
  expectParts(messageOf([&] { a.number("nan", {}, "m"); }), {"a.nan", "finite"});
  expectParts(messageOf([&] { a.boolean("flag"); }), {"a.flag", "true or false"});
  expectParts(messageOf([&] { a.integer("half", 0, 5); }), {"a.half", "whole number in [0, 5]"});
  expectParts(messageOf([&] { a.choice("name", {"y", "z"}); }), {"a.name", "one of y, z"});
}

TEST(SettingsReader, KeyGivenTwiceIsRefused) {
  expectParts(messageOf([] { reader("a: 1\na: 2"); }), {"test.yaml", "a"});
}

TEST(SettingsReader, BrokenFilesAreRefused) {
  expectParts(messageOf([] { reader("a: [1, 2"); }), {"invalid YAML"});
  expectParts(messageOf([] { reader(""); }), {"not a YAML map"});
  expectParts(messageOf([] { reader("- 1"); }), {"not a YAML map"});
  expectParts(messageOf([] { SettingsReader::fromFile("missing.yaml"); }), {"missing.yaml"});
}

TEST(SettingsReader, OneDocumentWithoutMergeKeysAndLoops) {
  expectParts(messageOf([] { reader("a: 1\n---\na: 2\n"); }), {"test.yaml", "more than one YAML document"});
  EXPECT_NO_THROW(reader("---\na: 1\n...\n"));
  expectParts(messageOf([] { reader("a: 1\nb: &s {c: [*s]}\n"); }), {"line 2", "alias of itself"});
  expectParts(messageOf([] { reader("a: &x {c: 1}\nb:\n  <<: *x\n"); }), {"line 3", "merge key"});
  EXPECT_NO_THROW(reader("a: &x {c: 1}\nb: *x\n"));
  std::string wide = "a0: &a0 [1, 1, 1, 1, 1, 1, 1, 1, 1, 1]\n", deep = "a: ";
  for (int k = 1; k < 9; ++k) {
    const std::string before = "*a" + std::to_string(k - 1), name = std::to_string(k);
    wide += "a" + name + ": &a" + name + " [";
    for (int n = 0; n < 10; ++n) wide += (n > 0 ? ", " : "") + before;
    wide += "]\n";
  }
  expectParts(messageOf([&] { reader(wide); }), {"longer than a million entries"});
  for (int k = 0; k < 200; ++k) deep += "[";
  for (int k = 0; k < 200; ++k) deep += "]";
  expectParts(messageOf([&] { reader(deep); }), {"100 levels"});
}

TEST(SettingsReader, NumbersHaveOneReading) {
  SettingsReader r = reader("a: 010\nb: [1, 007.5]\nc: 0x10\nd: 1_000\ne: '010'\nf: 0.5\ng: -0\nh: 'true'");
  expectParts(messageOf([&] { r.integer("a", 0, 100); }), {"a", "'010'", "leading zero"});
  expectParts(messageOf([&] { r.number("a", {}, "m"); }), {"a", "'010'", "leading zero"});
  expectParts(messageOf([&] { r.numbers("b", 2, {}, "m"); }), {"b[1]", "leading zero"});
  expectParts(messageOf([&] { r.integer("c", 0, 100); }), {"c", "'0x10'"});
  expectParts(messageOf([&] { r.integer("d", 0, 10000); }), {"d", "'1_000'"});
  EXPECT_EQ(r.text("e"), "010");
  EXPECT_DOUBLE_EQ(r.number("f", {}, ""), 0.5);
  EXPECT_EQ(r.integer("g", -1, 1), 0);
  expectParts(messageOf([&] { r.boolean("h"); }), {"h", "true or false"});
}

TEST(SettingsReader, MarksAndLineEndsOfOtherSystemsAreTaken) {
  const std::string path = ::testing::TempDir() + "snapwing_line_ends.yaml";
  for (const char* end : {"\n", "\r\n", "\r"}) {
    std::ofstream(path, std::ios::binary) << "\xef\xbb\xbf"
                                          << "a: 1" << end << "b: word" << end << "c:" << end << "  d: 2" << end;
    SettingsReader r = SettingsReader::fromFile(path);
    EXPECT_EQ(r.integer("a", 0, 9), 1);
    EXPECT_EQ(r.text("b"), "word");
    EXPECT_EQ(r.map("c").integer("d", 0, 9), 2);
  }
  std::ofstream(path, std::ios::binary) << std::string(
      "\xff\xfe"
      "a\0:\0",
      6);
  expectParts(messageOf([&] { SettingsReader::fromFile(path); }), {"UTF-16", "allowed: UTF-8"});
}

TEST(SettingsReader, QuantityNeedsUnitSourceAndRoomForItsSpread) {
  SettingsReader r = reader(
      "good: {value: 2, unit: m, plus_minus: 0.5, source: paper}\n"
      "unit: {value: 2, unit: mm, source: paper}\n"
      "source: {value: 2, unit: m}\n"
      "wide: {value: 2, unit: m, plus_minus: 3, source: paper}\n"
      "extra: {value: 2, unit: m, source: paper, sigma: 1}\n");
  const Quantity q = r.quantity("good", "m", {0, 10});
  EXPECT_DOUBLE_EQ(q.low(), 1.5);
  EXPECT_DOUBLE_EQ(q.high(), 2.5);
  expectParts(messageOf([&] { r.quantity("unit", "m", {0, 10}); }), {"unit.unit", "'mm'", "one of m"});
  expectParts(messageOf([&] { r.quantity("source", "m", {0, 10}); }), {"source.source", "missing"});
  expectParts(messageOf([&] { r.quantity("wide", "m", {0, 10}); }), {"wide.plus_minus", "3"});
  expectParts(messageOf([&] { r.quantity("extra", "m", {0, 10}); }), {"extra.sigma"});
}

TEST(SettingsReader, KnowsTheFilesThatItNamed) {
  SettingsReader reader = SettingsReader::fromText("a: {file: x.csv}\nb: [{file: /y.stl}]", "/folder/s.yaml");
  SettingsReader a = reader.map("a");
  a.resolvePath(a.text("file"));
  for (SettingsReader& b : reader.list("b")) b.resolvePath(b.text("file"));
  EXPECT_EQ(reader.namedFiles(), (std::vector<std::string>{"/folder/x.csv", "/y.stl"}));
}

TEST(SettingsReader, ContentIsWhatIsSaidNotHowItIsWritten) {
  const auto content = [](const std::string& text) {
    return SettingsReader::fromText(text, "s").content({"name", "steps.count", "loads[].name"});
  };
  const std::string one = content("name: x\nsize: 1.0e-3\nsteps: {count: 3, to: 2}\nloads: [{name: a, force: 1.0}]");
  EXPECT_EQ(one, content("# same\nsteps: {to: 2.0}\nname: y\nsize: 0.001\nloads:\n- force: 1\n  name: b"));
  EXPECT_NE(one, content("size: 0.002\nsteps: {to: 2}\nloads: [{force: 1.0}]"));
  EXPECT_NE(one, content("size: 0.001\nsteps: {to: 2}\nloads: [{force: 1.0}, {force: 1.0}]"));
  EXPECT_NE(one, content("size: 0.001\nsteps: {to: 2}\nloads: [{force: '1.0'}]"));
}

}  // namespace
}  // namespace snapwing::common
