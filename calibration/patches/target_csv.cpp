// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/patches/target_csv.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "base/contracts.h"
#include "base/error.h"
#include "base/printable.h"
#include "calibration/patches/measured_values.h"
#include "calibration/patches/patch_mixture.h"
#include "calibration/patches/patch_surfaces.h"
#include "calibration/tables/table_cells.h"
#include "calibration/tables/text_table.h"
#include "io/files/json_keys.h"

namespace voxtone::calibration {

namespace {

constexpr std::size_t most_columns = 20000, most_patches = 100000;

// What a column of the table holds.
struct Column {
    enum class Kind { top, backing, thickness, base, cell, value, error } kind;
    std::size_t channel = 0;
};

// A title may stand above the header.
bool is_target_header(const std::vector<std::string>& cells) {
    return cells.size() > 1 && cells[0] == "top" && cells[1] == "backing";
}

class TargetReader {
public:
    TargetReader(std::string_view text, std::string source, std::optional<optics::Illuminant> illuminant)
        : csv_(text, std::move(source),
               "a target begins top,backing,thickness_mm,R,G,B, a chart with a line such as W,C,M,Y,K,L,a,b",
               is_target_header),
          illuminant_(illuminant) {
        table_.source = csv_.source();
    }

    PatchTable read() {
        header(csv_.names());
        while (csv_.next()) row(csv_.cells());
        if (table_.patches.empty())
            throw InputError(
                fmt::format("{}: has a header and no patches; give one line per measured square.", table_.source));
        if (colorimetric()) make_rho(table_, quantity_, conditions_of(csv_), illuminant_);
        lay_on_surfaces(table_);
        return std::move(table_);
    }

private:
    bool colorimetric() const { return quantity_ == Quantity::lab || quantity_ == Quantity::xyz; }

    static bool is_cell(std::string_view name) { return name == "cell_x_mm" || name == "cell_y_mm"; }
    static bool is_wide(std::string_view name) { return name == "wR" || name == "wG" || name == "wB"; }
    static std::optional<std::pair<Quantity, std::size_t>> letter_channel(std::string_view name) {
        if (is_wide(name)) return letter_channel(name.substr(1));
        constexpr std::string_view letters = "RGBLabXYZ";
        constexpr Quantity quantities[] = {Quantity::rgb, Quantity::lab, Quantity::xyz};
        const std::size_t at = name.size() == 1 ? letters.find(name) : std::string_view::npos;
        if (at == std::string_view::npos) return std::nullopt;
        return std::pair(quantities[at / 3], at % 3);
    }

    void header(const std::vector<std::string>& names) {
        if (names.size() > most_columns) csv_.fail(fmt::format("{} columns, more than {}", names.size(), most_columns));
        csv_.expect_names(std::array<std::string_view, 3>{"top", "backing", "thickness_mm"},
                          "top,backing,thickness_mm, and what is measured");
        columns_ = {{Column::Kind::top}, {Column::Kind::backing}, {Column::Kind::thickness}};
        // Values first, so that an error column may stand before its channel.
        std::vector<double> wavelengths;
        std::map<std::string_view, std::size_t> channels;
        for (std::size_t k = 3; k < names.size(); ++k) {
            const std::string_view name = names[k];
            if (name == "base_mm" || is_cell(name) || name.ends_with("_se")) continue;
            const auto nm = number(name);
            const auto letter = nm ? std::nullopt : letter_channel(name);
            if (!nm && !letter) {
                const std::vector<std::string> known{"base_mm", "cell_x_mm", "cell_y_mm", "R",  "G",  "B",
                                                     "R_se",    "G_se",      "B_se",      "L",  "a",  "b",
                                                     "X",       "Y",         "Z",         "wR", "wG", "wB"};
                csv_.fail(k, fmt::format("{}; a wavelength is a number in nm",
                                         io::unknown_key_message(printable(name.substr(0, 40)), known)));
            }
            if (nm && !(*nm >= 100 && *nm <= 20000))
                csv_.fail(k, fmt::format("a wavelength of {} nm; expected 100 to 20000", *nm));
            const Quantity quantity = nm ? Quantity::spectrum : letter->first;
            if (!channels.empty() && (quantity != quantity_ || is_wide(name) != table_.channels.is_own()))
                csv_.fail(
                    "R, G, B and wavelengths in one table, or L, a, b or X, Y, Z beside them; give three channels of "
                    "one kind, or wavelengths");
            quantity_ = quantity;
            if (is_wide(name)) table_.channels = optics::wide_channels();
            if (!channels.try_emplace(name, nm ? wavelengths.size() : letter->second).second)
                csv_.fail(fmt::format("column {} is there twice", shown(name)));
            if (nm) wavelengths.push_back(*nm);
        }
        if (channels.empty())
            csv_.fail("no channel; after thickness_mm come R,G,B or L,a,b or X,Y,Z or wavelengths in nm");
        if (wavelengths.empty() && channels.size() != 3)
            csv_.fail(fmt::format("of {} some are missing; all three are needed",
                                  quantity_ == Quantity::rgb   ? "R, G and B"
                                  : quantity_ == Quantity::lab ? "L, a and b"
                                                               : "X, Y and Z"));
        for (std::size_t k = 1; k < wavelengths.size(); ++k)
            if (!(wavelengths[k] > wavelengths[k - 1]))
                csv_.fail(fmt::format("wavelengths must rise, {} comes after {}", wavelengths[k], wavelengths[k - 1]));
        if (!table_.channels.is_own()) table_.channels.wavelengths_nm = wavelengths;
        std::size_t errors = 0;
        for (std::size_t k = 3; k < names.size(); ++k) {
            std::string_view name = names[k];
            if (name == "base_mm") {
                if (std::ranges::any_of(columns_, [](const Column& c) { return c.kind == Column::Kind::base; }))
                    csv_.fail("column \"base_mm\" is there twice");
                columns_.push_back({Column::Kind::base});
                continue;
            }
            if (is_cell(name)) {
                const std::size_t axis = name == "cell_y_mm";
                if (std::exchange(has_cells_[axis], true)) csv_.fail(fmt::format("column {} is there twice", name));
                columns_.push_back({Column::Kind::cell, axis});
                continue;
            }
            const bool error = name.ends_with("_se");
            if (error) name.remove_suffix(3), ++errors;
            const auto channel = channels.find(name);
            if (channel == channels.end()) csv_.fail(fmt::format("column {} belongs to no channel", shown(names[k])));
            columns_.push_back({error ? Column::Kind::error : Column::Kind::value, channel->second});
        }
        if (errors != 0 && errors != channels.size())
            csv_.fail(fmt::format("{} of {} channels have a standard error; give it for all or for none", errors,
                                  channels.size()));
        has_errors_ = errors != 0;
        if (has_cells_[0] != has_cells_[1]) csv_.fail("cell_x_mm and cell_y_mm belong together; give both or none");
    }

    void row(const std::vector<std::string>& cells) {
        if (table_.patches.size() >= most_patches) csv_.fail(fmt::format("more than {} patches", most_patches));
        Patch patch;
        patch.where = csv_.where();
        try {
            const auto bare = bare_kind(cells[0]);
            if (bare) patch.on = std::make_shared<PatchSurface>(PatchSurface{cells[1], *bare, {}, {}});
            if (!bare) patch.top = parse_mixture(cells[0]);
            for (const auto light : {optics::LightThrough::diffuse, optics::LightThrough::beam})
                if (cells[1] == light_name(light)) patch.lit = light;
            if (!patch.lit) check_role(cells[1], cells[1]);
        } catch (const InputError& error) {
            throw InputError(fmt::format("{}: {}", patch.where, error.what()));
        }
        if (!patch.lit) patch.backing = cells[1];
        patch.rho.resize(table_.channels.size());  // of L, a, b and X, Y, Z the same three, until all rows are known
        if (has_errors_) patch.error.resize(table_.channels.size());
        for (std::size_t k = 2; k < cells.size(); ++k) {
            const double value = csv_.number(k);
            const Column& column = columns_[k];
            switch (column.kind) {
                case Column::Kind::thickness:
                    patch.thickness_mm = value;
                    break;
                case Column::Kind::base:
                    patch.base_mm = value;
                    break;
                case Column::Kind::cell:
                    patch.cell_mm[column.channel] = value;
                    break;
                case Column::Kind::error:
                    patch.error[column.channel] = value;
                    break;
                default:
                    patch.rho[column.channel] = value;
            }
        }
        const std::string name = patch_name(patch);
        check(patch, name);
        if (!known(patch, name)) table_.patches.push_back(std::move(patch));
    }

    void check(const Patch& patch, const std::string& name) const {
        const bool bare = patch.top.empty();
        if (bare && (patch.lit || patch.thickness_mm != 0 || patch.base_mm != 0 || patch.cell_mm != Patch{}.cell_mm))
            csv_.fail(fmt::format(
                "{}: a bare surface has its name for backing, and 0 for thickness_mm, base_mm and cells", name));
        if (!bare && !(patch.thickness_mm >= 0.001 && patch.thickness_mm <= 1000))
            csv_.fail(
                fmt::format("patch {}: thickness_mm is {}; expected mm, from 0.001 to 1000", name, patch.thickness_mm));
        if (!(patch.base_mm == 0 || (patch.base_mm >= 0.001 && patch.base_mm <= 10000)))
            csv_.fail(
                fmt::format("patch {}: base_mm is {}; expected mm, from 0.001 to 10000, or 0 where it is not known",
                            name, patch.base_mm));
        if (patch.lit && (patch.base_mm > 0 || patch.cell_mm != std::array<double, 2>{}))
            csv_.fail(fmt::format(
                "patch {}: a slab that is lit from behind lies on nothing and is mixed voxel by voxel; give "
                "0 for base_mm, cell_x_mm and cell_y_mm",
                name));
        constexpr double least_cell_mm = 0.001, most_cell_mm = 10, rounding = 1e-3;
        const auto is_length = [](double mm) { return mm >= least_cell_mm && mm <= most_cell_mm; };
        if (patch.cell_mm != std::array<double, 2>{} && !(is_length(patch.cell_mm[0]) && is_length(patch.cell_mm[1])))
            csv_.fail(
                fmt::format("patch {}: cells of {} x {} mm; expected {} to {} mm, or 0 and 0 where there are none",
                            name, patch.cell_mm[0], patch.cell_mm[1], least_cell_mm, most_cell_mm));
        if (patch.is_checker() &&
            !(patch.top.size() == 2 && std::abs(patch.top[0].fraction - patch.top[1].fraction) < rounding))
            csv_.fail(fmt::format("patch {}: a checker holds as much of one resin as of another, W:50+K:50", name));
        for (std::size_t c = 0; c < patch.rho.size() && !colorimetric(); ++c) {
            const double rho = patch.rho[c];
            const std::string channel = channel_name(table_.channels, c);
            if (has_errors_ && !(patch.error[c] > 0 && patch.error[c] <= 1))
                csv_.fail(fmt::format("patch {}: the standard error of {} is {}; expected more than 0 and at most 1",
                                      name, channel, patch.error[c]));
            if (rho < (has_errors_ ? -6 * patch.error[c] : 0))
                csv_.fail(fmt::format(
                    "patch {}: {} is {}, but a reflectance cannot be negative; look at the dark level that was "
                    "subtracted, or give standard errors (R_se, ...) if this is noise",
                    name, channel, rho));
            if (rho > 1)
                csv_.fail(
                    fmt::format("patch {}: {} is {}, above 1, more than {}; divide by {}, and give shares, not percent",
                                name, channel, rho, patch.lit ? "all light" : "a perfect diffuser reflects",
                                patch.lit ? "what comes without the slab" : "the white reference's reflectance"));
        }
    }

    // Whether the same square has been there; with other values it cannot be known which to believe.
    bool known(const Patch& patch, const std::string& name) {
        const std::string key = fmt::format("{} {} {}", name, patch.thickness_mm, patch.base_mm);
        const auto [entry, is_new] = seen_.try_emplace(key, table_.patches.size());
        if (is_new) return false;
        const Patch& other = table_.patches[entry->second];
        if (other.rho == patch.rho && other.error == patch.error) return true;
        const std::size_t channel = static_cast<std::size_t>(
            std::mismatch(patch.rho.begin(), patch.rho.end(), other.rho.begin()).first - patch.rho.begin());
        const std::string values =
            channel < patch.rho.size()
                ? fmt::format("{} {} there and {} here", value_name(channel), other.rho[channel], patch.rho[channel])
                : "other standard errors";
        csv_.fail(fmt::format(
            "patch {} of {} mm was measured already ({}) with other values: {}; keep one row, the mean of both", name,
            patch.thickness_mm, other.where, values));
    }

    std::string value_name(std::size_t channel) const {
        if (!colorimetric()) return channel_name(table_.channels, channel);
        return std::string(1, (quantity_ == Quantity::lab ? "Lab" : "XYZ")[channel]);
    }

    CsvText csv_;
    std::optional<optics::Illuminant> illuminant_;
    PatchTable table_;
    Quantity quantity_ = Quantity::rgb;
    std::vector<Column> columns_;
    bool has_errors_ = false;
    std::array<bool, 2> has_cells_{};
    std::map<std::string, std::size_t> seen_;
};

}  // namespace

bool is_target_csv(std::string_view text) {
    const io::CsvReader csv(text, io::CsvRules::lenient, is_target_header);
    return csv.header().cells.empty() || csv.header().cells.front() == "top";
}

PatchTable read_target_csv(std::string_view text, std::string source, std::optional<optics::Illuminant> illuminant) {
    return TargetReader(text, std::move(source), illuminant).read();
}

std::string target_csv_text(const PatchTable& table, std::string_view comment) {
    VOXTONE_EXPECT(!table.is_chart);
    const bool base = std::ranges::any_of(table.patches, [](const Patch& p) { return p.base_mm > 0; });
    const bool cells = std::ranges::any_of(table.patches, &Patch::is_checker);
    const bool errors = !table.patches.empty() && std::ranges::all_of(table.patches, [](const Patch& p) {
        return !p.error.empty() && !(p.on && p.on->error.empty());
    });
    const std::vector<std::string> names = written_names(table.channels, errors);
    const std::size_t channels = table.channels.size();
    std::string text = comment_lines(comment) + comment_lines(written_illuminant(table.channels));
    text += "top,backing,thickness_mm";
    for (std::size_t c = 0; c < channels; ++c) text += fmt::format(",{}", names[c]);
    if (base) text += ",base_mm";
    if (cells) text += ",cell_x_mm,cell_y_mm";
    for (std::size_t c = channels; c < names.size(); ++c) text += fmt::format(",{}", names[c]);
    text += '\n';
    std::vector<Patch> rows = bare_patches(table);
    rows.insert(rows.end(), table.patches.begin(), table.patches.end());
    for (const Patch& patch : rows) {
        const std::vector<double> values = written_values(table.channels, patch, errors);
        text += fmt::format("{},{},{}", patch.top.empty() ? bare_text(patch.on->kind) : mixture_text(patch.top),
                            patch.lit ? light_name(*patch.lit) : patch.backing, patch.thickness_mm);
        for (std::size_t c = 0; c < channels; ++c) text += fmt::format(",{}", values[c]);
        if (base) text += fmt::format(",{}", patch.base_mm);
        if (cells) text += fmt::format(",{:.6g},{:.6g}", patch.cell_mm[0], patch.cell_mm[1]);
        for (std::size_t c = channels; c < values.size(); ++c) text += fmt::format(",{}", values[c]);
        text += '\n';
    }
    return text;
}

}  // namespace voxtone::calibration
