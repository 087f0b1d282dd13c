// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/profiles/lamp_file.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <optional>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/error.h"
#include "base/warning.h"
#include "io/files/csv_table.h"
#include "io/files/read_bytes.h"
#include "io/profiles/resin_file.h"

namespace voxtone::io {

namespace {

constexpr std::uint64_t most_lamp_bytes = std::uint64_t{16} << 20;
constexpr double first_seen_nm = 400, last_seen_nm = 700;

/// Decimal commas are points where commas do not separate.
std::optional<double> number_in(std::string cell, char separator) {
    if (separator != ',') std::ranges::replace(cell, ',', '.');
    double value = 0;
    const auto [rest, status] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
    if (status != std::errc{} || rest != cell.data() + cell.size() || !std::isfinite(value)) return std::nullopt;
    return value;
}

class LampTable {
public:
    LampTable(std::string_view text, const std::string& source) : csv_(text, CsvRules::lenient), source_(source) {
        if (csv_.header().cells.size() >= 2 && number_in(csv_.header().cells[0], csv_.separator())) add(csv_.header());
        CsvRow row;
        std::string fault;
        while (csv_.next(row, fault)) {
            if (!fault.empty()) fail(row, fault);
            add(row);
        }
        const bool covers = nm_.size() >= 2 && nm_.front() <= first_seen_nm && nm_.back() >= last_seen_nm;
        if (!covers)
            throw InputError(fmt::format(
                "{}: a lamp's power is known{}; colours take all that an eye sees: measure it from {:g} to {:g} nm at "
                "least, a row each: nm,power",
                source_, nm_.empty() ? " nowhere" : fmt::format(" from {:g} to {:g} nm", nm_.front(), nm_.back()),
                first_seen_nm, last_seen_nm));
        const auto seen = [&](std::size_t i) { return nm_[i] >= first_seen_nm && nm_[i] <= last_seen_nm; };
        for (std::size_t i = 0; i < nm_.size(); ++i)
            if (seen(i) && power_[i] > 0) return;
        throw InputError(fmt::format("{}: all power from {:g} to {:g} nm is 0: a print is black under it", source_,
                                     first_seen_nm, last_seen_nm));
    }

    [[nodiscard]] optics::LampPower power() const { return optics::sampled_lamp(nm_, power_); }

private:
    [[noreturn]] void fail(const CsvRow& row, const std::string& rule) const {
        throw InputError(fmt::format("{}: line {} {}", source_, row.line, rule));
    }
    void add(const CsvRow& row) {
        std::optional<double> nm, power;
        if (row.cells.size() >= 2)
            nm = number_in(row.cells[0], csv_.separator()), power = number_in(row.cells[1], csv_.separator());
        if (!nm || !power) fail(row, "is not two numbers, a wavelength in nm and the lamp's power there: \"450,0.83\"");
        if (!(*nm > 0) || (!nm_.empty() && !(*nm > nm_.back())))
            fail(row, fmt::format("has {:g} nm: wavelengths must be positive and rise", *nm));
        if (!(*power >= 0))
            fail(row, fmt::format("has the power {:g}, and light is not negative: set noise to 0", *power));
        nm_.push_back(*nm), power_.push_back(*power);
    }

    CsvReader csv_;
    const std::string& source_;
    std::vector<double> nm_, power_;
};

}  // namespace

optics::LampPower parse_lamp(std::string_view text, const std::string& source) {
    return LampTable(text, source).power();
}

optics::LampPower find_lamp(const std::string& name_or_file) {
    if (const auto lamp = optics::known_lamp(name_or_file)) return *lamp;
    std::error_code none;
    if (!std::filesystem::exists(name_or_file, none))
        throw InputError(
            fmt::format("--illuminant {}: there is no such lamp, and no file of that name; lamps by name are {} and "
                        "black bodies by "
                        "their temperature (2700K), others a table of their power (lamp.csv: nm,power)",
                        name_or_file, fmt::join(optics::lamp_names(), ", ")));
    return parse_lamp(read_text(name_or_file, most_lamp_bytes), name_or_file);
}

optics::ResinSet seen_under(optics::ResinSet set, const std::string& lamp) {
    if (lamp.empty() || lamp == usual_lamp) return set;
    const optics::LampPower power = find_lamp(lamp);
    set.channels = optics::seen_under(set.channels, power);
    set.name += " under " + std::filesystem::path(lamp).filename().string();
    return set;
}

std::optional<std::string> lamp_doubt(const std::string& resins, const std::string& lamp) {
    if (lamp.empty() || lamp == usual_lamp) return std::nullopt;
    return lamp_doubt(find_resin_set(resins), lamp);
}

std::optional<std::string> lamp_doubt(const optics::ResinSet& set, const std::string& lamp) {
    if (lamp.empty() || lamp == usual_lamp || set.channels.is_spectral()) return std::nullopt;
    return named_warning(
        "guessed-light",
        fmt::format(
            "the resin set {} has {} and no wavelengths: its colours under {} are those of the flattest spectra, "
            "which are off by some 2 CIEDE2000, and resins that part under that lamp do not part here; --resins "
            "with a set fitted to spectra knows better",
            set.name, optics::channels_text(set.channels), lamp));
}

}  // namespace voxtone::io
