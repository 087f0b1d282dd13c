// SPDX-License-Identifier: GPL-3.0-or-later
//
// Trays in this process, as far as their parts, places and voxels: nothing is encoded, drawn or reported.
#pragma once

#include <array>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <fmt/core.h>

#include "base/error.h"
#include "slicer/plate/opened_tray.h"
#include "slicer/plate/tray_record.h"
#include "tests/io/files/temporary_folder.h"
#include "tests/said_progress.h"
#include "tests/slicer/layers/source_voxels.h"

namespace voxtone::test {

/// OBJ of the box between two corners, rose on the left and sage on the right: colours that the usual resins reach.
inline std::string soft_box(std::array<double, 3> low, std::array<double, 3> high, int first_vertex = 1) {
    std::string text;
    for (int c = 0; c < 8; ++c)
        text += fmt::format("v {:.9f} {:.9f} {:.9f} {}\n", c & 1 ? high[0] : low[0], c & 2 ? high[1] : low[1],
                            c & 4 ? high[2] : low[2], c & 1 ? "0.45 0.6 0.45" : "0.7 0.45 0.45");
    for (const auto& f : {std::array{0, 2, 3, 1}, std::array{4, 5, 7, 6}, std::array{0, 1, 5, 4},
                          std::array{2, 6, 7, 3}, std::array{0, 4, 6, 2}, std::array{1, 3, 7, 5}})
        text += fmt::format("f {} {} {} {}\n", f[0] + first_vertex, f[1] + first_vertex, f[2] + first_vertex,
                            f[3] + first_vertex);
    return text;
}

/// A tray whose parts have places.
struct PlacedTray {
    slicer::PreparedTray prepared;
    std::string notes, warnings;
};

/// A tray whose layers were made.
struct ComposedTray {
    SourceVoxels print;
    std::vector<slicer::Overlap> overlaps;   ///< of each part
    std::vector<std::string> overlap_notes;  ///< of those of which another has a piece
};

/// A folder with models, and trays of them.
struct TrayDesk {
    void write(const std::string& name, const std::string& text) const {
        std::ofstream(folder.path() / name, std::ios::binary) << text;
    }
    [[nodiscard]] std::string operator/(const std::string& name) const { return (folder.path() / name).string(); }

    /// What a job begins with here: no loop, no report.
    [[nodiscard]] slicer::SliceOptions options(const std::string& model) const {
        slicer::SliceOptions options;
        options.model = *this / model;
        options.out = *this / "out";
        options.iterations = "0";
        options.predict = "none";
        options.report = false;
        options.overwrite = true;
        return options;
    }
    /// Of these parts of a plan.
    [[nodiscard]] slicer::OpenedTray open(const std::string& parts, const slicer::SliceOptions& said) const {
        write("tray.json", R"({"format": "voxtone-tray", "version": 1, "parts": [)" + parts + "]}");
        return slicer::open_tray(said);
    }
    [[nodiscard]] slicer::OpenedTray open(const std::string& parts) const { return open(parts, options("tray.json")); }
    [[nodiscard]] static PlacedTray place(const slicer::OpenedTray& tray) {
        SaidProgress progress;
        slicer::PreparedTray prepared = slicer::prepare_tray(tray, progress);
        return {std::move(prepared), progress.notes(), progress.warnings()};
    }
    /// Makes its layers.
    [[nodiscard]] static ComposedTray compose(const slicer::OpenedTray& tray, slicer::PreparedTray& prepared) {
        Progress progress;
        slicer::rearrange_parts(tray, prepared, progress);
        const slicer::ComposedLayers layers = slicer::compose(prepared, 0);
        ComposedTray made{source_voxels(layers), {}, {}};
        made.overlaps = slicer::overlaps_of(prepared, 0, layers.overlapped());
        made.overlap_notes = slicer::overlap_notes(prepared, 0, made.overlaps);
        return made;
    }
    /// The voxels of a print of one body.
    [[nodiscard]] static SourceVoxels print_of(const slicer::SliceOptions& options) {
        Progress progress;
        const auto ready = slicer::make_ready(slicer::open_job(options), std::nullopt, progress);
        ready->print->prepare(progress);
        ready->print->rearrange(progress);
        return source_voxels(*ready->print->layers());
    }
    /// What is wrong with a tray, until its parts have places.
    [[nodiscard]] std::string fault(const std::string& parts, const slicer::SliceOptions& said) const {
        try {
            (void)place(open(parts, said));
            return "none";
        } catch (const Error& error) {
            return error.what();
        }
    }
    io::TemporaryFolder folder;
};

}  // namespace voxtone::test
