// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/colour/tried_advice.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

#include <fmt/core.h>

#include "halftone/loop/appearance_loop.h"
#include "halftone/loop/eye_filter.h"
#include "slicer/colour/slab_picture.h"
#include "slicer/colour/type_size.h"
#include "slicer/mesh/solid_mesh.h"
#include "slicer/options/auto_limits.h"
#include "slicer/part/resin_choice.h"
#include "slicer/surface/target_cells.h"
#include "slicer/surface/visible_surface.h"

namespace voxtone::slicer {

namespace {

constexpr double worth_a_word = 0.9;        // of what there is now
constexpr double left_by_loop = 0.65;       // at most, of what the resins could reach
constexpr double left_by_thickness = 0.35;  // at most, of what is lost in walls of a few voxels
constexpr double least_wall_mm = 0.25;      // in which they do
constexpr double some_sheets = 0.25;        // of the thin walls, from where on a thickness for them is worth a word
constexpr double slow_part = 0.25;          // of the exponent, at the least: the header tells of which
constexpr double some_more = 1.1;           // of a size from which on type is read, for its contrast is not foreseen
constexpr double fading_mm = 0.25;          // in which light through walls falls to a third, at best
constexpr const char *seen_mean = "seen_de2000", *gamut_mean = "gamut", *smallest_type = "type_mm",
                     *code_module = "module_mm";
constexpr double readable_module_mm = 0.4;  // of a QR code one of 0.31 mm was read in one print and not in the next

/// What blurring the target changes of it, on average.
double changed_by_blur(const AdviceSources& s, double spread_mm) {
    constexpr double degrees = 0.0283;  // the narrowest Gaussian's spread (eye_filter.h)
    const optics::Surface& surface = s.prediction.predicted.surface;
    const halftone::EyeFilter blur(surface, spread_mm / std::tan(degrees * 3.14159265358979323846 / 180),
                                   halftone::EyeSurround::none, halftone::OpponentSpace::cielab,
                                   halftone::EyeParts::narrowest);
    const std::vector<double> changed = colour_differences(s.prediction.target, blur.smoothed(s.prediction.target));
    double sum = 0, all = 0;
    for (std::size_t i = 0; i < changed.size(); ++i) sum += s.weight[i] * changed[i], all += s.weight[i];
    return all > 0 ? sum / all : 0;
}

double exponent_of(const AdviceSources& s) {
    constexpr double spread_mm = 0.5;
    const double wide = changed_by_blur(s, spread_mm), narrow = changed_by_blur(s, spread_mm / 2);
    return narrow > 0 && wide > narrow ? std::min(1.0, std::log2(wide / narrow)) : 0;
}

/// What the mean would be of the same print so many times as large, with light that spread as many times as far: that
/// of this one seen from as much nearer.
double mean_from_nearer(const AdviceSources& s, double times) {
    const SeenPrint seen = seen_from(s.prediction, s.job.options.loop.viewing_distance_mm / times,
                                     s.job.options.loop.intent != halftone::Intent::absolute);
    double sum = 0, all = 0;
    for (std::size_t i = 0; i < seen.difference.size(); ++i)
        sum += s.weight[i] * seen.difference[i], all += s.weight[i];
    return all > 0 ? sum / all : 0;
}

/// A size as it is written and read again.
double rounded_mm(double mm) { return mm < 20 ? std::ceil(2 * mm) / 2 : std::ceil(mm); }

/// Most that the tray allows.
double most_larger(const AdviceSources& s) {
    const Eigen::Vector3d tray = s.job.printer.sliced_tray_mm(), extent = s.body.placement.extent_mm;
    double most = 1e3;
    for (Eigen::Index a = 0; a < 3; ++a)
        if (extent[a] > 0 && tray[a] > 0 && !(s.body.is_picture && a == 2)) most = std::min(most, tray[a] / extent[a]);
    return most;
}

/// By a number of iterations, and not by what there was to gain: another size would be cut short elsewhere.
bool is_cut_short(const AdviceSources& s) {
    const int asked = s.job.options.loop.iterations.value_or(-1);
    return s.loop && asked >= 0 && asked < halftone::most_iterations &&
           s.loop->result.why_stopped == halftone::all_iterations_made;
}

/// The option that says how large it is, as the user said it, and what it says now.
struct SizeOption {
    const char* name;
    double mm;
};
SizeOption size_option(const AdviceSources& s) {
    const Eigen::Vector3d& extent = s.body.placement.extent_mm;
    if (!s.body.is_picture) return {"--size", extent.maxCoeff()};
    const PictureOptions& picture = s.job.options.picture;
    if (picture.width_mm > 0) return {"--width", extent.x()};
    if (picture.height_mm > 0) return {"--height", extent.y()};
    return picture.size_mm > 0 && picture.dpi == 0 ? SizeOption{"--size", std::max(extent.x(), extent.y())}
                                                   : SizeOption{"--width", extent.x()};
}

/// Of faces that have their own back in the same place, both sides.
double area_of_sheets_mm2(const SolidMesh& mesh) {
    using Corners = std::array<std::array<double, 3>, 3>;
    const auto corners = [&](const std::array<std::uint32_t, 3>& triangle) {
        Corners at{};
        for (std::size_t c = 0; c < 3; ++c) {
            const Eigen::Vector3d& p = mesh.positions_mm[triangle[c]];
            at[c] = {p.x(), p.y(), p.z()};
        }
        std::ranges::sort(at);
        return at;
    };
    std::map<Corners, int> times;
    for (const auto& triangle : mesh.triangles) ++times[corners(triangle)];
    double area = 0;
    for (const auto& triangle : mesh.triangles) {
        if (times[corners(triangle)] < 2) continue;
        const auto at = [&](std::size_t c) -> const Eigen::Vector3d& { return mesh.positions_mm[triangle[c]]; };
        area += (at(1) - at(0)).cross(at(2) - at(0)).norm() / 2;
    }
    return area;
}

/// Of the thin walls.
double share_of_sheets(const AdviceSources& s) {
    if (s.body.is_picture || !(s.mean.thin_mm2 > 0)) return 0;
    return area_of_sheets_mm2(*s.body.solid) / s.mean.thin_mm2;
}

void add_larger(const AdviceSources& s, std::vector<io::ReportAdvice>& advice) {
    constexpr double fourfold = 4;
    const double thick_mm = 2 * s.job.options.colour.depth_mm, of_tray = most_larger(s),
                 most = std::min(fourfold, of_tray);
    const double exponent = exponent_of(s), now = s.mean.sum(), good = s.job.options.verdict.good;
    MeanParts parts = s.mean;
    // Sheets that enclose nothing are as thin at any size.
    if (s.mean.thin > (1 - worth_a_word) * now) {
        const double sheets = std::min(1.0, share_of_sheets(s)) * parts.thin;
        parts.thin -= sheets, parts.reach += sheets;
    }
    // At best flat areas come nearer too: light from afar is in their middles.
    MeanParts at_best = parts;
    at_best.neighbours += std::exchange(at_best.flat, 0);
    const auto at_least = [&](double k) { return mean_when_larger(at_best, k, exponent, thick_mm, fading_mm); };
    const auto at_most = [&](double k) { return mean_when_larger(parts, k, slow_part * exponent, thick_mm); };
    const auto then = [&](double k) { return (at_least(k) + at_most(k)) / 2; };
    // What is clearly off is a band along edges, too.
    const double stays = s.mean.reach_off, shrinks = std::max(0.0, s.whole.wrong_share - stays);
    const auto is_good = [&](double k) { return then(k) <= good && stays + shrinks / k <= much_wrong; };
    // As large as makes it good; else twice as large.
    const double type_k = s.page.type_times > 1 ? some_more * s.page.type_times : 1;
    double k = 1.25;
    while (k < most && !is_good(k)) k *= 1.1;
    if (!is_good(k)) k = 2;
    const double module_now_mm = s.page.module_mm,
                 code_k = module_now_mm > 0 ? std::max(1.0, readable_module_mm / module_now_mm) : 1,
                 read_k = std::max(type_k, code_k);
    k = read_k > 1 && (read_k > k || now <= good || is_cut_short(s)) ? std::min(read_k, of_tray) : std::min(k, most);
    if (read_k == 1 && (is_cut_short(s) || (now <= good && s.whole.wrong_share <= much_wrong))) return;
    const auto [option, edge_mm] = size_option(s);
    const double to_mm = rounded_mm(k * edge_mm);
    if (to_mm <= edge_mm) return;
    const double times = to_mm / edge_mm, least = at_least(times);
    const std::string size = fmt::format("{} {:g}mm", option, to_mm);
    if (code_k > 1 && to_mm >= code_k * edge_mm) {
        const double module_mm = module_now_mm * times;
        advice.push_back(
            {fmt::format("print it larger ({}): then its code has modules of {:.2f} mm, which scanners read", size,
                         module_mm),
             size, code_module, module_now_mm, module_mm});
    }
    if (type_k > 1 && to_mm >= type_k * edge_mm) {
        const double smallest_mm = s.page.smallest_type_mm * times;
        advice.push_back({fmt::format("print it larger ({}): then its smallest type is of {}, and nearly all of it can "
                                      "be read",
                                      size, type_size_text(smallest_mm)),
                          size, smallest_type, s.page.smallest_type_mm, smallest_mm});
    }
    if (read_k > 1) return;
    const bool is_page = s.body.is_picture && is_graphics(s.prediction);
    const double highest = std::max(at_most(times), is_page ? mean_from_nearer(s, times) : 0);
    if (now > good && (least + highest) / 2 > worth_a_word * now) return;
    std::string options = size;
    // Where nothing else would tell what it comes to.
    const double area_mm2 = coloured_area_mm2(*s.body.surface) * std::pow(to_mm / edge_mm, 2);
    if (!s.loop && s.job.options.prediction.automatic && area_mm2 > 100 * auto_prediction_cm2)
        options += fmt::format(" --predict {}", name_of(PredictionModel::transport));
    // Where nothing is thick nobody knows what thick walls are like.
    const bool is_known = s.mean.thin < (1 - worth_a_word) * now || s.mean.thick_walls < s.mean.thin;
    const std::string from = fmt::format("{:.1f}", least), to = fmt::format("{:.1f}", highest),
                      come_to = !is_known    ? from + " at best"
                                : from == to ? "about " + from
                                             : fmt::format("{} to {}", from, to);
    advice.push_back({fmt::format("print it larger ({}): then {}", options, come_to), options, seen_mean, now, least});
}

void add_loop(const AdviceSources& s, std::vector<io::ReportAdvice>& advice) {
    const double now = s.mean.sum();
    double then = now;
    if (!s.loop) {
        if (s.job.resins.set.resins.size() < 2) return;
        const double lost_thin = s.mean.wall_mm < least_wall_mm ? s.mean.thin : 0;
        then = s.mean.reach + lost_thin + left_by_loop * (now - s.mean.reach - lost_thin);
    } else if (is_cut_short(s)) {
        std::vector<double> means;
        for (const halftone::LoopStep& step : s.loop->result.state.steps)
            if (step.method != halftone::LoopMethod::descent) means.push_back(step.seen.mean);
        const double made = means.back(), least = left_by_loop * means.front(),
                     longer = mean_of_longer_loop(means, halftone::most_iterations - *s.job.options.loop.iterations),
                     gained = made - std::min(made, std::max(least, longer));
        then = made > 0 ? now * (1 - gained / made) : now;
    }
    if (then > worth_a_word * now) return;
    advice.push_back(
        {fmt::format("let the resins be rearranged until that gains no more (--iterations auto): then {:.1f} "
                     "or less",
                     then),
         "--iterations auto", seen_mean, now, then});
}

void add_thicker(const AdviceSources& s, std::vector<io::ReportAdvice>& advice) {
    const double thick_mm = 2 * s.job.options.colour.depth_mm, now = s.mean.sum();
    // Of a sheet both sides are one area, and light passes it more than any wall.
    const double by_area = share_of_sheets(s),
                 of_sheets = by_area > 0 ? std::max(by_area, s.mean.thinnest / s.mean.thin) : 0;
    // Some of the thin walls: those that stay are as they were.
    const bool sheets = of_sheets >= some_sheets, is_part = sheets && by_area < 0.5;
    const bool known = !is_part && s.mean.thick_walls < s.mean.thin,
               is_bound = is_part || (!known && s.mean.wall_mm < least_wall_mm);
    const double left = is_part ? 1 - of_sheets * (1 - left_by_thickness) : left_by_thickness;
    const double then = now - s.mean.thin + (is_bound ? left * s.mean.thin : s.mean.thick_walls);
    if (then > worth_a_word * now) return;
    const std::string options = s.body.is_picture ? fmt::format("--thickness {:g}mm", thick_mm)
                                : sheets          ? fmt::format("--sheet-thickness {:g}mm", thick_mm)
                                                  : std::string();
    const std::string what = sheets ? fmt::format("print open sheets {:g} mm thick", thick_mm)
                                    : fmt::format("make walls of {:.1f} mm at least {:g} mm thick{}", s.mean.wall_mm,
                                                  thick_mm, s.body.is_picture ? "" : " in a mesh editor");
    advice.push_back({fmt::format("{}{}: then {}", what, options.empty() ? "" : " (" + options + ")",
                                  known ? fmt::format("about {:.1f}", then) : fmt::format("{:.1f} or less", then)),
                      options, seen_mean, now, then});
}

}  // namespace

double mean_when_larger(const MeanParts& mean, double k, double exponent, double thick_mm, double fading_mm) {
    const double open = thick_mm - mean.wall_mm, left = thick_mm - k * mean.wall_mm;
    double through = open > 0 ? std::max(0.0, left / open) : 0;
    if (fading_mm > 0) through = std::min(through, std::exp(-(k - 1) * mean.wall_mm / fading_mm));
    // Where nothing is thick nobody knows what thick walls are like: at best, as asked.
    const double thick = mean.thick_walls < mean.thin ? mean.thick_walls : 0;
    return mean.reach + mean.flat + (mean.thin - thick) * through + (mean.neighbours + thick) * std::pow(k, -exponent);
}

double mean_of_longer_loop(const std::vector<double>& means, int more) {
    constexpr double usual = 0.35, most = 0.7;  // part of the gain before
    if (means.size() < 2) return means.empty() ? 0 : means.back();
    const std::size_t n = means.size();
    const double gain = means[n - 2] - means[n - 1];
    double part = usual;
    if (n > 2 && means[n - 3] > means[n - 2]) part = std::clamp(gain / (means[n - 3] - means[n - 2]), 0.0, most);
    double mean = means[n - 1], next = gain;
    for (int i = 0; i < more && next > 0; ++i) next *= part, mean -= next;
    return std::max(0.0, mean);
}

std::vector<io::ReportAdvice> advice_on_reach(const OpenedJob& job, const JobBody& body) {
    std::vector<io::ReportAdvice> advice;
    if (const auto core = loss_with_white_core(job, body))
        advice.push_back({fmt::format("print it over white (--core W): colours out of reach go from {:.1f} to {:.1f} "
                                      "CIEDE2000 then",
                                      core->now_de2000, core->mean_de2000),
                          "--core W", gamut_mean, core->now_de2000, core->mean_de2000});
    if (const auto resin = most_helpful_resin(job, body)) {
        const std::string load = resin->loaded_with;
        advice.push_back(
            {resin->has_slot ? fmt::format("load {} too (--load {}): colours out of reach go from {:.1f} to {:.1f} "
                                           "CIEDE2000 then",
                                           resin->role, load, resin->now_de2000, resin->mean_de2000)
                             : fmt::format("print it where {} can be loaded too, in another mode or on another "
                                           "printer: colours out of reach go from {:.1f} to {:.1f} CIEDE2000 then",
                                           resin->role, resin->now_de2000, resin->mean_de2000),
             resin->has_slot ? "--load " + load : std::string(), gamut_mean, resin->now_de2000, resin->mean_de2000});
    }
    return advice;
}

std::vector<io::ReportAdvice> tried_advice(const AdviceSources& s) {
    std::vector<io::ReportAdvice> advice;
    add_loop(s, advice);
    add_thicker(s, advice);
    // What an option makes thick enough needs no other cure.
    if (advice.size() == 2 && !advice[1].options.empty() && s.mean.thin > s.mean.sum() / 2)
        std::swap(advice[0], advice[1]);
    add_larger(s, advice);
    if (s.mean.reach >= (1 - worth_a_word) * s.mean.sum()) {
        std::vector<io::ReportAdvice> more = advice_on_reach(s.job, s.body);
        // What lies under the colour is the first thing to put right.
        const bool first = !more.empty() && s.mean.reach > s.mean.sum() / 2;
        advice.insert(first ? advice.begin() : advice.end(), more.begin(), more.end());
    }
    return advice;
}

}  // namespace voxtone::slicer
