#pragma once
/// What has been printed must have arrived.

namespace snapwing::tools {

/// Before anything is written: a reader that goes away is an error of that write and not the end of the program.
void keepFailedWrites();
/// @return `code`, or that of bad input where the standard output cannot be written, which is then told
int afterPrinting(int code);

}  // namespace snapwing::tools
