#include "snapwing/common/settings_reader.h"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <sstream>

#include "snapwing/common/error.h"
#include "snapwing/common/plain_text.h"
#include "yaml_check.h"

namespace snapwing::common {

namespace {

std::string describe(const YAML::Node& node) {
  if (!node.IsDefined() || node.IsNull()) return "null";
  if (node.IsScalar()) {
    const std::string& text = node.Scalar();
    double number = 0;
    const bool zero = node.Tag() != "!" && hasLeadingZero(text) && parseNumber(text, &number);
    return "'" + text + "'" + (zero ? " (its leading zero would mean octal to some readers: leave it out)" : "");
  }
  return node.IsSequence() ? "a list" : "a map";
}

std::string describeRange(const Range& range, const std::string& unit) {
  const std::string suffix = unit.empty() || unit == "1" ? "" : " " + unit;
  const bool below = std::isfinite(range.low);
  const bool above = std::isfinite(range.high);
  if (below && above) return "a number in [" + toText(range.low) + ", " + toText(range.high) + "]" + suffix;
  if (below) return "a number >= " + toText(range.low) + suffix;
  if (above) return "a number <= " + toText(range.high) + suffix;
  return "a finite number" + suffix;
}

/// A quoted number is text, as for every other YAML reader: refuse it.
bool isPlain(const YAML::Node& node) { return node.IsScalar() && node.Tag() != "!"; }

bool readNumber(const YAML::Node& node, double* value) {
  return isPlain(node) && !hasLeadingZero(node.Scalar()) && parseNumber(node.Scalar(), value);
}

std::string join(const std::vector<std::string>& words) {
  std::string all;
  for (const std::string& word : words) all += (all.empty() ? "" : ", ") + word;
  return all;
}

/// yaml-cpp silently keeps both of two equal keys; only the first is ever read.
void refuseDuplicates(const YAML::Node& node, const std::string& where, const std::string& prefix) {
  std::set<std::string> seen;
  for (const auto& entry : node) {
    const std::string key = entry.first.IsScalar() ? entry.first.Scalar() : "";
    if (key.empty()) throw FileError(where, "a key under '" + prefix + "' is not a plain word");
    if (!seen.insert(key).second) throw SettingError(where, prefix + key, "given twice", "each key once");
  }
}

void appendContent(const YAML::Node& node, const std::string& path, const std::set<std::string>& except,
                   std::string& text) {
  if (except.count(path) || except.count("*" + path.substr(std::min(path.rfind('.'), path.size())))) return;
  if (node.IsMap()) {
    std::map<std::string, YAML::Node> sorted;
    for (const auto& entry : node) sorted.emplace(entry.first.Scalar(), entry.second);
    for (const auto& [key, value] : sorted) appendContent(value, path.empty() ? key : path + "." + key, except, text);
  } else if (node.IsSequence()) {
    for (std::size_t i = 0; i < node.size(); ++i) appendContent(node[i], path + "[]", except, text);
  } else {
    std::ostringstream line;
    line.precision(17);
    double value = 0;
    line << path << '=';
    readNumber(node, &value) ? line << value : line << describe(node);
    text += line.str() + "\n";
  }
}

}  // namespace

struct SettingsReader::Impl {
  YAML::Node node;
  std::string where;
  std::string prefix;
  std::set<std::string> asked;
  std::set<std::string> looked_for;  ///< keys that may be left out: not accepted by that, but named
  std::shared_ptr<std::vector<std::string>> files = std::make_shared<std::vector<std::string>>();
};

SettingsReader::SettingsReader(const YAML::Node& node, std::string where, std::string prefix)
    : impl_(std::make_unique<Impl>()) {
  refuseDuplicates(node, where, prefix);
  impl_->node.reset(node);
  impl_->where = std::move(where);
  impl_->prefix = std::move(prefix);
}
SettingsReader::SettingsReader(SettingsReader&&) noexcept = default;
SettingsReader& SettingsReader::operator=(SettingsReader&&) noexcept = default;
SettingsReader::~SettingsReader() = default;

SettingsReader SettingsReader::fromFile(const std::string& path) { return fromText(readTextFile(path), path); }

SettingsReader SettingsReader::fromText(const std::string& text, const std::string& where) {
  YAML::Node root;
  try {
    checkYaml(text, where);
    root = YAML::Load(text);
  } catch (const YAML::Exception& e) {
    throw FileError(where, std::string("invalid YAML: ") + e.what());
  }
  if (!root.IsMap()) throw FileError(where, "is not a YAML map of settings, but " + describe(root));
  return SettingsReader(root, where, "");
}

YAML::Node SettingsReader::child(const std::string& key, const std::string& allowed) {
  impl_->asked.insert(key);
  // Look-up through a const node: operator[] on a mutable one would insert the key.
  const YAML::Node& map = impl_->node;
  const YAML::Node node = map[key];
  if (!node.IsDefined()) throw SettingError(where(), fullKey(key), "", allowed);
  return node;
}

bool SettingsReader::has(const std::string& key) const {
  impl_->looked_for.insert(key);
  const YAML::Node& map = impl_->node;
  return map[key].IsDefined();
}

SettingsReader SettingsReader::map(const std::string& key) {
  const YAML::Node node = child(key, "a map");
  if (!node.IsMap()) fail(key, describe(node), "a map");
  SettingsReader reader(node, where(), fullKey(key) + ".");
  reader.impl_->files = impl_->files;
  return reader;
}

std::vector<SettingsReader> SettingsReader::list(const std::string& key) {
  const YAML::Node node = child(key, "a list of maps");
  if (!node.IsSequence()) fail(key, describe(node), "a list of maps");
  std::vector<SettingsReader> readers;
  for (std::size_t i = 0; i < node.size(); ++i) {
    const std::string name = key + "[" + std::to_string(i) + "]";
    if (!node[i].IsMap()) fail(name, describe(node[i]), "a map");
    readers.push_back(SettingsReader(node[i], where(), fullKey(name) + "."));
    readers.back().impl_->files = impl_->files;
  }
  return readers;
}

std::vector<std::string> SettingsReader::keys() const {
  std::vector<std::string> names;
  for (const auto& entry : impl_->node) names.push_back(entry.first.Scalar());
  return names;
}

double SettingsReader::number(const std::string& key, const Range& range, const std::string& unit) {
  const std::string allowed = describeRange(range, unit);
  const YAML::Node node = child(key, allowed);
  double value = 0;
  if (!readNumber(node, &value) || value < range.low || value > range.high) fail(key, describe(node), allowed);
  return value;
}

double SettingsReader::numberOr(const std::string& key, double fallback, const Range& range, const std::string& unit) {
  impl_->asked.insert(key);
  return has(key) ? number(key, range, unit) : fallback;
}

int SettingsReader::integer(const std::string& key, int low, int high) {
  const std::string allowed = "a whole number in [" + std::to_string(low) + ", " + std::to_string(high) + "]";
  const YAML::Node node = child(key, allowed);
  int value = 0;
  const bool good = isPlain(node) && !hasLeadingZero(node.Scalar()) && parseInteger(node.Scalar(), &value);
  if (!good || value < low || value > high) fail(key, describe(node), allowed);
  return value;
}

int SettingsReader::integerOr(const std::string& key, int fallback, int low, int high) {
  impl_->asked.insert(key);
  return has(key) ? integer(key, low, high) : fallback;
}

bool SettingsReader::boolean(const std::string& key) {
  const YAML::Node node = child(key, "true or false");
  const bool plain = isPlain(node) && (node.Scalar() == "true" || node.Scalar() == "false");
  if (!plain) fail(key, describe(node), "true or false");
  return node.Scalar() == "true";
}

bool SettingsReader::booleanOr(const std::string& key, bool fallback) {
  impl_->asked.insert(key);
  return has(key) ? boolean(key) : fallback;
}

std::string SettingsReader::text(const std::string& key) {
  const YAML::Node node = child(key, "a text that is not empty");
  if (!node.IsScalar() || node.Scalar().empty()) fail(key, describe(node), "a text that is not empty");
  return node.Scalar();
}

std::string SettingsReader::textOr(const std::string& key, const std::string& fallback) {
  impl_->asked.insert(key);
  return has(key) ? text(key) : fallback;
}

std::string SettingsReader::choice(const std::string& key, const std::vector<std::string>& allowed) {
  const YAML::Node node = child(key, "one of " + join(allowed));
  const bool known = node.IsScalar() && std::find(allowed.begin(), allowed.end(), node.Scalar()) != allowed.end();
  if (!known) fail(key, describe(node), "one of " + join(allowed));
  return node.Scalar();
}

std::vector<std::string> SettingsReader::texts(const std::string& key) {
  const std::string allowed = "a list of texts";
  const YAML::Node node = child(key, allowed);
  if (!node.IsSequence()) fail(key, describe(node), allowed);
  std::vector<std::string> values;
  for (std::size_t i = 0; i < node.size(); ++i) {
    if (!node[i].IsScalar() || node[i].Scalar().empty()) {
      fail(key + "[" + std::to_string(i) + "]", describe(node[i]), "text, not empty");
    }
    values.push_back(node[i].Scalar());
  }
  return values;
}

std::vector<double> SettingsReader::numbers(const std::string& key, std::size_t count, const Range& range,
                                            const std::string& unit) {
  const std::string each = describeRange(range, unit);
  const std::string allowed = "a list" + (count > 0 ? " of " + std::to_string(count) : "") + ", each " + each;
  const YAML::Node node = child(key, allowed);
  if (!node.IsSequence() || (count > 0 && node.size() != count)) fail(key, describe(node), allowed);
  std::vector<double> values(node.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    const bool good = readNumber(node[i], &values[i]) && values[i] >= range.low && values[i] <= range.high;
    if (!good) fail(key + "[" + std::to_string(i) + "]", describe(node[i]), each);
  }
  return values;
}

Quantity SettingsReader::quantity(const std::string& key, const std::string& unit, const Range& range) {
  SettingsReader reader = map(key);
  Quantity quantity;
  reader.choice("unit", {unit});
  quantity.value = reader.number("value", range, unit);
  quantity.plus_minus = reader.numberOr("plus_minus", 0.0, {0.0, std::numeric_limits<double>::infinity()}, unit);
  reader.text("source");
  reader.finish();
  if (quantity.low() < range.low || quantity.high() > range.high) {
    reader.fail("plus_minus", toText(quantity.plus_minus), "value +- plus_minus within " + describeRange(range, unit));
  }
  return quantity;
}

void SettingsReader::finish() const {
  for (const auto& entry : impl_->node) {
    const std::string key = entry.first.Scalar();
    if (impl_->asked.count(key)) continue;
    std::set<std::string> known = impl_->looked_for;
    known.insert(impl_->asked.begin(), impl_->asked.end());
    fail(key, "not known here", "the keys " + join({known.begin(), known.end()}));
  }
}

const std::string& SettingsReader::where() const { return impl_->where; }

std::string SettingsReader::resolvePath(const std::string& path) const {
  namespace fs = std::filesystem;
  fs::path file(path);
  if (!file.is_absolute()) {
    std::error_code gone;
    // A pipe has no folder of its own: what it names lies relative to the working folder.
    const bool pipe = fs::exists(where(), gone) && !fs::is_regular_file(where(), gone);
    const fs::path folder = pipe ? fs::path() : fs::path(where()).parent_path();
    file = fs::absolute(folder / path, gone).lexically_normal();
    if (gone) throw FileError(path, "the working folder no longer exists");
  }
  impl_->files->push_back(file.string());
  return file.string();
}

const std::vector<std::string>& SettingsReader::namedFiles() const { return *impl_->files; }

std::string SettingsReader::content(const std::set<std::string>& except) const {
  std::string text;
  appendContent(impl_->node, "", except, text);
  return text;
}

std::string SettingsReader::fullKey(const std::string& key) const { return impl_->prefix + key; }

void SettingsReader::fail(const std::string& key, const std::string& value, const std::string& allowed) const {
  throw SettingError(where(), fullKey(key), value, allowed);
}

}  // namespace snapwing::common
