#pragma once
/// Options of a validation, shared by the commands that run one.

#include <CLI/CLI.hpp>
#include <cstdio>

#include "numbers.h"
#include "snapwing/validation/validation.h"

namespace snapwing::tools {

struct ValidationOptions {
  validation::ValidationSettings asked;
  bool no_volumetric = false, one_size = false;

  /// What a validation alone may be asked, then what any may.
  void addTo(CLI::App& command) {
    command.add_option("--body", asked.body,
                       "density file [CSV] of the arm as it was made, for the solids; default: the vehicle's");
    command.add_option("--threads", asked.threads, "trials side by side; the result is the same for any number")
        ->check(wholeNumber(1, 256))
        ->capture_default_str();
    addGateTo(command);
  }
  void addGateTo(CLI::App& command) {
    command.add_option("--weakest", asked.weakest, "vehicles of each plan that the planner finds weakest")
        ->check(wholeNumber(0, 500))
        ->capture_default_str();
    command.add_option("--samples", asked.samples, "vehicles drawn from the uncertainty box for each plan")
        ->check(wholeNumber(0, 10000))
        ->capture_default_str();
    command
        .add_option("--cell-size", asked.planar_cell,
                    "of the planar rung [m]; its curve and shortest pulse are judged on half of that, too")
        ->check(realNumber(1e-4, 0.02, "m"))
        ->capture_default_str();
    command.add_flag("--one-cell-size", one_size,
                     "judge the planar rung on --cell-size alone, without an error bar: a quick look");
    command.add_option("--solid-cell-size", asked.solid_cell, "of the volumetric rung [m]")
        ->check(realNumber(1e-4, 0.02, "m"))
        ->capture_default_str();
    command.add_flag("--no-volumetric", no_volumetric, "leave the solids out");
    command.add_option("--step", asked.step, "of time on the soft rungs [s]")
        ->check(realNumber(1e-5, 0.02, "s"))
        ->capture_default_str();
  }

  validation::ValidationSettings settings() const {
    validation::ValidationSettings s = asked;
    s.volumetric = !no_volumetric;
    s.extrapolate = !one_size;
    return s;
  }

  /// How an answer that is undecided is decided.
  void printRemedy() const {
    std::printf("to decide: the same with smaller cells, --cell-size %g (planar)", asked.planar_cell / 2);
    if (!no_volumetric) std::printf(", --solid-cell-size %g (volumetric)", asked.solid_cell / 2);
    std::printf("\n");
  }
};

}  // namespace snapwing::tools
