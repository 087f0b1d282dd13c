// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/patches/chart_columns.h"

#include <algorithm>
#include <optional>
#include <set>

#include <fmt/format.h>

#include "base/contracts.h"
#include "base/error.h"
#include "base/printable.h"
#include "calibration/patches/table_cells.h"
#include "io/files/json_keys.h"

namespace voxtone::calibration {

namespace {

using Kind = ChartColumns::Kind;

constexpr double first_nm = 300, last_nm = 1100;
constexpr std::size_t most_columns_of_chart = 5000, most_roles = 64;

// What a name may mean, by itself.
struct Meaning {
    enum class Of {
        role,
        ink,
        numbered_ink,
        device_rgb,
        quantity,
        wavelength,
        thickness,
        backing,
        base,
        row,
        column,
        unused
    } of;
    std::string role = {};              // of a resin or an ink
    Quantity quantity = Quantity::lab;  // of `quantity`
    std::size_t channel = 0;            // of it, 0 to 2; of a numbered ink its number, from 0
    double nm = 0;                      // of a wavelength
    bool plain = false;                 // a letter alone, which may be a resin as well
    bool error = false;                 // the standard error of it
};

std::optional<double> wavelength(std::string_view name) {
    std::string text = in_capitals(name);
    for (const std::string_view prefix : {"SPECTRAL_", "SPEC_"})
        if (text.starts_with(prefix)) {
            text.erase(0, prefix.size());
            break;
        }
    if (text.starts_with("NM")) text.erase(0, 2);
    if (text.starts_with("_")) text.erase(0, 1);
    if (text.ends_with("NM")) text.erase(text.size() - 2);
    return number_with_comma(trimmed(text));
}

std::optional<std::pair<Quantity, std::size_t>> measured_channel(std::string_view name, bool& plain) {
    struct Entry {
        const char* name;
        Quantity quantity;
        std::size_t channel;
    };
    static constexpr Entry plain_names[] = {
        {"L", Quantity::lab, 0},  {"a", Quantity::lab, 1},  {"b", Quantity::lab, 2}, {"L*", Quantity::lab, 0},
        {"a*", Quantity::lab, 1}, {"b*", Quantity::lab, 2}, {"X", Quantity::xyz, 0}, {"Y", Quantity::xyz, 1},
        {"Z", Quantity::xyz, 2},  {"R", Quantity::rgb, 0},  {"G", Quantity::rgb, 1}, {"B", Quantity::rgb, 2}};
    static constexpr Entry long_names[] = {{"LAB_L", Quantity::lab, 0}, {"LAB_A", Quantity::lab, 1},
                                           {"LAB_B", Quantity::lab, 2}, {"XYZ_X", Quantity::xyz, 0},
                                           {"XYZ_Y", Quantity::xyz, 1}, {"XYZ_Z", Quantity::xyz, 2}};
    plain = true;
    for (const Entry& entry : plain_names)
        if (name == entry.name) return std::pair(entry.quantity, entry.channel);
    plain = false;
    const std::string capitals = in_capitals(name);
    for (const Entry& entry : long_names)
        if (capitals == entry.name) return std::pair(entry.quantity, entry.channel);
    return std::nullopt;
}

// What programs and people write beside the measurement.
bool is_bookkeeping(std::string_view capitals) {
    static const std::set<std::string_view> names{
        "",           "ID",       "NAME",        "NO",          "NR",           "NUMBER",   "INDEX",       "PATCH",
        "PATCH_ID",   "COL",      "PAGE",        "STRIP",       "PLACE",        "ORDER",    "DATE",        "TIME",
        "COMMENT",    "COMMENTS", "NOTE",        "NOTES",       "INFO",         "STRING",   "TAG",         "REPEAT",
        "INSTRUMENT", "LCH_L",    "LCH_C",       "LCH_H",       "LAB_C",        "LAB_H",    "XYY_X",       "XYY_Y",
        "GLOSS",      "MODE",     "CHI_SQD_PAR", "SPECTRAL_NM", "SPECTRAL_PCT", "XYY_CAPY", "SPECTRAL_DEC"};
    return names.contains(capitals) || capitals.starts_with("SAMPLE") || capitals.starts_with("D_") ||
           capitals.starts_with("DE_") || capitals.starts_with("STDEV_") || capitals.starts_with("MEAN_");
}

// "6CLR_2" or "SIXCLR_2" -> 2.
std::optional<std::size_t> numbered_ink(std::string_view capitals) {
    const std::size_t at = capitals.find("CLR_");
    if (at == 0 || at == std::string_view::npos) return std::nullopt;
    const auto value = number(capitals.substr(at + 4));
    if (!value || *value < 1 || *value > 15) return std::nullopt;
    return static_cast<std::size_t>(*value);
}

Meaning meaning_of_whole(std::string_view name) {
    using Of = Meaning::Of;
    const std::string capitals = in_capitals(name);
    if (capitals == "THICKNESS_MM") return {.of = Of::thickness};
    if (capitals == "BASE_MM") return {.of = Of::base};
    if (capitals == "BACKING") return {.of = Of::backing};
    if (capitals == "ROW") return {.of = Of::row};
    if (capitals == "COLUMN") return {.of = Of::column};
    if (is_bookkeeping(capitals)) return {.of = Of::unused};
    if (capitals == "RGB_R" || capitals == "RGB_G" || capitals == "RGB_B") return {.of = Of::device_rgb};
    if (capitals.size() == 6 && capitals.starts_with("CMYK_") &&
        std::string_view("CMYK").find(capitals[5]) != std::string_view::npos)
        return {.of = Of::ink, .role = capitals.substr(5)};
    if (const auto ink = numbered_ink(capitals)) return {.of = Of::numbered_ink, .channel = *ink - 1};
    if (const auto nm = wavelength(name)) return {.of = Of::wavelength, .nm = *nm};
    bool plain = false;
    if (const auto channel = measured_channel(name, plain))
        return {.of = Of::quantity,
                .role = std::string(name),
                .quantity = channel->first,
                .channel = channel->second,
                .plain = plain};
    return {.of = Of::role, .role = std::string(name)};
}

Meaning meaning_of(std::string_view name) {
    using Of = Meaning::Of;
    if (name.ends_with("_se")) {
        Meaning meaning = meaning_of_whole(name.substr(0, name.size() - 3));
        meaning.error = true;
        if (meaning.of == Of::quantity || meaning.of == Of::wavelength) return meaning;
    }
    return meaning_of_whole(name);
}

// Reads the header of a chart: first what is measured, then what is left for resins.
class HeaderReader {
public:
    HeaderReader(std::span<const std::string_view> names, const std::string& where) : names_(names), where_(where) {
        if (names.size() > most_columns_of_chart)
            fail(fmt::format("{} columns, more than {}", names.size(), most_columns_of_chart));
        for (const std::string_view name : names) meanings_.push_back(meaning_of(name));
    }

    ChartColumns read() {
        find_luminance();
        choose_quantity();
        number_inks();
        for (std::size_t k = 0; k < names_.size(); ++k) place(k);
        check_roles();
        check_errors();
        return std::move(columns_);
    }

private:
    using Of = Meaning::Of;

    [[noreturn]] void fail(const std::string& what) const { throw InputError(fmt::format("{}: {}.", where_, what)); }

    void be_role(Meaning& meaning) const { meaning = {.of = Of::role, .role = meaning.role}; }

    // A plain Y is luminance where it stands between X and Z, and yellow elsewhere.
    void find_luminance() {
        std::vector<std::size_t> plain;
        bool has_x = false, has_z = false;
        for (std::size_t k = 0; k < meanings_.size(); ++k) {
            if (meanings_[k].error || meanings_[k].of == Of::unused) continue;
            plain.push_back(k);
            has_x = has_x || names_[k] == "X", has_z = has_z || names_[k] == "Z";
        }
        bool found = false;
        for (std::size_t i = 0; i < plain.size(); ++i) {
            if (names_[plain[i]] != "Y") continue;
            const bool between =
                i > 0 && i + 1 < plain.size() && names_[plain[i - 1]] == "X" && names_[plain[i + 1]] == "Z";
            if (between)
                found = true;
            else
                be_role(meanings_[plain[i]]);
        }
        if (has_x && has_z && !found)
            fail(
                "there are columns X and Z and no Y between them, so that a Y may be luminance or yellow; name them "
                "XYZ_X, XYZ_Y, XYZ_Z");
    }

    // How many of the three channels of a quantity there are.
    std::size_t channels_of(Quantity quantity) const {
        std::set<std::size_t> channels;
        for (const Meaning& m : meanings_)
            if (m.of == Of::quantity && m.quantity == quantity && !m.error) channels.insert(m.channel);
        return channels.size();
    }

    void choose_quantity() {
        std::vector<double>& nm = columns_.wavelengths_nm;
        for (const Meaning& m : meanings_)
            if (m.of == Of::wavelength && !m.error) nm.push_back(m.nm);
        std::ranges::sort(nm);
        if (!nm.empty() && !(nm.front() >= first_nm && nm.back() <= last_nm))
            fail(fmt::format("a wavelength of {} nm; expected {} to {}", nm.front() < first_nm ? nm.front() : nm.back(),
                             first_nm, last_nm));
        if (const auto twice = std::ranges::adjacent_find(nm); twice != nm.end())
            fail(fmt::format("the wavelength {} nm is there twice", *twice));
        const bool lab = channels_of(Quantity::lab) == 3, xyz = channels_of(Quantity::xyz) == 3;
        if (!nm.empty())
            columns_.quantity = Quantity::spectrum;
        else if (lab)
            columns_.quantity = Quantity::lab;
        else if (xyz)
            columns_.quantity = Quantity::xyz;
        else if (channels_of(Quantity::rgb) == 3)
            columns_.quantity = Quantity::rgb;
        else
            fail_for_want_of_measurement();
    }

    [[noreturn]] void fail_for_want_of_measurement() const {
        if (channels_of(Quantity::lab) == 2) fail("of L, a and b one is missing; all three are needed");
        if (channels_of(Quantity::xyz) == 2) fail("of X, Y and Z one is missing; all three are needed");
        if (channels_of(Quantity::rgb) == 2) fail("of R, G and B one is missing; all three are needed");
        fail(
            "nothing is measured in these columns: a chart has L,a,b or X,Y,Z or R,G,B or wavelengths in nm beside the "
            "shares of its resins, and a target begins top,backing,thickness_mm");
    }

    // Inks with numbers have no names, but three and four are what every such device has.
    void number_inks() {
        std::size_t inks = 0;
        for (const Meaning& m : meanings_)
            if (m.of == Of::numbered_ink) ++inks;
        if (inks == 0) return;
        if (inks != 3 && inks != 4)
            fail(fmt::format(
                "there are {} device fields with numbers and no names; rename them to the roles of their resins, such "
                "as W, C, M, Y, K",
                inks));
        for (Meaning& m : meanings_) {
            if (m.of != Of::numbered_ink) continue;
            if (m.channel >= inks) fail("device fields with numbers are not counted from 1");
            m = {.of = Of::ink, .role = std::string(1, "CMYK"[m.channel])};
        }
        columns_.note =
            fmt::format("device fields 1 to {} are taken as {}", inks, inks == 3 ? "C, M, Y" : "C, M, Y, K");
    }

    std::size_t channel_index(const Meaning& m) const {
        if (m.of == Of::quantity) return m.channel;
        const auto& nm = columns_.wavelengths_nm;
        const auto found = std::ranges::find(nm, m.nm);
        if (found == nm.end()) fail(fmt::format("a standard error of {} nm, but no such wavelength", m.nm));
        return static_cast<std::size_t>(found - nm.begin());
    }

    void place(std::size_t k) {
        Meaning m = meanings_[k];
        const bool chosen = m.of == Of::wavelength ? columns_.quantity == Quantity::spectrum
                                                   : m.of == Of::quantity && m.quantity == columns_.quantity;
        const bool whole = m.of == Of::quantity && (m.quantity != Quantity::rgb) && channels_of(m.quantity) == 3;
        // L alone, or R beside a spectrum: a resin of that name.
        if (m.of == Of::quantity && m.plain && !m.error && !chosen && !whole) be_role(m);
        ChartColumns::Column column{.name = std::string(names_[k])};
        if (chosen) {
            column.kind = m.error ? Kind::error : Kind::value;
            column.index = channel_index(m);
        } else if (m.of == Of::role || m.of == Of::ink) {
            column = share(m, k);
        } else if (m.of == Of::thickness || m.of == Of::backing || m.of == Of::base) {
            column.kind = m.of == Of::thickness ? Kind::thickness : m.of == Of::backing ? Kind::backing : Kind::base;
        } else if (m.of == Of::row || m.of == Of::column) {
            column.kind = m.of == Of::row ? Kind::row : Kind::column;
        }
        if (column.kind != Kind::unused && !placed_.insert({column.kind, column.index}).second)
            fail(fmt::format("column {} is there twice", shown(names_[k])));
        columns_.columns.push_back(std::move(column));
    }

    ChartColumns::Column share(const Meaning& m, std::size_t k) {
        static const std::vector<std::string> near{"thickness_mm", "base_mm", "backing"};
        const std::string_view name = names_[k];
        if (name == "top")
            fail("a table with a column top begins top,backing,thickness_mm; in a chart every resin has a column");
        if (!is_role(m.role))
            fail(fmt::format("column {}: {} is neither measured nor the role of a resin, a short word such as C or W",
                             k + 1, shown(name)));
        if (name.size() > 4 && (name.ends_with("_mm") || !io::nearest_name(name, near).empty()))
            fail(fmt::format("column {}: {}", k + 1, io::unknown_key_message(printable(name), near)));
        if (std::ranges::find(columns_.roles, m.role) != columns_.roles.end())
            fail(fmt::format("the resin {} has two columns", shown(m.role)));
        if (columns_.roles.size() >= most_roles) fail(fmt::format("more than {} resins", most_roles));
        columns_.roles.push_back(m.role);
        return {.kind = Kind::share, .index = columns_.roles.size() - 1, .name = std::string(name)};
    }

    void check_roles() {
        bool inks = false, white = false, device_rgb = false;
        for (const Meaning& m : meanings_) {
            inks = inks || m.of == Of::ink;
            device_rgb = device_rgb || m.of == Of::device_rgb;
        }
        for (const std::string& role : columns_.roles)
            white = white || in_capitals(role) == "W" || in_capitals(role) == "WHITE";
        columns_.rest_is_white = inks && !white;
        if (!columns_.roles.empty()) return;
        if (device_rgb)
            fail(
                "its patches are given as RGB of a device, which says nothing of the resins that the printer mixed; "
                "give the shares of all resins, in columns such as W,C,M,Y,K");
        fail("no column has the share of a resin; give one for each, such as W,C,M,Y,K");
    }

    void check_errors() {
        std::size_t errors = 0;
        for (const auto& column : columns_.columns) errors += column.kind == Kind::error ? 1 : 0;
        if (errors != 0 && errors != columns_.channels())
            fail(fmt::format("{} of {} measured columns have a standard error; give it for all or for none", errors,
                             columns_.channels()));
        columns_.has_errors = errors != 0;
    }

    std::span<const std::string_view> names_;
    std::string where_;
    std::vector<Meaning> meanings_;
    ChartColumns columns_;
    std::set<std::pair<Kind, std::size_t>> placed_;
};

double number_of(const ChartColumns::Column& column, std::string_view cell, const std::string& where) {
    if (const auto value = number_with_comma(cell)) return *value;
    if (column.kind == Kind::share)
        throw InputError(
            fmt::format("{}: column {} has {}, which is no number; the column was taken as the share of a resin, as "
                        "every column is whose name means nothing else.",
                        where, shown(column.name), shown(cell)));
    if (cell.empty())
        throw InputError(fmt::format("{}: column {} is empty; measure the patch, or leave its line out.", where,
                                     shown(column.name)));
    throw InputError(fmt::format("{}: column {} has {}, which is no number.", where, shown(column.name), shown(cell)));
}

}  // namespace

ChartColumns chart_columns(std::span<const std::string_view> names, const std::string& where) {
    return HeaderReader(names, where).read();
}

bool is_unmeasured(const ChartColumns& columns, std::span<const std::string_view> cells) {
    VOXTONE_EXPECT(cells.size() == columns.columns.size());
    for (std::size_t k = 0; k < cells.size(); ++k)
        if (columns.columns[k].kind == Kind::value && !cells[k].empty()) return false;
    return true;
}

Patch chart_row(const ChartColumns& columns, std::span<const std::string_view> cells, std::string where) {
    VOXTONE_EXPECT(cells.size() == columns.columns.size());
    Patch patch;
    patch.where = std::move(where);
    for (const std::string& role : columns.roles) patch.top.push_back({role, 0});
    patch.rho.resize(columns.channels());
    if (columns.has_errors) patch.error.resize(columns.channels());
    for (std::size_t k = 0; k < cells.size(); ++k) {
        const ChartColumns::Column& column = columns.columns[k];
        if (column.kind == Kind::unused) continue;
        if (column.kind == Kind::backing) {
            if (!cells[k].empty() && !is_role(cells[k]))
                throw InputError(fmt::format("{}: the backing {} is no role of a resin, a short word such as W.",
                                             patch.where, shown(cells[k])));
            patch.backing = cells[k];
            continue;
        }
        if (column.kind == Kind::row || column.kind == Kind::column) {
            // What other programs call a row may be a word.
            const auto place = number(cells[k]);
            if (place && *place >= 1 && *place <= 10000)
                (column.kind == Kind::row ? patch.row : patch.column) = static_cast<int>(*place);
            continue;
        }
        const bool of_layer = column.kind == Kind::thickness || column.kind == Kind::base;
        const double value = of_layer && cells[k].empty() ? 0 : number_of(column, cells[k], patch.where);
        if (column.kind == Kind::share) patch.top[column.index].fraction = value;
        if (column.kind == Kind::thickness) patch.thickness_mm = value;
        if (column.kind == Kind::base) patch.base_mm = value;
        if (column.kind == Kind::value) patch.rho[column.index] = value;
        if (column.kind == Kind::error) patch.error[column.index] = value;
    }
    return patch;
}

}  // namespace voxtone::calibration
