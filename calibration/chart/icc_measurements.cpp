// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/chart/icc_measurements.h"

#include <algorithm>
#include <map>

#include <fmt/format.h>

#include "base/error.h"
#include "calibration/patches/cgats_file.h"
#include "calibration/patches/chart_reading.h"
#include "calibration/patches/cxf_file.h"
#include "calibration/tables/cgats_text.h"
#include "calibration/tables/table_cells.h"

namespace voxtone::calibration {

namespace {

void rename_roles(PatchTable& table, const std::map<std::string, std::string>& names) {
    for (Patch& patch : table.patches) {
        for (ResinShare& share : patch.top) {
            const auto found = names.find(share.role);
            if (found == names.end())
                throw InputError(
                    fmt::format("{}: has a resin {}, which is no channel of the profile", patch.where, share.role));
            share.role = found->second;
        }
        std::ranges::sort(patch.top, {}, &ResinShare::role);
    }
}

// Names that the readers give to inks, and those that the user has for them.
std::map<std::string, std::string> names_of(std::span<const std::string> roles, const std::string& rest) {
    std::map<std::string, std::string> names{{"W", rest}};
    const bool process = roles.size() == 3 || roles.size() == 4;
    for (std::size_t c = 0; c < roles.size(); ++c) names[process ? std::string(1, "CMYK"[c]) : roles[c]] = roles[c];
    return names;
}

}  // namespace

std::optional<IccMeasurements> icc_measurements(const io::DeviceProfile& profile, std::span<const std::string> roles,
                                                const std::string& rest, std::vector<std::string>& notes) {
    for (const io::MeasurementText& text : profile.measurements) {
        const std::string tag(trimmed(text.tag));
        const std::string source = fmt::format("{} ({})", profile.name, tag);
        const bool cxf = is_xml(text.text);
        if (!cxf && !CgatsText::is(text.text)) {
            notes.push_back(
                fmt::format("{}: names measurements ({}) and does not hold them.", source, shown(text.text)));
            continue;
        }
        try {
            const std::vector<std::string> known(roles.begin(), roles.end());
            ChartReading reading =
                cxf ? read_cxf(text.text, source) : read_cgats(text.text, source, {.resins = {}, .known = known});
            IccMeasurements found{finished_chart(std::move(reading), {.illuminant = {}, .printable_only = true}), tag};
            rename_roles(found.table, names_of(roles, rest));
            return found;
        } catch (const InputError& error) {
            notes.push_back(
                fmt::format("{}: the measurements that it carries cannot be used, its table is taken instead: {}",
                            source, error.what()));
        }
    }
    return std::nullopt;
}

}  // namespace voxtone::calibration
