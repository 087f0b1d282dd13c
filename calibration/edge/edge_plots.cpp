// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/edge/edge_plots.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include <fmt/format.h>

#include "calibration/resins/resin_coordinates.h"
#include "io/pictures/picture_writer.h"
#include "io/report/plot_svg.h"

namespace voxtone::calibration {
namespace {

using io::Plot;
using io::PlotAxis;

constexpr const char* slab_colours[] = {"#1565c0", "#c62828", "#2e7d32", "#6a1b9a"};
constexpr const char* channel_colours[] = {"#c62828", "#2e7d32", "#1565c0"};
constexpr Eigen::Index strip_px = 362;  // wide
constexpr std::uint32_t strip_height_px = 44;
constexpr double map_range = 200;  // of the distance, from the least

const char* slab_colour(std::size_t s) { return slab_colours[s % std::size(slab_colours)]; }

Plot::Points points(const Eigen::VectorXd& x, const Eigen::VectorXd& y, Eigen::Index step = 1) {
    Plot::Points list;
    for (Eigen::Index k = 0; k < y.size(); k += step) list.emplace_back(x[k], y[k]);
    return list;
}

PlotAxis across_edge(double half) {
    PlotAxis axis{-half, half, false, {}, "mm across the edge"};
    const double step = half > 2 ? 1 : 0.5;
    for (double m = -std::floor(half / step) * step; m <= half + 1e-9; m += step) axis.marks.push_back(m);
    return axis;
}

// The nearest values of a list to both sides of x.
std::vector<double> around(const std::vector<double>& list, double x) {
    std::vector<double> pair;
    const auto above = std::ranges::upper_bound(list, x * (1 + 1e-9));
    const auto below = std::ranges::lower_bound(list, x * (1 - 1e-9));
    if (below != list.begin()) pair.push_back(*(below - 1));
    if (above != list.end()) pair.push_back(*above);
    return pair;
}

// From blue over green to yellow, t from 0 to 1; evenly growing lightness.
Eigen::Vector3f map_colour(double t) {
    const Eigen::Vector3f stops[] = {{0.03F, 0.04F, 0.20F},
                                     {0.04F, 0.20F, 0.32F},
                                     {0.07F, 0.42F, 0.30F},
                                     {0.40F, 0.66F, 0.12F},
                                     {0.98F, 0.86F, 0.20F}};
    const double at = std::clamp(t, 0.0, 1.0) * 4;
    const auto k = std::min<std::size_t>(3, static_cast<std::size_t>(at));
    const auto part = static_cast<float>(at - static_cast<double>(k));
    return stops[k] * (1 - part) + stops[k + 1] * part;
}

// Values of R, G, B along rows of one colour each.
void add_rows(io::LinearPicture& picture, const std::array<Eigen::VectorXd, 3>& value) {
    for (std::uint32_t row = 0; row < strip_height_px; ++row, ++picture.height_px)
        for (Eigen::Index column = 0; column < strip_px; ++column) {
            Eigen::Vector4f pixel(0, 0, 0, 1);
            for (std::size_t c = 0; c < 3; ++c)
                pixel[static_cast<Eigen::Index>(c)] =
                    static_cast<float>(std::clamp(value[c][column * value[c].size() / strip_px], 0.0, 1.0));
            picture.pixels.push_back(pixel);
        }
}

io::LinearPicture map_picture(const Eigen::MatrixXd& distance, double least, double most) {
    io::LinearPicture picture{
        static_cast<std::uint32_t>(distance.cols()), static_cast<std::uint32_t>(distance.rows()), {}};
    for (Eigen::Index row = distance.rows() - 1; row >= 0; --row)
        for (Eigen::Index column = 0; column < distance.cols(); ++column) {
            const Eigen::Vector3f colour = map_colour(std::log(distance(row, column) / least) / std::log(most / least));
            picture.pixels.emplace_back(colour[0], colour[1], colour[2], 1.0F);
        }
    return picture;
}

void cross(Plot& plot, double x, double y, const char* colour) {
    plot.line({{x / 1.35, y}, {x * 1.35, y}}, colour, 1.6);
    plot.line({{x, y / 1.15}, {x, y * 1.15}}, colour, 1.6);
}

Plot one_map(const EdgeMap& map, const EdgeSimilarity& all, const Plot::Points& similar, double least, bool of_fit,
             const std::string& title) {
    const auto beyond = [](const std::vector<double>& list, bool end) {  // pixels are rectangles round their values
        const double step = std::sqrt(list[1] / list[0]);
        return end ? list.back() * step : list.front() / step;
    };
    Plot plot({beyond(all.co_albedo, false), beyond(all.co_albedo, true), true, {0.001, 0.01, 0.1}, "1 - albedo"},
              {beyond(all.sigma_t, false), beyond(all.sigma_t, true), true, {1, 2, 5, 10, 20}, "extinction, 1/mm"},
              title, 170, 140);
    plot.picture(io::png_bytes(io::encode_over(map_picture(map.distance, least, map_range * least), {0, 0, 0})));
    plot.line(similar, "#ffffff", 1, true);
    plot.point(1 - map.similar.albedo, map.similar.sigma_t, "#ffffff");
    cross(plot, 1 - map.fitted.albedo, map.fitted.sigma_t, of_fit ? "#ff1744" : "#ff8a80");
    return plot;
}

}  // namespace

std::vector<double> plot_marks(double most) {
    double step = std::pow(10, std::floor(std::log10(most / 2)));
    if (most / step > 10) step *= 5;
    std::vector<double> marks;
    for (double v = 0; v <= most * 1.0001; v += step) marks.push_back(v);
    return marks;
}

EdgePlots::EdgePlots(const EdgeFit& fit, const EdgeResinFit& resin, const std::vector<EdgeProfile>& profiles,
                     const EdgeProfileTable& table, const EdgeFitOptions& options)
    : fit_(fit), resin_(resin), table_(table), options_(options) {
    for (std::size_t c = 0; c < 3; ++c)
        for (const EdgeProfile& profile : profiles) {
            if (profile.resin != resin.role) continue;
            std::vector<std::string> ignored;
            auto one = edge_observations({&profile}, c, table, options.metric, ignored);
            if (one.empty()) continue;
            channels_[c].seen.push_back(std::move(one.front()));
            channels_[c].thickness_mm.push_back(profile.thickness_mm);
        }
}

EdgeObjective EdgePlots::objective(std::size_t channel) const {
    return {channels_[channel].seen, channel, table_, options_.metric};
}

io::ReportDrawing EdgePlots::profiles(std::size_t c) const {
    const auto& [seen, thickness_mm] = channels_[c];
    double most = 0.01;
    for (const EdgeObservation& slab : seen) most = std::max(most, fit_.mu * slab.value.maxCoeff());
    const double half = table_.setup().width_mm / 2;
    Plot plot(across_edge(half), {0, most * 1.05, false, plot_marks(most), "reflectance"},
              fmt::format("{} in {}", resin_.role, "RGB"[c]), 330, 220);
    const EdgeObjective of = objective(c);
    for (std::size_t s = 0; s < seen.size(); ++s) {
        const EdgeObservation& slab = seen[s];
        for (Eigen::Index k = 0; k < slab.x.size(); k += 4) plot.point(slab.x[k], fit_.mu * slab.value[k], "#bbb");
        plot.line(points(slab.x, of.simulated(slab, resin_.channel[c].at, resin_.g)), slab_colour(s));
        plot.label(-0.95 * half, most * (0.95 - 0.1 * static_cast<double>(s)), fmt::format("{:g} mm", thickness_mm[s]),
                   slab_colour(s));
    }
    return {"", plot.svg()};
}

io::ReportDrawing EdgePlots::gradients(std::size_t c) const {
    const std::vector<EdgeObservation>& seen = channels_[c].seen;
    double steepest = 1e-4;
    for (const EdgeObservation& slab : seen) steepest = std::max(steepest, fit_.mu * slab.gradient.maxCoeff());
    Plot plot(across_edge(table_.setup().width_mm / 8), {0, steepest * 1.1, false, plot_marks(steepest), "gradient"},
              fmt::format("{} in {}: gradient", resin_.role, "RGB"[c]), 330, 160);
    const EdgeObjective of = objective(c);
    for (std::size_t s = 0; s < seen.size(); ++s) {
        const EdgeObservation& slab = seen[s];
        const Eigen::VectorXd between = (slab.x.head(slab.x.size() - 1) + slab.x.tail(slab.x.size() - 1)) / 2;
        plot.line(points(between, fit_.mu * slab.gradient), "#999", 1);
        plot.line(points(between, of.simulated_gradient(slab, resin_.channel[c].at, resin_.g)), slab_colour(s));
    }
    return {"", plot.svg()};
}

void EdgePlots::add_profiles(io::ReportSection& section) const {
    using Draw = io::ReportDrawing (EdgePlots::*)(std::size_t) const;
    for (const Draw draw : {&EdgePlots::profiles, &EdgePlots::gradients, &EdgePlots::neighbours})
        for (std::size_t c = 0; c < 3; ++c)
            if (!channels_[c].seen.empty()) section.drawings.push_back((this->*draw)(c));
}

io::ReportDrawing EdgePlots::neighbours(std::size_t c) const {
    const std::vector<EdgeObservation>& seen = channels_[c].seen;
    const EdgeObjective of = objective(c);
    const double g = resin_.g;
    const EdgeMedium at = edge_medium(resin_.channel[c].at, g);
    struct Neighbour {
        EdgeMedium medium;
        const char* colour;
        std::string name;
    };
    std::vector<Neighbour> list;
    for (const double s : around(paper_extinctions(), at.sigma_t))
        list.push_back({{s, at.albedo, g}, "#d9730d", fmt::format("extinction {:g}", s)});
    for (const double a : around(paper_albedos(), at.albedo))
        list.push_back({{at.sigma_t, a, g}, "#6a1b9a", fmt::format("albedo {:g}", a)});
    if (table_.grid().g.size() > 1)
        for (const double other : around(table_.grid().g, g))
            list.push_back({{at.sigma_t, at.albedo, other}, "#2e7d32", fmt::format("g {:g}", other)});
    double most = 0.01;
    for (const EdgeObservation& slab : seen) most = std::max(most, fit_.mu * slab.value.maxCoeff());
    Plot plot(across_edge(table_.setup().width_mm / 4), {0, most * 1.05, false, plot_marks(most), "reflectance"},
              fmt::format("{} in {}: neighbours", resin_.role, "RGB"[c]), 330, 200);
    std::string distances;
    for (const Neighbour& n : list) {
        const EdgePoint p(v_of_albedo(n.medium.albedo, n.medium.g), std::log(n.medium.sigma_t));
        for (const EdgeObservation& slab : seen)
            plot.line(points(slab.x, of.simulated(slab, p, n.medium.g), 2), n.colour, 1, true);
        distances += fmt::format("{}{} {:.4f}", distances.empty() ? "" : ", ", n.name, of(p, n.medium.g, fit_.mu));
    }
    for (const EdgeObservation& slab : seen)
        plot.line(points(slab.x, of.simulated(slab, resin_.channel[c].at, g), 2), "#222");
    return {fmt::format("distance {:.4f}; {}", resin_.channel[c].distance, distances), plot.svg()};
}

void EdgePlots::add_strips(io::ReportSection& section) const {
    const std::size_t slabs = channels_[0].seen.size();
    if (channels_[1].seen.size() != slabs || channels_[2].seen.size() != slabs) return;  // a channel is not known
    for (std::size_t s = 0; s < slabs; ++s) {
        std::array<Eigen::VectorXd, 3> measured, simulated;
        for (std::size_t c = 0; c < 3; ++c) {
            const EdgeObservation& slab = channels_[c].seen[s];
            measured[c] = fit_.mu * slab.value;
            simulated[c] = objective(c).simulated(slab, resin_.channel[c].at, resin_.g);
        }
        io::LinearPicture picture{strip_px, 0, {}};
        add_rows(picture, measured);
        add_rows(picture, simulated);
        section.pictures.push_back({fmt::format("{}, {:g} mm", resin_.role, channels_[0].thickness_mm[s]),
                                    io::png_bytes(io::encode_over(picture, {0, 0, 0})), picture.width_px,
                                    picture.height_px});
    }
}

void add_similarity_curves(const EdgeResinFit& resin, io::ReportSection& section) {
    if (resin.by_g.size() < 2) return;
    const double from = resin.by_g.front().first, to = resin.by_g.back().first;
    double farthest = 0, largest = 1;
    for (const auto& [g, distance] : resin.by_g) farthest = std::max(farthest, distance);
    for (const auto& list : resin.similar)
        for (const SimilarEdgeMedium& s : list) largest = std::max({largest, s.fitted.sigma_t, s.similar.sigma_t});
    PlotAxis x{from, to, false, {}, "g"};
    for (double g = std::ceil(from * 5) / 5; g <= to + 1e-9; g += 0.2) x.marks.push_back(g);
    Plot distance(x, {0, farthest * 1.05, false, plot_marks(farthest), "distance (Eq. 1)"},
                  fmt::format("{}: what g explains", resin.role), 330, 200);
    distance.line({resin.by_g.begin(), resin.by_g.end()}, "#333");
    Plot media(x, {0, largest * 1.05, false, plot_marks(largest), "extinction, 1/mm"},
               fmt::format("{}: fitted (dots), similar (lines)", resin.role), 330, 200);
    for (std::size_t c = 0; c < 3; ++c) {
        Plot::Points similar;
        for (const SimilarEdgeMedium& s : resin.similar[c]) {
            similar.emplace_back(s.g, s.similar.sigma_t);
            media.point(s.g, s.fitted.sigma_t, channel_colours[c]);
        }
        media.line(similar, channel_colours[c], 1, true);
    }
    section.drawings.push_back({"", distance.svg()});
    section.drawings.push_back({"", media.svg()});
}

void add_similarity_maps(const EdgeSimilarity& similarity, const EdgeFit& fit, std::size_t resin,
                         io::ReportSection& section) {
    const EdgeResinFit& of = fit.resins[resin];
    for (std::size_t c = 0; c < 3; ++c) {
        const std::vector<EdgeMap>& maps = similarity.maps[resin][c];
        if (maps.empty()) continue;
        Plot::Points similar;
        for (const EdgeMap& map : maps) similar.emplace_back(1 - map.similar.albedo, map.similar.sigma_t);
        const double least = std::max(1e-6, std::ranges::min(maps, {}, &EdgeMap::at_fitted).at_fitted);
        const double near = std::ranges::min(maps, {}, [&](const EdgeMap& map) { return std::abs(map.g - of.g); }).g;
        for (const EdgeMap& map : maps)
            section.drawings.push_back(
                {"", one_map(map, similarity, similar, least, map.g == near,
                             fmt::format("{} in {}, g = {:g}: {:.4f}", of.role, "RGB"[c], map.g, map.at_fitted))
                         .svg()});
        if (maps.size() < 2) continue;
        const EdgeSimilarity::Agreement agreement = similarity.agreement(resin, c);
        section.paragraphs.push_back(fmt::format(
            "{} in {}: fits and similar media differ by {:.1f} % in extinction and {:.4f} in v (rms over g).", of.role,
            "RGB"[c], 100 * agreement.ln_sigma_t, agreement.v));
    }
}

}  // namespace voxtone::calibration
