// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/patches/chart_columns.h"

#include <algorithm>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/error.h"
#include "base/printable.h"
#include "calibration/tables/table_cells.h"
#include "io/files/json_keys.h"

namespace voxtone::calibration {

namespace {

using Kind = ChartColumns::Kind;

constexpr double first_nm = 300, last_nm = 1100;
constexpr std::size_t most_columns_of_chart = 5000, most_roles = 64;

// Reads the header of a chart: first what is measured, then what is left for resins.
class HeaderReader {
public:
    HeaderReader(std::span<const std::string> names, const std::string& where, const ColumnWords& words)
        : names_(names), where_(where), words_(words) {
        if (names.size() > most_columns_of_chart)
            fail(fmt::format("{} columns, more than {}", names.size(), most_columns_of_chart));
        for (const std::string_view name : names) meanings_.push_back(column_meaning(name, words));
    }

    ChartColumns read() {
        find_letters();
        find_luminance();
        choose_ways();
        choose_quantity();
        number_inks();
        for (std::size_t k = 0; k < names_.size(); ++k) place(k);
        check_roles();
        check_errors();
        return std::move(columns_);
    }

private:
    using Of = ColumnMeaning::Of;
    using Meaning = ColumnMeaning;

    [[noreturn]] void fail(const std::string& what) const { throw InputError(fmt::format("{}: {}.", where_, what)); }

    bool is_resin(std::string_view name) const { return is_known_role(name) || words_.names(name); }
    void be_role(Meaning& meaning) const {
        meaning = {.of = is_resin(meaning.role) ? Of::role : Of::unknown, .role = meaning.role};
    }

    std::size_t place_of(std::string_view name) const {
        return static_cast<std::size_t>(std::ranges::find(names_, name) - names_.begin());
    }
    bool has(std::string_view name) const { return place_of(name) < names_.size(); }

    // Some write L, A, B, or all in small letters.
    void find_letters() {
        const auto be_lab = [&](std::string_view name, std::size_t channel) {
            meanings_[place_of(name)] = {.of = Of::quantity,
                                         .role = std::string(name),
                                         .quantity = Quantity::lab,
                                         .channel = channel,
                                         .plain = true};
        };
        if (has("L") && has("A") && has("B") && !has("a") && !has("b") && !(has("R") && has("G")))
            be_lab("A", 1), be_lab("B", 2);
        if (has("l") && !has("L") && has("a") && has("b")) be_lab("l", 0);
        for (const std::string_view small : {"c", "m", "y", "k", "w"})
            if (const std::string role = in_capitals(small); has(small) && !has(role) && !is_resin(small))
                meanings_[place_of(small)] = {.of = Of::role, .role = role};
    }

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

    // How many of the three channels of a quantity there are, measured in one way or in any.
    std::size_t channels_of(Quantity quantity, const MeasuredWay* way = nullptr) const {
        std::set<std::size_t> channels;
        for (const Meaning& m : meanings_)
            if (m.of == Of::quantity && m.quantity == quantity && !m.error && (!way || m.way == *way))
                channels.insert(m.channel);
        return channels.size();
    }

    static std::string name_of(const MeasuredWay& way) {
        std::string name = way.mode;
        for (const std::string& word : {way.illuminant, way.observer.empty() ? "" : way.observer + " degree"})
            if (!word.empty()) name += (name.empty() ? "" : " ") + word;
        return name.empty() ? "without a word" : name;
    }

    // Of one quantity that was measured in several ways, all but one are known, and not used.
    template <class IsOne, class IsWhole>
    void choose_way(const char* what, IsOne is_one, IsWhole is_whole) {
        std::vector<MeasuredWay> ways;
        for (const Meaning& m : meanings_)
            if (is_one(m) && !m.error && std::ranges::find(ways, m.way) == ways.end()) ways.push_back(m.way);
        if (ways.empty()) return;
        const auto part = std::stable_partition(ways.begin(), ways.end(), is_whole);
        std::stable_partition(ways.begin(), part, [](const MeasuredWay& way) { return way.observer != "10"; });
        const MeasuredWay taken = ways.front();
        if (part - ways.begin() > 1)
            columns_.notes.push_back(
                fmt::format("{} are there in {} ways; those {} are taken", what, part - ways.begin(), name_of(taken)));
        for (Meaning& m : meanings_) {
            if (!is_one(m) || m.way == taken) continue;
            const bool of_whole = std::find(ways.begin(), part, m.way) != part;
            if (m.plain && !of_whole)
                be_role(m);
            else
                m = {.of = Of::unused};
        }
    }

    void choose_ways() {
        for (const Quantity quantity : {Quantity::lab, Quantity::xyz})
            choose_way(
                quantity == Quantity::lab ? "L, a, b" : "X, Y, Z",
                [&](const Meaning& m) { return m.of == Of::quantity && m.quantity == quantity; },
                [&](const MeasuredWay& way) { return channels_of(quantity, &way) == 3; });
        choose_way(
            "spectra", [](const Meaning& m) { return m.of == Of::wavelength; },
            [](const MeasuredWay&) { return true; });
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
        for (const Meaning& m : meanings_) {
            if (!is_chosen(m)) continue;
            columns_.conditions.illuminant = m.way.illuminant;
            columns_.conditions.observer = m.way.observer;
            if (m.way.mode == "M3") columns_.conditions.filter = "Pol";
        }
    }

    bool is_chosen(const Meaning& m) const {
        return m.of == Of::wavelength ? columns_.quantity == Quantity::spectrum
                                      : m.of == Of::quantity && m.quantity == columns_.quantity;
    }

    std::string not_known() const {
        std::vector<std::string> names;
        for (std::size_t k = 0; k < names_.size(); ++k)
            if (meanings_[k].of == Of::unknown) names.emplace_back(names_[k]);
        return names.empty() ? "" : fmt::format("; not known here: {}", shown_list(names));
    }

    [[noreturn]] void fail_for_want_of_measurement() const {
        if (channels_of(Quantity::lab) == 2) fail("of L, a and b one is missing; all three are needed");
        if (channels_of(Quantity::xyz) == 2) fail("of X, Y and Z one is missing; all three are needed");
        if (channels_of(Quantity::rgb) == 2) fail("of R, G and B one is missing; all three are needed");
        fail(
            "nothing is measured in these columns: a chart has L,a,b or X,Y,Z or R,G,B or wavelengths in nm beside the "
            "shares of its resins, and a target begins top,backing,thickness_mm" +
            not_known());
    }

    // Inks with numbers have no names, but three and four are what every such device has.
    void number_inks() {
        std::size_t inks = 0;
        for (const Meaning& m : meanings_)
            if (m.of == Of::numbered_ink) ++inks;
        if (inks == 0) return;
        std::vector<std::string> roles(words_.resins.begin(), words_.resins.end());
        if (roles.size() == inks + 1) std::erase(roles, "W");  // what lies beside the inks
        const bool named = roles.size() == inks;
        if (!named && inks != 3 && inks != 4)
            fail(fmt::format(
                "there are {} device fields with numbers and no names; name their resins in their order with --resins, "
                "or rename them to the roles of their resins, such as W, C, M, Y, K",
                inks));
        if (!named) roles.assign({"C", "M", "Y", "K"}), roles.resize(inks);
        for (Meaning& m : meanings_) {
            if (m.of != Of::numbered_ink) continue;
            if (m.channel >= inks) fail("device fields with numbers are not counted from 1");
            m = {.of = Of::ink, .role = roles[m.channel]};
        }
        columns_.notes.push_back(fmt::format("device fields 1 to {} are taken as {}", inks, fmt::join(roles, ", ")));
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
        const bool chosen = is_chosen(m);
        const bool whole = m.of == Of::quantity && (m.quantity != Quantity::rgb) && channels_of(m.quantity) == 3;
        // L alone, or R beside a spectrum: a resin of that name.
        if (m.of == Of::quantity && m.plain && !m.error && !chosen && !whole) be_role(m);
        if (m.of == Of::unknown) leave_aside(k);
        ChartColumns::Column column;
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
        columns_.columns.push_back(column);
    }

    // A name that is nearly one of ours is a slip, any other somebody else's.
    void leave_aside(std::size_t k) {
        static const std::vector<std::string> near{"thickness_mm", "base_mm", "backing"};
        const std::string_view name = names_[k];
        if (name == "top")
            fail("a table with a column top begins top,backing,thickness_mm; in a chart every resin has a column");
        if (name.size() > 4 && (name.ends_with("_mm") || !io::nearest_name(name, near).empty()))
            fail(fmt::format("column {}: {}", k + 1, io::unknown_key_message(printable(name), near)));
        columns_.aside.emplace_back(name);
    }

    ChartColumns::Column share(const Meaning& m, std::size_t k) {
        const std::string_view name = names_[k];
        if (!is_role(m.role))
            fail(fmt::format("column {}: {} is no role of a resin, a short word such as C or W", k + 1, shown(name)));
        if (std::ranges::find(columns_.roles, m.role) != columns_.roles.end())
            fail(fmt::format("the resin {} has two columns", shown(m.role)));
        if (columns_.roles.size() >= most_roles) fail(fmt::format("more than {} resins", most_roles));
        columns_.roles.push_back(m.role);
        return {.kind = Kind::share, .index = columns_.roles.size() - 1};
    }

    void check_roles() {
        bool white = false, device_rgb = false;
        for (const Meaning& m : meanings_) {
            columns_.of_inks = columns_.of_inks || m.of == Of::ink;
            device_rgb = device_rgb || m.of == Of::device_rgb;
        }
        for (const std::string& role : columns_.roles)
            white = white || in_capitals(role) == "W" || in_capitals(role) == "WHITE";
        columns_.rest_is_white = columns_.of_inks && !white;
        if (columns_.roles.empty() && device_rgb)
            fail(
                "its patches are given as RGB of a device, which says nothing of the resins that the printer mixed; "
                "give the shares of all resins, in columns such as W,C,M,Y,K");
        if (columns_.roles.empty())
            fail(
                "no column has the share of a resin; give one for each, such as W,C,M,Y,K, or name them with "
                "`calibrate fit --resins`" +
                not_known());
        if (!columns_.aside.empty())
            columns_.notes.push_back(fmt::format(
                "left aside, as neither measured nor a resin that is known: {}; `calibrate fit --resins` names others",
                shown_list(columns_.aside)));
    }

    void check_errors() {
        std::size_t errors = 0;
        for (const auto& column : columns_.columns) errors += column.kind == Kind::error ? 1 : 0;
        if (errors != 0 && errors != columns_.channels())
            fail(fmt::format("{} of {} measured columns have a standard error; give it for all or for none", errors,
                             columns_.channels()));
        columns_.has_errors = errors != 0;
    }

    std::span<const std::string> names_;
    std::string where_;
    ColumnWords words_;
    std::vector<Meaning> meanings_;
    ChartColumns columns_;
    std::set<std::pair<Kind, std::size_t>> placed_;
};

double number_of(const TextTable& row, std::size_t k, bool share) {
    std::string_view cell = row.cells()[k];
    if (share && cell.ends_with('%')) cell = trimmed(cell.substr(0, cell.size() - 1));
    if (const auto value = number_with_comma(cell)) return *value;
    if (cell.empty() && !share) row.fail(k, "is empty; measure the patch, or leave its line out");
    row.fail(k, fmt::format("{} is no number{}", shown(cell), share ? ", but the share of a resin is one" : ""));
}

// Whether nothing is measured: every measured cell is empty.
bool is_unmeasured(const TextTable& row, const ChartColumns& columns) {
    for (std::size_t k = 0; k < columns.columns.size(); ++k)
        if (columns.columns[k].kind == Kind::value && !row.cells()[k].empty()) return false;
    return true;
}

Patch patch_of(const TextTable& row, const ChartColumns& columns) {
    Patch patch;
    patch.where = row.where();
    for (const std::string& role : columns.roles) patch.top.push_back({role, 0});
    patch.rho.resize(columns.channels());
    if (columns.has_errors) patch.error.resize(columns.channels());
    for (std::size_t k = 0; k < columns.columns.size(); ++k) {
        const ChartColumns::Column& column = columns.columns[k];
        const std::string& cell = row.cells()[k];
        switch (column.kind) {
            case Kind::unused:
                break;
            case Kind::share:
                patch.top[column.index].fraction = number_of(row, k, true);
                break;
            case Kind::thickness:
            case Kind::base:
                (column.kind == Kind::base ? patch.base_mm : patch.thickness_mm) =
                    cell.empty() ? 0 : number_of(row, k, false);
                break;
            case Kind::backing:
                if (!cell.empty() && !is_role(cell))
                    row.fail(k, fmt::format("{} is no role of a resin, a short word such as W", shown(cell)));
                patch.backing = cell;
                break;
            case Kind::value:
                patch.rho[column.index] = number_of(row, k, false);
                break;
            case Kind::error:
                patch.error[column.index] = number_of(row, k, false);
                break;
            case Kind::row:
            case Kind::column:
                // What other programs call a row may be a word.
                if (const auto place = calibration::number(cell); place && *place >= 1 && *place <= 10000)
                    (column.kind == Kind::row ? patch.row : patch.column) = static_cast<int>(*place);
        }
    }
    return patch;
}

}  // namespace

ChartColumns chart_columns(std::span<const std::string> names, const std::string& where, const ColumnWords& words) {
    return HeaderReader(names, where, words).read();
}

void take_rows(TextTable& table, const ChartColumns& columns, ChartReading& reading) {
    std::vector<Patch>& patches = reading.table.patches;
    std::size_t unmeasured = 0;
    while (table.next()) {
        if (patches.size() + unmeasured >= most_chart_patches)
            table.fail(fmt::format("more than {} patches", most_chart_patches));
        if (is_unmeasured(table, columns))
            ++unmeasured;
        else
            patches.push_back(patch_of(table, columns));
    }
    const std::string& source = reading.table.source;
    if (unmeasured > 0 && patches.empty())
        throw InputError(fmt::format("{}: no patch is measured yet: its {} lines have no colour; fill them in.", source,
                                     unmeasured));
    reading.quantity = columns.quantity;
    reading.inks = columns.of_inks ? columns.roles.size() : 0;
    reading.rest_is_white = columns.rest_is_white;
    reading.aside = columns.aside;
    if (columns.quantity == Quantity::spectrum) reading.table.channels.wavelengths_nm = columns.wavelengths_nm;
    // A name tells of its own column, the file of all.
    reading.conditions = conditions_of(table);
    const MeasuringConditions& told = columns.conditions;
    if (!told.illuminant.empty()) reading.conditions.illuminant = told.illuminant;
    if (!told.observer.empty()) reading.conditions.observer = told.observer;
    if (!told.filter.empty()) reading.conditions.filter = told.filter;
    for (const std::string& note : columns.notes) reading.table.notes.push_back(fmt::format("{}: {}.", source, note));
    if (unmeasured > 0)
        reading.table.notes.push_back(
            fmt::format("{}: {} patches have no colour and are left out.", source, unmeasured));
}

}  // namespace voxtone::calibration
