#include "yaml_check.h"

#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <map>
#include <sstream>
#include <vector>

#include "snapwing/common/error.h"

namespace snapwing::common {

namespace {

constexpr int DEEPEST = 100;
constexpr double MOST_ENTRIES = 1e6;

/// Follows the events of one document with the nodes that are open.
class Check : public YAML::EventHandler {
 public:
  explicit Check(const std::string& where) : where_(where) {}

  void OnDocumentStart(const YAML::Mark&) override {}
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override { leaf(mark, anchor); }
  void OnScalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                const std::string& value) override {
    const bool key = !open_.empty() && open_.back().map && open_.back().children % 2 == 0;
    if (key && value == "<<" && tag != "!") {
      refuse(mark, "holds a merge key '<<', which is not read; allowed: the keys themselves");
    }
    leaf(mark, anchor);
  }
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    const auto known = known_.find(anchor);
    if (known == known_.end()) refuse(mark, "names a node that holds this very line: an alias of itself");
    add(mark, known->second);
  }
  void OnSequenceStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t anchor,
                       YAML::EmitterStyle::value) override {
    begin(mark, anchor, false);
  }
  void OnMapStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t anchor,
                  YAML::EmitterStyle::value) override {
    begin(mark, anchor, true);
  }
  void OnSequenceEnd() override { end(); }
  void OnMapEnd() override { end(); }

 private:
  /// Entries and levels of a node with all that its aliases stand for.
  struct Extent {
    double entries = 1;
    int levels = 1;
  };
  struct Open {
    YAML::anchor_t anchor = 0;
    bool map = false;
    std::size_t children = 0;
    Extent extent;
    YAML::Mark mark;
  };

  [[noreturn]] void refuse(const YAML::Mark& mark, const std::string& why) const {
    throw FileError(where_, "line " + std::to_string(mark.line + 1) + " " + why);
  }
  void leaf(const YAML::Mark& mark, YAML::anchor_t anchor) {
    if (anchor != 0) known_[anchor] = {};
    add(mark, {});
  }
  void begin(const YAML::Mark& mark, YAML::anchor_t anchor, bool map) {
    if (static_cast<int>(open_.size()) >= DEEPEST) tooDeep(mark);
    open_.push_back({anchor, map, 0, {}, mark});
  }
  void end() {
    const Open node = open_.back();
    open_.pop_back();
    if (node.anchor != 0) known_[node.anchor] = node.extent;
    add(node.mark, node.extent);
  }
  void add(const YAML::Mark& mark, const Extent& extent) {
    if (static_cast<int>(open_.size()) + extent.levels > DEEPEST) tooDeep(mark);
    if (open_.empty()) return;
    Open& parent = open_.back();
    ++parent.children;
    parent.extent.entries += extent.entries;
    parent.extent.levels = std::max(parent.extent.levels, extent.levels + 1);
    if (parent.extent.entries > MOST_ENTRIES)
      refuse(mark, "makes the file, aliases expanded, longer than a million entries");
  }
  [[noreturn]] void tooDeep(const YAML::Mark& mark) const {
    refuse(mark, "is nested more than " + std::to_string(DEEPEST) + " levels deep");
  }

  const std::string& where_;
  std::vector<Open> open_;
  std::map<YAML::anchor_t, Extent> known_;  ///< of anchors whose node is complete
};

}  // namespace

void checkYaml(const std::string& text, const std::string& where) {
  std::istringstream stream(text);
  YAML::Parser parser(stream);
  Check check(where);
  if (!parser.HandleNextDocument(check)) return;
  Check second(where);
  if (parser.HandleNextDocument(second)) {
    throw FileError(where, "holds more than one YAML document (a line '---' begins another); allowed: one");
  }
}

}  // namespace snapwing::common
