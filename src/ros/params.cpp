#include "params.h"

#include <ros/console.h>

#include <cmath>
#include <sstream>

#include "snapwing/common/error.h"
#include "snapwing/common/plain_text.h"

namespace snapwing::nodes {

namespace {

/// Keys that libraries inside a node read by themselves.
const std::set<std::string> LIBRARY_KEYS = {"diagnostic_period", "diagnostic_updater", "tcp_nodelay"};

std::string rangeText(const common::Range& range, const std::string& unit) {
  std::ostringstream out;
  out << "a number within [" << common::toText(range.low) << ", " << common::toText(range.high) << "] " << unit
      << " (written like 1.0e-3, not 1e-3)";
  return out.str();
}

}  // namespace

Params Params::fromServer(const ros::NodeHandle& private_handle) {
  XmlRpc::XmlRpcValue tree;
  private_handle.getParam(private_handle.getNamespace(), tree);
  return Params(tree, private_handle.getNamespace());
}

Params::Params(const XmlRpc::XmlRpcValue& tree, std::string where) : tree_(tree), where_(std::move(where)) {
  if (tree_.valid() && tree_.getType() != XmlRpc::XmlRpcValue::TypeStruct) {
    throw common::SettingError(where_, "", "", "a map of parameters");
  }
}

bool Params::present(const std::string& key) {
  asked_.insert(key);
  return tree_.valid() && tree_.hasMember(key);
}

void Params::fail(const std::string& key, const std::string& allowed) const {
  std::ostringstream value;
  if (tree_.valid() && tree_.hasMember(key)) {
    XmlRpc::XmlRpcValue found = tree_[key];
    if (found.getType() == XmlRpc::XmlRpcValue::TypeDouble) {
      value << common::toText(static_cast<double&>(found));  // its own output has six decimals
    } else {
      value << found;
    }
  }
  throw common::SettingError(where_, where_ + "/" + key, value.str(), allowed);
}

template <class Value>
Value Params::noted(const std::string& key, Value value, bool is_default) {
  std::ostringstream line;
  line << std::boolalpha << key << ": " << value << (is_default ? " (default)" : "") << "\n";
  summary_ += line.str();
  return value;
}

double Params::readNumber(const std::string& key, const common::Range& range, const std::string& unit) {
  XmlRpc::XmlRpcValue value = tree_[key];
  double number = std::nan("");
  if (value.getType() == XmlRpc::XmlRpcValue::TypeDouble) number = static_cast<double&>(value);
  if (value.getType() == XmlRpc::XmlRpcValue::TypeInt) number = static_cast<int&>(value);
  if (!(number >= range.low && number <= range.high)) fail(key, rangeText(range, unit));
  return number;
}

int Params::readInteger(const std::string& key, int low, int high) {
  XmlRpc::XmlRpcValue value = tree_[key];
  const std::string allowed = "an integer within [" + std::to_string(low) + ", " + std::to_string(high) + "]";
  if (value.getType() != XmlRpc::XmlRpcValue::TypeInt) fail(key, allowed);
  const int number = static_cast<int&>(value);
  if (number < low || number > high) fail(key, allowed);
  return number;
}

bool Params::readBoolean(const std::string& key) {
  XmlRpc::XmlRpcValue value = tree_[key];
  if (value.getType() != XmlRpc::XmlRpcValue::TypeBoolean) fail(key, "true or false");
  return static_cast<bool&>(value);
}

std::string Params::readText(const std::string& key) {
  XmlRpc::XmlRpcValue value = tree_[key];
  if (value.getType() != XmlRpc::XmlRpcValue::TypeString) fail(key, "text");
  return static_cast<std::string&>(value);
}

double Params::number(const std::string& key, const common::Range& range, const std::string& unit) {
  if (!present(key)) fail(key, "required: " + rangeText(range, unit));
  return noted(key, readNumber(key, range, unit), false);
}

double Params::numberOr(const std::string& key, double fallback, const common::Range& range, const std::string& unit) {
  const bool given = present(key);
  return noted(key, given ? readNumber(key, range, unit) : fallback, !given);
}

int Params::integer(const std::string& key, int low, int high) {
  if (!present(key)) fail(key, "required: an integer");
  return noted(key, readInteger(key, low, high), false);
}

int Params::integerOr(const std::string& key, int fallback, int low, int high) {
  const bool given = present(key);
  return noted(key, given ? readInteger(key, low, high) : fallback, !given);
}

bool Params::boolean(const std::string& key) {
  if (!present(key)) fail(key, "required: true or false");
  return noted(key, readBoolean(key), false);
}

bool Params::booleanOr(const std::string& key, bool fallback) {
  const bool given = present(key);
  return noted(key, given ? readBoolean(key) : fallback, !given);
}

std::string Params::text(const std::string& key) {
  if (!present(key)) fail(key, "required: text");
  const std::string value = readText(key);
  if (value.empty()) fail(key, "text that is not empty");
  return noted(key, value, false);
}

std::string Params::textOr(const std::string& key, const std::string& fallback) {
  const bool given = present(key);
  return noted(key, given ? readText(key) : fallback, !given);
}

std::string Params::choice(const std::string& key, const std::vector<std::string>& allowed) {
  const std::string value = text(key);
  std::string list = "one of:";
  for (const std::string& word : allowed) {
    if (word == value) return value;
    list += " " + word;
  }
  fail(key, list);
}

vehicle::Vehicle Params::vehicle() { return vehicle::loadVehicle(text("vehicle_file")); }

std::string framePrefix(Params& params, const std::string& name_space) {
  std::string prefix = params.textOr("frame_prefix", "auto");
  if (prefix == "none") return "";
  if (prefix == "auto") prefix = name_space;
  // tf2 refuses frames that begin with a slash.
  const std::size_t begin = prefix.find_first_not_of('/');
  if (begin == std::string::npos) return "";
  return prefix.substr(begin, prefix.find_last_not_of('/') - begin + 1) + "/";
}

void Params::finish() {
  if (tree_.valid()) {
    std::string known;
    for (const std::string& key : asked_) known += " " + key;
    for (const auto& entry : tree_) {
      if (!asked_.count(entry.first) && !LIBRARY_KEYS.count(entry.first)) fail(entry.first, "unknown; known:" + known);
    }
  }
  ROS_INFO_STREAM("parameters of " << where_ << ":\n" << summary_);
}

}  // namespace snapwing::nodes
