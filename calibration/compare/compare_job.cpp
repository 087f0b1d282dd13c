// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/compare/compare_job.h"

#include <algorithm>
#include <filesystem>

#include <fmt/format.h>

#include "base/error.h"
#include "calibration/compare/body_reading.h"
#include "calibration/compare/compare_page.h"
#include "calibration/compare/print_difference.h"
#include "io/disk/output_files.h"
#include "io/files/json_writer.h"
#include "io/files/whole_file.h"

namespace voxtone::calibration {

namespace {

constexpr const char* page_file = "compare.html";
constexpr const char* json_file = "compare.json";
constexpr const char* regions_file = "regions.json";

void add_summary(io::JsonWriter& json, const optics::DifferenceSummary& s) {
    json.key("ciede2000").begin_object().add("mean", s.mean).add("median", s.median);
    json.add("percentile_95", s.percentile_95).add("max", s.max).end_object();
}

void add_reading(io::JsonWriter& json, const PrintReading& r, const PredictedPrint& print) {
    const Eigen::Vector2d s = print.size();
    json.begin_object().add("photograph", r.photograph);
    json.add("size_px", std::array{r.width_px, r.height_px});
    json.key("corners_px").begin_list();
    for (const Eigen::Vector2d& corner :
         {Eigen::Vector2d(0, 0), Eigen::Vector2d(s.x(), 0), s, Eigen::Vector2d(0, s.y())})
        json.value(r.found.place.to_px(corner));
    json.end_list().add("px_per_cell", r.found.place.px_per_cell()).add("correlation", r.found.correlation);
    json.add("turned_deg", r.found.turned_deg).add("checker", r.has_checker);
    json.add("light", r.light_from_body     ? "body"
                      : r.light_from_ground ? "ground"
                                            : "even")
        .add("light_falls_to", r.light_falls_to);
    json.add("clipped", r.clipped);
    if (print.of_body) json.add("left_out", r.left_out).add("overlap", r.overlap);
    if (r.camera) {
        json.key("camera").begin_object().add("position_mm", r.camera->position);
        json.add("look_at_mm", r.camera->look_at)
            .add("up", r.camera->up)
            .add("focal_mm", r.camera->focal_mm)
            .end_object();
    }
    if (r.camera_blur_mm) json.add("camera_blur_mm", *r.camera_blur_mm);
    json.end_object();
}

void add_parts(io::JsonWriter& json, const PrintDifference& d) {
    json.key("mean_ciede2000").begin_object().add("as_taken", d.as_taken).add("after_exposure", d.after_exposure);
    json.add("after_cast", d.after_cast).add("after_blur", d.after_spread).end_object();
    json.add("exposure_ev", d.exposure_ev).add("cast", d.cast);
    json.key("blur_mm").begin_object().add("all", d.spread_mm).add("print", d.print_spread_mm).end_object();
}

void add_resins(io::JsonWriter& json, const PredictedPrint& print, const PrintDifference& d) {
    json.key("resins").begin_list();
    for (std::size_t r = 0; r < d.hints.resins.size(); ++r) {
        const ResinHint& hint = d.hints.resins[r];
        json.begin_object().add("resin", print.resin(r)).add("extinction_change", hint.change);
        json.add("error", hint.error).add("explained", hint.explained);
        json.add("named", d.hints.named == r).end_object();
    }
    json.end_list();
}

void add_regions(io::JsonWriter& json, const PrintDifference& d) {
    json.key("regions").begin_list();
    for (std::size_t i = 0; i < std::min(shown_tiles, d.tiles.size()); ++i) {
        const PrintTile& tile = d.tiles[i];
        json.begin_object().add("corner_mm", tile.corner_mm).add("size_mm", tile.size_mm);
        json.add("predicted", tile.predicted).add("printed", tile.printed).add("lab", tile.off_lab);
        json.add("ciede2000", tile.ciede2000).add("words", tile_words(tile)).end_object();
    }
    json.end_list();
}

std::string comparison_json(const CompareJob& job, const PredictedPrint& print,
                            const std::vector<PrintReading>& readings, const PrintDifference& d) {
    io::JsonWriter json;
    json.begin_object().add("format", "voxtone-compare").add("version", 1).add("stack", job.stack);
    json.add("model", print.model)
        .add("illuminant", print.illuminant)
        .add("cells", std::array{print.columns, print.rows})
        .add("cell_mm", print.cell_mm);
    json.add("viewing_distance_mm", job.viewing_distance_mm);
    json.key("photographs").begin_list();
    for (const PrintReading& reading : readings) add_reading(json, reading, print);
    json.end_list();
    add_summary(json, d.ciede2000);
    add_parts(json, d);
    json.add("causes", d.causes);
    add_resins(json, print, d);
    add_regions(json, d);
    json.end_object();
    return json.text();
}

std::string comparison_text(const CompareJob& job, const PredictedPrint& print,
                            const std::vector<PrintReading>& readings, const PrintDifference& d) {
    std::string text;
    for (const PrintReading& reading : readings) text += reading_words(reading, print) + "\n";
    text += fmt::format("{}: the print {}\n", job.stack, difference_words(d, job.viewing_distance_mm));
    for (const std::string& cause : d.causes) text += fmt::format("  {}\n", cause);
    for (std::size_t i = 0; i < std::min<std::size_t>(3, d.tiles.size()); ++i)
        text += fmt::format("  {:.1f} mm right, {:.1f} mm down of the upper left corner: {}\n",
                            d.tiles[i].corner_mm.x(), d.tiles[i].corner_mm.y(), tile_words(d.tiles[i]));
    const std::filesystem::path folder = job.out;
    if (job.refit)
        text += fmt::format("better resins: voxtone calibrate fit {} --prior {} -o better.json\n",
                            (folder / regions_file).string(), print.set.name);
    return text + fmt::format("page: {}\n", (folder / page_file).string());
}

std::vector<io::Photograph> read_all(const CompareJob& job, Progress& progress) {
    std::vector<io::Photograph> photos;
    io::PhotographReader reader(std::vector<std::filesystem::path>(job.photos.begin(), job.photos.end()),
                                job.read.coding != io::SampleCoding::linear);
    for (const std::string& file : job.photos) {
        photos.push_back(reader.read(file, &progress));
        io::turn_upright(photos.back());  // --corners are those of the picture as it is shown
    }
    return photos;
}

/// What is compared, and as what each photograph shows it.
using Compared = std::pair<PredictedPrint, std::vector<PrintReading>>;

Compared read_flat(PredictedPrint print, std::vector<io::Photograph> photos, const ReadPrintOptions& options,
                   Progress& progress) {
    std::vector<PrintReading> readings;
    progress.begin_stage("photographs", photos.size(), "photographs");
    for (io::Photograph& photo : photos) {
        progress.check_cancelled();
        readings.push_back(read_print(std::move(photo), print, options));
        progress.advance();
    }
    progress.end_stage();
    return {std::move(print), std::move(readings)};
}

/// What goes with flat prints alone.
void expect_for_body(const CompareJob& job) {
    const auto refuse = [&](const char* option, const char* why) {
        throw UsageError(fmt::format("{}: {} is a body, and {}; leave it out", option, job.stack, why));
    };
    if (job.photos.size() > 1) refuse("PHOTO...", "each photograph shows another side of it: compare one by one");
    if (job.read.corners) refuse("--corners", "has none in a picture: --view says from where it was taken");
    if (job.checker != "none") refuse("--checker", "the light on a chart beside it is not that on it");
    if (job.refit) refuse("--refit", "what its resins change is known of slabs alone");
}

Compared read_one_body(const PredictedBody& body, std::vector<io::Photograph> photos, const CompareJob& job,
                       Progress& progress) {
    expect_for_body(job);
    progress.begin_stage("photograph", 0);
    BodyReading read = read_body(std::move(photos.front()), body, job.read.coding);
    progress.end_stage();
    return {std::move(read.print), std::vector{std::move(read.reading)}};
}

}  // namespace

void CompareJob::validate() const {
    if (photos.empty()) throw UsageError("compare: no photograph; give PHOTO... and then the stack that was printed");
    for (const std::string& photo : photos)
        if (std::filesystem::is_directory(photo))
            throw UsageError(fmt::format("{}: is a folder; give the photographs first, and the stack last", photo));
    if (photos.size() > 1 && (read.corners || read.checker_corners))
        throw UsageError("corners given by hand are those of one photograph; compare such photographs one by one");
    if (read.checker_corners && checker == "none")
        throw UsageError("--checker-corners: would be ignored: say which chart it is (--checker colorchecker24)");
    if (!(viewing_distance_mm >= 10 && viewing_distance_mm <= 1e5))
        throw UsageError(
            fmt::format("--viewing-distance: {:g} mm; it lies between 10 mm and 100 m", viewing_distance_mm));
}

JobResult run_compare_job(const CompareJob& job, const PredictPrint& predict, Progress& progress) {
    job.validate();
    ReadPrintOptions options = job.read;
    if (job.checker != "none") options.checker = find_checker(job.checker);
    const std::filesystem::path folder =
        io::make_folder_for(job.out, {page_file, json_file, regions_file}, job.overwrite);
    std::vector<io::Photograph> photos = read_all(job, progress);
    auto predicted = predict(progress);
    const auto [print, readings] =
        std::holds_alternative<PredictedPrint>(predicted)
            ? read_flat(std::move(std::get<PredictedPrint>(predicted)), std::move(photos), options, progress)
            : read_one_body(std::get<PredictedBody>(predicted), std::move(photos), job, progress);
    for (const PrintReading& reading : readings)
        for (const std::string& warning : reading.warnings) progress.warn(warning);
    const PrintDifference difference = difference_of(print, readings);
    const std::string json = comparison_json(job, print, readings, difference);
    io::write_whole_file(folder / json_file, json + "\n");
    io::write_whole_file(folder / page_file, compare_page(print, readings, difference, job.viewing_distance_mm));
    if (job.refit)
        io::write_whole_file(
            folder / regions_file,
            region_sheet_text({.stack = job.stack,
                               .has_checker = std::ranges::all_of(readings, &PrintReading::has_checker),
                               .set = print.set,
                               .regions = difference.regions}));
    return {json, comparison_text(job, print, readings, difference)};
}

}  // namespace voxtone::calibration
