// SPDX-License-Identifier: GPL-3.0-or-later
//
// The report of a tray: one page that turns all parts in their places, with a cut through all, and a list of them with
// verdict, resin and worst place, each a click away and with a page of its own.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "io/layers/manifest.h"
#include "io/report/report.h"
#include "slicer/plate/job_phases.h"
#include "slicer/plate/tray_parts.h"

namespace voxtone::slicer {

class TrayReport {
public:
    /// `copies`: of all parts, among which the page's room is shared out. `first_folder`: name of that of the first
    /// tray. `is_one_body`: its report is the tray's (opened_tray.h).
    TrayReport(std::size_t copies, std::string first_folder, bool is_one_body)
        : copies_(copies), first_folder_(std::move(first_folder)), is_one_body_(is_one_body) {}

    /// Once a part's own report is written, while it still knows what was predicted.
    void add(const ReadyPart& part, io::Report own, Progress& progress);
    /// A component, which is not predicted: its shape, where it has one.
    void add_component(const ReadyPart& part, std::optional<io::ViewerSurface> surface);
    /// Bytes of the page for one copy's surface.
    [[nodiscard]] std::size_t surface_share() const;
    /// What is on one tray, as files of the folder.
    struct Tray {
        std::filesystem::path out;
        int number = 0;
        const OpenedJob& job;  ///< of any part
        const io::StackDescription& stack;
        const VoxelGrid& grid;
        std::vector<std::string> warnings;
        std::vector<FailedPart> failed;  ///< of the whole job
    };
    /// Writes the figures, and the page where `watchers` have seen the tray's layers, or it is one body's; nothing is
    /// left there. `seconds`: of the whole job.
    void write(const Tray& tray, LayerWatchers& watchers, double seconds, Progress& progress);

private:
    struct Entry {
        io::ReportPart row;
        std::optional<io::ViewerSurface> surface;
        io::ViewerPlace worst;  ///< in the part's own mm
        std::vector<PlacedCopy> copies;
        Eigen::Vector3d pitch_mm;
        std::optional<double> support_ml;  ///< of one copy
        bool is_component = false;
        std::vector<std::string> warnings = {};  ///< with its name
    };
    /// Of an entry, on one tray, in its mm.
    [[nodiscard]] static std::vector<Eigen::Vector3d> places(const Entry& entry, int tray);
    [[nodiscard]] std::vector<const Entry*> on(int tray) const;
    /// Below what hangs over; nothing where one stands above others, or what it is made of is not known.
    [[nodiscard]] static std::optional<double> support_of(const std::vector<const Entry*>& entries, int tray);
    static void add_surface(const std::vector<const Entry*>& entries, int tray, io::Report& report, Progress& progress);
    [[nodiscard]] io::Report of_bodies(const Tray& tray, LayerWatchers& watchers, Progress& progress) const;

    std::size_t copies_;
    std::string first_folder_;
    bool is_one_body_;
    std::optional<io::Report> of_one_body_;
    std::vector<Entry> entries_;
};

}  // namespace voxtone::slicer
