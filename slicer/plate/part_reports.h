// SPDX-License-Identifier: GPL-3.0-or-later
//
// The reports of a tray's parts: each is told of its first copy, whose layers it sees while the tray's are made, so
// that none is made twice. What a prediction needs of them is held until then: parts for which that is too much
// together are looked at one by one afterwards, and their layers made once more.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "base/progress.h"
#include "slicer/plate/job_phases.h"
#include "slicer/plate/opened_tray.h"
#include "slicer/plate/tray_report.h"

namespace voxtone::slicer {

/// An empty report, which shares its room out among all copies.
[[nodiscard]] TrayReport report_for(const PreparedTray& prepared, const std::filesystem::path& out);

class PartReports {
public:
    /// Of the parts whose first copy is on the tray; `wanted`: else of none. Keeps a reference.
    PartReports(PreparedTray& prepared, int tray, bool wanted);
    ~PartReports();

    /// For the layers of the tray, all of which they have to see.
    [[nodiscard]] PartSinks sinks();
    /// Predicts each part and writes its report once they are made, which took what `made` says; that of a tray which
    /// is one body is left to `tray`.
    void write(const ComposedLayers& layers, const JobMeasurements& made, TrayReport& tray, Progress& progress);

private:
    class View;
    [[nodiscard]] bool is_first_seen(const ReadyPart& part) const;
    void write_later(View& view, TrayReport& tray, Progress& progress) const;

    PreparedTray& prepared_;
    int tray_;
    std::vector<std::unique_ptr<View>> now_, later_;
    std::vector<const ReadyPart*> components_;  ///< have no reports of their own
};

}  // namespace voxtone::slicer
