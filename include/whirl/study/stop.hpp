#pragma once
// Runs that end at a chosen checkpoint, as if they had been killed there.

namespace whirl::study {

/// Ends the process by SIGKILL once `count` checkpoints have been written. Until then one is written wherever one may
/// lie, whatever the clock says, so that the same deck always ends at the same place. Zero: never, the default.
void stop_after_checkpoints(int count);

/// Whether checkpoints are written as soon as there is something to keep, and not by the clock.
[[nodiscard]] bool saves_at_once();

/// Says that a checkpoint has been written. Every rank that took part says so.
void checkpoint_written();

}  // namespace whirl::study
