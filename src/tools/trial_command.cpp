// `snapwing trial`: one pulse on the vehicle, computed on the rung that the trial's file names.
#include <sys/resource.h>

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <memory>

#include "commands.h"
#include "curve_options.h"
#include "numbers.h"
#include "prediction_text.h"
#include "snapwing/common/checkpoint_bytes.h"
#include "snapwing/common/error.h"
#include "snapwing/common/folder_lock.h"
#include "snapwing/common/json_text.h"
#include "snapwing/common/output_file.h"
#include "snapwing/common/program_code.h"
#include "snapwing/common/provenance.h"
#include "snapwing/motion/trial_file.h"
#include "snapwing/motion/trial_record.h"
#include "snapwing/mpm/cell_values.h"
#include "snapwing/rom/lumped_model.h"
#include "snapwing/scene/rung.h"
#include "snapwing/solver/sparse.h"
#include "snapwing/validation/kept_results.h"
#include "snapwing/validation/prediction_json.h"
#include "snapwing/vehicle/motion_columns.h"
#include "snapwing/vehicle/table_origin.h"
#include "trial_bag_call.h"
#include "trial_frames.h"
#include "trial_progress.h"

namespace snapwing::tools {

namespace {

using nlohmann::ordered_json;

struct Options {
  std::string file, folder;
  int threads = 1;
  double vtu_every = 0;  // [s]
  bool quiet = false, vtu = false, bag = false, unless_done = false;
};

const char HERE = 0;  // in this program, whose code counts for what is kept of ended trials

/// A trial with what it names, and the files that it writes.
struct Work {
  /// @param asked  the trial that its file states, or one of its repeats; @param into  where its files go
  Work(const Options& given, motion::TrialFile asked, std::string into)
      : options(given),
        folder(std::move(into)),
        file(std::move(asked)),
        vehicle(vehicle::loadVehicle(file.vehicle_file)),
        table(vehicle::armTableOf(vehicle)) {
    file.trial.mount = vehicle::mountFor(vehicle, file.mount, "mount");
    vehicle::Trial checked = file.trial;
    if (file.six) checked.wings = false;  // the space vehicle has the boom's turning, and says itself what it refuses
    checked.validate();
    parameters = vehicle::realise(vehicle, table, file.box);
    idle = vehicle::thrustFraction(parameters.quadratic_share, vehicle.radio, 0);
    fraction = fractionOf(file.pulse);
    common::OutputFiles files;
    files.reads({file.file, vehicle.file, vehicle.arm.density_file, vehicle.arm.table_file}, "a file of the trial");
    if (vehicle.hasWing()) files.reads({vehicle.wing.layout_file, vehicle.wing.table_file}, "a file of the wing");
    files.fills(folder, "--output");
    for (const char* name : {"series.csv", "series.h5", "summary.json", "checkpoint.bin"}) {
      files.writes(path(name), "--output");
    }
  }
  /// Steady thrust of a level / full thrust.
  double fractionOf(const motion::TrialLevel& level) const {
    if (level.throttle < 0) return level.thrust;
    return vehicle::thrustFraction(parameters.quadratic_share, vehicle.radio, level.throttle);
  }
  std::string path(const std::string& name) const { return folder + "/" + name; }
  std::string hash() const {
    return common::sha256(file.name + ";" + file.sha256 + ";" + vehicle.sha256 + ";" +
                          common::sha256OfFile(vehicle.arm.density_file) + ";" +
                          common::sha256OfFile(vehicle.arm.table_file) + wings());
  }
  std::string wings() const {
    if (!vehicle.hasWing()) return "";
    return ";" + common::sha256OfFile(vehicle.wing.layout_file) + ";" + common::sha256OfFile(vehicle.wing.table_file);
  }

  const Options& options;
  std::string folder;
  motion::TrialFile file;
  vehicle::Vehicle vehicle;
  vehicle::ForceTable table;
  vehicle::VehicleParameters parameters;
  double idle = 0, fraction = 0;
};

double cpuSeconds() {
  rusage use{};
  getrusage(RUSAGE_SELF, &use);
  return use.ru_utime.tv_sec + use.ru_stime.tv_sec + 1e-6 * (use.ru_utime.tv_usec + use.ru_stime.tv_usec);
}

ordered_json levelJson(const Work& work, const motion::TrialLevel& level) {
  return {{"thrust_fraction", work.fractionOf(level)},
          {"throttle", level.throttle < 0 ? std::nan("") : level.throttle},
          {"duration", level.duration}};
}

ordered_json headOf(const Work& work) {
  ordered_json then = ordered_json::array();
  for (const motion::TrialLevel& level : work.file.then) then.push_back(levelJson(work, level));
  return {{"trial", work.file.name},
          {"trial_file", work.file.file},
          {"trial_sha256", work.file.sha256},
          {"inputs", validation::inputsJson(work.vehicle, work.vehicle.arm.table_file)},
          {"rung", motion::rungName(work.file.rung)},
          {"surroundings", validation::trialJson(work.file.trial)},
          {"pulse", levelJson(work, work.file.pulse)},
          {"then", then}};
}

void writeSummary(const Work& work, const ordered_json& summary) {
  common::writeFileAtomically(work.path("summary.json"), common::jsonText(summary));
}

/// What the rung of tables does not know of a vehicle.
std::vector<std::string> leftOutByTables(const vehicle::Vehicle& vehicle) {
  std::vector<std::string> out{"modes of the arms beside the travel, motion across the thrust axis"};
  const bool known = !vehicle.material.relaxation.terms.empty();
  out.push_back(std::string("memory of the material") +
                (known ? ", which the vehicle file states (material.relaxation)" : "") +
                ": the table's modulus holds for a slow curve, a snap and a rest");
  if (vehicle::loadMotionColumns(vehicle.arm.table_file)) {
    out.emplace_back(
        "effective mass and damping that trials have taught the table: the static path's inertia and the vehicle "
        "file's damping instead");
  }
  return out;
}

int runLumped(const Work& work) {
  const rom::LumpedModel model = rom::LumpedModel::fromVehicle(work.vehicle, work.table, work.parameters, {},
                                                               vehicle::wingTableOf(work.vehicle, work.table));
  std::vector<motion::AxisSample> samples;
  const auto observer = [&](const rom::LumpedState& s) {
    motion::AxisSample& sample = samples.emplace_back();
    sample.time = s.time, sample.travel = s.travel, sample.travel_rate = s.travelRate();
    sample.ring_position = s.position, sample.ring_speed = s.ring_speed, sample.centre_speed = s.centre_speed;
    sample.thrust = s.thrust;
    return true;
  };
  const rom::SnapPrediction prediction =
      model.predict(work.file.start, work.fraction, work.file.pulse.duration, work.file.trial, observer);
  common::writeFileAtomically(work.path("series.csv"), motion::seriesCsv(samples));
  ordered_json summary = headOf(work);
  summary["outcome"] = validation::predictionJson(prediction);
  const std::vector<std::string> left_out = leftOutByTables(work.vehicle);
  summary["model"] = {{"left_out", left_out}};
  writeSummary(work, summary);
  std::printf("%s: %s\n", work.file.name.c_str(), predictionLine(prediction).c_str());
  for (const std::string& what : left_out) std::printf("left out: %s\n", what.c_str());
  return prediction.end_mode == vehicle::Mode::UNKNOWN ? 1 : 0;
}

ordered_json motionJson(const motion::AxisOutcome& o) {
  ordered_json json = validation::outcomeJson(o);
  json.update({{"largest_imbalance", o.largest_imbalance},
               {"largest_strain", o.largest_strain},
               {"largest_mean_strain", o.largest_mean_strain},
               {"steps", o.steps},
               {"iterations", o.iterations},
               {"factorizations", o.factorizations}});
  return json;
}

ordered_json barJson(const solver::RigidMass& mass) {
  return {{"mass", mass.mass},
          {"first_moment", {mass.first(0), mass.first(1)}},
          {"second_moment", mass.second.topLeftCorner<2, 2>().trace()}};
}

/// Of one wing, about the axle in the frame of the wing's table. [m], [kg], [kg m], [kg m2], [N m]
ordered_json linkageJson(const motion::WingLinkage& w, const motion::AxisSettings& axis) {
  const auto point = [](const Eigen::Vector2d& x) { return ordered_json{x(0), x(1)}; };
  return {{"auxiliary", point(w.auxiliary())},
          {"joint1", point(w.joint1())},
          {"joint2", point(w.joint2())},
          {"crank", barJson(w.mass(motion::WingLinkage::CRANK))},
          {"wing", barJson(w.mass(motion::WingLinkage::WING))},
          {"rocker", barJson(w.mass(motion::WingLinkage::ROCKER))},
          {"friction_left", axis.friction_left * w.frictionMoment(true)},
          {"friction_right", axis.friction_right * w.frictionMoment(false)},
          {"fold_bias", axis.wing_forces.fold_bias},
          {"fold_stop", axis.wing_forces.fold_stop},
          {"air", axis.wing_forces.air},
          {"blade_error", w.bladeError()},
          {"follow", axis.wings_follow_travel ? "travel" : "arm"}};
}

/// What any other code needs beside the static curve to do the same.
ordered_json bodiesJson(const Work& work, const motion::TrialVehicle& vehicle) {
  const vehicle::VehicleParameters& p = work.parameters;
  const motion::WingLinkage* wing = vehicle.linkage();
  const double wings = wing != nullptr ? 2 * wing->totalMass() : 0;
  const bool boom = work.file.trial.mount == vehicle::Mount::BOOM;
  return {{"ring_mass", p.ring_mass - vehicle.armMass() - wings + (boom ? p.boom_mass : 0)},
          {"centre_mass", p.centre_mass},
          {"arms_mass", vehicle.armMass()},
          {"ring_drag", p.ring_drag + (boom ? p.boom_drag : 0)},
          {"centre_drag", p.centre_drag},
          {"ring_friction", boom ? p.boom_friction : 0.0},
          {"damping_of_travel", p.damping},
          {"max_thrust", p.max_thrust},
          {"idle_fraction", work.idle},
          {"latency", p.latency},
          {"time_constant_up", p.time_constant_up},
          {"time_constant_down", p.time_constant_down}};
}

ordered_json modelJson(const Work& work, const motion::TrialVehicle& vehicle) {
  const motion::TrialFile& f = work.file;
  const motion::StaticCurve& curve = vehicle.curve();
  return {
      {"freedom", f.six ? "six" : "axis"},
      {"cells", vehicle.cellCount()},
      {"free_coordinates", vehicle.freeCount()},
      {"kernel", scene::kernelName(f.axis.kernel)},
      {"cell_size", f.axis.cell_size},
      {"coarsening", mpm::coarseningName(f.axis.coarsening)},
      {"scheme", motion::schemeName(f.scheme)},
      {"largest_step", f.steps.largest_step},
      {"step_error", f.steps.error},
      {"damping", motion::dampingName(f.axis.damping)},
      {"bodies", bodiesJson(work, vehicle)},
      {"linkage",
       vehicle.linkage() != nullptr ? linkageJson(*vehicle.linkage(), work.file.axis) : ordered_json(nullptr)},
      {"strain_radius", mpm::STRAIN_RADIUS},
      {"strain_limit", work.vehicle.material.strain_limit ? work.vehicle.material.strain_limit->low() : std::nan("")},
      {"static_barrier", curve.barrier()},
      {"static_valley_force", vehicle.valleyForce()},
      {"static_second_equilibrium", curve.second()},
      {"kept", vehicle.kept()},
      {"left_out", vehicle.leftOut()}};
}

void writeRecord(const Work& work, const motion::TrialVehicle& vehicle, const motion::AxisRun& run,
                 const ordered_json& summary) {
  common::writeFileAtomically(work.path("series.csv"), motion::seriesCsv(run.samples));
  motion::saveSeries(run.samples, vehicle,
                     {{"trial", work.file.name},
                      {"trial_sha256", work.file.sha256},
                      {"vehicle_sha256", work.vehicle.sha256},
                      {"rung", motion::rungName(work.file.rung)},
                      {"snapwing_version", common::version()}},
                     work.path("series.h5"));
  if (work.options.vtu) common::writeFileAtomically(work.path("end.vtu"), vehicle.vtu(run.state));
  writeSummary(work, summary);
}

void printStrain(const motion::AxisOutcome& o, const std::optional<common::Quantity>& limit) {
  std::printf("largest mean strain of the arms within %g mm %.3g on these cells", 1e3 * mpm::STRAIN_RADIUS,
              o.largest_mean_strain);
  if (limit) {
    std::printf(", %s the material's strain limit of %.3g for a single load; fatigue life unknown",
                o.largest_mean_strain <= limit->low() ? "below" : "ABOVE", limit->low());
  } else {
    std::printf("; the material's strain limit is unknown (material.strain_limit)");
  }
  std::printf("; largest of a cell, in a notch, %.3g: grows with smaller cells\n", o.largest_strain);
}

void printOutcome(const Work& work, const motion::AxisRun& run, double cpu) {
  const motion::AxisOutcome& o = run.outcome;
  std::printf("%s, %s rung: from %s ", work.file.name.c_str(), motion::rungName(work.file.rung).c_str(),
              vehicle::modeName(o.start_mode).c_str());
  if (o.end_mode == vehicle::Mode::UNKNOWN) {
    std::printf("to no settled mode within the horizon");
  } else {
    std::printf("%s %s", o.snapped ? "switched to" : "stayed in", vehicle::modeName(o.end_mode).c_str());
  }
  if (std::isfinite(o.snap_time)) std::printf(", last crossed the barrier at %.2f ms", 1e3 * o.snap_time);
  std::printf("; travel %.2f .. %.2f mm; scheme's imbalance at most %.2g mJ\n", 1e3 * o.least_travel,
              1e3 * o.peak_travel, 1e3 * o.largest_imbalance);
  std::printf("%d steps, %d iterations, %d factorizations, %.2f CPU seconds\n", o.steps, o.iterations, o.factorizations,
              cpu);
  printStrain(o, work.vehicle.material.strain_limit);
  if (!o.start_held) std::printf("note: the start mode is not an equilibrium under the loads before the pulse\n");
}

std::unique_ptr<const motion::TrialVehicle> vehicleOf(const Work& work, const vehicle::Trial& surroundings,
                                                      const motion::AxisSettings& axis) {
  if (work.file.six) {
    return std::make_unique<const motion::SpaceVehicle>(work.vehicle, work.parameters, surroundings, axis,
                                                        work.file.space,
                                                        vehicle::wingTableOf(work.vehicle, work.table));
  }
  return std::make_unique<const motion::AxisVehicle>(work.vehicle, work.parameters, surroundings, axis,
                                                     vehicle::wingTableOf(work.vehicle, work.table));
}

int runSolid(const Work& work) {
  const double cpu_before = cpuSeconds(), clock_before = solver::secondsNow();
  motion::AxisSettings axis = work.file.axis;
  axis.threads = work.options.threads;
  vehicle::Trial surroundings = work.file.trial;
  surroundings.wings = rom::wingsAct(work.file.trial, work.vehicle.hasWing());
  const std::unique_ptr<const motion::TrialVehicle> made = vehicleOf(work, surroundings, axis);
  const motion::TrialVehicle& vehicle = *made;
  const double cpu_of_vehicle = cpuSeconds() - cpu_before;
  motion::AxisTrial trial = motion::AxisTrial::of(work.file.start, work.fraction, work.file.pulse.duration,
                                                  work.parameters, work.idle, work.file.trial);
  for (const motion::TrialLevel& level : work.file.then) trial.then.push_back({work.fractionOf(level), level.duration});
  motion::Stepper stepper(vehicle.problem(), motion::Scheme(work.file.scheme, work.file.points, work.file.bias),
                          work.file.steps, vehicle.rigidMotions());
  motion::AxisRun run;
  const std::string checkpoint = work.path("checkpoint.bin"), owner = work.hash();
  if (std::filesystem::exists(checkpoint)) {
    try {
      run = motion::loadTrialCheckpoint(checkpoint, owner);
      std::fprintf(stderr, "resuming at %.4f s from %s\n", run.state.time, checkpoint.c_str());
    } catch (const common::OtherProgramError& other) {
      std::fprintf(stderr, "snapwing trial: %s; begins anew\n", other.what());
    }
  }
  TrialProgress progress(work.options.quiet, trial.changes().back() + trial.horizon);
  progress.startsAt(run.state.time);
  const InterruptGuard guard;
  motion::AxisRunHooks hooks;
  const TrialFrames frames(vehicle, work.folder, work.options.vtu_every);
  frames.take(run);
  double cpu_of_start = -1;
  hooks.stepped = [&](const motion::AxisRun& now) {
    if (cpu_of_start < 0) cpu_of_start = cpuSeconds() - cpu_before - cpu_of_vehicle;
    frames.take(now);
    progress.show(now);
    return !InterruptGuard::interrupted();
  };
  hooks.keep = [&](const motion::AxisRun& now) { motion::saveTrialCheckpoint(now, owner, checkpoint); };
  const bool ended = motion::runTrial(vehicle, stepper, trial, run, hooks);
  progress.end();
  const double cpu = cpuSeconds() - cpu_before;
  ordered_json summary = headOf(work);
  summary["model"] = modelJson(work, vehicle);
  summary["outcome"] = motionJson(run.outcome);
  summary["ended"] = ended;
  // Phases are timed by the clock: of a busy machine's each gets its share of the CPU.
  const double share = cpu / (solver::secondsNow() - clock_before);
  summary["cpu_seconds"] = {{"all", cpu},
                            {"vehicle", cpu_of_vehicle},
                            {"start", std::max(0.0, cpu_of_start)},
                            {"assembly", share * stepper.secondsAssembly()},
                            {"factor", share * stepper.secondsFactor()},
                            {"solve", share * stepper.secondsSolve()}};
  writeRecord(work, vehicle, run, summary);
  frames.finish(run);
  if (!ended) {
    std::fprintf(stderr, "stopped at %.4f s; the same command resumes from the last checkpoint\n", run.state.time);
    return 1;
  }
  std::filesystem::remove(checkpoint);
  printOutcome(work, run, cpu);
  for (const std::string& what : vehicle.kept()) std::printf("kept: %s\n", what.c_str());
  for (const std::string& what : vehicle.leftOut()) std::printf("left out: %s\n", what.c_str());
  return run.outcome.end_mode == vehicle::Mode::UNKNOWN ? 1 : 0;
}

/// Runs one trial and what follows it. @return its exit code
int runOne(const Work& work, const std::string& bag_program) {
  common::makeFolder(work.folder);
  const common::FolderLock lock(work.folder);
  const int code = work.file.rung == motion::TrialRung::LUMPED ? runLumped(work) : runSolid(work);
  if (!bag_program.empty() && !InterruptGuard::interrupted()) callBagProgram(bag_program, work.folder);
  return code;
}

/// What the tables say of the same trial: least clearance of the barrier, in units of it; NaN where they cannot.
double lumpedMargin(const Work& work) {
  if (!work.file.then.empty()) return std::nan("");
  const rom::LumpedModel model = rom::LumpedModel::fromVehicle(work.vehicle, work.table, work.parameters, {},
                                                               vehicle::wingTableOf(work.vehicle, work.table));
  return model.predict(work.file.start, work.fraction, work.file.pulse.duration, work.file.trial).energy_margin;
}

/// Verdict over all repeats: how many switch, and what is left of each margin.
void printVerdict(const motion::TrialFile& file, const ordered_json& repeats) {
  int switched = 0;
  double least = INFINITY, first = INFINITY, last = -INFINITY, room = INFINITY;
  for (const ordered_json& r : repeats) {
    switched += r["snapped"].get<bool>() ? 1 : 0;
    if (r["lumped_margin"].is_number()) least = std::min(least, r["lumped_margin"].get<double>());
    room = std::min(room, r["room_to_travel_max"].get<double>());
    if (!r["snap_time"].is_number()) continue;
    first = std::min(first, r["snap_time"].get<double>());
    last = std::max(last, r["snap_time"].get<double>());
  }
  std::printf("%s: %d of %d switch", file.name.c_str(), switched, static_cast<int>(repeats.size()));
  if (std::isfinite(first)) std::printf(", last crossing of the barrier at %.1f .. %.1f ms", 1e3 * first, 1e3 * last);
  std::printf("; at least %.1f mm to limits.travel_max", 1e3 * room);
  if (std::isfinite(least)) std::printf("; least margin by the tables %+.2f", least);
  std::printf("\n");
}

/// Row of a trial that has ended before, if this program did it with the same files. Says so if another program did.
std::optional<ordered_json> doneBefore(const validation::KeptResults& kept, const Work& work) {
  const std::string key = work.hash();
  if (std::optional<ordered_json> before = kept.load("done", key)) return before;
  const std::string other = kept.otherProgram("done", key);
  if (!other.empty())
    std::fprintf(stderr, "snapwing trial: %s: %s; computed anew\n", work.folder.c_str(), other.c_str());
  return std::nullopt;
}

bool hasEnded(const ordered_json& summary) { return summary.value("ended", true); }

ordered_json summaryOf(const Work& work) { return ordered_json::parse(common::readFile(work.path("summary.json"))); }

/// A trial of its own, unless it is done.
int runUnlessDone(const Work& work, const std::string& bag_program) {
  const validation::KeptResults kept(work.folder, common::programOf(&HERE));
  if (const std::optional<ordered_json> before = doneBefore(kept, work)) {
    std::printf("%s: done before, by this program and with the same files\n", work.file.name.c_str());
    return before->value("exit_code", 1);
  }
  const int code = runOne(work, bag_program);
  if (hasEnded(summaryOf(work))) kept.save("done", work.hash(), ordered_json{{"exit_code", code}});
  return code;
}

/// Each repeat in a folder of its own, and all of them in summary.json. A repeat that has ended is not run again.
int runRepeats(const Options& options, const motion::TrialFile& file, const std::string& bag_program) {
  ordered_json repeats = ordered_json::array();
  int code = 0;
  for (int k = 0; k < file.repeats && !InterruptGuard::interrupted(); ++k) {
    const motion::TrialFile one = motion::repeatOf(file, k);
    const Work work(options, one, options.folder + "/" + one.name);
    ordered_json row = {{"trial", one.name}, {"exit_code", 0}};
    const validation::KeptResults kept(work.folder, common::programOf(&HERE));
    if (const std::optional<ordered_json> before = doneBefore(kept, work)) {
      row = *before;
    } else {
      row["exit_code"] = runOne(work, bag_program);
      const ordered_json summary = summaryOf(work);
      if (!hasEnded(summary)) return 1;
      row["pulse"] = summary["pulse"];
      for (const char* name : {"end_mode", "snapped", "snap_time", "peak_travel"}) row[name] = summary["outcome"][name];
      row["room_to_travel_max"] = work.vehicle.limits.travel_max - row["peak_travel"].get<double>();
      row["lumped_margin"] = lumpedMargin(work);
      kept.save("done", work.hash(), row);
    }
    code = std::max(code, row["exit_code"].get<int>());
    repeats.push_back(row);
  }
  if (static_cast<int>(repeats.size()) < file.repeats) return 1;
  common::writeFileAtomically(options.folder + "/summary.json",
                              common::jsonText(ordered_json{{"trial", file.name}, {"repeats", repeats}}));
  printVerdict(file, ordered_json::parse(common::jsonText(repeats)));
  return code;
}

}  // namespace

void addTrialCommand(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<Options>();
  CLI::App* command =
      app.add_subcommand("trial", "Simulate one pulse: by tables, by one soft arm in the plane, or as a 3-D solid");
  command->add_option("trial", options->file, "trial file [YAML]")->required();
  command->add_option("-o,--output", options->folder, "folder for series, summary and checkpoint")->required();
  command->add_option("--threads", options->threads, "of assembly; the bits do not depend on it")
      ->check(CLI::Range(1, 256))
      ->capture_default_str();
  command->add_flag("--vtu", options->vtu, "also write the deformed arm at the end, for ParaView");
  command
      ->add_option("--vtu-every", options->vtu_every, "a deformed arm every so often [s], and trial.pvd for ParaView")
      ->check(realNumber(1e-4, 10, "s"));
  command->add_flag("--bag", options->bag,
                    "also write run.bag for rviz and Foxglove: frames, markers, joint states (needs a build with ROS)");
  command->add_flag("--unless-done", options->unless_done,
                    "leave the trial as it is if this program has ended it before with the same files");
  command->add_flag("-q,--quiet", options->quiet, "No progress");
  command->footer(
      "Exit code: 0 settled in F or Q, 1 not settled or stopped, 2 bad input. The same command goes on "
      "with a run that was stopped.");
  command->callback([options, &exit_code] {
    const motion::TrialFile file = motion::loadTrial(options->file);
    if (file.rung == motion::TrialRung::LUMPED && (options->vtu || options->vtu_every > 0)) {
      throw common::Error("--vtu: the rung is lumped and has no arm to draw; allowed: with rung planar or volumetric");
    }
    const std::string bag_program = options->bag ? bagProgram() : "";
    const InterruptGuard guard;
    const auto one = options->unless_done ? runUnlessDone : runOne;
    exit_code = file.repeats > 1 ? runRepeats(*options, file, bag_program)
                                 : one(Work(*options, file, options->folder), bag_program);
  });
}

}  // namespace snapwing::tools
