// SPDX-License-Identifier: GPL-3.0-or-later
//
// A report's views: what several surfaces of one shape look like, from each side, pictures of a side beside each other.
#pragma once

#include <span>
#include <string>

#include "base/progress.h"
#include "io/pictures/picture_writer.h"
#include "io/report/report.h"
#include "slicer/look/preview.h"

namespace voxtone::slicer {

class ReportViews {
public:
    /// In a scale that shows all of `framed` from every side, a picture's from above alone. `finest_mm`: what the
    /// colours are filtered to; a picture that has coarser pixels averages them, 0: any does.
    ReportViews(const ColouredSurface& framed, bool is_picture, double finest_mm, io::Report& report,
                const Progress& progress);

    /// Draws it from every side. The first side's picture, for a file.
    io::Picture8 add(const char* caption, const ColouredSurface& surface);
    /// Surfaces of one mesh.
    void add(std::span<const std::string> captions, std::span<const ColouredSurface> surfaces);

    [[nodiscard]] double px_per_mm() const { return options_.px_per_mm; }

private:
    /// The first side's picture of the first.
    io::Picture8 add_all(std::span<const std::string> captions, std::span<const ColouredSurface> surfaces);
    std::span<const View> views_;
    PreviewOptions options_;
    io::Report& report_;
    const Progress& progress_;
};

}  // namespace voxtone::slicer
