// SPDX-License-Identifier: GPL-3.0-or-later
#include "scores.h"

#include <algorithm>

#include "base/parallel.h"
#include "optics/colour/colour.h"
#include "optics/scene/surface_smoothing.h"

namespace voxtone::loop_benchmark {
namespace {

Eigen::Vector3d lab(const Eigen::Vector3f& rgb) {
    return optics::lab_from_linear_srgb(rgb.cwiseMax(0.0F).cast<double>());
}

optics::DifferenceSummary summary(const Colours& a, const Colours& b, std::span<const char> mask) {
    const std::vector<double> all = differences(a, b);
    std::vector<double> counted;
    for (std::size_t i = 0; i < all.size(); ++i)
        if (mask.empty() || mask[i]) counted.push_back(all[i]);
    return optics::summarize(counted);
}

double share_at_limit(const Judgement& j, const halftone::EyeFilter& eye) {
    constexpr float nearly = 0.02F;
    const Colours target = eye.filter(j.target), seen = eye.filter(j.print());
    const std::vector<double> difference = differences(target, seen);
    double all = 0, at_limit = 0;
    for (std::size_t i = 0; i < difference.size(); ++i) {
        if (!j.in_gamut[i]) continue;
        all += difference[i];
        const bool too_dark = lab(seen[i])[0] < lab(target[i])[0];
        if (too_dark ? j.white_share[i] > 1 - nearly : j.white_share[i] < nearly) at_limit += difference[i];
    }
    return all > 0 ? at_limit / all : 0;
}

/// L* less its mean over fine_mm.
std::vector<float> fine_lightness(const optics::Surface& surface, const Colours& colours) {
    const std::vector<optics::SurfacePoint> points = optics::surface_points(surface);
    const optics::SurfaceSmoothing smoothing(points, fine_mm, 0, optics::typical_edge_mm(points));
    std::vector<float> lightness(colours.size()), mean(colours.size());
    parallel_for(0, colours.size(), 1024,
                 [&](std::size_t i) { lightness[i] = static_cast<float>(lab(colours[i])[0]); });
    smoothing.apply(lightness, mean, 1);
    for (std::size_t i = 0; i < mean.size(); ++i) lightness[i] -= mean[i];
    return lightness;
}

double paper_difference(const Colours& target, const Colours& print) {
    constexpr double white = 99.5;  // L*
    const std::vector<double> difference = differences(target, print);
    double sum = 0, cells = 0;
    for (std::size_t i = 0; i < target.size(); ++i)
        if (lab(target[i])[0] > white) sum += difference[i], ++cells;
    return cells > 0 ? sum / cells : 0;
}

}  // namespace

double contrast_kept(const optics::Surface& surface, const Colours& target, const Colours& print,
                     std::span<const char> mask) {
    const std::vector<float> asked = fine_lightness(surface, target), shown = fine_lightness(surface, print);
    double both = 0, square = 0;
    for (std::size_t i = 0; i < asked.size(); ++i) {
        if (!mask.empty() && !mask[i]) continue;
        both += static_cast<double>(asked[i]) * static_cast<double>(shown[i]);
        square += static_cast<double>(asked[i]) * static_cast<double>(asked[i]);
    }
    constexpr double barely = 1e-3;  // of L*
    return square > barely * barely * static_cast<double>(asked.size()) ? both / square : 0;
}

std::vector<double> differences(const Colours& a, const Colours& b) {
    std::vector<double> d(a.size());
    parallel_for(0, a.size(), 1024, [&](std::size_t i) { d[i] = optics::ciede2000(lab(a[i]), lab(b[i])); });
    return d;
}

Figures compare(const Colours& target, const std::array<Colours, 2>& half, std::span<const char> mask) {
    Colours mean(target.size());
    for (std::size_t i = 0; i < mean.size(); ++i) mean[i] = 0.5F * (half[0][i] + half[1][i]);
    const auto m = summary(target, mean, mask), a = summary(target, half[0], mask), b = summary(target, half[1], mask);
    const auto without_noise = [&](double optics::DifferenceSummary::*f) {
        return std::max(0.0, 2 * m.*f - (a.*f + b.*f) / 2);
    };
    return {without_noise(&optics::DifferenceSummary::mean), without_noise(&optics::DifferenceSummary::median),
            without_noise(&optics::DifferenceSummary::percentile_95), summary(half[0], half[1], mask).mean / 2,
            m.count};
}

Scores score(const Judgement& j, const Eye& eye) {
    const auto through = [&](const halftone::EyeFilter& with, std::span<const char> mask) {
        return compare(with.filter(j.target), {with.filter(j.half[0]), with.filter(j.half[1])}, mask);
    };
    Scores s;
    s.cells_in_gamut = compare(j.target, j.half, j.in_gamut);
    s.cells_all = compare(j.target, j.half, {});
    s.eye_in_gamut = through(eye.as_light, j.in_gamut);
    s.eye_all = through(eye.as_light, {});
    const Colours reachable = eye.as_light.filter(j.mapped);
    const std::array<Colours, 2> seen{eye.as_light.filter(j.half[0]), eye.as_light.filter(j.half[1])};
    s.eye_reachable = compare(reachable, seen, j.in_gamut);
    s.eye_mapped = compare(reachable, seen, {});
    s.seen_in_gamut = through(eye.seen, j.in_gamut);
    s.s_cielab_in_gamut = through(eye.s_cielab, j.in_gamut);
    s.at_limit = share_at_limit(j, eye.as_light);
    const Colours wanted = eye.seen.filter(j.target), shown = eye.seen.filter(j.print());
    s.contrast_kept = contrast_kept(j.surface, wanted, shown, j.in_gamut);
    s.paper = paper_difference(wanted, shown);
    return s;
}

}  // namespace voxtone::loop_benchmark
