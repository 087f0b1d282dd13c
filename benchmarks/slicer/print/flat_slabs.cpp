// SPDX-License-Identifier: GPL-3.0-or-later
#include "flat_slabs.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "base/contracts.h"
#include "io/files/whole_file.h"
#include "io/pictures/picture.h"
#include "io/pictures/picture_writer.h"
#include "optics/colour/colour.h"

namespace voxtone::loop_benchmark {

namespace {

constexpr double judged_mm = 4;

double difference(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
    return optics::ciede2000(optics::lab_from_linear_srgb(a.cwiseMax(0)), optics::lab_from_linear_srgb(b.cwiseMax(0)));
}

Eigen::Vector3d middle_of(const Judgement& j, const Colours& colours) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    double n = 0;
    for (std::size_t i = 0; i < colours.size(); ++i) {
        const auto& at = j.surface.cells[i].centre_mm;
        const double x = static_cast<double>(at[0]) - flat_mm / 2, y = static_cast<double>(at[1]) - flat_mm / 2;
        if (std::abs(x) > judged_mm / 2 || std::abs(y) > judged_mm / 2) continue;
        sum += colours[i].cast<double>();
        n += 1;
    }
    VOXTONE_EXPECT(n > 0);
    return sum / n;
}

}  // namespace

std::vector<FlatTarget> flat_targets(const std::filesystem::path& work) {
    std::filesystem::create_directories(work);
    // sRGB codes, so that the picture holds them exactly.
    static constexpr std::array<std::array<int, 3>, 9> codes{{{230, 230, 230},
                                                              {160, 160, 160},
                                                              {90, 90, 90},
                                                              {190, 120, 110},
                                                              {120, 160, 110},
                                                              {110, 130, 170},
                                                              {200, 180, 110},
                                                              {150, 100, 140},
                                                              {80, 110, 110}}};
    std::vector<FlatTarget> out;
    for (const auto& code : codes) {
        FlatTarget target;
        for (int c = 0; c < 3; ++c) {
            const double s = code[static_cast<std::size_t>(c)] / 255.0;
            target.rgb[c] = static_cast<float>(s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4));
        }
        target.picture = work / fmt::format("flat-{:02x}{:02x}{:02x}.png", code[0], code[1], code[2]);
        io::LinearPicture picture;
        picture.width_px = picture.height_px = 80;
        picture.pixels.assign(std::size_t{80} * 80, {target.rgb[0], target.rgb[1], target.rgb[2], 1.0F});
        io::write_whole_file(target.picture, io::png_bytes(io::encode_over(picture, Eigen::Vector3f::Ones())));
        out.push_back(std::move(target));
    }
    return out;
}

void judge_flat(const Judgement& judged, std::size_t way, FlatRow& row) {
    const Eigen::Vector3d a = middle_of(judged, judged.half[0]), b = middle_of(judged, judged.half[1]);
    row.difference[way] = difference(row.rgb.cast<double>(), 0.5 * (a + b));
    row.noise = difference(a, b) / 2;
}

std::string flat_table(const std::vector<FlatRow>& rows) {
    std::string text = "| colour, linear sRGB | open loop | loop | noise of the tracer |\n|---|---|---|---|\n";
    std::array<double, 2> mean{}, most{};
    for (const FlatRow& row : rows) {
        text += fmt::format("| {:.2f} {:.2f} {:.2f} | {:.2f} | {:.2f} | {:.2f} |\n", row.rgb[0], row.rgb[1], row.rgb[2],
                            row.difference[0], row.difference[1], row.noise);
        for (std::size_t v = 0; v < 2; ++v) {
            mean[v] += row.difference[v] / static_cast<double>(rows.size());
            most[v] = std::max(most[v], row.difference[v]);
        }
    }
    return text + fmt::format("| mean | {:.2f} | {:.2f} | |\n| largest | {:.2f} | {:.2f} | |\n", mean[0], mean[1],
                              most[0], most[1]);
}

}  // namespace voxtone::loop_benchmark
