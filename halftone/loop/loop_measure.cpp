// SPDX-License-Identifier: GPL-3.0-or-later
#include "halftone/loop/loop_measure.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/parallel.h"
#include "halftone/loop/paper.h"
#include "optics/scene/area_summary.h"

namespace voxtone::halftone {

namespace {

constexpr float most_weight = 4;
constexpr double let_go = 0.25;  // CIEDE2000: nobody sees that a region is so much worse

std::vector<double> differences(std::span<const Eigen::Vector3f> a, std::span<const Eigen::Vector3f> b) {
    std::vector<double> difference(a.size());
    parallel_for(0, a.size(), 1024, [&](std::size_t i) {
        const auto lab = [](const Eigen::Vector3f& v) {
            return optics::lab_from_linear_srgb(v.cast<double>().cwiseMax(0));
        };
        difference[i] = optics::ciede2000(lab(a[i]), lab(b[i]));
    });
    return difference;
}

}  // namespace

LoopMeasure::LoopMeasure(const optics::Surface& surface, std::span<const Eigen::Vector3f> target,
                         std::span<const Eigen::Vector3f> shown, const std::vector<char>& in_gamut,
                         double viewing_distance_mm, bool adapts)
    : surface_(surface),
      eye_(surface, viewing_distance_mm, EyeSurround::none),
      asked_(target),
      seen_shown_(eye_.filter(shown)),
      in_gamut_(in_gamut),
      adapts_(adapts),
      regions_(colour_regions(surface, target)) {
    EyeFilter::Views asked = eye_.views(target);
    seen_asked_ = std::move(asked.filtered), near_asked_ = std::move(asked.smoothed);
    weight_ = weights(std::vector<float>(regions_.size(), 1.0f), 0);
}

float LoopMeasure::weight_of(const ColourRegion& region) const {
    return std::min(most_weight, static_cast<float>(std::sqrt(regions_.front().area_mm2 / region.area_mm2)));
}

std::vector<float> LoopMeasure::weights(std::span<const float> urgency, float beyond) const {
    std::vector<float> weight(asked_.size());
    for (std::size_t i = 0; i < weight.size(); ++i) weight[i] = in_gamut_[i] ? 1 : beyond;
    for (std::size_t r = 0; r < regions_.size(); ++r)
        for (const std::uint32_t i : regions_[r].cells) weight[i] = urgency[r] * weight_of(regions_[r]);
    return weight;
}

LoopMeasure::Value LoopMeasure::operator()(std::span<const Eigen::Vector3f> rgb,
                                           std::span<const RegionLook> open) const {
    Value value;
    if (adapts_) value.paper = paper_level(surface_, asked_, rgb);
    value.views = eye_.views(rgb);
    std::vector<Eigen::Vector3f> seen = value.views.filtered;
    for (Eigen::Vector3f& colour : seen) colour /= value.paper;
    value.seen = optics::summarize_by_area(surface_, differences(seen_asked_, seen));
    value.cells = optics::summarize_by_area(surface_, differences(asked_, rgb));
    const std::vector<double> off = differences(seen_shown_, seen);
    double sum = 0, all = 0;
    for (std::size_t i = 0; i < off.size(); ++i) {
        const double a = static_cast<double>(weight_[i] * surface_.cells[i].area_mm2);
        sum += a * off[i], all += a;
    }
    seen = value.views.smoothed;
    for (Eigen::Vector3f& colour : seen) colour /= value.paper;
    value.looks = look_at(regions_, surface_, near_asked_, seen);
    for (std::size_t r = 0; r < open.size(); ++r)
        sum += regions_[r].area_mm2 * static_cast<double>(weight_of(regions_[r])) *
               std::max(0.0, worse_by(value.looks[r], open[r]) - let_go);
    value.score = all > 0 ? sum / all : 0;
    return value;
}

}  // namespace voxtone::halftone
