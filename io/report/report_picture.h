// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a print will look like, small, out of its report page: for pages that show many prints.
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

namespace voxtone::io {

/// A PNG of at most `most_px` a side of the prediction in the first view of the page that report_html made, or of the
/// target where nothing is predicted; empty where the page shows no view. Throws InputError where what is there is no
/// picture.
[[nodiscard]] std::vector<std::uint8_t> small_report_picture(std::string_view html, std::uint32_t most_px);

}  // namespace voxtone::io
