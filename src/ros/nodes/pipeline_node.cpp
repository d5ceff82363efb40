/// pipeline_node: actions design_vehicle and validate_vehicle, which do what `snapwing design arm ... --into` and
/// `snapwing validate` do. A preempted goal stops cleanly; the same goal, also of another node after this one was
/// killed, goes on.

#include <actionlib/server/simple_action_server.h>
#include <ros/console.h>
#include <snapwing/DesignPipelineAction.h>
#include <snapwing/ValidateVehicleAction.h>

#include <chrono>
#include <filesystem>
#include <functional>
#include <string>

#include "node_main.h"
#include "params.h"
#include "snapwing/common/error.h"
#include "snapwing/pipeline/design_pipeline.h"
#include "snapwing/pipeline/time_left.h"
#include "snapwing/pipeline/validate_vehicle.h"
#include "topics.h"

namespace snapwing::nodes {

namespace {

using validation::Verdict;

double steadySeconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

validation::ValidationSettings readValidation(Params& params) {
  validation::ValidationSettings s;
  s.planar_cell = params.number("cell_size", {1e-4, 0.02}, "m");
  s.extrapolate = params.boolean("two_cell_sizes");
  s.volumetric = params.boolean("volumetric");
  s.solid_cell = params.number("solid_cell_size", {1e-4, 0.02}, "m");
  s.weakest = params.integer("weakest", 0, 500);
  s.samples = params.integer("samples", 0, 10000);
  s.step = params.number("step", {1e-5, 0.02}, "s");
  s.threads = params.integer("threads", 1, 256);
  s.validate();
  return s;
}

void requireAbsolute(const std::string& key, const std::string& path) {
  if (std::filesystem::path(path).is_absolute()) return;
  throw common::Error(key + " is '" + path + "'; allowed: an absolute path, for a node has a folder of its own");
}

template <class Result>
std::uint8_t codeOf(Verdict verdict) {
  static_assert(Result::PASSED == 0 && Result::FAILED == 1 && Result::BAD_INPUT == 2 && Result::UNDECIDED == 3);
  return static_cast<std::uint8_t>(pipeline::exitCodeOf(verdict));
}

const char* wordOf(Verdict verdict) {
  return verdict == Verdict::PASS ? "passed" : verdict == Verdict::UNDECIDED ? "NOT decided" : "NOT passed";
}

std::uint8_t codeOf(pipeline::StageProgress::What what) {
  using What = pipeline::StageProgress::What;
  if (what == What::BEGUN) return DesignPipelineFeedback::BEGUN;
  if (what == What::WORKING) return DesignPipelineFeedback::WORKING;
  return what == What::KEPT ? DesignPipelineFeedback::KEPT : DesignPipelineFeedback::DONE;
}

constexpr char STOPPED[] = "stopped; the same goal resumes";

}  // namespace

class PipelineNode {
 public:
  explicit PipelineNode(Handles& handles) : PipelineNode(handles, Params::fromServer(handles.own)) {}

 private:
  template <class Action>
  using Server = actionlib::SimpleActionServer<Action>;

  PipelineNode(Handles& handles, Params params)
      : validation_(readValidation(params)),
        design_(
            handles.relative, topics::DESIGN_VEHICLE,
            [this](const DesignPipelineGoalConstPtr& goal) {
              serve<DesignPipelineResult>(design_, [&](DesignPipelineResult& result) { design(*goal, result); });
            },
            false),
        validate_(
            handles.relative, topics::VALIDATE_VEHICLE,
            [this](const ValidateVehicleGoalConstPtr& goal) {
              serve<ValidateVehicleResult>(validate_, [&](ValidateVehicleResult& result) { validate(*goal, result); });
            },
            false) {
    params.finish();
    design_.start();
    validate_.start();
  }

  /// Runs in the action server's thread: every error becomes a code.
  template <class Result, class Action>
  void serve(Server<Action>& server, const std::function<void(Result&)>& work) {
    const double begin = steadySeconds();
    Result result;
    try {
      work(result);
    } catch (const common::Error& error) {
      result.code = Result::BAD_INPUT;
      result.message = error.what();
    } catch (const std::exception& error) {
      result.code = Result::ERROR;
      result.message = error.what();
    }
    result.seconds = steadySeconds() - begin;
    if (result.code == Result::PREEMPTED) {
      server.setPreempted(result, result.message);
    } else if (result.code == Result::BAD_INPUT || result.code == Result::ERROR) {
      ROS_WARN_STREAM(result.message);
      server.setAborted(result, result.message);
    } else {
      server.setSucceeded(result, result.message);
    }
  }

  void design(const DesignPipelineGoal& goal, DesignPipelineResult& result) {
    pipeline::DesignPipelineSettings settings;
    settings.vehicle_file = goal.vehicle_file;
    settings.arm_settings = goal.settings_file;
    settings.density = goal.density_file;
    settings.wing_settings = goal.wing_settings_file;
    settings.folder = goal.into;
    settings.threads = validation_.threads;
    settings.validation = validation_;
    requireAbsolute("vehicle_file", goal.vehicle_file);
    requireAbsolute("into", goal.into);
    pipeline::DesignPipelineHooks hooks;
    pipeline::TimeLeft time;
    hooks.progress = [this, &time](const pipeline::StageProgress& p) { tell(p, &time); };
    hooks.warning = [](const std::string& text) { ROS_WARN_STREAM("design_vehicle: " << text); };
    hooks.cancelled = [this] { return design_.isPreemptRequested() || !ros::ok(); };
    const pipeline::DesignPipelineResult answer = pipeline::designPipeline(settings, hooks);
    for (const pipeline::StageResult& stage : answer.stages) {
      result.stages.push_back(stage.stage);
      result.verdicts.push_back(validation::verdictName(stage.verdict));
      result.words.push_back(stage.words);
      result.kept.push_back(stage.kept);
    }
    result.vehicle_file = answer.vehicle_file;
    result.report_file = answer.report_file;
    result.code = answer.cancelled ? static_cast<std::uint8_t>(DesignPipelineResult::PREEMPTED)
                                   : codeOf<DesignPipelineResult>(answer.verdict());
    result.message = answer.cancelled ? STOPPED : wordOf(answer.verdict());
  }

  void tell(const pipeline::StageProgress& p, pipeline::TimeLeft* time) {
    if (p.what == pipeline::StageProgress::What::BEGUN) *time = pipeline::TimeLeft();
    DesignPipelineFeedback feedback;
    feedback.what = codeOf(p.what);
    feedback.stage = static_cast<std::uint32_t>(p.number);
    feedback.stages = static_cast<std::uint32_t>(p.count);
    feedback.name = p.stage;
    feedback.detail = p.words;
    feedback.share = p.share;
    feedback.seconds_left = time->after(p.share, steadySeconds());
    design_.publishFeedback(feedback);
  }

  void validate(const ValidateVehicleGoal& goal, ValidateVehicleResult& result) {
    pipeline::ValidateJob job;
    job.vehicle_file = goal.vehicle_file;
    job.plans = goal.plan_files;
    job.folder = goal.folder;
    job.settings = validation_;
    job.settings.body = goal.body_file;
    job.command = "validate_vehicle " + goal.vehicle_file;
    requireAbsolute("vehicle_file", goal.vehicle_file);
    requireAbsolute("folder", goal.folder);
    pipeline::TimeLeft time;
    job.cancelled = [this] { return validate_.isPreemptRequested() || !ros::ok(); };
    job.note = [](const std::string& why) { ROS_WARN_STREAM("validate_vehicle: " << why); };
    job.progress = [this, &time](int done, int all, const std::string& what) {
      ValidateVehicleFeedback feedback;
      feedback.done = static_cast<std::uint32_t>(done);
      feedback.all = static_cast<std::uint32_t>(all);
      feedback.detail = what;
      feedback.seconds_left = time.after(all > 0 ? static_cast<double>(done) / all : 0, steadySeconds());
      validate_.publishFeedback(feedback);
    };
    const pipeline::VehicleValidation answer = pipeline::validateVehicle(job);
    if (answer.found.cancelled) {
      result.code = ValidateVehicleResult::PREEMPTED;
      result.message = STOPPED;
      return;
    }
    for (const validation::Check& check : answer.found.checks) {
      if (check.verdict == Verdict::FAIL) result.failed.push_back(pipeline::checkLine(check));
      if (check.verdict == Verdict::UNDECIDED) result.undecided.push_back(pipeline::checkLine(check));
      result.passed += check.verdict == Verdict::PASS;
    }
    const Verdict verdict = validation::verdictOf(answer.found.checks);
    result.code = codeOf<ValidateVehicleResult>(verdict);
    result.message = wordOf(verdict);
    result.report_file = answer.report_file;
  }

  validation::ValidationSettings validation_;
  Server<DesignPipelineAction> design_;  ///< last: their threads use all of the above
  Server<ValidateVehicleAction> validate_;
};

}  // namespace snapwing::nodes

int main(int argc, char** argv) {
  return snapwing::nodes::runNode<snapwing::nodes::PipelineNode>(argc, argv, "pipeline_node");
}
