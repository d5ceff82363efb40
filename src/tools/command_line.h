#pragma once
/// What the programs of the command line share: parsing, exit codes, errors.

namespace CLI {
class App;
}

namespace snapwing::tools {

/// Exit codes beside 0, and 1 for a negative answer.
constexpr int BAD_INPUT = 2;
constexpr int INTERNAL_ERROR = 3;

/// Runs the subcommand that the arguments name. @return exit code
/// @param add  adds the subcommands; they set their second argument
int runCommandLine(int argc, char** argv, void (*add)(CLI::App& app, int& exit_code));

}  // namespace snapwing::tools
