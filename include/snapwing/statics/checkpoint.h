#pragma once
/// What a run along a scene's path has reached, kept in a file so that it can go on after an interruption.

#include <string>

#include "snapwing/common/checkpoint_bytes.h"
#include "snapwing/statics/scene_curve.h"

namespace snapwing::statics {

/// Hash of all that the points of a scene's path depend on; `more` adds settings that are not in the scene.
std::string traceHash(const scene::Scene& scene, const std::string& more);

/// Replaces the file in one step. @throws common::FileError
void saveCheckpoint(const SceneCurve& sofar, const std::string& hash, const std::string& path);

/// @throws common::OtherProgramError if another build of the solver wrote it
/// @throws common::FileError if it is missing, damaged, or of another scene or other settings
SceneCurve loadCheckpoint(const std::string& path, const std::string& hash);

}  // namespace snapwing::statics
