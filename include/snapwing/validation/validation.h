#pragma once
/// A vehicle's plans and its arm put to the test on every rung, and the gate that lets it pass or not.

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "snapwing/planning/accident_margins.h"
#include "snapwing/planning/pulse_planner.h"
#include "snapwing/validation/arm_curve.h"
#include "snapwing/validation/check.h"
#include "snapwing/validation/plan_file.h"
#include "snapwing/validation/rung_trial.h"

namespace snapwing::validation {

struct ValidationSettings {
  std::string body;             ///< density file [CSV] of the arm as it was made; empty: the vehicle's
  double planar_cell = 1e-3;    ///< [m]
  bool extrapolate = true;      ///< judge the planar rung on half that size, too, and on the limit of small cells
  double solid_cell = 1.25e-3;  ///< [m] of the volumetric rung; its static curve is traced on half of that, too
  bool volumetric = true;
  int weakest = 2;          ///< vehicles that the planner finds weakest, of each plan
  int samples = 4;          ///< vehicles drawn from the box, of each plan
  int first_sample = 4096;  ///< of the Sobol sequence: beyond what the planner looked at
  double step = 2e-3;       ///< [s]
  int threads = 2;          ///< the result is the same for any number
  /// @throws common::Error naming the member
  void validate() const;
};

enum class TrialRole {
  NOMINAL,
  HALF_STEP,  ///< nominal, with half the step
  CURVE,      ///< nominal, by the lumped model on a soft rung's static curve with the solids' cells
  LIMIT,      ///< the same of the plane with the planar rung's smaller cells, and with half of those
  WEAKEST,
  SAMPLE,
  THRESHOLD,  ///< the shortest pulse that switches the nominal vehicle
  CARRIED,    ///< the heaviest centre that F carries, ring held upright; of no plan
};

struct ValidationTrial {
  std::string name;  ///< one word
  int plan = 0;      ///< index of its plan; -1: of none
  TrialRole role = TrialRole::NOMINAL;
  bool finer = false;  ///< cells of half the size; what it is the twin of has the same name without "_fine"
  RungTrial trial;
  RungOutcome outcome;
};

/// What a validation found, whole.
struct Validation {
  std::vector<PlanFile> plans;
  std::vector<ValidationTrial> trials;
  std::vector<ArmCurve> curves;  ///< of the body, coarser cells first
  std::vector<planning::AccidentMargin> accidents;
  std::vector<Check> checks;
  bool cancelled = false;
  bool passed() const { return !cancelled && validation::passed(checks); }
  bool undecided() const { return !cancelled && validation::undecided(checks); }
};

struct ValidationHooks {
  /// Told before work begins. @param done, all  trials
  std::function<void(int done, int all, const std::string& what)> progress;
  /// Told at most once: results in the folder are computed anew, because another program left them.
  std::function<void(const std::string& why)> note;
  std::function<bool()> cancelled;
  std::string folder;  ///< where results are kept for a resumed run; empty: nowhere
};

/// @param plans  to be tested; empty: one each way is planned first, on the vehicle's default mount
/// @throws common::Error for bad settings, or a `must_survive` that is no known accident
Validation validate(const vehicle::Vehicle& vehicle, const vehicle::ForceTable& table,
                    const std::optional<vehicle::WingTable>& wing, std::vector<PlanFile> plans,
                    const ValidationSettings& settings, const ValidationHooks& hooks = {});

/// The gate's answers for trials that have run; pure.
std::vector<Check> checkTrials(const Validation& found, const vehicle::Vehicle& vehicle);
constexpr char HELD_UPRIGHT[] = "ring held upright in F";  ///< of planning::accidentMargins
bool mustSurvive(const vehicle::Vehicle& vehicle, const std::string& accident);
/// Accidents: those of the file's must_survive gate, the others are reported. @throws common::SettingError for one that
/// is not known, or that states nothing that a vehicle meets, so that it would hold whatever its limit
std::vector<Check> checkAccidents(const std::vector<planning::AccidentMargin>& accidents,
                                  const vehicle::Vehicle& vehicle);
/// What F carries on soft arms with the ring held upright, beside the accident of this name; it gates as that one does.
std::vector<Check> checkCarried(const Validation& found, const vehicle::Vehicle& vehicle);

}  // namespace snapwing::validation
