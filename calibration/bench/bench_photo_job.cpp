// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/bench/bench_photo_job.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <map>

#include <fmt/format.h>

#include "base/error.h"
#include "base/warning.h"
#include "calibration/bench/bench_list.h"
#include "calibration/bench/bench_overlay.h"
#include "io/disk/output_files.h"
#include "io/files/json_writer.h"
#include "io/files/whole_file.h"

namespace voxtone::calibration {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector2d;

constexpr double least_level_error = 0.001;  // a white patch is not known better

std::string overlay_folder(const BenchPhotoJob& job) {
    if (!job.overlays.empty()) return job.overlays;
    return fs::path(job.out).replace_extension().concat("-overlays").string();
}

std::string slab_picture(const SlabPhotograph& slab, std::size_t number) {
    std::string name = slab.resin;
    for (char& c : name)
        if (!std::isalnum(static_cast<unsigned char>(c))) c = '_';
    return fmt::format("{}-{}-{}.png", name, slab.thickness_mm, number);
}

// Names of the slabs' pictures: resin, thickness, number of the photograph.
std::vector<std::string> slab_pictures(const BenchList& list) {
    std::vector<std::string> names;
    std::size_t number = 1;
    for (std::size_t k = 0; k < list.slabs.size(); ++k) {
        const bool same = k > 0 && list.slabs[k].resin == list.slabs[k - 1].resin &&
                          list.slabs[k].thickness_mm == list.slabs[k - 1].thickness_mm;
        number = same ? number + 1 : 1;
        names.push_back(slab_picture(list.slabs[k], number));
    }
    return names;
}

std::vector<fs::path> photographs_of(const BenchList& list) {
    std::vector<fs::path> files{list.checker, list.sheet};
    if (!list.paper.empty()) files.emplace_back(list.paper);
    for (const SlabPhotograph& slab : list.slabs) files.emplace_back(slab.file);
    return files;
}

class BenchReader {
public:
    BenchReader(const BenchPhotoJob& job, const BenchList& list, const EdgeSetup& setup, Progress& progress)
        : job_(job), list_(list), progress_(progress), folder_(overlay_folder(job)), reader_(photographs_of(list)) {
        reading_.setup = setup;
        options_ = {job.square_mm, setup.width_mm, job.length_mm};
        json_.begin_object().add("format", "voxtone-calibrate-edge-photo").add("version", 1);
        json_.key("photographs").begin_list();
    }

    BenchReading read() {
        progress_.begin_stage("photographs", list_.slabs.size() + 3, "photographs");
        read_light();
        read_slabs();
        progress_.end_stage();
        measured_setup();  // traces paths: once nothing can be refused any more
        judge_slabs();
        return std::move(reading_);
    }

    /// What the job says of itself, up to the last of its list of photographs.
    [[nodiscard]] const io::JsonWriter& json() const { return json_; }
    [[nodiscard]] const BenchLight& light() const { return light_; }

private:
    void warn_all(std::vector<std::string>& warnings) {
        for (const std::string& warning : warnings) progress_.warn(warning);
        std::ranges::move(warnings, std::back_inserter(reading_.warnings));
        warnings.clear();
    }

    void save(const std::string& name, const io::Picture8& picture) const {
        io::write_whole_file(fs::path(folder_) / name, io::png_bytes(picture));
    }

    void read_light() {
        const CheckerChart chart = find_checker(job_.checker);
        BenchLightPhotos photos{reader_.read(list_.checker, &progress_), reader_.read(list_.sheet, &progress_),
                                std::nullopt};
        if (!list_.paper.empty()) photos.paper = reader_.read(list_.paper, &progress_);
        exposure_s_ = photos.sheet.exposure_s;
        size_px_ = {photos.sheet.width_px, photos.sheet.height_px};
        BenchLightOptions options = job_.light;
        options.width_mm = std::max(reading_.setup.width_mm, job_.length_mm);
        light_ = measure_bench_light(photos, chart, options, board_, job_.square_mm);
        warn_all(light_.warnings);
        if (photos.paper)
            save("light.png", light_overlay(light_map(*photos.paper, board_, options.width_mm), board_, options_));
        const EdgeStrip strip = cut_strip(photos.sheet, board_, light_.scale(photos.sheet),
                                          {Vector2d::Zero(), options_.width_mm, options_.length_mm});
        save("sheet.png", strip_overlay(photos.sheet, light_, board_, strip, options_));
        reading_.sheet = read_sheet(strip, photos.sheet.name);
        progress_.advance(3);
    }

    void measured_setup() {
        EdgeSetup& setup = reading_.setup;
        reading_.base = base_under_surface(reading_.sheet, bare_sheet_kernels(setup));
        setup.white = reading_.base.white;
        setup.black = reading_.base.black;
        setup.blur_mm = reading_.sheet.edge.blur_mm;
        setup.pitch_mm = 1 / board_.px_per_mm;
        setup.level_error = std::hypot(least_level_error, light_.level_error.maxCoeff());
        std::string channels;
        for (std::size_t c = 0; c < 3; ++c)
            if (reading_.base.too_bright[c]) channels += "RGB"[c];
        if (!channels.empty()) {
            std::vector<std::string> warning{fmt::format(
                "{}: its white is brighter in {} than any paper under the setup's surface can look; is the checker's "
                "white what its file says, and \"surface\" of the sheet in setup.json right?",
                list_.sheet, channels)};
            warn_all(warning);
        }
    }

    void read_slabs() {
        const std::vector<std::string> pictures = slab_pictures(list_);
        BenchReference reference{&light_,        &reading_.sheet,   board_.place.to_px(Vector2d::Zero()),
                                 job_.square_mm, options_.width_mm, options_.length_mm};
        std::vector<SlabView> views;
        std::vector<std::string> warnings;
        for (std::size_t k = 0; k < list_.slabs.size(); ++k) {
            progress_.check_cancelled();
            const SlabPhotograph& slab = list_.slabs[k];
            io::Photograph photo = reader_.read(slab.file, &progress_);
            if (photo.width_px != size_px_[0] || photo.height_px != size_px_[1])
                throw InputError(
                    fmt::format("{}: {} x {} pixels, but the bare sheet's photograph has {} x {}; all must "
                                "be taken by the same camera in the same place, and not be cropped",
                                slab.file, photo.width_px, photo.height_px, size_px_[0], size_px_[1]));
            if (photo.exposure_s > 0 && exposure_s_ > 0 && std::abs(photo.exposure_s / exposure_s_ - 1) > 1e-3)
                throw InputError(
                    fmt::format("{}: exposed {:g} s, but the bare sheet {:g} s; light is compared between "
                                "photographs, so all must have one exposure",
                                slab.file, photo.exposure_s, exposure_s_));
            photo.coding = light_.coding;
            io::make_linear(photo);
            views.push_back(read_slab(photo, reference, warnings));
            save(pictures[k], strip_overlay(photo, light_, views.back().board, views.back().strip, options_));
            add_json(slab, pictures[k], views.back());
            const bool last = k + 1 == list_.slabs.size() || list_.slabs[k + 1].resin != slab.resin ||
                              list_.slabs[k + 1].thickness_mm != slab.thickness_mm;
            if (last) {
                reading_.profiles.push_back(join_views(views, slab.resin, slab.thickness_mm, warnings));
                views.clear();
            }
            warn_all(warnings);
            progress_.advance();
        }
    }

    void add_json(const SlabPhotograph& slab, const std::string& picture, const SlabView& view) {
        json_.begin_object().add("photograph", slab.file).add("resin", slab.resin);
        json_.add("thickness_mm", slab.thickness_mm).add("overlay", (fs::path(folder_) / picture).string());
        json_.add("px_per_mm", view.board.px_per_mm).add("corners", view.board.corners);
        json_.add("residual_px", view.board.residual_px).add("turn_deg", view.board.turn_deg);
        json_.add("edge_offset_mm", view.edge.offset_mm).add("edge_turn_deg", view.edge.turn_deg);
        json_.add("blur_mm", view.blur_mm).add("left_out", view.strip.left_out_share).end_object();
    }

    // What a fit will miss is said here, while the slabs still lie on the bench.
    void judge_slabs() {
        std::map<std::string, std::vector<double>> thicknesses;
        for (const EdgeProfile& profile : reading_.profiles) thicknesses[profile.resin].push_back(profile.thickness_mm);
        std::vector<std::string> warnings;
        for (const auto& [resin, list] : thicknesses)
            if (list.size() < 2)
                warnings.push_back(named_warning(
                    "one-slab", fmt::format("{}: one thickness only ({} mm); extinction and albedo lean on one "
                                            "profile, and nothing tells when it is wrong. Measure a second slab.",
                                            resin, list[0])));
        if (thicknesses.size() < 2)
            warnings.push_back(named_warning(
                "one-slab",
                "Slabs of one resin only: the factor mu that takes the bench's bias out is told by what resins have in "
                "common; `edge fit` wants two at least."));
        warn_all(warnings);
    }

    const BenchPhotoJob& job_;
    const BenchList& list_;
    Progress& progress_;
    std::string folder_;
    io::PhotographReader reader_;
    OverlayOptions options_;
    BenchReading reading_;
    BenchLight light_;
    BoardView board_;
    double exposure_s_ = 0;
    std::array<std::uint32_t, 2> size_px_{};
    io::JsonWriter json_;
};

std::string numbers(const std::array<double, 3>& v) { return fmt::format("{:.4f}, {:.4f}, {:.4f}", v[0], v[1], v[2]); }

std::string sheet_text(const BenchReading& reading, const BenchLight& light) {
    const SheetReading& sheet = reading.sheet;
    std::string text = fmt::format("Checker off by {:.4f}; light ", light.model.chart_residual());
    text += light.unevenness ? fmt::format("uneven by {:.2f} % over the region, corrected to {:.2f} %\n",
                                           100 * *light.unevenness, 100 * light.left_over)
                             : std::string("not mapped\n");
    text += fmt::format("Sheet looks {} (white), {} (black)\n", numbers(sheet.seen_white), numbers(sheet.seen_black));
    text += fmt::format(
        "For setup.json:\n  \"sheet\": {{\"white\": [{}], \"black\": [{}], ...}},\n  \"camera\": {{\"pitch_mm\": "
        "{:.5f}, "
        "\"blur_mm\": {:.4f}, \"level_error\": {:.4f}, ...}}\n",
        numbers(reading.base.white), numbers(reading.base.black), reading.setup.pitch_mm, reading.setup.blur_mm,
        reading.setup.level_error);
    return text;
}

double worst_error_of(const std::vector<EdgeProfile>& profiles) {
    double worst = 0;
    for (const EdgeProfile& profile : profiles)
        for (const auto& channel : profile.error) worst = std::max(worst, std::ranges::max(channel));
    return worst;
}

JobResult result_of(const BenchPhotoJob& job, const BenchReading& reading, const BenchReader& reader) {
    const BenchLight& light = reader.light();
    io::JsonWriter json = reader.json();
    json.end_list().add("profiles", job.out).add("count", reading.profiles.size());
    json.add("worst_error", worst_error_of(reading.profiles));
    json.add("checker_residual", light.model.chart_residual());
    json.key("sheet").begin_object().add("white", reading.base.white).add("black", reading.base.black);
    json.add("seen_white", reading.sheet.seen_white).add("seen_black", reading.sheet.seen_black);
    json.add("offset_mm", reading.sheet.edge.offset_mm).end_object();
    json.key("camera").begin_object().add("pitch_mm", reading.setup.pitch_mm);
    json.add("blur_mm", reading.setup.blur_mm).add("level_error", reading.setup.level_error).end_object();
    json.add("warnings", reading.warnings);
    if (light.unevenness) json.add("unevenness", *light.unevenness);
    json.end_object();
    std::string text =
        sheet_text(reading, light) +
        fmt::format("{}: {} profiles, standard errors up to {:.4f}; look at the pictures in {}\n", job.out,
                    reading.profiles.size(), worst_error_of(reading.profiles), overlay_folder(job));
    if (!job.new_setup.empty()) text += fmt::format("Wrote {}\n", job.new_setup);
    return {json.text(), text};
}

}  // namespace

void BenchPhotoJob::validate() const {
    if (list.empty()) throw UsageError("the list of photographs is missing");
    if (out.empty()) throw UsageError("--out is missing: the profiles to write");
    if (!(square_mm >= 5 && square_mm <= 100))
        throw InputError(fmt::format("--square: {} mm; expected 5 to 100", square_mm));
    if (!(length_mm >= 2 && length_mm <= 0.9 * square_mm))
        throw InputError(
            fmt::format("--along: {} mm; expected 2 to 0.9 of a square, for the edge ends there", length_mm));
}

JobResult run_bench_photo_job(const BenchPhotoJob& job, Progress& progress) {
    job.validate();
    const BenchList list = read_bench_list(job.list);
    const EdgeSetup setup = read_edge_setup(job.setup);
    std::vector<fs::path> files{job.out};
    if (!job.new_setup.empty()) files.emplace_back(job.new_setup);
    io::expect_outputs(files, job.overwrite);
    std::vector<fs::path> pictures{"sheet.png"};
    if (!list.paper.empty()) pictures.emplace_back("light.png");
    for (const std::string& name : slab_pictures(list)) pictures.emplace_back(name);
    static_cast<void>(io::make_folder_for(overlay_folder(job), pictures, job.overwrite));
    BenchReader reader(job, list, setup, progress);
    const BenchReading reading = reader.read();
    check_edge_profiles(reading.profiles, job.list);
    const std::string comment = fmt::format(
        "from {} photographs of {}; a perfect diffuser is 1; standard errors hold "
        "what differs along the edge and between photographs, not the white point",
        list.slabs.size(), job.list);
    io::write_whole_file(job.out, edge_profiles_text(reading.profiles, comment));
    if (!job.new_setup.empty()) io::write_whole_file(job.new_setup, edge_setup_text(reading.setup));
    return result_of(job, reading, reader);
}

}  // namespace voxtone::calibration
