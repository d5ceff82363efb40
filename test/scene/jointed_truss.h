#pragma once
/// Two slender bars that meet in a joint and snap through: a scene with ports, pins and a joint in both basins.

#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>
#include <string>

#include "snapwing/scene/scene.h"

namespace snapwing::scene::testing_scenes {

/// Half span 20 mm, rise 5 mm. The apex of the left bar is driven down, the right bar hangs on the joint.
inline Scene jointedTruss(int dimension, const std::string& kernel, double cell_size_mm) {
  const bool space = dimension == 3;
  const std::string material = "material: {youngs_modulus: 5.5e+6, poisson_ratio: 0.3}, thickness: 2, ";
  const std::string text =
      "scene: truss\nlength_unit: mm\ndimension: " + std::to_string(dimension) + (space ? "\n" : "\nplane: stress\n") +
      "kernel: " + kernel + "\ncell_size: " + std::to_string(cell_size_mm) + "\nparticles: 4\nbodies:\n  left: {" +
      material + "shape: {polygon: [{x: -20, y: -1}, {x: 0, y: 4}, {x: 0, y: 6}, {x: -20, y: 1}]}}\n  right: {" +
      material +
      "shape: {polygon: [{x: -1, y: 6}, {x: -1, y: 4}, {x: 20, y: -1}, {x: 20, y: 1}]}}\n"
      "pins:\n  - {name: left foot, body: left, at: [-19, 0.1], kind: line}\n"
      "  - {name: right foot, body: right, at: [19, 0.1], kind: line}\n"
      "joints:\n  - {name: apex, first: left, second: right, at: [-0.4, 5]}\n"
      "ports:\n  - {name: drive, body: left, region: {x: [0, 0]}, direction: " +
      (space ? "[0, -1, 0]" : "[0, -1]") + ", cross_motion: held}\npath: {to: 10, steps: 20}\n";
  static int number = 0;
  const std::string path =
      ::testing::TempDir() + "jointed_truss_" + std::to_string(getpid()) + "_" + std::to_string(++number) + ".yaml";
  std::ofstream(path) << text;
  return loadScene(path);
}

}  // namespace snapwing::scene::testing_scenes
