#include "snapwing/design/wing/wing_stack.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <sstream>

#include "snapwing/common/error.h"

namespace snapwing::design {

using Eigen::Vector2d;

namespace {

constexpr std::size_t MOST_PIECES = 8;  ///< all orders are tried

using Line = std::array<Vector2d, 2>;

double distance(const Vector2d& p, const Line& line) {
  const Vector2d along = line[1] - line[0];
  const double share = std::clamp((p - line[0]).dot(along) / std::max(along.squaredNorm(), 1e-300), 0.0, 1.0);
  return (p - line[0] - share * along).norm();
}

double cross(const Vector2d& a, const Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

double distance(const Line& a, const Line& b) {
  const Vector2d u = a[1] - a[0], v = b[1] - b[0];
  const bool parts_a = cross(v, a[0] - b[0]) * cross(v, a[1] - b[0]) < 0;
  const bool parts_b = cross(u, b[0] - a[0]) * cross(u, b[1] - a[0]) < 0;
  if (parts_a && parts_b) return 0;
  return std::min({distance(a[0], b), distance(a[1], b), distance(b[0], a), distance(b[1], a)});
}

/// The closest that two come over all samples.
Meeting closest(int first, int second, std::size_t samples, const std::function<double(std::size_t)>& gap) {
  Meeting meeting{first, second, std::numeric_limits<double>::infinity(), 0};
  for (std::size_t k = 0; k < samples; ++k) {
    const double here = gap(k);
    if (here < meeting.gap) meeting.gap = here, meeting.sample = static_cast<int>(k);
  }
  return meeting;
}

bool holds(const StackPin& pin, int piece) {
  return std::find(pin.pieces.begin(), pin.pieces.end(), piece) != pin.pieces.end();
}

void findMeetings(const Stack& s, double clearance, StackPlan* plan) {
  const auto keep = [&](const Meeting& meeting, std::vector<Meeting>* list) {
    if (meeting.gap < clearance) list->push_back(meeting);
  };
  const std::size_t samples = s.pieces[0].ends.size();
  const int pieces = static_cast<int>(s.pieces.size()), pins = static_cast<int>(s.pins.size());
  for (int i = 0; i < pieces; ++i) {
    const StackPiece& a = s.pieces[i];
    for (int j = i + 1; j < pieces; ++j) {
      const StackPiece& b = s.pieces[j];
      const auto gap = [&](std::size_t k) { return distance(a.ends[k], b.ends[k]) - a.half_width - b.half_width; };
      keep(closest(i, j, samples, gap), &plan->over);
    }
  }
  for (int p = 0; p < pins; ++p) {
    const StackPin& pin = s.pins[p];
    for (int i = 0; i < pieces; ++i) {
      const StackPiece& a = s.pieces[i];
      const auto gap = [&](std::size_t k) { return distance(pin.place[k], a.ends[k]) - pin.radius - a.half_width; };
      if (!holds(pin, i)) keep(closest(p, i, samples, gap), &plan->in_way);
    }
    for (int q = p + 1; q < pins; ++q) {
      const StackPin& other = s.pins[q];
      const auto gap = [&](std::size_t k) {
        return (pin.place[k] - other.place[k]).norm() - pin.radius - other.radius;
      };
      keep(closest(p, q, samples, gap), &plan->pin_pairs);
    }
  }
}

/// The rules of one stack, and the search for layers that keep them.
class Search {
 public:
  Search(const Stack& stack, const StackPlan& meetings) : stack_(stack), over_(meetings.over) {
    for (const Meeting& m : meetings.in_way) rules_.push_back({Rule::PIN_AND_PIECE, m});
    for (const Meeting& m : meetings.pin_pairs) rules_.push_back({Rule::PINS, m});
    for (const auto& [i, j] : stack.fixed) rules_.push_back({Rule::FIXED, {i, j, 0, 0}});
  }
  int ruleCount() const { return static_cast<int>(rules_.size()); }
  /// Layers of the pieces with at most `layers` layers and the shortest pins; empty if there are none.
  /// @param without  number of a rule that is left out, -1: none
  std::vector<int> solve(int layers, int without) {
    without_ = without;
    best_.clear();
    least_ = std::numeric_limits<int>::max();
    layer_.assign(stack_.pieces.size(), 0);
    place(0, layers);
    return best_;
  }
  /// The fewest layers and their order.
  std::vector<int> fewest(int most, int without = -1) {
    for (int layers = 1; layers <= most; ++layers) {
      const std::vector<int> found = solve(layers, without);
      if (!found.empty()) return found;
    }
    return {};
  }
  std::string describe(int rule) const {
    const Meeting& m = rules_[rule].meeting;
    std::ostringstream text;
    switch (rules_[rule].kind) {
      case Rule::PIN_AND_PIECE:
        text << "pin " << stack_.pins[m.first].name << " meets " << stack_.pieces[m.second].name;
        break;
      case Rule::PINS:
        text << "pin " << stack_.pins[m.first].name << " meets pin " << stack_.pins[m.second].name;
        break;
      case Rule::FIXED:
        text << stack_.pieces[m.first].name << " is fixed to " << stack_.pieces[m.second].name;
        return text.str();
    }
    text << " (" << 1e3 * m.gap << " mm apart)";
    return text.str();
  }

 private:
  struct Rule {
    enum Kind { PIN_AND_PIECE, PINS, FIXED } kind;
    Meeting meeting;
  };

  /// Lowest and highest layer of a pin; high is 0 while a piece of it has no layer yet.
  std::array<int, 2> reach(int pin) const {
    std::array<int, 2> r{std::numeric_limits<int>::max(), 0};
    for (const int piece : stack_.pins[pin].pieces) {
      if (layer_[piece] == 0) return {0, 0};
      r = {std::min(r[0], layer_[piece]), std::max(r[1], layer_[piece])};
    }
    if (stack_.pins[pin].grounded) r[0] = 0;
    return r;
  }
  bool kept(const Rule& rule) const {
    const Meeting& m = rule.meeting;
    if (rule.kind == Rule::FIXED) {
      return layer_[m.first] == 0 || layer_[m.second] == 0 || std::abs(layer_[m.first] - layer_[m.second]) == 1;
    }
    const std::array<int, 2> a = reach(m.first);
    if (a[1] == 0) return true;
    if (rule.kind == Rule::PINS) {
      const std::array<int, 2> b = reach(m.second);
      return b[1] == 0 || a[1] < b[0] || b[1] < a[0];
    }
    const int layer = layer_[m.second];
    return layer == 0 || layer < a[0] || layer > a[1];
  }
  bool allKept() const {
    for (const Meeting& m : over_) {
      if (layer_[m.first] != 0 && layer_[m.first] == layer_[m.second]) return false;
    }
    for (int k = 0; k < ruleCount(); ++k) {
      if (k != without_ && !kept(rules_[k])) return false;
    }
    return true;
  }
  void place(std::size_t piece, int layers) {
    if (piece == layer_.size()) {
      int length = 0;
      for (std::size_t p = 0; p < stack_.pins.size(); ++p) {
        const std::array<int, 2> r = reach(static_cast<int>(p));
        length += r[1] - r[0];
      }
      if (length < least_) least_ = length, best_ = layer_;
      return;
    }
    for (int layer = 1; layer <= layers; ++layer) {
      layer_[piece] = layer;
      if (allKept()) place(piece + 1, layers);
    }
    layer_[piece] = 0;
  }

  const Stack& stack_;
  std::vector<Meeting> over_;
  std::vector<Rule> rules_;
  int without_ = -1, least_ = 0;
  std::vector<int> layer_, best_;
};

std::string reasonFor(Search& search, int most, int pieces) {
  std::ostringstream text;
  const std::vector<int> more = search.fewest(pieces);
  if (!more.empty()) {
    text << "no order within " << most << " layers; " << *std::max_element(more.begin(), more.end()) << " would do";
    return text.str();
  }
  std::string alone;
  for (int rule = 0; rule < search.ruleCount(); ++rule) {
    if (!search.solve(pieces, rule).empty()) alone += (alone.empty() ? "" : "; ") + search.describe(rule);
  }
  text << "no order in any number of layers; ";
  if (!alone.empty()) {
    text << "an order exists without any one of these rules: " << alone;
    return text.str();
  }
  text << "no single rule prevents an order:";
  for (int rule = 0; rule < search.ruleCount(); ++rule) text << (rule > 0 ? "; " : " ") << search.describe(rule);
  return text.str();
}

/// Each layer is as thick as its thickest piece.
void stackUp(const Stack& s, const std::vector<int>& layer, double gap, StackPlan* plan) {
  plan->layers = *std::max_element(layer.begin(), layer.end());
  std::vector<double> bottom(plan->layers + 1, 0), thickness(plan->layers + 1, 0);
  for (std::size_t i = 0; i < layer.size(); ++i) {
    thickness[layer[i]] = std::max(thickness[layer[i]], s.pieces[i].thickness);
  }
  for (int k = 1; k <= plan->layers; ++k) bottom[k] = bottom[k - 1] + thickness[k - 1] + gap;
  for (std::size_t i = 0; i < layer.size(); ++i) {
    plan->pieces[i].layer = layer[i];
    plan->pieces[i].z = bottom[layer[i]];
  }
  for (const StackPin& pin : s.pins) {
    PlacedPin placed{pin.name, std::numeric_limits<double>::infinity(), 0, pin.grounded};
    for (const int piece : pin.pieces) {
      placed.low = std::min(placed.low, plan->pieces[piece].z);
      placed.high = std::max(placed.high, plan->pieces[piece].z + s.pieces[piece].thickness);
    }
    if (pin.grounded) placed.low = 0;
    plan->pins.push_back(placed);
  }
}

void demand(bool good, const std::string& what, const std::string& allowed) {
  if (!good) throw common::Error("stack: " + what + "; allowed: " + allowed);
}

void check(const Stack& s) {
  demand(!s.pieces.empty() && s.pieces.size() <= MOST_PIECES, std::to_string(s.pieces.size()) + " pieces", "1 to 8");
  const std::size_t samples = s.pieces[0].ends.size();
  const auto known = [&](int i) { return i >= 0 && i < static_cast<int>(s.pieces.size()); };
  for (const StackPiece& piece : s.pieces) {
    demand(piece.half_width > 0 && piece.thickness > 0, "width or thickness of piece '" + piece.name + "'", "above 0");
    demand(samples > 0 && piece.ends.size() == samples, "samples of piece '" + piece.name + "'", "as many as others");
    for (const auto& line : piece.ends) {
      demand(line[0].allFinite() && line[1].allFinite(), "a place of piece '" + piece.name + "'", "finite");
    }
  }
  for (const StackPin& pin : s.pins) {
    demand(pin.radius > 0, "radius of pin '" + pin.name + "'", "above 0");
    demand(pin.place.size() == samples, "samples of pin '" + pin.name + "'", "as many as others");
    demand(!pin.pieces.empty() && std::all_of(pin.pieces.begin(), pin.pieces.end(), known),
           "pieces of pin '" + pin.name + "'", "numbers of pieces");
    for (const Vector2d& p : pin.place) demand(p.allFinite(), "a place of pin '" + pin.name + "'", "finite");
  }
  for (const auto& [i, j] : s.fixed) demand(known(i) && known(j) && i != j, "fixed pieces", "two different pieces");
}

}  // namespace

const PlacedPiece* StackPlan::find(const std::string& name) const {
  for (const PlacedPiece& piece : pieces) {
    if (found && piece.name == name) return &piece;
  }
  return nullptr;
}

StackPlan planStack(const Stack& stack, const WingStackSettings& settings) {
  settings.validate();
  check(stack);
  StackPlan plan;
  for (const StackPiece& piece : stack.pieces) plan.pieces.push_back({piece.name});
  findMeetings(stack, settings.clearance, &plan);
  Search search(stack, plan);
  const std::vector<int> layer = search.fewest(settings.most_layers);
  plan.found = !layer.empty();
  if (plan.found) {
    stackUp(stack, layer, settings.gap, &plan);
  } else {
    plan.message = reasonFor(search, settings.most_layers, static_cast<int>(stack.pieces.size()));
  }
  return plan;
}

}  // namespace snapwing::design
