// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/patches/patch_file.h"

#include <fmt/format.h>

#include "base/error.h"
#include "calibration/patches/cgats_file.h"
#include "calibration/patches/chart_csv.h"
#include "calibration/patches/cxf_file.h"
#include "calibration/patches/target_csv.h"
#include "io/files/whole_file.h"

namespace voxtone::calibration {

namespace {

constexpr std::uint64_t most_bytes = std::uint64_t{64} << 20;

}  // namespace

PatchTable parse_patches(std::string_view text, std::string source, std::optional<optics::Illuminant> illuminant) {
    if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
    if (text.starts_with("\xFF\xFE") || text.starts_with("\xFE\xFF"))
        throw InputError(
            fmt::format("{}: is text in UTF-16; save it as UTF-8, or as CSV or tab-separated text.", source));
    if (is_xml(text)) return finished_chart(read_cxf(text, source), illuminant);
    if (is_cgats(text)) return finished_chart(read_cgats(text, source), illuminant);
    if (is_target_csv(text)) return read_target_csv(text, std::move(source), illuminant);
    return finished_chart(read_chart_csv(text, source), illuminant);
}

PatchTable read_patches(const std::filesystem::path& file, std::optional<optics::Illuminant> illuminant) {
    const auto bytes = io::read_whole_file(file, most_bytes);
    return parse_patches({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, file.string(), illuminant);
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
    return table.is_chart ? chart_csv_text(table, comment) : target_csv_text(table, comment);
}

}  // namespace voxtone::calibration
