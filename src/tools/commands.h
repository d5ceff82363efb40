#pragma once
/// Subcommands of the `snapwing` command line. Each adds itself to the app; a callback sets exit_code to 1 for an
/// negative answer (refused, not converged) and throws common::Error for bad input.

namespace CLI {
class App;
}

namespace snapwing::tools {

void addCurveCommand(CLI::App& app, int& exit_code);
void addDesignArmCommand(CLI::App& app, int& exit_code);
void addDesignWingCommand(CLI::App& app, int& exit_code);
void addPredictCommand(CLI::App& app, int& exit_code);
void addPlanCommand(CLI::App& app, int& exit_code);
void addTrialCommand(CLI::App& app, int& exit_code);
void addValidateCommand(CLI::App& app, int& exit_code);
void addVehicleCommand(CLI::App& app, int& exit_code);

/// The parent command `design`, added on first use. Its subcommands share it.
CLI::App* designCommand(CLI::App& app);

}  // namespace snapwing::tools
