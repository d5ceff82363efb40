#pragma once
/// Strict private parameters of a node: each key must be known, of the right type and within its range. Reading ends
/// with finish(), which refuses whatever nobody asked for and logs the final values once.

#include <ros/node_handle.h>
#include <xmlrpcpp/XmlRpcValue.h>

#include <set>
#include <string>
#include <vector>

#include "snapwing/common/settings_reader.h"
#include "snapwing/vehicle/vehicle.h"

namespace snapwing::nodes {

/// Parameters of one node, read key by key. Every getter throws common::SettingError that names the full key, its
/// value and what is allowed; those without a fallback also when the key is missing.
class Params {
 public:
  /// Copy of everything under the node's private namespace on the parameter server, now.
  static Params fromServer(const ros::NodeHandle& private_handle);
  /// @param tree   a struct of values, or an invalid value for none (tests, no master needed)
  /// @param where  the node's name, e.g. "/wing_state_node"
  Params(const XmlRpc::XmlRpcValue& tree, std::string where);

  /// @param unit  only for messages, e.g. "s"
  double number(const std::string& key, const common::Range& range, const std::string& unit);
  double numberOr(const std::string& key, double fallback, const common::Range& range, const std::string& unit);
  int integer(const std::string& key, int low, int high);
  int integerOr(const std::string& key, int fallback, int low, int high);
  bool boolean(const std::string& key);
  bool booleanOr(const std::string& key, bool fallback);
  std::string text(const std::string& key);
  std::string textOr(const std::string& key, const std::string& fallback);
  /// One of a few words.
  std::string choice(const std::string& key, const std::vector<std::string>& allowed);

  /// The vehicle file that required key `vehicle_file` names. @throws common::FileError, common::SettingError
  vehicle::Vehicle vehicle();

  /// @throws common::SettingError for the first key that no getter asked for; else logs the final values.
  void finish();
  /// "key: value" lines of everything read so far.
  const std::string& summary() const { return summary_; }

 private:
  bool present(const std::string& key);
  [[noreturn]] void fail(const std::string& key, const std::string& allowed) const;
  double readNumber(const std::string& key, const common::Range& range, const std::string& unit);
  int readInteger(const std::string& key, int low, int high);
  bool readBoolean(const std::string& key);
  std::string readText(const std::string& key);
  template <class Value>
  Value noted(const std::string& key, Value value, bool is_default);

  XmlRpc::XmlRpcValue tree_;
  std::string where_;
  std::set<std::string> asked_;
  std::string summary_;
};

/// What stands before the names of a vehicle's tf frames, so that those of two vehicles differ: key `frame_prefix`,
/// auto (the namespace, also if the key is missing), none, or a name. @return with a slash at its end, or empty
std::string framePrefix(Params& params, const std::string& name_space);

}  // namespace snapwing::nodes
