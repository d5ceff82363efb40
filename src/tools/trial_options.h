#pragma once
/// Options that describe a trial, shared by predict and plan.

#include <CLI/CLI.hpp>
#include <optional>
#include <string>

#include "numbers.h"
#include "snapwing/vehicle/trial.h"

namespace snapwing::tools {

/// The level behind a pulse, shared by predict and plan.
inline void addHoldTo(CLI::App& command, double& throttle, double& duration) {
  CLI::Option* level =
      command.add_option("--hold-throttle", throttle, "stick travel right behind the pulse [0 .. 1]; 0: no hold")
          ->check(realNumber(0, 1, "1"));
  CLI::Option* length = command
                            .add_option("--hold-duration", duration,
                                        "how long [s]; then throttle low, or --final-thrust if somebody takes over")
                            ->check(realNumber(0, 60, "s"));
  level->needs(length);
  length->needs(level);
}

struct TrialOptions {
  std::string mount = "auto", wings = "auto";
  double gravity = 0;
  double initial_speed = 0;
  std::optional<double> initial_thrust, final_thrust;
  double horizon = vehicle::Trial().horizon;

  void addTo(CLI::App& command) {
    command
        .add_option(
            "--mount", mount,
            "free (flight), boom (the paper's stand), held (ring stands still); auto: boom if the vehicle has one")
        ->check(CLI::IsMember({"auto", "free", "boom", "held"}))
        ->capture_default_str();
    command.add_option("--wings", wings, "on or off; auto: on if the vehicle has them, but off on a boom")
        ->check(CLI::IsMember({"auto", "on", "off"}))
        ->capture_default_str();
    command.add_option("--gravity", gravity, "pull against the thrust axis [m/s2]: 9.81 upright, -9.81 inverted")
        ->check(realNumber(-100, 100, "m/s2"))
        ->capture_default_str();
    command.add_option("--initial-speed", initial_speed, "along the thrust axis [m/s]")
        ->check(realNumber(-200, 200, "m/s"))
        ->capture_default_str();
    command
        .add_option("--initial-thrust", initial_thrust,
                    "steady thrust before the pulse / full thrust; default: motors idle")
        ->check(realNumber(0, 1, "1"));
    command.add_option("--final-thrust", final_thrust, "thrust after the pulse / full thrust; default: motors idle")
        ->check(realNumber(0, 1, "1"));
    command.add_option("--horizon", horizon, "longest time watched after the pulse [s]")
        ->check(realNumber(0, 60, "s", true))
        ->capture_default_str();
  }

  /// @throws common::Error
  vehicle::Trial trial(const vehicle::Vehicle& vehicle) const {
    vehicle::Trial result;
    result.mount = vehicle::mountFor(vehicle, mount, "--mount");
    result.wings = vehicle::wingsFromName(wings);
    result.gravity = gravity;
    result.initial_speed = initial_speed;
    result.initial_thrust_fraction = initial_thrust;
    result.final_thrust_fraction = final_thrust;
    result.horizon = horizon;
    result.validate();
    return result;
  }
};

}  // namespace snapwing::tools
