#include "snapwing/design/wing/wing_outcome.h"

#include <cmath>
#include <filesystem>
#include <memory>

#include "snapwing/common/error.h"
#include "snapwing/common/provenance.h"
#include "snapwing/design/design_program.h"
#include "snapwing/design/wing/wing_parts.h"

namespace snapwing::design {

namespace {

LinkageFactory elasticRung(WingRung rung, const WingBars& bars) {
  return rung == WingRung::SOLIDS ? solidRung(bars) : beamRung(bars);
}

/// Elastic bars over the table's travel fill the stored energy.
RungComparison compare(const WingBars& bars, const FourBar& linkage, WingRung rung, WingTable* table) {
  RungComparison comparison = compareRungs(*elasticRung(rung, bars)(linkage), table->arm_rotation);
  if (!comparison.converged) {
    table->provenance["stored_energy"] = "none: " + comparison.message;
    return comparison;
  }
  table->stored_energy = comparison.stored_energy;
  table->provenance["stored_energy"] =
      std::string("elastic ") + (rung == WingRung::SOLIDS ? "solids" : "beams") + " with friction at the pins";
  return comparison;
}

bool meetsTargets(const WingDesign& d) {
  bool met = d.status == WingStatus::DESIGNED;
  for (const WingState& state : d.states) {
    met = met && std::abs(state.rotation_error) <= WING_ROTATION_TOLERANCE && state.tip_residual <= WING_TIP_TOLERANCE;
  }
  return met;
}

/// What follows from layout and table.
void weigh(const WingSettings& s, const vehicle::Vehicle& vehicle, WingOutcome* o) {
  const WingBlade blade(o->layout);
  o->panel_angle = blade.panelAngle();
  o->mass = blade.massAt(*blade.poseAt(0, WingSide::LEFT)).mass;
  const WingTable& t = o->table;
  for (std::size_t i = 1; i < t.travel.size(); ++i) {
    o->friction_work += 0.5 * (t.travel[i] - t.travel[i - 1]) * (t.friction_force[i] + t.friction_force[i - 1]);
  }
  o->clearance = clearanceOf(blade, vehicle);
  o->stack = planStack(stackOf(o->layout), s.stack);
  o->targets_met = meetsTargets(o->design);
}

}  // namespace

WingRung wingRungOf(const std::string& name) {
  for (const WingRung rung : {WingRung::RIGID, WingRung::BEAMS, WingRung::SOLIDS}) {
    if (name == nameOf(rung)) return rung;
  }
  throw common::Error("rung is '" + name + "'; allowed: rigid, elastic, solid");
}

const char* nameOf(WingRung rung) {
  return rung == WingRung::RIGID ? "rigid" : rung == WingRung::BEAMS ? "elastic" : "solid";
}

std::unique_ptr<WingProblem> makeWingProblem(const WingSettings& s, WingRung rung) {
  if (rung == WingRung::RIGID) return std::make_unique<RigidWingProblem>(s);
  return std::make_unique<ElasticWingProblem>(s, elasticRung(rung, s.bars));
}

WingOutcome designWingInto(const WingSettings& s, const WingJob& job) {
  WingOutcome o;
  o.folder = job.folder;
  o.design = designWing(*makeWingProblem(s, job.rung), job.go_on, job.cancelled);
  if (o.design.status != WingStatus::DESIGNED) return o;
  const vehicle::Vehicle vehicle = vehicle::loadVehicle(s.vehicle_file);
  o.layout = layoutOf(s, o.design, vehicle, nameOf(job.rung));
  auto table = tabulate(o.design.linkage, *s.motion, s.motion->travelAt(s.targets[1].arm_rotation), job.points);
  if (!table) throw common::Error("wing table: the loop opens within the travel although the design was accepted");
  o.table = *table;
  o.table.provenance["command"] = std::string("snapwing design wing --rung ") + nameOf(job.rung);
  o.table.provenance["snapwing_version"] = common::version();
  o.table.provenance["settings_sha256"] = common::sha256OfFile(s.file);
  o.comparison = compare(s.bars, o.design.linkage, job.rung, &o.table);
  addBlade(WingBlade(o.layout), *s.motion, &o.table);
  weigh(s, vehicle, &o);
  if (std::filesystem::exists(vehicle.arm.table_file)) {
    o.barrier_back = vehicle::curveFeatures(vehicle::loadForceTable(vehicle.arm.table_file)).barrier_back;
  }
  const std::filesystem::path folder(job.folder);
  common::makeFolder(folder.string());
  saveWing(o.layout, s, o.design, o.stack, (folder / "wing.yaml").string());
  saveParts(o.layout, o.stack, (folder / "parts").string());
  saveWingTable(o.table, (folder / "wing_table.h5").string());
  return o;
}

WingTable tabulateLayout(const WingLayout& layout, const ArmMotion& motion, int points) {
  auto table = tabulate(layout.linkage, motion, motion.travelAt(layout.arm_rotation[1]), points);
  if (!table) throw common::Error("wing '" + layout.name + "': its loop opens within the travel of this arm");
  table->provenance["layout"] = layout.name;
  table->provenance["snapwing_version"] = common::version();
  compare(layout.bars, layout.linkage, wingRungOf(layout.rung), &*table);
  addBlade(WingBlade(layout), motion, &*table);
  return *table;
}

std::string wingHash(const WingSettings& s, WingRung rung) {
  std::string inputs = common::readFile(s.file) + common::readFile(s.vehicle_file) + s.motion->source();
  return common::sha256(inputs + nameOf(rung) + designProgram());
}

std::optional<WingOutcome> loadWingOutcome(const WingSettings& s, const std::string& folder) {
  const std::filesystem::path path(folder);
  if (!std::filesystem::exists(path / "wing.yaml") || !std::filesystem::exists(path / "wing_table.h5")) {
    return std::nullopt;
  }
  WingOutcome o;
  o.folder = folder;
  o.from_store = true;
  o.layout = loadWing((path / "wing.yaml").string());
  o.table = loadWingTable((path / "wing_table.h5").string());
  o.design.linkage = o.layout.linkage;
  assess(s, &o.design);
  const Eigen::Vector2d &X1 = o.layout.linkage.joint1, &X2 = o.layout.linkage.joint2;
  const auto problem = makeWingProblem(s, wingRungOf(o.layout.rung));
  o.design.objective = problem->evaluate({X1.x(), X1.y(), X2.x(), X2.y()}, false).objective;
  weigh(s, vehicle::loadVehicle(s.vehicle_file), &o);
  return o;
}

}  // namespace snapwing::design
