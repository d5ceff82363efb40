#pragma once
/// Output of a trial: time series as CSV and HDF5, and a checkpoint from which a stopped run continues with the same
/// bits. Files are written atomically: a killed run leaves the last complete record.

#include <map>
#include <string>
#include <vector>

#include "snapwing/common/checkpoint_bytes.h"
#include "snapwing/motion/axis_trial.h"

namespace snapwing::motion {

/// CSV text, one row per step; the header contains the units.
std::string seriesCsv(const std::vector<AxisSample>& samples);
/// HDF5 file: the same columns as datasets with units, the static curve of all arms with rotation and inertia, and the
/// provenance. @throws common::FileError
void saveSeries(const std::vector<AxisSample>& samples, const TrialVehicle& vehicle,
                const std::map<std::string, std::string>& provenance, const std::string& path);

/// @param hash  of all inputs of the run, 64 digits. @throws common::FileError
void saveTrialCheckpoint(const AxisRun& run, const std::string& hash, const std::string& path);
/// @throws common::OtherProgramError if another build of the solver wrote it
/// @throws common::FileError if the file is missing, damaged or has another hash
AxisRun loadTrialCheckpoint(const std::string& path, const std::string& hash);

}  // namespace snapwing::motion
