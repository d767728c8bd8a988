#pragma once

#include <cstddef>
#include <vector>

#include "nav/internal/frame_tracker.hpp"
#include "pingvox/nav/nav_log.hpp"

namespace pingvox {

/// Whether a stay in another frame is more than some outliers.
bool is_lasting(std::size_t samples, double seconds);

/// Without the samples that are left out.
SourceStep source_step(const PoseStep& step, bool is_new_start);

/// Of each source that says where the vehicle is, leaves out the samples that are not in the frame of most of its valid
/// samples, and notes the steps that lead there. Does nothing more when it is called again.
void leave_out_other_frames(std::vector<NavSource>& sources);

/// Takes back what leave_out_other_frames did, as for a source that gets more samples.
void restore_other_frames(NavSource& source);

}  // namespace pingvox
