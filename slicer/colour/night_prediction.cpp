// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/colour/night_prediction.h"

#include <utility>

#include <fmt/core.h>

#include "io/files/whole_file.h"
#include "io/pictures/picture_writer.h"
#include "io/report/report_picture.h"
#include "slicer/colour/colour_report.h"
#include "slicer/look/prediction_files.h"
#include "slicer/part/report_files.h"
#include "slicer/surface/target_cells.h"

namespace voxtone::slicer {

namespace {

/// By which a print's colours are multiplied to lie nearest to its target's, by least squares of light.
double level_of(const std::vector<Eigen::Vector3f>& target, const std::vector<Eigen::Vector3f>& print) {
    double both = 0, alone = 0;
    for (std::size_t i = 0; i < print.size(); ++i)
        both += double(target[i].dot(print[i])), alone += double(print[i].squaredNorm());
    return both > 0 ? alone / both : 1;
}

}  // namespace

std::string NightPrediction::words() const {
    return fmt::format(
        "By light from behind {:.1f} off (CIEDE2000 as seen), its white {:.3g} of what clear resin alone lets through: "
        "a brighter lamp makes up for that. {:.0f} % of the picture asks for more light than the day's colours leave.",
        seen_mean, level, 100 * beyond);
}

NightPrediction predict_night(const ResolvedJob& job, PredictionModel model, const JobBody& body,
                              const LoadedResins& resins, const NightSide& night, JobPrediction& print,
                              Progress& progress) {
    ResolvedJob dark = job;
    dark.picture.view = PictureView::through;
    dark.picture.backing = optics::Backing::none;
    const optics::Scene scene = scene_of(print.volume, resins, body, dark.picture.backing);
    ViewedCells cells = find_viewed_cells(scene, body, job.prediction.cell_mm, progress);
    cells.target = target_of_cells(cells.surface, scene.volume->pitch_mm(), body.grid.origin_mm, body.surface,
                                   night.slab(), &progress);
    JobPrediction seen = predict_print(dark, model, body, resins, std::move(print.volume), &cells, {}, progress);
    NightPrediction out;
    out.level = level_of(seen.target, seen.predicted.rgb);
    out.beyond = night.beyond();
    for (Eigen::Vector3f& rgb : seen.predicted.rgb) rgb /= static_cast<float>(out.level);
    const SeenPrint looked = seen_from(seen, job.loop.viewing_distance_mm, true);
    out.seen_mean = summarize_by_area(seen.predicted.surface, looked.difference).mean;
    print.volume = std::move(seen.volume);
    out.predicted = std::move(seen.predicted);
    out.target = std::move(seen.target);
    return out;
}

io::ReportSection draw_night(const NightPrediction& night, const JobPrediction& print,
                             const std::filesystem::path& folder) {
    io::ReportSection section;
    section.title = "By light from behind";
    section.paragraphs.push_back(night.words());
    const auto px_per_mm = picture_px_per_mm(print.volume, night.predicted.surface.cell_voxels);
    for (const auto& [caption, file, rgb] : {std::tuple{"target", report_file::night_target_png, &night.target},
                                             std::tuple{"predicted", report_file::night_png, &night.predicted.rgb}}) {
        const io::LinearPicture whole = top_picture(print.volume, cells_in_colours(night.predicted, *rgb));
        const io::Picture8 codes = io::encode_transparent(whole);
        io::write_whole_file(folder / file, io::png_bytes(codes, px_per_mm));
        section.pictures.push_back(io::report_picture(caption, codes, px_per_mm[0]));
    }
    return section;
}

}  // namespace voxtone::slicer
