// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/photo/photo_measurement.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <Eigen/LU>

#include "base/contracts.h"
#include "base/error.h"
#include "base/warning.h"
#include "calibration/target/target_surfaces.h"
#include "optics/colour/channels.h"

namespace voxtone::calibration {

namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double most_spread = 0.025;    // of reflectance, between blocks of a square: more is refused
constexpr double most_excess = 0.003;    // of reflectance, from noise cut off at 0: more is refused
constexpr double least_light = 0.04;     // of full scale, in the brightest channel of the frame
constexpr double blur_reach = 3.5;       // deviations of the blur between a sampled part and the edge of its square
constexpr double uneven_frame = 0.01;    // relative residual of the frame: more means shadows or glare
constexpr double steep_light = 0.5;      // least light on target and checker / most: less is said
constexpr double steepest_light = 0.25;  // less is refused
constexpr double chart_doubt = 0.03;     // residual of the chart in linear sRGB
constexpr double chart_wrong = 0.05;     // more is refused

/// From linear sRGB to wide channels.
Eigen::Matrix3d to_wide() { return Eigen::Matrix3d(optics::linear_srgb_weights(optics::wide_channels())).inverse(); }

[[noreturn]] void refuse(const std::string& photo, const std::string& what) {
    throw InputError(fmt::format("{}: {}", photo, what));
}

void check_sharp(const std::string& name, const Target& target, const TargetView& view, double inner) {
    double margin = 1e9;
    for (const TargetSquare& square : target.squares)
        margin = std::min(margin, 0.5 * (1 - inner) * square.area.size().minCoeff());
    if (view.blur_mm * blur_reach > margin)
        refuse(name,
               fmt::format(
                   "the photograph is blurred: edges spread over {:.2f} mm (one standard deviation; {:.1f} pixels), so "
                   "that squares mix with what is beside "
                   "them; at most {:.2f} mm can be used. Focus, use a tripod, or sample less of every square (--inner)",
                   view.blur_mm, view.blur_mm * view.px_per_mm, margin / blur_reach));
}

void check_area(const AreaSample& sample, const std::string& photo, const std::string& what) {
    if (!sample.complete)
        refuse(photo, fmt::format("{} is cut off by the edge of the picture or too small in it (9 pixels along the "
                                  "sampled part are needed)",
                                  what));
    for (int channel = 0; channel < 3; ++channel)
        if (sample.clipped[channel] > clipped_share)
            refuse(photo, fmt::format("{} is overexposed: the {} channel is clipped in {:.1f} % of its pixels, so that "
                                      "its value is not known. Expose less",
                                      what, std::array{"red", "green", "blue"}[std::size_t(channel)],
                                      100 * sample.clipped[channel]));
    if (sample.rejected > dirty_share)
        refuse(photo, fmt::format("{} is too dirty: {:.0f} % of it differ from the rest (dust, scratches, glare, a "
                                  "print gone wrong). Clean the target",
                                  what, 100 * sample.rejected));
}

std::vector<AreaSample> sample_squares(const io::Photograph& photo, const Target& target, const TargetView& view,
                                       const Vector3d& clip, const std::vector<Area>& areas) {
    std::vector<AreaSample> samples;
    for (std::size_t s = 0; s < areas.size(); ++s) {
        samples.push_back(sample_area(photo, view.place, areas[s], clip));
        check_area(samples.back(), photo.name, square_name(target, s));
    }
    return samples;
}

std::vector<LitSample> usable_frame(const PhotoMeasurement& m) {
    std::vector<LitSample> lit;
    double clipped = 0;
    for (const AreaSample& sample : m.frame) {
        clipped = std::max(clipped, sample.clipped.maxCoeff());
        if (sample.complete && sample.clipped.maxCoeff() <= clipped_share && sample.rejected <= dirty_share)
            lit.push_back({sample.middle_px, sample.mean, Vector3d::Zero()});
    }
    if (clipped > clipped_share)
        refuse(m.photograph.name,
               "the light frame of the target is overexposed: a channel is clipped there. Expose less");
    return lit;
}

void check_light(PhotoMeasurement& m, const std::vector<LitSample>& frame) {
    double brightest = 0;
    for (const LitSample& sample : frame) brightest = std::max(brightest, sample.value.maxCoeff());
    if (m.photograph.bits < 32 && brightest < least_light)
        refuse(m.photograph.name,
               fmt::format("the photograph is underexposed: the target's light frame reaches {:.1f} % of full scale, "
                           "dark squares vanish in the noise; expose at least {:.0f} times longer",
                           100 * brightest, std::ceil(0.5 / std::max(brightest, 1e-3))));
    if (m.model.frame_residual() > uneven_frame)
        refuse(m.photograph.name,
               fmt::format("the light on the target's frame varies by {:.1f} % in a way that is not smooth: a shadow, "
                           "glare, or dirt. Light the target evenly from one side at 45 degrees",
                           100 * m.model.frame_residual()));
    double least = 1e30, most = 0;
    for (const std::vector<AreaSample>* samples : {&m.frame, &m.checker.patches})
        for (const AreaSample& sample : *samples) {
            if (!sample.complete) continue;
            const double light = m.model.light(sample.middle_px);
            least = std::min(least, light);
            most = std::max(most, light);
        }
    const std::string fall =
        fmt::format("the light falls off to {:.0f} % across target and checker", 100 * least / most);
    if (least < steepest_light * most)
        refuse(m.photograph.name, fall +
                                      ", too much for it to be corrected; use light from further away, and less of "
                                      "the picture's corners");
    if (least < steep_light * most)
        m.warnings.push_back(named_warning(
            "uneven-light",
            fmt::format("{}: {}; it was corrected, but light from further away is better.", m.photograph.name, fall)));
    if (m.model.chart_residual() > chart_wrong)
        refuse(m.photograph.name,
               fmt::format("after the correction of light and colours the checker's patches are still off by {:.3f} on "
                           "average (linear, white is 1): another chart, glare on it, or samples that are not linear "
                           "light (a tone curve): develop the photograph linearly",
                           m.model.chart_residual()));
    if (m.model.chart_residual() > chart_doubt)
        m.warnings.push_back(named_warning(
            "checker-off",
            fmt::format("{}: after the colour correction the checker's patches are still off by {:.3f} on average "
                        "(linear, white is 1); colours of squares will be as much.",
                        m.photograph.name, m.model.chart_residual())));
}

void check_halves(const PhotoMeasurement& m, const Target& target) {
    const Vector3d frame = m.model.frame_reflectance();
    for (std::size_t s = 0; s < target.squares.size(); ++s) {
        // A saturated yellow is above 1 in sRGB's red, and nothing is in wide primaries.
        const double most = (to_wide() * m.rho[s]).maxCoeff();
        if (most > 1.02)
            refuse(m.photograph.name,
                   fmt::format("{} would reflect {:.3f}, more than a perfect white: the checker and the target are not "
                               "in the same light, or there is glare on the square",
                               square_name(target, s), most));
        const TargetSquare& square = target.squares[s];
        if (square.top.size() == 1 && square.top[0].role == target.dark && square.backing == target.dark &&
            m.rho[s].mean() > 0.7 * frame.mean())
            refuse(m.photograph.name,
                   fmt::format("{} is as light as the frame: {} and {} were exchanged, or they have no contrast",
                               square_name(target, s), target.light, target.dark));
    }
}

PhotoMeasurement measure_linear(io::Photograph photograph, const Target& target, const CheckerChart& chart,
                                const PhotoMeasureOptions& options) {
    PhotoMeasurement m;
    m.photograph = std::move(photograph);
    const io::Photograph& photo = m.photograph;
    const Vector3d clip = clipping_level(photo);
    m.view = find_target(photo, target, options.corners);
    check_sharp(photo.name, target, m.view, options.inner);
    for (const TargetSquare& square : target.squares)
        m.square_areas.push_back(square.area.shrunk(0.5 * (1 - options.inner) * square.area.size().minCoeff()));
    m.frame_areas = frame_areas(target);
    m.squares = sample_squares(photo, target, m.view, clip, m.square_areas);
    for (const Area& area : m.frame_areas) m.frame.push_back(sample_area(photo, m.view.place, area, clip));
    const std::vector<LitSample> frame = usable_frame(m);

    const Area slab{Vector2d::Zero(), target.size_mm};
    const std::array<Vector2d, 4> hidden{m.view.place.to_px({0, slab.max_mm.y()}), m.view.place.to_px(slab.max_mm),
                                         m.view.place.to_px({slab.max_mm.x(), 0}), m.view.place.to_px({0, 0})};
    m.checker = find_checker_in(photo, chart, clip, hidden, options.checker_corners);
    m.model = PhotoModel::fit(usable_patches(m.checker, chart), frame, photo.width_px, photo.height_px, photo.name);
    check_light(m, frame);
    for (std::size_t q = 0; q < m.squares.size(); ++q) {
        const AreaSample& sample = m.squares[q];
        const Vector3d spread = m.model.noise(sample.middle_px, sample.spread);
        if (spread.maxCoeff() > most_spread)
            refuse(photo.name,
                   fmt::format("{} is too noisy or too dirty: its parts differ by {:.3f} (standard deviation), "
                               "so that dirt cannot be told from noise. Clean the target, expose more, come "
                               "nearer",
                               square_name(target, q), spread.maxCoeff()));
        const Vector3d excess =
            m.model.to_linear_srgb().cwiseAbs() * sample.zero_excess / m.model.light(sample.middle_px);
        if (excess.maxCoeff() > most_excess)
            refuse(photo.name, fmt::format("{} is underexposed: {:.0f} % of its pixels are 0 in a channel, so that its "
                                           "mean is too large by about {:.3f}. Expose more",
                                           square_name(target, q), 100 * sample.at_zero.maxCoeff(), excess.maxCoeff()));
        m.rho.push_back(m.model.reflectance(sample.middle_px, sample.mean));
        m.error.push_back((m.model.error(sample.middle_px, sample.mean).cwiseAbs2() +
                           m.model.noise(sample.middle_px, sample.error).cwiseAbs2() + excess.cwiseAbs2())
                              .cwiseSqrt());
    }
    check_halves(m, target);
    if (m.view.markers < 4)
        m.warnings.push_back(named_warning(
            "markers",
            fmt::format("{}: only {} of the four markers were found; the place of the squares is less certain.",
                        photo.name, m.view.markers)));
    if (photo.bits == 8)
        m.warnings.push_back(named_warning(
            "coarse-samples",
            fmt::format("{}: 8 bits per sample are coarse for dark squares, and pictures of this kind were developed "
                        "for the eye; use the camera's RAW file or a linear 16-bit TIFF.",
                        photo.name)));
    return m;
}

}  // namespace

std::vector<Area> frame_areas(const Target& target) {
    const double marker = target.markers.front().area.size().x(), edge = 0.4 * marker, clearance = 0.25 * marker;
    std::vector<Area> areas;
    const Area slab = Area{Vector2d::Zero(), target.size_mm}.shrunk(clearance);
    const auto apart = [](const Area& a, const Area& b) {
        return (a.max_mm.array() < b.min_mm.array()).any() || (b.max_mm.array() < a.min_mm.array()).any();
    };
    // Whole rows and columns from both ends, so that the frame is covered evenly.
    const int columns = int((slab.size().x() + 1e-9) / (edge / 2)), rows = int((slab.size().y() + 1e-9) / (edge / 2));
    for (int row = 0; row <= rows; ++row)
        for (int column = 0; column <= columns; ++column) {
            const Vector2d corner = slab.min_mm + Vector2d(std::min(column * edge / 2, slab.size().x() - edge),
                                                           std::min(row * edge / 2, slab.size().y() - edge));
            const Area area{corner, corner + Vector2d::Constant(edge)}, wide = area.shrunk(-clearance),
                                                                        near = area.shrunk(-0.1 * marker);
            bool free = apart(wide, target.dark_half);
            for (const TargetSquare& square : target.squares) free = free && apart(wide, square.area);
            for (const TargetMarker& m : target.markers) free = free && apart(near, m.area);
            for (const Area& other : areas) free = free && apart(area, other);
            if (free) areas.push_back(area);
        }
    return areas;
}

PhotoMeasurement measure_photo(io::Photograph photograph, const Target& target, const CheckerChart& chart,
                               const PhotoMeasureOptions& options) {
    if (!(options.inner >= 0.1 && options.inner <= 0.9))
        throw UsageError(fmt::format("--inner {}: from 0.1 to 0.9 of a square's edge can be sampled", options.inner));
    if (options.coding != io::SampleCoding::unknown) photograph.coding = options.coding;
    if (photograph.coding != io::SampleCoding::unknown) {
        make_linear(photograph);
        return measure_linear(std::move(photograph), target, chart, options);
    }
    // The file does not say; the chart does: its greys are 28 to 1 apart in light and 5 to 1 in codes.
    io::Photograph decoded = photograph;
    decoded.coding = io::SampleCoding::srgb;
    make_linear(decoded);
    photograph.coding = io::SampleCoding::linear;
    std::optional<PhotoMeasurement> as_linear, as_srgb;
    std::optional<InputError> trouble;
    try {
        as_linear = measure_linear(std::move(photograph), target, chart, options);
    } catch (const InputError& error) {
        trouble = error;
    }
    try {
        as_srgb = measure_linear(std::move(decoded), target, chart, options);
    } catch (const InputError&) {
        if (!as_linear) throw *trouble;
    }
    const bool linear = as_linear && (!as_srgb || as_linear->model.chart_residual() <= as_srgb->model.chart_residual());
    PhotoMeasurement result = std::move(linear ? *as_linear : *as_srgb);
    result.warnings.push_back(named_warning(
        "coding-guessed",
        fmt::format(
            "{}: the file does not say how its samples stand for light; the checker's greys say {} (--coding sets it).",
            result.photograph.name, linear ? "linearly" : "as sRGB codes")));
    return result;
}

namespace {

struct Mean {
    Vector3d rho = Vector3d::Zero(), error = Vector3d::Zero();
};

/// Squares with a channel below 0, by more than three of its errors or by less.
struct NegativeSquares {
    std::vector<std::size_t> surely, hardly;
};

NegativeSquares negative_squares(const std::vector<Mean>& means) {
    constexpr double sure = 3;
    NegativeSquares squares;
    for (std::size_t s = 0; s < means.size(); ++s) {
        if ((means[s].rho.array() < -sure * means[s].error.array()).any())
            squares.surely.push_back(s);
        else if (means[s].rho.minCoeff() < 0)
            squares.hardly.push_back(s);
    }
    return squares;
}

/// How values below 0 are written.
enum class Told { cut, signed_rgb, wide };

void tell_negative(const NegativeSquares& negative, Told told, const Target& target, MeasuredTable& result) {
    const std::string_view written = told == Told::cut ? "written as 0" : "written as it is";
    if (!negative.hardly.empty() && told != Told::wide)
        result.warnings.push_back(named_warning(
            "beyond-rgb", fmt::format("In {} square(s), first of all {}, a channel came out below 0 by less than three "
                                      "of its errors; it is {}.",
                                      negative.hardly.size(), square_name(target, negative.hardly.front()), written)));
    if (negative.surely.empty()) return;
    const std::string where = fmt::format(
        "In {} square(s), first of all {}, a channel of linear sRGB lies below 0 by more than three of its errors: "
        "these "
        "inks are more saturated than it can say",
        negative.surely.size(), square_name(target, negative.surely.front()));
    if (told == Told::wide)
        result.warnings.push_back(named_warning("beyond-rgb", where + "; the table is in wide channels (wR, wG, wB)."));
    else if (told == Told::cut)
        result.warnings.push_back(named_warning(
            "beyond-rgb", where + "; it is written as 0, so that an ink may be stronger there than it is found."));
    else
        result.warnings.push_back(named_warning("beyond-rgb", where + "; it is written as it is."));
}

void make_wide(std::vector<double>& rho) {
    const Vector3d values = to_wide() * Vector3d(rho[0], rho[1], rho[2]);
    rho.assign(values.begin(), values.end());
}

void widen(std::vector<Mean>& means) {
    const Eigen::Matrix3d map = to_wide();
    for (Mean& mean : means) {
        mean.rho = map * mean.rho;
        mean.error = (map.cwiseAbs2() * mean.error.cwiseAbs2()).cwiseSqrt();
    }
}

// A square that is lighter than a perfect diffuser: by more than its error something is wrong.
void tell_too_light(const std::vector<Mean>& means, const Target& target, MeasuredTable& result) {
    std::size_t squares = 0, first = 0;
    double most = 1;
    for (std::size_t s = 0; s < means.size(); ++s) {
        const double rho = means[s].rho.maxCoeff();
        if (rho <= 1) continue;
        if (squares++ == 0) first = s;
        most = std::max(most, rho);
    }
    if (squares > 0)
        result.warnings.push_back(named_warning(
            "beyond-rgb",
            fmt::format(
                "In {} square(s), first of all {}, a channel lies above that of a perfect diffuser, up to {:.3f}, and "
                "is "
                "written as 1: an ink more saturated than R, G, B can say, gloss, uneven light, or a "
                "checker that is not what its file says. Look at the overlay.",
                squares, square_name(target, first), most)));
}

}  // namespace

MeasuredTable average_photos(const std::vector<PhotoMeasurement>& photos, const Target& target,
                             PhotoChannels channels) {
    VOXTONE_EXPECT(!photos.empty());
    MeasuredTable result;
    const double count = double(photos.size());
    std::vector<Mean> means;
    for (std::size_t s = 0; s < target.squares.size(); ++s) {
        Mean mean;
        Vector3d error2 = Vector3d::Zero(), spread2 = Vector3d::Zero();
        for (const PhotoMeasurement& photo : photos) {
            mean.rho += photo.rho[s] / count;
            error2 += photo.error[s].cwiseAbs2() / count;
        }
        for (const PhotoMeasurement& photo : photos)
            spread2 += (photo.rho[s] - mean.rho).cwiseAbs2() / std::max(1.0, count - 1);
        constexpr double differ = 0.02;
        if (spread2.cwiseSqrt().maxCoeff() > differ)
            result.warnings.push_back(named_warning(
                "uneven-light",
                fmt::format(
                    "{} differs by {:.3f} between the photographs: the light or the exposure of one of them is off.",
                    square_name(target, s), spread2.cwiseSqrt().maxCoeff())));
        mean.error = (error2 / count).cwiseMax(spread2 / count).cwiseSqrt();
        means.push_back(mean);
        result.spread.push_back(spread2.cwiseSqrt());
    }
    const NegativeSquares negative = negative_squares(means);
    const bool wide = !target.is_chart() && channels == PhotoChannels::wide;
    tell_negative(negative, wide ? Told::wide : target.is_chart() ? Told::signed_rgb : Told::cut, target, result);
    if (wide) {
        widen(means);
        result.table.channels = optics::wide_channels();
        if (const NegativeSquares still = negative_squares(means); !still.surely.empty())
            result.warnings.push_back(named_warning(
                "beyond-rgb",
                fmt::format(
                    "In {} square(s), first of all {}, a wide channel lies below 0 by more than three of its errors, "
                    "which "
                    "no ink can: glare, a checker that is not what its file says, or a camera whose colours no matrix "
                    "relates to it. Look at the overlay.",
                    still.surely.size(), square_name(target, still.surely.front()))));
    }
    result.table.is_chart = target.is_chart();
    if (!target.is_chart()) tell_too_light(means, target, result);
    for (std::size_t s = 0; s < means.size(); ++s) {
        const TargetSquare& square = target.squares[s];
        Patch patch = patch_of(target, square);
        patch.where = square_name(target, s);
        if (target.is_chart()) patch.backing.clear(), patch.thickness_mm = patch.base_mm = 0;
        for (int channel = 0; channel < 3; ++channel) {
            const double rho = means[s].rho[channel];
            patch.rho.push_back(target.is_chart() ? rho : std::clamp(rho, wide ? -1.0 : 0.0, 1.0));
            patch.error.push_back(means[s].error[channel]);
        }
        result.table.patches.push_back(std::move(patch));
    }
    if (wide) change_surfaces(result.table, [](PatchSurface& surface) { make_wide(surface.rho); });
    return result;
}

}  // namespace voxtone::calibration
