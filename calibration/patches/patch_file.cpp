// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/patches/patch_file.h"

#include <utility>

#include <fmt/format.h>

#include "base/error.h"
#include "calibration/patches/cgats_file.h"
#include "calibration/patches/chart_csv.h"
#include "calibration/patches/cxf_file.h"
#include "calibration/patches/laminate_file.h"
#include "calibration/patches/patch_surfaces.h"
#include "calibration/patches/target_csv.h"
#include "calibration/tables/cgats_text.h"
#include "calibration/tables/table_cells.h"
#include "io/files/utf8.h"

namespace voxtone::calibration {

namespace {

constexpr std::uint64_t most_bytes = std::uint64_t{64} << 20;

// Sections of spectra, each under a name.
bool is_qtx(std::string_view text) {
    const std::string head = in_capitals(text.substr(0, 200));
    return head.find("[STANDARD_DATA ") != std::string::npos || head.find("[BATCH_DATA ") != std::string::npos;
}

}  // namespace

PatchTable parse_patches(std::string_view bytes, std::string source, const PatchReading& reading) {
    const std::string text = io::text_as_utf8(bytes);
    const ChartRules rules{reading.illuminant, reading.printable_only};
    const ColumnWords words{reading.resins, reading.known, {}};
    if (is_qtx(text))
        throw InputError(
            fmt::format("{}: is a QTX file, as Color iQC and Datacolor write it: spectra under names, and no shares of "
                        "resins; export them as CSV, and give each resin a column beside them: W,C,M,Y,K,400,410,...",
                        source));
    if (is_xml(text)) return finished_chart(read_cxf(text, source), rules);
    if (CgatsText::is(text)) return finished_chart(read_cgats(text, source, words), rules);
    if (is_laminate_file(text)) return read_laminates(text, std::move(source), reading.illuminant);
    if (is_target_csv(text)) return read_target_csv(text, std::move(source), reading.illuminant);
    return finished_chart(read_chart_csv(text, source, words), rules);
}

PatchTable read_patches(const std::filesystem::path& file, const PatchReading& reading) {
    return parse_patches(read_text(file, most_bytes), file.string(), reading);
}

void apply_white_reference(PatchTable& table, double reflectance) {
    if (!(reflectance > 0 && reflectance <= 1))
        throw InputError(fmt::format(
            "The white reference reflects {}; expected a share above 0 and at most 1, such as 0.99.", reflectance));
    for (Patch& patch : table.patches) {
        if (patch.lit) continue;
        for (double& rho : patch.rho) rho *= reflectance;
        for (double& error : patch.error) error *= reflectance;
    }
    change_surfaces(table, [&](PatchSurface& surface) {
        for (double& rho : surface.rho) rho *= reflectance;
    });
}

std::string patch_table_text(const PatchTable& table, std::string_view comment) {
    return table.is_chart ? chart_csv_text(table, comment) : target_csv_text(table, comment);
}

}  // namespace voxtone::calibration
