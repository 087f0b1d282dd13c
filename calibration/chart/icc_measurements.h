// SPDX-License-Identifier: GPL-3.0-or-later
//
// The measurements that a printer's ICC profile was made of, where it carries them.
//
// Of charts that go beyond what a volume can hold (ink percentages that sum to more than 100) the other rows are taken.
// Values stay as they were measured, relative to a perfect diffuser.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "calibration/patches/patch_table.h"
#include "io/profiles/device_profile.h"

namespace voxtone::calibration {

struct IccMeasurements {
    PatchTable table;
    std::string tag;  ///< "targ" or "CxF"
};

/// The first of the profile's texts that is a chart of its channels, C, M, Y, K and W in it under the names of `roles`
/// and `rest`; nothing where there is none. `notes` tells of texts that are there and are not used, and why.
[[nodiscard]] std::optional<IccMeasurements> icc_measurements(const io::DeviceProfile& profile,
                                                              std::span<const std::string> roles,
                                                              const std::string& rest, std::vector<std::string>& notes);

}  // namespace voxtone::calibration
