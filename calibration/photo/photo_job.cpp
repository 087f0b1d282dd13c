// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/photo/photo_job.h"

#include <algorithm>
#include <filesystem>

#include <fmt/format.h>

#include "base/error.h"
#include "calibration/patches/patch_file.h"
#include "calibration/photo/photo_overlay.h"
#include "calibration/photo/target_picture.h"
#include "calibration/target/target_file.h"
#include "io/disk/output_files.h"
#include "io/files/json_writer.h"
#include "io/files/whole_file.h"

namespace voxtone::calibration {
namespace {

std::string overlay_name(const PhotoJob& job, std::size_t photo) {
    const std::filesystem::path base = job.overlay.empty()
                                           ? std::filesystem::path(job.out).replace_extension().concat("-overlay.png")
                                           : std::filesystem::path(job.overlay);
    if (photo == 0) return base.string();
    return std::filesystem::path(base).replace_extension().concat(fmt::format("-{}.png", photo + 1)).string();
}

std::vector<std::filesystem::path> outputs(const PhotoJob& job) {
    std::vector<std::filesystem::path> files{job.out};
    for (std::size_t p = 0; p < job.photos.size(); ++p) files.emplace_back(overlay_name(job, p));
    if (!job.picture.empty()) files.emplace_back(job.picture);
    return files;
}

/// All photographs; their pixels are given back, the figures are enough from there on.
std::vector<PhotoMeasurement> measure_all(const PhotoJob& job, const Target& target, Progress& progress) {
    const CheckerChart chart = find_checker(job.checker);
    std::vector<PhotoMeasurement> photos;
    TargetPicture picture(target);
    io::PhotographReader reader(std::vector<std::filesystem::path>(job.photos.begin(), job.photos.end()),
                                job.measure.coding != io::SampleCoding::linear);
    progress.begin_stage("photographs", job.photos.size(), "photographs");
    for (std::size_t p = 0; p < job.photos.size(); ++p) {
        progress.check_cancelled();
        io::Photograph photograph = reader.read(job.photos[p], &progress);
        io::turn_upright(photograph);  // --corners are those of the picture as it is shown
        photos.push_back(measure_photo(std::move(photograph), target, chart, job.measure));
        PhotoMeasurement& photo = photos.back();
        for (const std::string& warning : photo.warnings) progress.warn(warning);
        io::write_whole_file(overlay_name(job, p), io::png_bytes(photo_overlay(photo, chart)));
        if (!job.picture.empty()) picture.add(photo);
        photo.photograph.pixels = {};
        progress.advance();
    }
    progress.end_stage();
    if (!job.picture.empty()) io::write_whole_file(job.picture, io::png_bytes(picture.mean()));
    return photos;
}

/// Of each square: between photographs, or between the blocks of the only one.
std::vector<Eigen::Vector3d> spreads(const MeasuredTable& measured, const std::vector<PhotoMeasurement>& photos) {
    if (photos.size() > 1) return measured.spread;
    std::vector<Eigen::Vector3d> spread;
    for (const AreaSample& square : photos[0].squares)
        spread.push_back(photos[0].model.noise(square.middle_px, square.spread));
    return spread;
}

std::string table_comment(const PhotoJob& job, const Target& target, const std::vector<Eigen::Vector3d>& spread) {
    std::string comment = fmt::format("rho(45 -> 0) of {} from {} photograph(s); standard errors beside the values.",
                                      job.target, job.photos.size());
    for (std::size_t s = 0; s < spread.size(); ++s)
        comment +=
            fmt::format("\n{}: spread {:.5f} {:.5f} {:.5f} {}", square_name(target, s), spread[s][0], spread[s][1],
                        spread[s][2], job.photos.size() == 1 ? "between its blocks" : "between photographs");
    return comment;
}

void add_photo(io::JsonWriter& json, const PhotoJob& job, const PhotoMeasurement& photo, std::size_t p) {
    json.begin_object().add("photograph", job.photos[p]).add("overlay", overlay_name(job, p));
    json.add("markers", photo.view.markers).add("residual_px", photo.view.residual_px);
    json.add("px_per_mm", photo.view.px_per_mm).add("blur_mm", photo.view.blur_mm);
    json.add("checker_residual", photo.model.chart_residual());
    json.add("frame_residual", photo.model.frame_residual()).end_object();
}

std::string photo_text(const PhotoJob& job, const PhotoMeasurement& photo, std::size_t p) {
    return fmt::format(
        "{}: {} markers, {:.1f} px/mm, blur {:.2f} mm, checker off by {:.4f}, frame by {:.2f} %; drawn in {}\n",
        job.photos[p], photo.view.markers, photo.view.px_per_mm, photo.view.blur_mm, photo.model.chart_residual(),
        100 * photo.model.frame_residual(), overlay_name(job, p));
}

double worst_error(const PatchTable& table) {
    double worst = 0;
    for (const Patch& patch : table.patches)
        for (const double error : patch.error) worst = std::max(worst, error);
    return worst;
}

JobResult result_of(const PhotoJob& job, const std::vector<PhotoMeasurement>& photos, const PatchTable& table,
                    const std::vector<Eigen::Vector3d>& spread) {
    double worst_spread = 0;
    for (const Eigen::Vector3d& of_square : spread) worst_spread = std::max(worst_spread, of_square.maxCoeff());
    io::JsonWriter json;
    json.begin_object().add("format", "voxtone-calibrate-photo").add("version", 1).add("patches", job.out);
    json.add("count", table.patches.size()).add("worst_error", worst_error(table)).add("worst_spread", worst_spread);
    json.key("photographs").begin_list();
    std::string text;
    for (std::size_t p = 0; p < photos.size(); ++p) {
        add_photo(json, job, photos[p], p);
        text += photo_text(job, photos[p], p);
    }
    json.end_list().end_object();
    return {json.text(), text + fmt::format("{}: {} patches, standard errors up to {:.4f}\n", job.out,
                                            table.patches.size(), worst_error(table))};
}

void take_off(Target& target, double polished_mm) {
    target.top_mm -= polished_mm;
    for (TargetSquare& square : target.squares)
        if (square.depth_mm > 0) square.depth_mm -= polished_mm;
}

}  // namespace

void PhotoJob::validate() const {
    if (photos.empty()) throw UsageError("calibrate photo: no photograph");
    if (!(measure.inner >= 0.1 && measure.inner <= 0.9))
        throw UsageError(fmt::format("--inner: {:g}; it lies between 0.1 and 0.9 of a square's edge", measure.inner));
    if (top_mm && !(*top_mm > 0 && *top_mm <= 10))
        throw UsageError(fmt::format("--top: {:g} mm; squares are above 0 and at most 10 mm thick", *top_mm));
    if (photos.size() > 1 && (measure.corners || measure.checker_corners))
        throw UsageError("corners given by hand are those of one photograph; measure such photographs one by one");
}

JobResult run_photo_job(const PhotoJob& job, Progress& progress) {
    job.validate();
    io::expect_outputs(outputs(job), job.overwrite);
    Target target = read_target(job.target);
    if (job.top_mm && target.is_chart())
        throw UsageError("--top: the squares of a chart are as thick as its slab; it is of a target of thin squares");
    constexpr double most = 1.1;  // of what was meant: layers and a gauge are not that far off
    if (job.top_mm && *job.top_mm > most * target.top_mm)
        throw UsageError(fmt::format("--top: {:g} mm, and {:g} mm were printed; polishing only takes off", *job.top_mm,
                                     target.top_mm));
    if (job.top_mm) take_off(target, target.top_mm - *job.top_mm);
    const std::vector<PhotoMeasurement> photos = measure_all(job, target, progress);
    const MeasuredTable measured = average_photos(photos, target, job.channels);
    for (const std::string& warning : measured.warnings) progress.warn(warning);
    const std::vector<Eigen::Vector3d> spread = spreads(measured, photos);
    io::write_whole_file(job.out, patch_table_text(measured.table, table_comment(job, target, spread)));
    return result_of(job, photos, measured.table, spread);
}

}  // namespace voxtone::calibration
