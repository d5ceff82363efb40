#pragma once
/// Checkpoint of a run along a scene's path, from which it can be resumed after an interruption.

#include <string>

#include "snapwing/common/checkpoint_bytes.h"
#include "snapwing/statics/scene_curve.h"

namespace snapwing::statics {

/// SHA-256 of the inputs of a scene's path: version, scene, numerical settings. `more`: settings outside the scene.
std::string traceHash(const scene::Scene& scene, const std::string& more);

/// Stores the runs `path` and `back` of a curve, not `below`. Replaces the file atomically. @throws common::FileError
void saveCheckpoint(const SceneCurve& sofar, const std::string& hash, const std::string& path);

/// @throws common::OtherProgramError if another build of the solver wrote it
/// @throws common::FileError if it is missing, damaged, or of another scene or other settings
SceneCurve loadCheckpoint(const std::string& path, const std::string& hash);

}  // namespace snapwing::statics
