// `snapwing design arm ... --into DIR`: from the design of an arm to a vehicle file with plans, and its validation.
#include "design_into_command.h"

#include <cstdio>

#include "curve_options.h"
#include "snapwing/common/output_file.h"
#include "snapwing/pipeline/validate_vehicle.h"
#include "time_shown.h"

namespace snapwing::tools {

namespace {

using pipeline::StageProgress;
using validation::Verdict;

/// "[3 of 7] wing: ..." on the terminal.
class Shown {
 public:
  explicit Shown(bool quiet) : quiet_(quiet) {}
  void operator()(const StageProgress& p) {
    if (p.what == StageProgress::What::BEGUN) time_ = TimeShown();
    const std::string left = p.what == StageProgress::What::WORKING ? time_.after(p.share) : "";
    if (quiet_) return;
    std::string words = p.words;
    if (p.what == StageProgress::What::KEPT) words = "kept";
    if (p.what == StageProgress::What::DONE) words = "done";
    if (p.what == StageProgress::What::BEGUN && words.empty()) words = "begins";
    std::fprintf(stderr, "[%d of %d] %s: %s%s\n", p.number, p.count, p.stage.c_str(), words.c_str(), left.c_str());
  }

 private:
  bool quiet_;
  TimeShown time_;
};

void printStages(const pipeline::DesignPipelineResult& result) {
  for (const pipeline::StageResult& s : result.stages) {
    std::printf("%-9s  %s%s", validation::verdictName(s.verdict).c_str(), s.stage.c_str(), s.kept ? " (kept)" : "");
    std::string words = s.words;
    for (std::size_t at = words.find('\n'); at != std::string::npos; at = words.find('\n', at + 1)) {
      words.replace(at, 1, "\n           ");
    }
    std::printf(words.empty()                           ? "\n"
                : words.find('\n') == std::string::npos ? ": %s\n"
                                                        : ":\n           %s\n",
                words.c_str());
  }
}

void checkFiles(const pipeline::DesignPipelineSettings& s) {
  common::OutputFiles files;
  files.reads({s.vehicle_file, s.arm_settings, s.density, s.wing_settings}, "an input");
  for (const char* part : {"", "/design", "/wing"}) files.fills(s.folder + part, "--into");
  for (const char* name : {"vehicle.yaml", "plan_f_to_q.json", "plan_q_to_f.json", "design/density.csv",
                           "design/body.csv", "design/table.h5", "wing/wing.yaml", "wing/wing_table.h5"}) {
    files.writes(s.folder + "/" + name, "--into");
  }
}

}  // namespace

int designInto(const pipeline::DesignPipelineSettings& settings, const ValidationOptions& options, bool quiet) {
  checkFiles(settings);
  const InterruptGuard guard;
  pipeline::DesignPipelineHooks hooks;
  Shown shown(quiet);
  hooks.progress = [&shown](const StageProgress& p) { shown(p); };
  hooks.warning = [](const std::string& text) {
    std::fprintf(stderr, "snapwing design arm: warning: %s\n", text.c_str());
  };
  hooks.cancelled = InterruptGuard::interrupted;
  const pipeline::DesignPipelineResult result = pipeline::designPipeline(settings, hooks);
  printStages(result);
  if (result.cancelled) {
    std::fprintf(stderr, "stopped; the same command resumes after the stages that are done\n");
    return 1;
  }
  const Verdict verdict = result.verdict();
  const char* word = verdict == Verdict::PASS ? "passed" : verdict == Verdict::UNDECIDED ? "NOT decided" : "NOT passed";
  std::printf("%s: %s", result.vehicle_file.empty() ? settings.folder.c_str() : result.vehicle_file.c_str(), word);
  std::printf(result.report_file.empty() ? "\n" : "; %s\n", result.report_file.c_str());
  if (verdict == Verdict::UNDECIDED) options.printRemedy();
  return pipeline::exitCodeOf(verdict);
}

}  // namespace snapwing::tools
