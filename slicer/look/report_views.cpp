// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/look/report_views.h"

#include <algorithm>
#include <vector>

#include "io/report/report_picture.h"

namespace voxtone::slicer {

namespace {

constexpr View from_above[] = {View::top};
constexpr double finest_px_mm = 0.085;  // a cell of the prediction

}  // namespace

ReportViews::ReportViews(const ColouredSurface& framed, bool is_picture, double finest_mm, io::Report& report,
                         const Progress& progress)
    : views_(is_picture ? std::span<const View>(from_above) : all_views()), report_(report), progress_(progress) {
    options_.samples = 3;
    if (is_picture) options_.margin_px = 0;
    options_.px_per_mm = std::min(fitting_scale(framed, views_, is_picture ? 1000 : 640, options_), 1 / finest_px_mm);
    options_.colour_per_sample = 1 / options_.px_per_mm > 1.5 * finest_mm;
    for (const View view : views_) report_.views.push_back({view_name(view), {}});
}

io::Picture8 ReportViews::add(const char* caption, const ColouredSurface& surface) {
    io::Picture8 first;
    const std::vector<Preview> shown = render_views(surface, views_, options_, &progress_);
    for (std::size_t v = 0; v < views_.size(); ++v) {
        io::Picture8 codes = io::encode_transparent(shown[v].picture);
        report_.views[v].pictures.push_back(io::report_picture(caption, codes, shown[v].px_per_mm));
        if (v == 0) first = std::move(codes);
    }
    return first;
}

}  // namespace voxtone::slicer
