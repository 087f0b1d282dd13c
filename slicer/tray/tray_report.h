// SPDX-License-Identifier: GPL-3.0-or-later
//
// The report of a tray: one page that turns all parts in their places, with a cut through all, and a list of them with
// verdict, resin and worst place, each a click away and with a page of its own.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "io/layers/manifest.h"
#include "io/report/report.h"
#include "slicer/job/job_phases.h"
#include "slicer/tray/tray_parts.h"

namespace voxtone::slicer {

class TrayReport {
public:
    /// `copies`: of all parts, among which the page's room is shared out.
    explicit TrayReport(std::size_t copies) : copies_(copies) {}

    /// Once a part's own report is written, while it still knows what was predicted.
    void add(const ReadyPart& part, const io::Report& own, Progress& progress);
    /// Writes the page. `watchers`: of the tray's layers; nothing is left there. `seconds`: of the whole job. The
    /// grid is the print's.
    void write(const std::filesystem::path& out, const OpenedJob& job, const io::StackDescription& stack,
               const VoxelGrid& grid, LayerWatchers& watchers, double seconds, Progress& progress);

private:
    struct Entry {
        io::ReportPart row;
        std::optional<io::ViewerSurface> surface;
        io::ViewerPlace worst;  ///< in the part's own mm
        std::vector<Eigen::Vector3d> at_mm;
    };
    void add_surface(io::Report& report, Progress& progress) const;
    [[nodiscard]] io::ReportVerdict verdict() const;

    std::size_t copies_;
    std::vector<Entry> entries_;
};

}  // namespace voxtone::slicer
