// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/fit/patch_page.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "calibration/patches/patch_file.h"
#include "io/pictures/picture_writer.h"
#include "io/pictures/srgb_code.h"
#include "io/programs/build_identity.h"
#include "io/report/report_html.h"

namespace voxtone::calibration {

namespace {

io::Rgb codes_of(const Eigen::Vector3d& linear) {
    return {io::linear_to_srgb8(float(linear[0])), io::linear_to_srgb8(float(linear[1])),
            io::linear_to_srgb8(float(linear[2]))};
}

class PatchPage {
public:
    PatchPage(const PatchTable& table, const PatchCheck& check, const optics::ResinSet& set, const PatchMap& map,
              double noise)
        : table_(table), check_(check), set_(set), map_(map), noise_(noise) {}

    io::Report report() const {
        io::Report report;
        report.program_version = io::program_version();
        for (const optics::Resin& resin : set_.resins)
            report.resins.push_back({resin.name, resin.role, "", colour_of(resin.role), 0, 0});
        report.viewer.heading = "Measured and predicted";
        report.viewer.surface = surface();
        report.viewer.worst = worst();
        report.prediction_note =
            map_.is_target ? "Markers, frame and what lies between the squares show the squares of the same resins."
            : table_.is_chart
                ? "A chart: patches stand where their table says, else in its order."
                : "One row for each resin below. Where the squares lie on their target is not known (--target).";
        report.views = {{"patches", stills(*report.viewer.surface)}};
        report.sections.push_back(section());
        return report;
    }

private:
    /// What the resin looks like by itself; grey where no patch shows it.
    io::Rgb colour_of(const std::string& role) const {
        Eigen::Vector3d lightest = Eigen::Vector3d::Constant(-1);
        for (std::size_t p = 0; p < table_.patches.size(); ++p) {
            const PatchMixture& top = table_.patches[p].top;
            const Eigen::Vector3d& rgb = check_.patches[p].predicted_rgb;
            if (top.size() == 1 && top[0].role == role && rgb.sum() > lightest.sum()) lightest = rgb;
        }
        return lightest[0] < 0 ? io::Rgb{128, 128, 128} : codes_of(lightest);
    }

    template <class ColourOf>
    io::ViewerLook look(const char* name, const char* caption, ColourOf&& colour) const {
        constexpr std::uint8_t nothing = 119;
        io::ViewerLook look{name, caption, {}};
        look.rgb.reserve(3 * map_.patch_of.size());
        for (const std::uint16_t patch : map_.patch_of) {
            const io::Rgb rgb =
                patch ? codes_of(colour(check_.patches[patch - 1u])) : io::Rgb{nothing, nothing, nothing};
            look.rgb.insert(look.rgb.end(), rgb.begin(), rgb.end());
        }
        return look;
    }

    io::ViewerSurface surface() const {
        io::ViewerSurface s;
        s.asked = "measured";
        s.expected = "predicted";
        s.size_px = {map_.width_px, map_.height_px};
        s.high_mm = {map_.size_mm().x(), map_.size_mm().y(), 0};
        s.place_mm = 1 / map_.px_per_mm;
        s.to_scale = map_.is_target;
        if (!map_.photograph.empty())
            s.looks.push_back(
                {"photograph", "the target as it was measured, without its uneven light", map_.photograph});
        s.looks.push_back(look("measured", "what was measured of each square",
                               [](const CheckedPatch& patch) { return patch.measured_rgb; }));
        s.looks.push_back(look("predicted", "what the resins predict of each square",
                               [](const CheckedPatch& patch) { return patch.predicted_rgb; }));
        for (const std::uint16_t patch : map_.patch_of) {
            s.covered.push_back(patch || !map_.photograph.empty() ? 1 : 0);
            const double difference = patch ? check_.patches[patch - 1u].difference : 0;
            s.single.push_back(std::uint8_t(std::clamp(std::round(10 * difference), 0.0, 255.0)));
        }
        s.part_of = map_.patch_of;
        for (std::size_t p = 0; p < table_.patches.size(); ++p) s.parts.push_back(part(p));
        return s;
    }

    std::string values(const Eigen::Vector3d& rho) const {
        std::string text;
        for (const double value : rho) text += fmt::format("{}{:.4f}", text.empty() ? "" : "  ", value);
        return text;
    }

    /// Of the channel that is farthest off.
    std::size_t worst_channel(std::size_t p) const {
        std::size_t worst = 0;
        const std::vector<double>& off = check_.patches[p].off;
        for (std::size_t c = 1; c < off.size(); ++c)
            if (std::abs(off[c]) > std::abs(off[worst])) worst = c;
        return worst;
    }

    std::string worst_error(std::size_t p) const {
        const std::size_t c = worst_channel(p);
        return fmt::format("{:+.4f} in {}", check_.patches[p].off[c], channel_name(check_.compared_in, c));
    }

    /// How large that is for what was measured; empty where its noise is not known.
    std::string in_noise(std::size_t p) const {
        if (check_.compared_in != table_.channels) return {};
        const std::size_t c = worst_channel(p);
        const Patch& patch = table_.patches[p];
        const double error = patch.error.empty() ? noise_ : patch.error[c];
        if (!(error > 0)) return {};
        return fmt::format("{:.1f} standard errors", std::abs(check_.patches[p].off[c]) / error);
    }

    io::ViewerPart part(std::size_t p) const {
        const Patch& patch = table_.patches[p];
        io::ViewerPart part{patch_name(patch), {}, {}};
        part.figures.emplace_back("CIEDE2000", fmt::format("{:.2f}", check_.patches[p].difference));
        if (check_.compared_in.is_rgb()) {
            part.figures.emplace_back("measured R, G, B", values(check_.patches[p].measured_rgb));
            part.figures.emplace_back("predicted", values(check_.patches[p].predicted_rgb));
        }
        part.figures.emplace_back("farthest off", worst_error(p));
        if (const std::string noise = in_noise(p); !noise.empty()) part.figures.emplace_back("that is", noise);
        part.figures.emplace_back("thickness",
                                  patch.thickness_mm > 0 ? fmt::format("{:g} mm", patch.thickness_mm) : "thick");
        for (const ResinShare& share : patch.top)
            if (const int resin = set_.find(share.role); resin >= 0)
                part.shares.emplace_back(std::size_t(resin), share.fraction);
        return part;
    }

    std::vector<io::ViewerPlace> worst() const {
        constexpr std::size_t most = 10;
        std::vector<io::ViewerPlace> places;
        for (const std::size_t p : largest_first(check_)) {
            if (places.size() == most) break;
            const CheckedPatch& patch = check_.patches[p];
            io::ViewerPlace place;
            place.at_mm = {map_.middles_mm[p].x(), map_.middles_mm[p].y(), 0};
            place.normal = {0, 0, 1};
            place.seen = patch.difference;
            place.target = codes_of(patch.measured_rgb);
            place.print = codes_of(patch.predicted_rgb);
            place.name = patch_name(table_.patches[p]);
            const std::string noise = in_noise(p);
            place.cause = worst_error(p) + (noise.empty() ? "" : ", " + noise);
            places.push_back(place);
        }
        return places;
    }

    std::vector<io::ReportPicture> stills(const io::ViewerSurface& surface) const {
        std::vector<io::ReportPicture> pictures;
        for (const io::ViewerLook& look : surface.looks)
            pictures.push_back({look.name + ": " + look.caption,
                                io::png_bytes({map_.width_px, map_.height_px, 3, look.rgb}), map_.width_px,
                                map_.height_px, map_.is_target ? map_.px_per_mm : 0});
        return pictures;
    }

    io::ReportSection section() const {
        const optics::DifferenceSummary& d = check_.differences;
        io::ReportSection section;
        section.title = "Patches";
        section.printed = true;
        section.paragraphs.push_back(fmt::format(
            "CIEDE2000 of {} patches: mean {:.2f}, median {:.2f}, 95 % {:.2f}, largest {:.2f}; root mean square error "
            "of a reflectance {:.4f}. Noise counts here, most of all in dark patches.",
            d.count, d.mean, d.median, d.percentile_95, d.max, check_.rms));
        io::ReportTable table{"", {"Patch", "CIEDE2000", "Farthest off", ""}, {}};
        const bool rgb = check_.compared_in.is_rgb();
        if (rgb) table.header.insert(table.header.end(), {"Measured R, G, B", "Predicted"});
        for (const std::size_t p : largest_first(check_)) {
            table.rows.push_back({patch_name(table_.patches[p]), fmt::format("{:.2f}", check_.patches[p].difference),
                                  worst_error(p), in_noise(p)});
            if (!rgb) continue;
            table.rows.back().push_back(values(check_.patches[p].measured_rgb));
            table.rows.back().push_back(values(check_.patches[p].predicted_rgb));
        }
        section.tables.push_back(table);
        return section;
    }

    const PatchTable& table_;
    const PatchCheck& check_;
    const optics::ResinSet& set_;
    const PatchMap& map_;
    double noise_;
};

}  // namespace

io::Report patch_report(const PatchTable& table, const PatchCheck& check, const optics::ResinSet& set,
                        const PatchMap& map, double noise) {
    return PatchPage(table, check, set, map, noise).report();
}

std::string check_report_html(const PatchTable& table, const PatchCheck& check, const optics::ResinSet& set,
                              const PatchMap& map) {
    io::Report report = patch_report(table, check, set, map, 0);
    report.title = fmt::format("Check of {}", set.name);
    return io::report_html(report);
}

}  // namespace voxtone::calibration
