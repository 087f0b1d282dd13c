// SPDX-License-Identifier: GPL-3.0-or-later
//
// Measured patches as files. What a file is, its content says, not its name:
//
//   a target: CSV whose header begins top,backing,thickness_mm (target_csv.h)
//   laminates: CSV whose header begins layers, or JSON (laminate_file.h)
//   a chart of mixtures: CSV with a column for each resin (chart_csv.h), CGATS text (cgats_file.h), CxF3 (cxf_file.h)
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "calibration/patches/patch_mixture.h"
#include "calibration/patches/patch_table.h"

namespace voxtone::calibration {

struct PatchReading {
    std::optional<optics::Illuminant> illuminant = {};  ///< of Lab and XYZ; none: what the file says, else D50, said
    std::vector<std::string> resins = {};               ///< roles that the user names, in order (column_meaning.h)
    std::vector<std::string> known = {};                ///< those of a printer, or of another set
    bool printable_only = false;                        ///< chart_reading.h
};

/// UTF-8 or UTF-16 (io/files/utf8.h). Throws InputError: what the readers, finished_chart (chart_reading.h) and
/// make_rho (measured_values.h) refuse.
[[nodiscard]] PatchTable parse_patches(std::string_view text, std::string source, const PatchReading& reading = {});
/// At most 64 MB. Throws FileError, InputError.
[[nodiscard]] PatchTable read_patches(const std::filesystem::path& file, const PatchReading& reading = {});
/// Values that were divided by those of a white reference become relative to a perfect diffuser: times the reference's
/// own reflectance (0.99 for Spectralon of 99 %), errors too. Throws InputError unless it lies in (0, 1].
void apply_white_reference(PatchTable& table, double reflectance);
/// A target or a chart as CSV that reads back as the same. `comment`: written before the header, a # before each of its
/// lines.
[[nodiscard]] std::string patch_table_text(const PatchTable& table, std::string_view comment = {});

}  // namespace voxtone::calibration
