// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/spot/profile_measurement.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <fmt/format.h>

#include "base/contracts.h"
#include "base/error.h"
#include "base/warning.h"

namespace voxtone::calibration {
namespace {

constexpr double doubtful_step = 0.03, doubtful_scale = 0.02, doubtful_noise = 2, doubtful_tail = 0.01,
                 doubtful_cut = 0.02, unlike_step = 0.3;
constexpr const char* channel_names[] = {"red", "green", "blue"};

void require(bool holds, const char* option, double value, const char* rule) {
    if (!holds) throw InputError(fmt::format("{} is {}; {}", option, value, rule));
}

void check(const ExposureSeries& series) {
    if (series.lit.empty()) throw InputError(fmt::format("the {} series has no exposures", series.name));
    if (series.lit.size() != series.dark.size())
        throw InputError(
            fmt::format("the {} series has {} exposures and {} dark frames; every exposure needs a dark frame of the "
                        "same time, in the same order",
                        series.name, series.lit.size(), series.dark.size()));
    for (int c = 0; c < 3; ++c)
        if (!(series.total[c] > 0 && series.total[c] <= 1))
            throw InputError(
                fmt::format("the {} albedo of the {} channel is {}; it is a share of the light, above 0 and up to 1",
                            series.name, channel_names[c], series.total[c]));
}

void warn_of_steps(const MergedPicture& picture, const ExposureSeries& series, std::vector<std::string>& warnings) {
    for (std::size_t k = 0; k < picture.step.size(); ++k) {
        const double off = picture.step[k] - 1;
        const std::string what =
            fmt::format("{}: the exposure of {} is {:.1f} % {} than the shorter ones let expect", series.name,
                        seconds_text(picture.seconds[k + 1]), 100 * std::abs(off), off > 0 ? "brighter" : "darker");
        if (std::abs(off) > unlike_step)
            throw InputError(
                what + "; its time is wrong, or the light or the camera's settings changed, or values are not linear");
        if (std::abs(off) > doubtful_step)
            warnings.push_back(
                named_warning("exposures", what + "; times on a dial are rounded: give measured ones (FILE@SECONDS)"));
    }
}

double light_of_tail(const RadialProfile& profile, double spacing_mm) {
    const std::size_t n = profile.light.size();
    double sum = 0;
    for (std::size_t i = n - n / 10; i < n; ++i) sum += static_cast<double>(i) * profile.light[i];
    return 2 * std::numbers::pi * spacing_mm * spacing_mm * sum;
}

}  // namespace

void ProfileMeasureOptions::validate() const {
    require(mm_per_px > 0 && std::isfinite(mm_per_px), "mm per pixel", mm_per_px,
            "photograph a scale and give a value above 0");
    require(spacing_mm > 0 && std::isfinite(spacing_mm), "the spacing", spacing_mm,
            "give the distance between samples in mm, above 0");
    require(spacing_mm >= mm_per_px, "the spacing", spacing_mm,
            fmt::format("it must not be below the width of a pixel, {} mm, or rings between pixels hold none: give "
                        "--spacing {}mm or more",
                        mm_per_px, mm_per_px)
                .c_str());
    require(reach_mm >= 0 && std::isfinite(reach_mm), "the reach", reach_mm,
            "it must be 0 (to the border) or above, in mm");
    require(most_asymmetry > 0, "the largest asymmetry", most_asymmetry, "it must be above 0");
    require(noise.full_well > 0, "the full well", noise.full_well, "it must be above 0 electrons");
    require(noise.read_noise > 0 && noise.read_noise < 1, "the read noise", noise.read_noise,
            "it must lie between 0 and 1, parts of full scale");
    require(noise.saturation > 0 && noise.saturation <= 1, "saturation", noise.saturation,
            "it must be above 0 and up to 1, parts of full scale");
}

optics::RadialSamples MeasuredSide::samples(std::size_t channel) const {
    return {spacing_mm, profile[channel].light, total[channel], profile[channel].error};
}

MeasuredSide measure_merged(const MergedPicture& picture, const ExposureSeries& series,
                            const ProfileMeasureOptions& options) {
    options.validate();
    const double spacing_px = options.spacing_mm / options.mm_per_px;
    MeasuredSide side;
    side.seconds = picture.seconds, side.step = picture.step, side.spacing_mm = options.spacing_mm;
    side.pixels.assign(picture.seconds.size() + 1, 0);
    for (const std::uint8_t longest : picture.exposures)
        ++side.pixels[std::min<std::size_t>(longest, picture.seconds.size())];
    warn_of_steps(picture, series, side.warnings);
    if (picture.cut_at_black > doubtful_cut)
        side.warnings.push_back(named_warning(
            "noisy-profile",
            fmt::format(
                "{}: {:.0f} % of a dark frame's samples are exactly 0: noise below black was cut off, so the faint "
                "end of the profile is wrong by about that noise; convert RAW files without taking the black level off",
                series.name, 100 * picture.cut_at_black)));
    const auto named = [&](const InputError& error) {
        return InputError(fmt::format("{} series: {}", series.name, error.what()));
    };
    try {
        const double wanted_px =
            options.reach_mm > 0 ? options.reach_mm / options.mm_per_px : std::numeric_limits<double>::max();
        side.centre = find_radial_centre(picture, spacing_px, wanted_px);
        const double border_px = border_distance_px(picture, side.centre.px);
        if (options.reach_mm > 0 && wanted_px > border_px)
            throw InputError(fmt::format(
                "a profile of {} mm does not fit: the centre, at ({:.1f}, {:.1f}) px, is {:.2f} mm from the border "
                "of the picture",
                options.reach_mm, side.centre.px.x(), side.centre.px.y(), border_px * options.mm_per_px));
        const RadialPlan plan{side.centre.px, options.mm_per_px, options.spacing_mm,
                              1 + static_cast<std::size_t>(std::min(wanted_px, border_px) / spacing_px * (1 + 1e-12))};
        for (int c = 0; c < 3; ++c) {
            const auto i = static_cast<std::size_t>(c);
            side.total[i] = series.total[c];
            RadialProfile& profile = side.profile[i];
            profile = average_rings(picture, c, plan, series.total[c]);
            if (profile.asymmetry > options.most_asymmetry)
                throw InputError(fmt::format(
                    "the spot is not round: in {} it differs from its rings by {:.1f} % (at most {:.1f} %); look for a "
                    "second lit pixel, a tilted camera, dust or an edge of the slab",
                    channel_names[c], 100 * profile.asymmetry, 100 * options.most_asymmetry));
        }
    } catch (const InputError& error) {
        throw named(error);
    }
    for (std::size_t c = 0; c < 3; ++c) {
        const RadialProfile& profile = side.profile[c];
        side.tail[c] = light_of_tail(profile, options.spacing_mm) / side.total[c];
        if (side.tail[c] > doubtful_tail)
            side.warnings.push_back(named_warning(
                "cut-profile",
                fmt::format(
                    "{}, {}: the last tenth of the profile holds {:.1f} % of the light; what lies beyond is counted "
                    "within, which makes the profile too bright: photograph more of what is about the spot",
                    series.name, channel_names[c], 100 * side.tail[c])));
        if (profile.scale_error > doubtful_scale)
            side.warnings.push_back(named_warning(
                "noisy-profile",
                fmt::format(
                    "{}, {}: the light of all rings is known to {:.1f} % only, for faint rings far out are wide; "
                    "give a shorter reach or expose longer",
                    series.name, channel_names[c], 100 * profile.scale_error)));
        if (profile.noise > doubtful_noise)
            side.warnings.push_back(named_warning(
                "noisy-profile",
                fmt::format(
                    "{}, {}: pixels scatter {:.1f} times as much as the camera's noise says (errors hold that); "
                    "dust, a moving slab, or a noisier camera",
                    series.name, channel_names[c], profile.noise)));
    }
    return side;
}

MeasuredSide measure_side(const ExposureSeries& series, const ProfileMeasureOptions& options,
                          const Progress* progress) {
    options.validate();
    check(series);
    ExposureMerge merge(options.noise);
    std::vector<std::filesystem::path> files = names_of(series.lit);
    for (std::filesystem::path& file : names_of(series.dark)) files.push_back(std::move(file));
    io::PhotographReader reader(files);
    for (std::size_t k = 0; k < series.lit.size(); ++k) {
        if (progress) progress->check_cancelled();
        merge.add(read_exposure(series.lit[k], reader, progress), read_exposure(series.dark[k], reader, progress));
    }
    return measure_merged(merge.merged(), series, options);
}

void expect_no_light_made(const Eigen::Vector3d& reflectance, const Eigen::Vector3d& transmittance) {
    constexpr double most = 1.02;  // what reading the file again allows (measured_profile.h)
    for (int c = 0; c < 3; ++c)
        if (const double sum = reflectance[c] + transmittance[c]; sum > most)
            throw InputError(
                fmt::format("the slab reflects {} and transmits {} of the {} light, {:.4g} in all: more than it got; "
                            "measure both albedos again, against "
                            "the same white",
                            reflectance[c], transmittance[c], channel_names[c], sum));
}

double blurred_from(double radius_mm, double share) {
    VOXTONE_EXPECT(radius_mm > 0 && share > 0 && share <= 0.5);
    double low = 0, high = 2.5;  // z = 2 pi k a; the factor falls from 1 to 0.4
    for (int i = 0; i < 60; ++i) {
        const double z = (low + high) / 2;
        (2 * std::cyl_bessel_j(1, z) / z > 1 - share ? low : high) = z;
    }
    return low / (2 * std::numbers::pi * radius_mm);
}

}  // namespace voxtone::calibration
