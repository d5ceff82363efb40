// Asks pipeline_node for a design or a validation, shows its progress, and ends with the exit code of the command of
// the same name. SIGINT preempts the goal.

#include <actionlib/client/simple_action_client.h>
#include <ros/init.h>
#include <ros/node_handle.h>
#include <snapwing/DesignPipelineAction.h>
#include <snapwing/ValidateVehicleAction.h>

#include <CLI/CLI.hpp>
#include <atomic>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

#include "snapwing/common/error.h"
#include "topics.h"

namespace snapwing::nodes {
namespace {

constexpr double PATIENCE = 10.0;  // [s] for the node to be there, and to stop
std::atomic<bool> interrupted{false};
void onInterrupt(int) { interrupted = true; }

std::string leftWords(double seconds) {
  if (std::isnan(seconds)) return "";
  char text[40];
  std::snprintf(text, sizeof text, seconds < 90 ? ", about %.0f s left" : ", about %.0f min left",
                seconds < 90 ? seconds : seconds / 60);
  return text;
}

void show(const DesignPipelineFeedback& f) {
  std::string words = f.detail;
  if (f.what == DesignPipelineFeedback::KEPT) words = "kept";
  if (f.what == DesignPipelineFeedback::DONE) words = "done";
  if (f.what == DesignPipelineFeedback::BEGUN && words.empty()) words = "begins";
  const std::string left = f.what == DesignPipelineFeedback::WORKING ? leftWords(f.seconds_left) : "";
  std::printf("[%u of %u] %s: %s%s\n", f.stage, f.stages, f.name.c_str(), words.c_str(), left.c_str());
  std::fflush(stdout);
}

void show(const ValidateVehicleFeedback& f) {
  if (f.all == 0) {
    std::printf("%s\n", f.detail.c_str());
  } else {
    std::printf("%s (%u of %u%s)\n", f.detail.c_str(), f.done, f.all, leftWords(f.seconds_left).c_str());
  }
  std::fflush(stdout);
}

void show(const DesignPipelineResult& r) {
  for (std::size_t k = 0; k < r.stages.size(); ++k) {
    std::printf("%-9s  %s%s: %s\n", r.verdicts[k].c_str(), r.stages[k].c_str(), r.kept[k] ? " (kept)" : "",
                r.words[k].c_str());
  }
  std::printf("%s: %s; %s\n", r.vehicle_file.c_str(), r.message.c_str(), r.report_file.c_str());
}

void show(const ValidateVehicleResult& r) {
  for (const std::string& line : r.failed) std::printf("FAIL  %s\n", line.c_str());
  for (const std::string& line : r.undecided) std::printf("UNDECIDED  %s\n", line.c_str());
  std::printf("%s, %u checks passed; %s\n", r.message.c_str(), r.passed, r.report_file.c_str());
}

template <class Action>
class Client {
 public:
  using Server = actionlib::SimpleActionClient<Action>;
  explicit Client(const std::string& name) : name_(name), server_(name, true) {}

  template <class Goal>
  int ask(const Goal& goal) {
    for (double waited = 0; !server_.waitForServer(ros::Duration(0.2)); waited += 0.2) {
      if (interrupted) return 1;
      if (waited > PATIENCE) throw common::Error("no action " + name_ + ": does pipeline_node run in this namespace?");
    }
    server_.sendGoal(goal, {}, {}, [](const auto& feedback) { show(*feedback); });
    return await();
  }

 private:
  int await() {
    double gone = 0, stopping = 0;
    while (!server_.waitForResult(ros::Duration(0.2))) {
      gone = server_.isServerConnected() ? 0 : gone + 0.2;
      if (interrupted && stopping == 0) server_.cancelGoal();
      if (interrupted) stopping += 0.2;
      if (gone < PATIENCE && stopping < PATIENCE) continue;
      std::fprintf(stderr, "pipeline_node is gone; the same command resumes the run\n");
      return 1;
    }
    const auto result = server_.getResult();
    show(*result);
    return result->code <= 3 ? result->code : 1;
  }

  std::string name_;
  Server server_;
};

std::string absolute(const std::string& path) {
  return path.empty() ? path : std::filesystem::absolute(path).lexically_normal().string();
}

int design(DesignPipelineGoal goal) {
  for (std::string* path :
       {&goal.vehicle_file, &goal.settings_file, &goal.density_file, &goal.wing_settings_file, &goal.into}) {
    *path = absolute(*path);
  }
  return Client<DesignPipelineAction>(topics::DESIGN_VEHICLE).ask(goal);
}

int validate(ValidateVehicleGoal goal) {
  for (std::string* path : {&goal.vehicle_file, &goal.body_file, &goal.folder}) *path = absolute(*path);
  for (std::string& path : goal.plan_files) path = absolute(path);
  if (goal.folder.empty()) {
    goal.folder = (std::filesystem::path(goal.vehicle_file).parent_path() / "validation").string();
  }
  return Client<ValidateVehicleAction>(topics::VALIDATE_VEHICLE).ask(goal);
}

int run(int argc, char** argv) {
  ros::init(argc, argv, "pipeline_client", ros::init_options::AnonymousName | ros::init_options::NoSigintHandler);
  std::signal(SIGINT, onInterrupt);
  CLI::App app{"Asks pipeline_node for a design or a validation, and shows the progress"};
  app.require_subcommand(1);
  DesignPipelineGoal wanted;
  CLI::App* command = app.add_subcommand("design", "from the design of an arm to a vehicle file with plans");
  command->add_option("--vehicle", wanted.vehicle_file, "vehicle file [YAML]")->required();
  command->add_option("--into", wanted.into, "folder of all results")->required();
  command->add_option("--settings", wanted.settings_file,
                      "of the arm; default: arm_design.yaml beside the vehicle file");
  command->add_option("--density", wanted.density_file, "to be checked in place of an optimisation [CSV]");
  command->add_option("--wing", wanted.wing_settings_file, "settings of a new wing");
  ValidateVehicleGoal tested;
  command = app.add_subcommand("validate", "may a vehicle fly its plans?");
  command->add_option("--vehicle", tested.vehicle_file, "vehicle file [YAML]")->required();
  command->add_option("--into", tested.folder, "folder of the report; default: validation beside the vehicle file");
  command->add_option("--plan", tested.plan_files, "plan [JSON], may be given again");
  command->add_option("--body", tested.body_file, "density of the arm as it was made [CSV]");
  try {
    app.parse(argc, argv);
    const ros::NodeHandle node;  // ROS lives as long
    return app.get_subcommands().front()->get_name() == "design" ? design(wanted) : validate(tested);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "pipeline_client: %s\n", error.what());
    return 2;
  }
}

}  // namespace
}  // namespace snapwing::nodes

int main(int argc, char** argv) { return snapwing::nodes::run(argc, argv); }
