/// link_command: an operator's commands to flight_link_node, sealed with the link's key: arm, disarm, reset, abort, or
/// one pulse. Exit code 0 only if the bridge confirmed.

#include <ros/callback_queue.h>
#include <ros/init.h>
#include <ros/node_handle.h>
#include <ros/service.h>
#include <snapwing/Arm.h>
#include <snapwing/LinkStatus.h>
#include <snapwing/PulseCommand.h>
#include <snapwing/ResetLink.h>
#include <std_srvs/Trigger.h>

#include <CLI/CLI.hpp>
#include <cstdio>

#include "conversions.h"
#include "seal_conversions.h"
#include "snapwing/common/error.h"
#include "snapwing/link/clock.h"
#include "snapwing/vehicle/pulse.h"
#include "topics.h"

namespace snapwing::nodes {
namespace {

struct Options {
  std::string what, key_file, vehicle_id = link::DEFAULT_VEHICLE_ID, name_space;
  double timeout = 3.0;
  std::uint32_t pulse_id = 0;
  vehicle::Pulse pulse;
};

class Commander {
 public:
  explicit Commander(const Options& options) : options_(options), nh_(options.name_space) {
    subscriber_ = nh_.subscribe<LinkStatus>(
        topics::LINK_STATUS, 1, [this](const LinkStatus::ConstPtr& message) { heard_ = message; }, {},
        ros::TransportHints().tcpNoDelay());
  }

  int run() {
    if (options_.what == "abort") return call<std_srvs::Trigger>("abort", {});
    if (options_.what == "disarm") return call<Arm>(topics::ARM, {});
    const std::string key_file =
        options_.key_file.empty() ? link::defaultKeyFile(options_.vehicle_id) : options_.key_file;
    const link::CommandSealer sealer(link::loadKeyFile(key_file), options_.vehicle_id);
    if (options_.what == "pulse") return pulse(sealer);
    if (options_.what == "arm") {
      waitForService(topics::ARM);
      Arm arm;
      arm.request.data = true;
      arm.request.seal = sealed(sealer, link::armContent(true));
      return call(topics::ARM, arm);
    }
    waitForService(topics::RESET_LINK);
    ResetLink reset;
    reset.request.seal = sealed(sealer, link::resetContent());
    return call(topics::RESET_LINK, reset);
  }

 private:
  void waitForService(const std::string& name) {
    if (ros::service::waitForService(nh_.resolveName(name), ros::Duration(options_.timeout))) return;
    throw common::Error("no service " + nh_.resolveName(name) +
                        ": does flight_link_node run, and under this namespace?");
  }

  /// With the newest status, and not with one that lay in the queue.
  Seal sealed(const link::CommandSealer& sealer, const std::string& content) {
    const double end = link::monotonicSeconds() + options_.timeout;
    while (heard_ == nullptr && link::monotonicSeconds() < end && ros::ok()) {
      ros::getGlobalCallbackQueue()->callAvailable(ros::WallDuration(0.02));
    }
    ros::getGlobalCallbackQueue()->callAvailable();
    if (heard_ == nullptr) throw common::Error("no link status on " + nh_.resolveName(topics::LINK_STATUS));
    if (heard_->vehicle_id != options_.vehicle_id) {
      throw common::Error("the link status is of vehicle '" + heard_->vehicle_id + "', not of '" + options_.vehicle_id +
                          "'");
    }
    return toMessage(sealer.seal(content, heard_->session, heard_->number));
  }

  int pulse(const link::CommandSealer& sealer) {
    ros::Publisher publisher = nh_.advertise<PulseCommand>(topics::COMMAND_PULSE, 1);
    const double end = link::monotonicSeconds() + options_.timeout;
    while (publisher.getNumSubscribers() == 0 && link::monotonicSeconds() < end) ros::WallDuration(0.01).sleep();
    PulseCommand command;
    command.header.stamp = ros::Time::now();
    command.id = options_.pulse_id;
    command.pulse = toMessage(options_.pulse);
    command.seal = sealed(sealer, link::pulseContent(command.id, shapeOf(command)));
    if (heard_->pulse_id >= command.id) {
      return report(false, "its id is not above " + std::to_string(heard_->pulse_id) + ", that of the last pulse");
    }
    publisher.publish(command);
    while (link::monotonicSeconds() < end && ros::ok() && heard_->pulse_id != command.id) {
      ros::getGlobalCallbackQueue()->callAvailable(ros::WallDuration(0.02));
    }
    return report(heard_->pulse_id == command.id, heard_->pulse_id == command.id ? "taken" : "not taken");
  }

  template <class Service>
  int call(const std::string& name, Service service) {
    waitForService(name);
    if (!ros::service::call(nh_.resolveName(name), service)) throw common::Error("the call of " + name + " failed");
    return report(service.response.success != 0, service.response.message);
  }

  int report(bool success, const std::string& message) {
    std::printf("%s: %s%s\n", options_.what.c_str(), success ? "" : "refused: ", message.c_str());
    return success ? 0 : 1;
  }

  Options options_;
  ros::NodeHandle nh_;
  ros::Subscriber subscriber_;
  LinkStatus::ConstPtr heard_;
};

int run(int argc, char** argv) {
  ros::init(argc, argv, "link_command", ros::init_options::AnonymousName | ros::init_options::NoSigintHandler);
  CLI::App app{"Operator's commands to flight_link_node, sealed with the link's key"};
  Options options;
  app.add_option("--vehicle", options.vehicle_id, "id of the vehicle (bringup's robot_name)")->capture_default_str();
  app.add_option("--key-file", options.key_file, "key of the link; default ~/.ros/snapwing_link_ID.key");
  app.add_option("--namespace", options.name_space, "of flight_link_node's topics; default /ID");
  app.add_option("--timeout", options.timeout, "for node and status to be there [s]")->check(CLI::Range(0.1, 60.0));
  app.require_subcommand(1);
  for (const char* name : {"arm", "disarm", "reset", "abort"}) app.add_subcommand(name);
  CLI::App* pulse = app.add_subcommand("pulse", "bench only: one thrust pulse");
  pulse->add_option("id", options.pulse_id, "above that of every pulse before")->required();
  pulse->add_option("throttle", options.pulse.throttle, "[1]")->required();
  pulse->add_option("seconds", options.pulse.duration, "[s]")->required();
  pulse->add_option("hold_throttle", options.pulse.hold_throttle, "behind it [1]");
  pulse->add_option("hold_seconds", options.pulse.hold_duration, "how long [s]");
  try {
    app.parse(argc, argv);
    options.what = app.get_subcommands().front()->get_name();
    if (options.name_space.empty()) options.name_space = "/" + options.vehicle_id;
    return Commander(options).run();
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "link_command: %s\n", error.what());
    return 2;
  }
}

}  // namespace
}  // namespace snapwing::nodes

int main(int argc, char** argv) { return snapwing::nodes::run(argc, argv); }
