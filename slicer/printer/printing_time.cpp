// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/printer/printing_time.h"

#include <algorithm>
#include <cmath>

#include <fmt/core.h>

#include "base/progress_bar.h"
#include "slicer/printer/tray_room.h"

namespace voxtone::slicer {

int HeadPasses::of_layer(const Eigen::Vector3d& extent_mm) const {
    if (!known()) return 0;
    return std::max(1, static_cast<int>(std::ceil((extent_mm[across()] - tray_slack_mm) / width_mm)));
}

void PrintingTime::add(const HeadPasses& heads, const Eigen::Vector3d& extent_mm, std::uint64_t layers) {
    const int more = heads.of_layer(extent_mm);
    passes_of_layer = std::max(passes_of_layer, more);
    passes += static_cast<std::uint64_t>(more) * layers;
    source = heads.source;
    if (heads.seconds && more > 0) seconds = static_cast<double>(passes) * *heads.seconds;
}

std::string printing_text(const PrintingTime& time) {
    if (time.passes == 0) return {};
    const std::string passes = fmt::format("{} passes of the heads, {} a layer", time.passes, time.passes_of_layer);
    if (!time.seconds) return passes + "; how long one takes the printer's profile does not say (pass_s)";
    return fmt::format("some {} at the printer: {}", duration_text(*time.seconds), passes);
}

}  // namespace voxtone::slicer
