#pragma once
/// The first stages: an arm is optimised, or its density given, and checked. Internal.

#include <optional>
#include <string>

#include "snapwing/design/arm/arm_outcome.h"
#include "snapwing/pipeline/design_pipeline.h"

namespace snapwing::pipeline {

constexpr char ARM_DENSITY[] = "design/density.csv", ARM_BODY[] = "design/body.csv", ARM_TABLE[] = "design/table.h5";

/// Thrown by a stage that was asked to end.
struct Cancelled {};

class ArmStages {
 public:
  /// @throws common::Error for bad input
  ArmStages(const DesignPipelineSettings& settings, const DesignPipelineHooks& hooks);
  bool optimises() const { return given_.empty(); }
  int count() const { return optimises() ? 2 : 1; }
  StageResult optimise(Stages& stages);
  StageResult check(Stages& stages);
  /// Inputs of all that is designed.
  Inputs madeOf() const;

 private:
  design::ArmRun run(Stages& stages, bool resume);
  design::ArmOutcome checked(Stages& stages, design::ArmCheck* check);
  int bodies() const;

  design::ArmDesignSettings settings_;
  std::string settings_file_, given_;
  DesignPipelineHooks hooks_;
  std::optional<design::ArmRun> run_;  ///< of this session
};

}  // namespace snapwing::pipeline
