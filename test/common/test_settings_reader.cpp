#include <gtest/gtest.h>

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
  expectParts(messageOf([] { reader("a: [1, 2"); }), {"no valid YAML"});
  expectParts(messageOf([] { reader(""); }), {"no YAML map"});
  expectParts(messageOf([] { reader("- 1"); }), {"no YAML map"});
  expectParts(messageOf([] { SettingsReader::fromFile("missing.yaml"); }), {"missing.yaml"});
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
