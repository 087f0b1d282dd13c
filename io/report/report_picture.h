// SPDX-License-Identifier: GPL-3.0-or-later
//
// Pictures of prints: into a report page, and small, for pages that show many prints.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "io/pictures/picture_writer.h"
#include "io/report/report.h"

namespace voxtone::io {

/// A page carries dozens of them beside what its viewer needs, so they are lossy (io/pictures/webp.h).
[[nodiscard]] ReportPicture report_picture(std::string caption, const Picture8& picture, double px_per_mm);

/// What the print is expected to look like: the second picture of the first view, whose first is the target and whose
/// others are differences and other prints; the first where it is alone. Null: the page shows no view.
[[nodiscard]] const ReportPicture* shown_picture(const Report& report);

/// A PNG of at most `most_px` a side of the picture in this file, WebP or PNG. Throws InputError where it is none.
[[nodiscard]] std::vector<std::uint8_t> small_picture_png(std::span<const std::uint8_t> file, std::uint32_t most_px);

/// The same picture, at most `most_px` a side, not to scale.
[[nodiscard]] ReportPicture small_report_picture(const ReportPicture& picture, std::uint32_t most_px);

}  // namespace voxtone::io
