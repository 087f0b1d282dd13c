// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/spot/response_sweep.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "base/error.h"
#include "calibration/tables/text_table.h"

namespace voxtone::calibration {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t most_table_bytes = 1u << 26;
constexpr double most_asymmetric = 0.25, most_light = 1.02;

const char* channel_name(std::size_t c) { return std::array{"red", "green", "blue"}[c]; }

std::string cell_name(std::size_t cell, const SweepGeometry& geometry) {
    return fmt::format("cell ({}, {})", cell % geometry.points[0], cell / geometry.points[0]);
}

ExposureFile beside(const fs::path& table, const std::string& name) {
    ExposureFile exposure = parse_exposure(name);
    if (exposure.file.is_relative()) exposure.file = table.parent_path() / exposure.file;
    return exposure;
}

std::vector<fs::path> all_files(const std::vector<SweepExposures>& frames, const SweepExposures& card) {
    std::set<fs::path> files;
    const auto add = [&](const SweepExposures& scene) {
        for (const auto* series : {&scene.lit, &scene.dark})
            for (const ExposureFile& exposure : *series) files.insert(exposure.file);
    };
    add(card);
    for (const SweepExposures& frame : frames) add(frame);
    return {files.begin(), files.end()};
}

/// Most frames of a sweep share their dark frames: as many as one has are kept.
class DarkFrames {
public:
    [[nodiscard]] const Exposure& read(const ExposureFile& file, std::size_t most, io::PhotographReader& reader,
                                       const Progress& progress) {
        const std::pair key(file.file, file.seconds);
        if (const auto known = kept_.find(key); known != kept_.end()) return known->second;
        if (kept_.size() >= most) kept_.clear();
        return kept_.emplace(key, read_exposure(file, reader, &progress)).first->second;
    }

private:
    std::map<std::pair<fs::path, double>, Exposure> kept_;
};

MergedPicture merged_of(const SweepExposures& scene, const CameraNoise& noise, DarkFrames& dark,
                        io::PhotographReader& reader, const Progress& progress) {
    ExposureMerge merge(noise);
    for (std::size_t i = 0; i < scene.lit.size(); ++i)
        merge.add(read_exposure(scene.lit[i], reader, &progress),
                  dark.read(scene.dark[i], scene.dark.size(), reader, progress));
    MergedPicture picture = merge.merged();
    const auto saturated = std::count(picture.exposures.begin(), picture.exposures.end(), 0);
    if (saturated > 0)
        throw InputError(
            fmt::format("{}: {} pixels are saturated in the shortest exposure, so that their light is not "
                        "known; add a shorter one",
                        scene.lit.front().file.string(), saturated));
    return picture;
}

Eigen::Vector3d sum_of(const MergedPicture& picture) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const Eigen::Vector3f& light : picture.light) sum += light.cast<double>();
    return sum;
}

/// Mean light of each cell.
class CellMeans {
public:
    CellMeans(const SweepGeometry& geometry, std::uint32_t width_px, std::uint32_t height_px)
        : geometry_(geometry), width_px_(width_px), height_px_(height_px) {
        const double cell_px = geometry.pitch_mm / geometry.mm_per_px;
        for (std::size_t a = 0; a < 2; ++a) {
            const double end = geometry.corner_px[a] + geometry.points[a] * cell_px,
                         size = a == 0 ? width_px : height_px;
            if (geometry.corner_px[a] < 0 || end > size + 1e-6)
                throw InputError(fmt::format(
                    "the surface lies at {:.4g} to {:.4g} px along {}, and the photographs have {:g}: the surface must "
                    "be within them; are --corner, --mm-per-px, --points or --pitch others?",
                    geometry.corner_px[a], end, "xy"[a], size));
        }
    }

    std::vector<Eigen::Vector3d> of(const MergedPicture& picture, const std::string& frame) const {
        if (picture.width_px != width_px_ || picture.height_px != height_px_)
            throw InputError(
                fmt::format("{}: its photographs have {} x {} pixels, those of the card {} x {}; the camera "
                            "must not be moved, nor pictures cut otherwise",
                            frame, picture.width_px, picture.height_px, width_px_, height_px_));
        const double cell_px = geometry_.pitch_mm / geometry_.mm_per_px;
        std::vector<Eigen::Vector3d> means(std::size_t{geometry_.points[0]} * geometry_.points[1]);
        for (std::size_t cell = 0; cell < means.size(); ++cell) {
            const std::size_t at[2] = {cell % geometry_.points[0], cell / geometry_.points[0]};
            std::uint32_t first[2], end[2];
            for (std::size_t a = 0; a < 2; ++a) {  // pixels whose middle lies within
                first[a] =
                    static_cast<std::uint32_t>(std::ceil(geometry_.corner_px[a] + double(at[a]) * cell_px - 0.5));
                end[a] =
                    static_cast<std::uint32_t>(std::ceil(geometry_.corner_px[a] + double(at[a] + 1) * cell_px - 0.5));
            }
            const auto pixels = double(end[0] - first[0]) * (end[1] - first[1]);
            Eigen::Vector3d sum = Eigen::Vector3d::Zero();
            for (std::uint32_t y = first[1]; y < end[1]; ++y)
                for (std::uint32_t x = first[0]; x < end[0]; ++x)
                    sum += picture.light[picture.index(x, y)].cast<double>();
            means[cell] = sum / pixels;
        }
        return means;
    }

private:
    const SweepGeometry& geometry_;
    std::uint32_t width_px_, height_px_;
};

/// rms over cells of what each sends to others of the window over what it gets from them, less 1. `rows`: [from][to].
double expect_reciprocal(const std::vector<std::vector<double>>& rows, const SweepGeometry& geometry, std::size_t c) {
    const auto offsets = optics::half_window(geometry.radius);
    std::vector<double> sent(rows.size()), got(rows.size());
    const int width = int(geometry.points[0]), height = int(geometry.points[1]);
    for (std::size_t from = 0; from < rows.size(); ++from)
        for (const auto& [x, y] : offsets) {
            const int column = int(from) % width + x, row = int(from) / width + y;
            if ((x == 0 && y == 0) || column < 0 || column >= width || row >= height) continue;
            const auto to = std::size_t(row * width + column);
            sent[from] += rows[from][to], got[to] += rows[from][to];
            sent[to] += rows[to][from], got[from] += rows[to][from];
        }
    double squares = 0;
    for (std::size_t i = 0; i < rows.size(); ++i) {
        if (!(sent[i] > 0) || !(got[i] > 0)) continue;
        const double off = sent[i] / got[i] - 1;
        squares += off * off;
        if (std::abs(std::log(sent[i] / got[i])) > std::log1p(most_asymmetric))
            throw InputError(fmt::format(
                "{}: in {} it sends {:.2f} times the light to other cells that these send to it, and both ways must be "
                "alike; was its frame lit or exposed otherwise, or is its place another?",
                cell_name(i, geometry), channel_name(c), sent[i] / got[i]));
    }
    return std::sqrt(squares / double(rows.size()));
}

optics::ChannelResponses channel_of(const std::vector<std::vector<double>>& rows, const SweepGeometry& geometry) {
    const auto offsets = optics::half_window(geometry.radius);
    const int width = int(geometry.points[0]), height = int(geometry.points[1]);
    optics::ChannelResponses channel;
    channel.pairs.assign(offsets.size() * rows.size(), 0.0F);
    for (std::size_t k = 0; k < offsets.size(); ++k)
        for (std::size_t from = 0; from < rows.size(); ++from) {
            const int column = int(from) % width + offsets[k].x, row = int(from) / width + offsets[k].y;
            if (column < 0 || column >= width || row >= height) continue;
            const auto to = std::size_t(row * width + column);
            channel.pairs[k * rows.size() + from] = float(std::max(0.0, 0.5 * (rows[from][to] + rows[to][from])));
        }
    return channel;
}

}  // namespace

void SweepGeometry::validate() const {
    if (!(mm_per_px > 0 && std::isfinite(mm_per_px)))
        throw UsageError(
            fmt::format("--mm-per-px: {:g}; photograph a scale and give mm per pixel, above 0", mm_per_px));
    for (const std::uint32_t count : points)
        if (count < 1 || count > 4096)
            throw UsageError(
                fmt::format("--points: {} x {}; a surface has 1 to 4096 cells a side", points[0], points[1]));
    if (!(pitch_mm >= mm_per_px && std::isfinite(pitch_mm)))
        throw UsageError(
            fmt::format("--pitch: {:g} mm; a cell must be as wide as a pixel or wider, {:g} mm", pitch_mm, mm_per_px));
    if (radius < 1 || radius > 64)
        throw UsageError(fmt::format("--radius: {}; it lies between 1 and 64 cells", radius));
}

std::vector<SweepExposures> read_sweep(const fs::path& table, const SweepGeometry& geometry) {
    constexpr std::string_view header = "file,dark,x_mm,y_mm", names[] = {"file", "dark", "x_mm", "y_mm"};
    const std::string text = read_text(table, most_table_bytes);
    CsvText csv(text, table.string(), fmt::format("expected {}", header), {}, CsvText::ShortRows::filled);
    csv.expect_names(names, header);
    std::vector<SweepExposures> frames(std::size_t{geometry.points[0]} * geometry.points[1]);
    while (csv.next()) {
        std::size_t at[2];
        for (std::size_t a = 0; a < 2; ++a) {
            if (csv.cells()[2 + a].empty())
                csv.fail(2 + a,
                         "is empty: where the square lay is not known; give the mm from the surface's upper left "
                         "corner to its middle");
            const double place = csv.number(2 + a) / geometry.pitch_mm;
            if (!(place >= 0 && place < geometry.points[a]))
                csv.fail(2 + a, fmt::format("lies off the surface, which ends at {:g} mm",
                                            geometry.points[a] * geometry.pitch_mm));
            at[a] = static_cast<std::size_t>(place);
        }
        if (csv.cells()[0].empty() || csv.cells()[1].empty())
            csv.fail(csv.cells()[0].empty() ? 0 : 1, "is empty: each photograph needs a dark frame of the same time");
        SweepExposures& frame = frames[at[1] * geometry.points[0] + at[0]];
        frame.lit.push_back(beside(table, csv.cells()[0]));
        frame.dark.push_back(beside(table, csv.cells()[1]));
    }
    for (std::size_t cell = 0; cell < frames.size(); ++cell)
        if (frames[cell].lit.empty())
            throw InputError(fmt::format("{}: {} has no frame; each cell of the {} x {} needs one in which it is lit",
                                         table.string(), cell_name(cell, geometry), geometry.points[0],
                                         geometry.points[1]));
    return frames;
}

SweptResponses measure_sweep(const std::vector<SweepExposures>& frames, const SweepExposures& card, double card_albedo,
                             const SweepGeometry& geometry, const CameraNoise& noise, Progress& progress) {
    geometry.validate();
    if (!(card_albedo > 0 && card_albedo <= 1))
        throw UsageError(
            fmt::format("--card-albedo: {:g}; a card reflects more than 0 and at most 1 of the light", card_albedo));
    DarkFrames dark;
    io::PhotographReader reader(all_files(frames, card));
    const MergedPicture lit_card = merged_of(card, noise, dark, reader, progress);
    const double px_mm2 = geometry.mm_per_px * geometry.mm_per_px;
    const Eigen::Vector3d light = sum_of(lit_card) * px_mm2 / card_albedo;  // Phi
    if (!(light.minCoeff() > 0))
        throw InputError(
            fmt::format("{}: the card is no brighter than its dark frame, so that nothing tells how much "
                        "light the square is; were they swapped?",
                        card.lit.front().file.string()));
    const CellMeans cells(geometry, lit_card.width_px, lit_card.height_px);
    std::array<std::vector<std::vector<double>>, 3> rows;
    std::array<std::vector<float>, 3> totals;
    progress.begin_stage("frames", frames.size(), "cells");
    for (std::size_t from = 0; from < frames.size(); ++from) {
        progress.check_cancelled();
        const std::string name = frames[from].lit.front().file.string();
        const MergedPicture picture = merged_of(frames[from], noise, dark, reader, progress);
        const std::vector<Eigen::Vector3d> means = cells.of(picture, name);
        const Eigen::Vector3d total = (sum_of(picture) * px_mm2).cwiseQuotient(light);
        for (std::size_t c = 0; c < 3; ++c) {
            const auto axis = static_cast<Eigen::Index>(c);
            if (total[axis] > most_light)
                throw InputError(
                    fmt::format("{}: {} sends back {:.3f} of the light in {}, more than it got; is the "
                                "card's albedo, its exposure or its square another?",
                                name, cell_name(from, geometry), total[axis], channel_name(c)));
            std::vector<double>& row = rows[c].emplace_back();
            for (const Eigen::Vector3d& mean : means) row.push_back(mean[axis] / light[axis]);
            totals[c].push_back(float(std::clamp(total[axis], 0.0, 1.0)));
        }
        progress.advance();
    }
    progress.end_stage();
    SweptResponses swept{{geometry.points[0], geometry.points[1], geometry.radius, geometry.pitch_mm, {}}, 0};
    double longest = 0;
    for (const double seconds : lit_card.seconds) longest = std::max(longest, seconds);
    for (std::size_t c = 0; c < 3; ++c) {
        swept.asymmetry = std::max(swept.asymmetry, expect_reciprocal(rows[c], geometry, c));
        optics::ChannelResponses& channel = swept.responses.channels.emplace_back(channel_of(rows[c], geometry));
        channel.total = totals[c];
        // Electrons that one unit would make, both ways; exposures as long as the card's longest.
        const double electrons = light[Eigen::Index(c)] / px_mm2 * longest * noise.full_well;
        channel.noise = 1 / (2 * electrons * geometry.pitch_mm * geometry.pitch_mm);
    }
    return swept;
}

}  // namespace voxtone::calibration
