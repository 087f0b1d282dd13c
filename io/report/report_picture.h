// SPDX-License-Identifier: GPL-3.0-or-later
//
// Pictures of prints: into a report page, and small out of one, for pages that show many prints.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "io/pictures/picture_writer.h"
#include "io/report/report.h"

namespace voxtone::io {

/// A page carries dozens of them beside what its viewer needs, so they are lossy (io/pictures/webp.h).
[[nodiscard]] ReportPicture report_picture(std::string caption, const Picture8& picture, double px_per_mm);

/// A PNG of at most `most_px` a side of the prediction in the first view of the page that report_html made, its second
/// picture, or of the first where there is one; empty where the page shows no view. Throws InputError where what is
/// there is no picture.
[[nodiscard]] std::vector<std::uint8_t> small_report_picture(std::string_view html, std::uint32_t most_px);

/// The same picture, at most `most_px` a side, not to scale.
[[nodiscard]] ReportPicture small_report_picture(const ReportPicture& picture, std::uint32_t most_px);

}  // namespace voxtone::io
