#pragma once
/// `snapwing design arm ... --into DIR`.

#include "snapwing/pipeline/design_pipeline.h"
#include "validation_options.h"

namespace snapwing::tools {

/// @param options  of the validation, for what is said of an answer that is undecided. @return exit code of `validate`
int designInto(const pipeline::DesignPipelineSettings& settings, const ValidationOptions& options, bool quiet);

}  // namespace snapwing::tools
