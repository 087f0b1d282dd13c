// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/edge/edge_profiles.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "base/error.h"
#include "base/printable.h"
#include "calibration/patches/table_cells.h"
#include "io/files/csv_table.h"
#include "io/files/utf8.h"
#include "io/files/whole_file.h"

namespace voxtone::calibration {
namespace {

constexpr std::uint64_t most_edge_bytes = std::uint64_t{256} << 20;
constexpr std::size_t most_samples = 20000, most_profiles = 1000, least_samples = 20;
constexpr double far_mm = 1.0;  // samples on both sides must reach this far
constexpr const char* edge_columns[] = {"resin", "thickness_mm", "x_mm",    "R",      "G",
                                        "B",     "error_R",      "error_G", "error_B"};

class EdgeReader {
public:
    EdgeReader(std::string_view text, const std::string& source) : text_(text), source_(source) {}

    std::vector<EdgeProfile> read() {
        io::CsvReader csv(text_, io::CsvRules::lenient);
        line_ = csv.header().line;
        if (csv.header().cells.empty())
            throw InputError(fmt::format(
                "{}: no header line; expected resin,thickness_mm,x_mm,R,G,B and one line a sample.", source_));
        header(csv.header().cells);
        io::CsvRow cells;
        for (std::string fault; csv.next(cells, fault);) {
            line_ = cells.line;
            if (!fault.empty()) fail(fault);
            row(cells.cells);
        }
        if (profiles_.empty()) throw InputError(fmt::format("{}: a header and no samples.", source_));
        for (EdgeProfile& profile : profiles_) sort(profile);
        return std::move(profiles_);
    }

private:
    [[noreturn]] void fail(const std::string& what) const {
        throw InputError(fmt::format("{}: line {}: {}.", source_, line_, what));
    }

    void header(const std::vector<std::string>& names) {
        for (std::size_t k = 0; k < names.size() && k < std::size(edge_columns); ++k)
            if (names[k] != edge_columns[k])
                fail(
                    fmt::format("column {} is \"{}\", expected \"{}\": the header is resin,thickness_mm,x_mm,R,G,B, "
                                "with error_R,error_G,error_B after it where errors are known",
                                k + 1, printable(names[k].substr(0, 40)), edge_columns[k]));
        if (names.size() != 6 && names.size() != 9)
            fail(
                fmt::format("{} columns; expected the 6 of resin,thickness_mm,x_mm,R,G,B, or 9 with the errors of all "
                            "three channels",
                            names.size()));
        columns_ = names.size();
    }

    [[nodiscard]] double value_of(std::string_view text, std::size_t column, bool may_be_unknown) const {
        if (may_be_unknown && (text.empty() || text == "nan" || text == "NaN")) return std::nan("");
        const auto value = number_with_comma(text);
        if (!value)
            fail(fmt::format("column {} is \"{}\", no number", edge_columns[column], printable(text.substr(0, 40))));
        return *value;
    }

    void row(const std::vector<std::string>& cells) {
        if (cells[0].empty() || cells[0].size() > 32 || printable(cells[0]) != cells[0])
            fail("the resin is a short word such as C or W");
        const double thickness = value_of(cells[1], 1, false);
        if (!(thickness >= 0.05 && thickness <= 10))
            fail(fmt::format("thickness_mm is {}; expected the slab's thickness in mm, from 0.05 to 10", thickness));
        EdgeProfile& profile = of(cells[0], thickness);
        if (profile.x_mm.size() >= most_samples) fail(fmt::format("more than {} samples of a profile", most_samples));
        profile.x_mm.push_back(value_of(cells[2], 2, false));
        for (std::size_t c = 0; c < 3; ++c) {
            profile.value[c].push_back(value_of(cells[3 + c], 3 + c, true));
            if (columns_ == 6) continue;
            const double error = value_of(cells[6 + c], 6 + c, true);
            if (!std::isnan(error) && !(error > 0))
                fail(fmt::format("{} is {}; a standard error is above 0", edge_columns[6 + c], error));
            profile.error[c].push_back(error);
            if (std::isnan(error)) profile.value[c].back() = std::nan("");
        }
    }

    EdgeProfile& of(std::string_view resin, double thickness) {
        for (auto p = profiles_.rbegin(); p != profiles_.rend(); ++p)
            if (p->resin == resin && p->thickness_mm == thickness) return *p;
        if (profiles_.size() >= most_profiles) fail(fmt::format("more than {} profiles", most_profiles));
        profiles_.push_back({std::string(resin), thickness, {}, {}, {}});
        return profiles_.back();
    }

    void sort(EdgeProfile& profile) const {
        for (std::size_t k = 1; k < profile.x_mm.size(); ++k)
            if (!(profile.x_mm[k] > profile.x_mm[k - 1]))
                throw InputError(fmt::format(
                    "{}: {} of {} mm: x_mm must grow from sample to sample, but {} comes after {}; give the mean where "
                    "a slab was photographed twice.",
                    source_, profile.resin, profile.thickness_mm, profile.x_mm[k], profile.x_mm[k - 1]));
    }

    std::string_view text_;
    const std::string& source_;
    std::size_t line_ = 0, columns_ = 0;
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
    const std::vector<std::uint8_t> bytes = io::read_whole_file(file, most_edge_bytes);
    return parse_edge_profiles(io::text_as_utf8({reinterpret_cast<const char*>(bytes.data()), bytes.size()}),
                               file.string());
}

std::string edge_profiles_text(const std::vector<EdgeProfile>& profiles, std::string_view comment) {
    std::string text;
    while (!comment.empty()) {
        const std::size_t end = std::min(comment.find('\n'), comment.size());
        text += fmt::format("# {}\n", comment.substr(0, end));
        comment.remove_prefix(std::min(end + 1, comment.size()));
    }
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
