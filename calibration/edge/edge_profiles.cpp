// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/edge/edge_profiles.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>

#include <fmt/format.h>

#include "base/error.h"
#include "base/printable.h"
#include "calibration/tables/table_cells.h"
#include "calibration/tables/text_table.h"

namespace voxtone::calibration {
namespace {

constexpr std::uint64_t most_edge_bytes = std::uint64_t{256} << 20;
constexpr std::size_t most_samples = 20000, most_profiles = 1000, least_samples = 20;
constexpr double far_mm = 1.0;  // samples on both sides must reach this far
constexpr std::string_view edge_columns[] = {"resin", "thickness_mm", "x_mm",    "R",      "G",
                                             "B",     "error_R",      "error_G", "error_B"};

class EdgeReader {
public:
    EdgeReader(std::string_view text, const std::string& source)
        : csv_(text, source, "expected resin,thickness_mm,x_mm,R,G,B and one line a sample") {}

    std::vector<EdgeProfile> read() {
        const std::size_t columns = csv_.names().size(), all = std::size(edge_columns);
        csv_.expect_names(
            std::span(edge_columns).first(std::min(columns, all)),
            "resin,thickness_mm,x_mm,R,G,B, with error_R,error_G,error_B after it where errors are known");
        if (columns != 6 && columns != all)
            csv_.fail(
                fmt::format("{} columns; expected the 6 of resin,thickness_mm,x_mm,R,G,B, or 9 with the errors of all "
                            "three channels",
                            columns));
        while (csv_.next()) row(columns == all);
        if (profiles_.empty()) throw InputError(fmt::format("{}: a header and no samples.", csv_.source()));
        for (const EdgeProfile& profile : profiles_) expect_growing(profile);
        return std::move(profiles_);
    }

private:
    [[nodiscard]] double known_or_nan(std::size_t column) const {
        const std::string& cell = csv_.cells()[column];
        return cell.empty() || cell == "nan" || cell == "NaN" ? std::nan("") : csv_.number(column);
    }

    void row(bool with_errors) {
        const std::string& resin = csv_.cells()[0];
        if (resin.empty() || resin.size() > 32 || printable(resin) != resin)
            csv_.fail(0, "the resin is a short word such as C or W");
        const double thickness = csv_.number(1);
        if (!(thickness >= 0.05 && thickness <= 10))
            csv_.fail(
                1, fmt::format("thickness_mm is {}; expected the slab's thickness in mm, from 0.05 to 10", thickness));
        EdgeProfile& profile = of(resin, thickness);
        if (profile.x_mm.size() >= most_samples)
            csv_.fail(fmt::format("more than {} samples of a profile", most_samples));
        profile.x_mm.push_back(csv_.number(2));
        for (std::size_t c = 0; c < 3; ++c) {
            profile.value[c].push_back(known_or_nan(3 + c));
            if (!with_errors) continue;
            const double error = known_or_nan(6 + c);
            if (!std::isnan(error) && !(error > 0))
                csv_.fail(6 + c, fmt::format("{} is no standard error, which is above 0", error));
            profile.error[c].push_back(error);
            if (std::isnan(error)) profile.value[c].back() = std::nan("");
        }
    }

    EdgeProfile& of(std::string_view resin, double thickness) {
        for (auto p = profiles_.rbegin(); p != profiles_.rend(); ++p)
            if (p->resin == resin && p->thickness_mm == thickness) return *p;
        if (profiles_.size() >= most_profiles) csv_.fail(fmt::format("more than {} profiles", most_profiles));
        profiles_.push_back({std::string(resin), thickness, {}, {}, {}});
        return profiles_.back();
    }

    void expect_growing(const EdgeProfile& profile) const {
        for (std::size_t k = 1; k < profile.x_mm.size(); ++k)
            if (!(profile.x_mm[k] > profile.x_mm[k - 1]))
                throw InputError(fmt::format(
                    "{}: {} of {} mm: x_mm must grow from sample to sample, but {} comes after {}; give the mean where "
                    "a slab was photographed twice.",
                    csv_.source(), profile.resin, profile.thickness_mm, profile.x_mm[k], profile.x_mm[k - 1]));
    }

    CsvText csv_;
    std::vector<EdgeProfile> profiles_;
};

// Mean of a channel where `keep` says so; nothing where it is never known.
template <class Keep>
std::optional<double> mean_where(const EdgeProfile& profile, std::size_t c, Keep&& keep) {
    double sum = 0;
    std::size_t count = 0;
    for (std::size_t k = 0; k < profile.x_mm.size(); ++k) {
        if (std::isnan(profile.value[c][k]) || !keep(profile.x_mm[k])) continue;
        sum += profile.value[c][k];
        ++count;
    }
    return count ? std::optional(sum / static_cast<double>(count)) : std::nullopt;
}

void check_profile(const EdgeProfile& profile, const std::string& source) {
    const std::string name = fmt::format("{}: {} of {} mm", source, profile.resin, profile.thickness_mm);
    if (profile.x_mm.size() < least_samples)
        throw InputError(fmt::format("{}: {} samples; a profile needs at least {} across the edge.", name,
                                     profile.x_mm.size(), least_samples));
    if (profile.x_mm.front() > -far_mm || profile.x_mm.back() < far_mm)
        throw InputError(fmt::format(
            "{}: x_mm runs from {} to {}; both sides of the edge (x = 0) must be seen to {} mm at least, for the tails "
            "tell absorption. Cut the profile wider, and count x from the edge.",
            name, profile.x_mm.front(), profile.x_mm.back(), far_mm));
    double step = 0;
    for (std::size_t c = 0; c < 3; ++c) {
        for (const double v : profile.value[c])
            if (v < -0.2 || v > 2)
                throw InputError(fmt::format(
                    "{}: {} is {}; values are relative to a perfect diffuser, between 0 and 1 but for noise and a "
                    "common factor. Divide by the white patch, and give shares, not percent.",
                    name, edge_columns[3 + c], v));
        const auto black = mean_where(profile, c, [](double x) { return x < -far_mm / 2; }),
                   white = mean_where(profile, c, [](double x) { return x > far_mm / 2; });
        if (!black || !white)
            throw InputError(fmt::format(
                "{}: {} is not known on one side of the edge (clipped or left out); take the photograph with a shorter "
                "exposure.",
                name, edge_columns[3 + c]));
        if (std::abs(*white - *black) > std::abs(step)) step = *white - *black;
    }
    if (step < -0.005)
        throw InputError(
            fmt::format("{}: it is brighter on the left ({:+.3f} from left to right), but x grows from the black to "
                        "the white side: "
                        "the edge is the wrong way round. Turn the photograph, or change the sign of x_mm.",
                        name, step));
}

}  // namespace

std::vector<EdgeProfile> parse_edge_profiles(std::string_view text, const std::string& source) {
    return EdgeReader(text, source).read();
}

std::vector<EdgeProfile> read_edge_profiles(const std::filesystem::path& file) {
    return parse_edge_profiles(read_text(file, most_edge_bytes), file.string());
}

std::string edge_profiles_text(const std::vector<EdgeProfile>& profiles, std::string_view comment) {
    std::string text = comment_lines(comment);
    const bool errors = std::ranges::all_of(profiles, [](const EdgeProfile& p) { return !p.error[0].empty(); });
    text += "resin,thickness_mm,x_mm,R,G,B";
    text += errors ? ",error_R,error_G,error_B\n" : "\n";
    for (const EdgeProfile& p : profiles)
        for (std::size_t k = 0; k < p.x_mm.size(); ++k) {
            text += fmt::format("{},{},{:.5f}", p.resin, p.thickness_mm, p.x_mm[k]);
            for (std::size_t c = 0; c < 3; ++c) text += fmt::format(",{:.6g}", p.value[c][k]);
            if (errors)
                for (std::size_t c = 0; c < 3; ++c) text += fmt::format(",{:.3g}", p.error[c][k]);
            text += '\n';
        }
    return text;
}

void check_edge_profiles(const std::vector<EdgeProfile>& profiles, const std::string& source) {
    for (const EdgeProfile& profile : profiles) check_profile(profile, source);
}

}  // namespace voxtone::calibration
