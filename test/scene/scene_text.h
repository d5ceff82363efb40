#pragma once
/// Scenes from text for tests.

#include <gtest/gtest.h>

#include <fstream>
#include <string>

#include "snapwing/common/error.h"
#include "snapwing/statics/scene_curve.h"
#include "support/own_folder.h"
#include "support/paths.h"

namespace snapwing::scene {

inline const std::string SCENES = test::sourceDir() + "/config/scenes/";

inline Scene sceneFromText(const std::string& text) {
  const std::string path = test::ownFolder() + "scene.yaml";
  std::ofstream(path) << text;
  return loadScene(path);
}

/// Why a scene is not compiled, or "accepted".
inline std::string reasonFor(const std::string& text) {
  try {
    compileScene(sceneFromText(text), 1);
  } catch (const common::Error& e) {
    return e.what();
  }
  return "accepted";
}

inline statics::SceneCurve trace(const Scene& scene) {
  return statics::traceScene(scene, *compileScene(scene, 1), {}, {});
}

/// A block of 3 x 2 x 2 mm.
inline std::string box(const std::string& kernel, int dimension, const std::string& more) {
  const bool space = dimension == 3;
  return "scene: box\nlength_unit: mm\ndimension: " + std::to_string(dimension) + (space ? "\n" : "\nplane: stress\n") +
         "kernel: " + kernel + "\ncell_size: 1\n" +
         "bodies:\n  block:\n    material: {youngs_modulus: 5.5e+6, poisson_ratio: 0.48}\n    thickness: 2\n" +
         "    shape: {box: {x: [0, 3], y: [0, 2]}}\n" + more;
}

}  // namespace snapwing::scene
