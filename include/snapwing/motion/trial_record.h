#pragma once
/// What a trial leaves behind: series as CSV and HDF5, and a checkpoint from which a stopped run goes on with the same
/// bits. All written whole or not at all: a killed run leaves the last complete record.

#include <map>
#include <string>
#include <vector>

#include "snapwing/common/checkpoint_bytes.h"
#include "snapwing/motion/axis_trial.h"

namespace snapwing::motion {

/// One row a step; the header names the units.
std::string seriesCsv(const std::vector<AxisSample>& samples);
/// The same columns as datasets with units, the static curve of all arms with rotation and inertia beside them, and
/// where it came from. @throws common::FileError
void saveSeries(const std::vector<AxisSample>& samples, const TrialVehicle& vehicle,
                const std::map<std::string, std::string>& provenance, const std::string& path);

/// @param hash  of all that the run depends on. @throws common::FileError
void saveTrialCheckpoint(const AxisRun& run, const std::string& hash, const std::string& path);
/// @throws common::OtherProgramError if another build of the solver wrote it
/// @throws common::FileError if it is damaged or belongs to another trial
AxisRun loadTrialCheckpoint(const std::string& path, const std::string& hash);

}  // namespace snapwing::motion
