// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/calibration/patches/patch_file.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <optional>

#include <fmt/format.h>

#include "voxtone/base/error.h"
#include "voxtone/base/printable.h"
#include "voxtone/io/files/json_keys.h"
#include "voxtone/io/files/whole_file.h"

namespace voxtone::calibration {

namespace {

constexpr std::uint64_t most_bytes = std::uint64_t{16} << 20;
constexpr std::size_t most_columns = 20000, most_patches = 100000, most_role_bytes = 32;

std::string_view trimmed(std::string_view text) {
    const auto blank = [](char c) { return c == ' ' || c == '\t' || c == '\r'; };
    while (!text.empty() && blank(text.front())) text.remove_prefix(1);
    while (!text.empty() && blank(text.back())) text.remove_suffix(1);
    if (text.size() >= 2 && text.front() == '"' && text.back() == '"') text = text.substr(1, text.size() - 2);
    return text;
}

std::vector<std::string_view> split(std::string_view line, char at) {
    std::vector<std::string_view> cells;
    for (std::size_t from = 0;;) {
        const std::size_t to = line.find(at, from);
        cells.push_back(trimmed(line.substr(from, to - from)));
        if (to == std::string_view::npos) return cells;
        from = to + 1;
    }
}

std::optional<double> number(std::string_view text) {
    if (text.starts_with('+')) text.remove_prefix(1);
    double value = 0;
    const auto [end, fault] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (fault != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) return std::nullopt;
    return value;
}

// A cell as it is shown in a message.
std::string shown(std::string_view text) {
    return fmt::format("\"{}{}\"", printable(text.substr(0, 40)), text.size() > 40 ? "..." : "");
}

void check_role(std::string_view role, std::string_view whole) {
    if (!role.empty() && role.size() <= most_role_bytes && role.find_first_of(":+%,\"") == std::string_view::npos &&
        printable(role) == role) {
        return;
    }
    throw InputError(fmt::format(
        "{} is no mixture: a role is a short word such as C or W, a mixture \"C:10+W:90\" in percent.", shown(whole)));
}

// What a column of the table holds.
struct Column {
    enum class Kind { top, backing, thickness, base, value, error } kind;
    std::size_t channel = 0;
};

class Reader {
public:
    Reader(std::string_view text, std::string source) : text_(text) { table_.source = std::move(source); }

    PatchTable read() {
        if (text_.starts_with("\xEF\xBB\xBF")) text_.remove_prefix(3);
        std::size_t from = 0;
        while (from < text_.size()) {
            std::size_t to = text_.find('\n', from);
            if (to == std::string_view::npos) to = text_.size();
            const std::string_view line = trimmed(text_.substr(from, to - from));
            from = to + 1;
            ++line_;
            if (line.empty() || line.starts_with('#')) continue;
            if (columns_.empty())
                header(line);
            else
                row(line);
        }
        if (columns_.empty())
            fail("has no header line; expected top,backing,thickness_mm,R,G,B or wavelengths in nm in place of R,G,B");
        if (table_.patches.empty()) fail("has a header and no patches; give one line per measured square");
        return std::move(table_);
    }

private:
    [[noreturn]] void fail(const std::string& what) const {
        throw InputError(fmt::format("{}: {}.", table_.source, what));
    }
    [[noreturn]] void fail_here(const std::string& what) const {
        throw InputError(fmt::format("{}: line {}: {}.", table_.source, line_, what));
    }

    void header(std::string_view line) {
        const auto names = split(line, ',');
        if (names.size() == 1 && line.find_first_of(";\t") != std::string_view::npos)
            fail_here(
                "columns are separated by semicolons or tabs; save the table with commas (and points in numbers)");
        if (names.size() > most_columns) fail_here(fmt::format("{} columns, more than {}", names.size(), most_columns));
        const std::vector<std::string> first{"top", "backing", "thickness_mm"};
        for (std::size_t k = 0; k < first.size(); ++k) {
            if (k < names.size() && names[k] == first[k]) continue;
            fail_here(fmt::format("column {} is {}, expected \"{}\": the header begins top,backing,thickness_mm", k + 1,
                                  k < names.size() ? shown(names[k]) : "missing", first[k]));
        }
        columns_ = {{Column::Kind::top}, {Column::Kind::backing}, {Column::Kind::thickness}};
        // Values first, so that an error column may stand before its channel.
        std::vector<double> wavelengths;
        std::map<std::string_view, std::size_t> channels;
        for (std::size_t k = 3; k < names.size(); ++k) {
            const std::string_view name = names[k];
            if (name == "base_mm" || name.ends_with("_se")) continue;
            const auto nm = number(name);
            const std::size_t rgb = name.size() == 1 ? std::string_view("RGB").find(name) : std::string_view::npos;
            if (!nm && rgb == std::string_view::npos) {
                const std::vector<std::string> known{"base_mm", "R", "G", "B", "R_se", "G_se", "B_se"};
                fail_here(fmt::format("column {}: {}; a wavelength is a number in nm", k + 1,
                                      io::unknown_key_message(printable(name.substr(0, 40)), known)));
            }
            if (nm && !(*nm >= 100 && *nm <= 20000))
                fail_here(fmt::format("column {}: a wavelength of {} nm; expected 100 to 20000", k + 1, *nm));
            if (nm ? channels.size() > wavelengths.size() : !wavelengths.empty())
                fail_here("R, G, B and wavelengths in one table; give either three channels or wavelengths");
            if (!channels.try_emplace(name, nm ? wavelengths.size() : rgb).second)
                fail_here(fmt::format("column {} is there twice", shown(name)));
            if (nm) wavelengths.push_back(*nm);
        }
        if (channels.empty()) fail_here("no channel; after thickness_mm come R,G,B or wavelengths in nm");
        if (wavelengths.empty() && channels.size() != 3)
            fail_here("of R, G and B some are missing; all three are needed");
        for (std::size_t k = 1; k < wavelengths.size(); ++k)
            if (!(wavelengths[k] > wavelengths[k - 1]))
                fail_here(fmt::format("wavelengths must rise, {} comes after {}", wavelengths[k], wavelengths[k - 1]));
        table_.channels.wavelengths_nm = wavelengths;
        std::size_t errors = 0;
        for (std::size_t k = 3; k < names.size(); ++k) {
            std::string_view name = names[k];
            if (name == "base_mm") {
                if (std::ranges::any_of(columns_, [](const Column& c) { return c.kind == Column::Kind::base; }))
                    fail_here("column \"base_mm\" is there twice");
                columns_.push_back({Column::Kind::base});
                continue;
            }
            const bool error = name.ends_with("_se");
            if (error) name.remove_suffix(3), ++errors;
            const auto channel = channels.find(name);
            if (channel == channels.end()) fail_here(fmt::format("column {} belongs to no channel", shown(names[k])));
            columns_.push_back({error ? Column::Kind::error : Column::Kind::value, channel->second});
        }
        if (errors != 0 && errors != channels.size())
            fail_here(fmt::format("{} of {} channels have a standard error; give it for all or for none", errors,
                                  channels.size()));
        has_errors_ = errors != 0;
    }

    void row(std::string_view line) {
        if (table_.patches.size() >= most_patches) fail_here(fmt::format("more than {} patches", most_patches));
        const auto cells = split(line, ',');
        if (cells.size() != columns_.size())
            fail_here(fmt::format("{} cells, but the header has {}; every patch needs them all", cells.size(),
                                  columns_.size()));
        Patch patch;
        patch.where = fmt::format("{}: line {}", table_.source, line_);
        try {
            patch.top = parse_mixture(cells[0]);
            check_role(cells[1], cells[1]);
        } catch (const InputError& error) {
            throw InputError(fmt::format("{}: {}", patch.where, error.what()));
        }
        patch.backing = cells[1];
        patch.rho.resize(table_.channels.size());
        if (has_errors_) patch.error.resize(table_.channels.size());
        const std::string name = patch_name(patch);
        for (std::size_t k = 2; k < cells.size(); ++k) {
            const auto value = number(cells[k]);
            if (!value) fail_here(fmt::format("patch {}, column {}: {} is no number", name, k + 1, shown(cells[k])));
            const Column& column = columns_[k];
            switch (column.kind) {
                case Column::Kind::thickness:
                    patch.thickness_mm = *value;
                    break;
                case Column::Kind::base:
                    patch.base_mm = *value;
                    break;
                case Column::Kind::error:
                    patch.error[column.channel] = *value;
                    break;
                default:
                    patch.rho[column.channel] = *value;
            }
        }
        check(patch, name);
        if (!known(patch, name)) table_.patches.push_back(std::move(patch));
    }

    void check(const Patch& patch, const std::string& name) const {
        if (!(patch.thickness_mm >= 0.001 && patch.thickness_mm <= 1000))
            fail_here(
                fmt::format("patch {}: thickness_mm is {}; expected mm, from 0.001 to 1000", name, patch.thickness_mm));
        if (!(patch.base_mm == 0 || (patch.base_mm >= 0.001 && patch.base_mm <= 10000)))
            fail_here(
                fmt::format("patch {}: base_mm is {}; expected mm, from 0.001 to 10000, or 0 where it is not known",
                            name, patch.base_mm));
        for (std::size_t c = 0; c < patch.rho.size(); ++c) {
            const double rho = patch.rho[c];
            const std::string channel = channel_name(table_.channels, c);
            if (has_errors_ && !(patch.error[c] > 0 && patch.error[c] <= 1))
                fail_here(fmt::format("patch {}: the standard error of {} is {}; expected more than 0 and at most 1",
                                      name, channel, patch.error[c]));
            if (rho < (has_errors_ ? -6 * patch.error[c] : 0))
                fail_here(fmt::format(
                    "patch {}: {} is {}, but a reflectance cannot be negative; look at the dark level that was "
                    "subtracted, or give standard errors (R_se, ...) if this is noise",
                    name, channel, rho));
            if (rho > 1)
                fail_here(fmt::format(
                    "patch {}: {} is {}, above 1, more than a perfect diffuser reflects; divide by the white "
                    "reference's reflectance, and give shares, not percent",
                    name, channel, rho));
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
        const std::string values = channel < patch.rho.size()
                                       ? fmt::format("{} {} there and {} here", channel_name(table_.channels, channel),
                                                     other.rho[channel], patch.rho[channel])
                                       : "other standard errors";
        fail_here(fmt::format(
            "patch {} of {} mm was measured already ({}) with other values: {}; keep one row, the mean of both", name,
            patch.thickness_mm, other.where, values));
    }

    std::string_view text_;
    PatchTable table_;
    std::size_t line_ = 0;
    std::vector<Column> columns_;
    bool has_errors_ = false;
    std::map<std::string, std::size_t> seen_;
};

}  // namespace

PatchMixture parse_mixture(std::string_view text) {
    PatchMixture mixture;
    const auto parts = split(text, '+');
    double sum = 0;
    for (const std::string_view part : parts) {
        const std::size_t colon = part.find(':');
        const std::string_view role = trimmed(part.substr(0, colon));
        check_role(role, text);
        double percent = 100;
        if (colon != std::string_view::npos || parts.size() > 1) {
            const auto value = colon == std::string_view::npos ? std::nullopt : number(trimmed(part.substr(colon + 1)));
            if (!value || !(*value > 0 && *value <= 100))
                throw InputError(fmt::format(
                    "Mixture {}: every part of it needs a percentage above 0, as in \"C:10+W:90\".", shown(text)));
            percent = *value;
        }
        if (std::ranges::any_of(mixture, [&](const ResinShare& share) { return share.role == role; }))
            throw InputError(fmt::format("Mixture {}: {} is there twice.", shown(text), role));
        mixture.push_back({std::string(role), percent / 100});
        sum += percent;
    }
    if (std::abs(sum - 100) > 0.01)
        throw InputError(fmt::format("Mixture {}: the percentages sum to {}, not to 100.", shown(text), sum));
    for (ResinShare& share : mixture) share.fraction *= 100 / sum;
    // One order of resins for one mixture, so that it is recognised.
    std::ranges::sort(mixture, {}, &ResinShare::role);
    return mixture;
}

std::string mixture_text(const PatchMixture& mixture) {
    if (mixture.size() == 1) return mixture.front().role;
    std::string text;
    for (const ResinShare& share : mixture)
        text += fmt::format("{}{}:{:.6g}", text.empty() ? "" : "+", share.role, share.fraction * 100);
    return text;
}

std::string patch_name(const Patch& patch) { return fmt::format("{} on {}", mixture_text(patch.top), patch.backing); }

PatchTable parse_patches(std::string_view text, std::string source) { return Reader(text, std::move(source)).read(); }

PatchTable read_patches(const std::filesystem::path& file) {
    const auto bytes = io::read_whole_file(file, most_bytes);
    return parse_patches({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, file.string());
}

void apply_white_reference(PatchTable& table, double reflectance) {
    if (!(reflectance > 0 && reflectance <= 1))
        throw InputError(fmt::format(
            "The white reference reflects {}; expected a share above 0 and at most 1, such as 0.99.", reflectance));
    for (Patch& patch : table.patches) {
        for (double& rho : patch.rho) rho *= reflectance;
        for (double& error : patch.error) error *= reflectance;
    }
}

std::string patch_table_text(const PatchTable& table, std::string_view comment) {
    std::string text;
    for (std::size_t from = 0; from < comment.size();) {
        const std::size_t to = std::min(comment.find('\n', from), comment.size());
        text += fmt::format("# {}\n", comment.substr(from, to - from));
        from = to + 1;
    }
    const bool base = std::ranges::any_of(table.patches, [](const Patch& p) { return p.base_mm > 0; });
    const bool errors =
        !table.patches.empty() && std::ranges::all_of(table.patches, [](const Patch& p) { return !p.error.empty(); });
    std::vector<std::string> names;
    for (std::size_t c = 0; c < table.channels.size(); ++c)
        names.push_back(table.channels.is_rgb() ? channel_name(table.channels, c)
                                                : fmt::format("{}", table.channels.wavelengths_nm[c]));
    text += "top,backing,thickness_mm";
    for (const auto& name : names) text += fmt::format(",{}", name);
    if (base) text += ",base_mm";
    if (errors)
        for (const auto& name : names) text += fmt::format(",{}_se", name);
    text += '\n';
    for (const Patch& patch : table.patches) {
        text += fmt::format("{},{},{}", mixture_text(patch.top), patch.backing, patch.thickness_mm);
        for (const double rho : patch.rho) text += fmt::format(",{}", rho);
        if (base) text += fmt::format(",{}", patch.base_mm);
        if (errors)
            for (const double error : patch.error) text += fmt::format(",{}", error);
        text += '\n';
    }
    return text;
}

}  // namespace voxtone::calibration
