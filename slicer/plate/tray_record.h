// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a finished tray says of itself: tray.json (data/schema/tray-stack.schema.json), a few lines, an exit code.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "io/layers/manifest.h"
#include "slicer/plate/opened_tray.h"

namespace voxtone::slicer {

/// Of each part, over its copies on one tray.
[[nodiscard]] std::vector<Overlap> overlaps_of(const PreparedTray& prepared, int tray,
                                               const std::vector<Overlap>& of_copies);

/// One sentence for each part that another one has a piece of.
[[nodiscard]] std::vector<std::string> overlap_notes(const PreparedTray& prepared, int tray,
                                                     const std::vector<Overlap>& overlaps);

/// The plan's parts with copies on the tray, for its manifest; joined parts are made of these.
[[nodiscard]] std::vector<io::StackMember> members_of(const PreparedTray& prepared, int tray);

[[nodiscard]] std::string tray_json(const PreparedTray& prepared, int tray, const std::vector<Overlap>& overlaps,
                                    const io::StackDescription& stack);

[[nodiscard]] std::string tray_summary(const PreparedTray& prepared, int tray, const io::StackDescription& stack,
                                       double seconds, const std::filesystem::path& folder);

/// What a tray ends with: the first failed part's, else with --strict that of a print that will not look as asked.
[[nodiscard]] ExitCode exit_code_of(const OpenedTray& tray, const std::vector<FailedPart>& failed,
                                    const std::vector<std::string>& verdicts);
/// What it ended so for, where no warning said it: what will not look as asked, a line each.
[[nodiscard]] std::string failure_of(const PreparedTray& prepared);
/// Verdicts of the parts that have one: "good", "fair", "bad".
[[nodiscard]] std::vector<std::string> verdicts_of(const PreparedTray& prepared);

/// Of a tray that is there: whether no part failed, and the verdicts. Nothing where there is none that can be read.
struct TrayEnding {
    std::vector<FailedPart> failed;
    std::vector<std::string> verdicts;
};
[[nodiscard]] std::optional<TrayEnding> ending_in(const std::filesystem::path& folder);

}  // namespace voxtone::slicer
