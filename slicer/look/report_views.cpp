// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/look/report_views.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "base/contracts.h"
#include "base/parallel.h"
#include "io/report/report_picture.h"

namespace voxtone::slicer {

namespace {

constexpr View top_alone[] = {View::top};
constexpr double finest_px_mm = 0.085;  // a cell of the prediction

}  // namespace

ReportViews::ReportViews(const ColouredSurface& framed, bool is_picture, double finest_mm, io::Report& report,
                         const Progress& progress)
    : views_(is_picture ? std::span<const View>(top_alone) : all_views()), report_(report), progress_(progress) {
    options_.samples = 3;
    if (is_picture) options_.margin_px = 0;
    options_.px_per_mm = std::min(fitting_scale(framed, views_, is_picture ? 1000 : 640, options_), 1 / finest_px_mm);
    options_.colour_per_sample = 1 / options_.px_per_mm > 1.5 * finest_mm;
    for (const View view : views_) report_.views.push_back({view_name(view), {}});
}

io::Picture8 ReportViews::add(const char* caption, const ColouredSurface& surface) {
    const std::string captions[] = {caption};
    return add_all(captions, std::span(&surface, 1));
}

void ReportViews::add(std::span<const std::string> captions, std::span<const ColouredSurface> surfaces) {
    (void)add_all(captions, surfaces);
}

io::Picture8 ReportViews::add_all(std::span<const std::string> captions, std::span<const ColouredSurface> surfaces) {
    VOXTONE_EXPECT(captions.size() == surfaces.size());
    const std::vector<std::vector<Preview>> shown = render_views(surfaces, views_, options_, &progress_);
    io::Picture8 first;
    std::vector<io::ReportPicture> pictures(shown.size() * views_.size());
    parallel_for(0, pictures.size(), 1, [&](std::size_t i) {
        const std::size_t s = i / views_.size(), v = i % views_.size();
        io::Picture8 codes = io::encode_transparent(shown[s][v].picture);
        pictures[i] = io::report_picture(captions[s], codes, shown[s][v].px_per_mm);
        if (i == 0) first = std::move(codes);
    });
    for (std::size_t i = 0; i < pictures.size(); ++i)
        report_.views[i % views_.size()].pictures.push_back(std::move(pictures[i]));
    return first;
}

}  // namespace voxtone::slicer
