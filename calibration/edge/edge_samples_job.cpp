// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/edge/edge_samples_job.h"

#include <algorithm>
#include <filesystem>

#include <fmt/format.h>

#include "base/error.h"
#include "calibration/edge/edge_sheet.h"
#include "calibration/target/marker_pattern.h"
#include "io/files/json_writer.h"
#include "io/files/whole_file.h"

namespace voxtone::calibration {
namespace {

using Sheet = EdgeSheetLayout;
constexpr const char* sheet_name = "edge-sheet.svg";

std::string black_square(double x, double y, double edge) {
    return fmt::format("<rect x=\"{:g}\" y=\"{:g}\" width=\"{:g}\" height=\"{:g}\"/>\n", x, y, edge, edge);
}

std::string board() {
    std::string svg;
    for (int row = 0; row < Sheet::rows; ++row)
        for (int column = 0; column < Sheet::columns; ++column)
            if (Sheet::black(column, row))
                svg +=
                    black_square(Sheet::left + column * Sheet::square, Sheet::top + row * Sheet::square, Sheet::square);
    return svg;
}

std::string fiducials() {
    std::string svg;
    constexpr double margin = Sheet::fiducial_margin, right = Sheet::width - margin - Sheet::fiducial,
                     below = Sheet::height - margin - Sheet::fiducial;
    constexpr double corners[4][2] = {{margin, margin}, {right, margin}, {right, below}, {margin, below}};
    for (int id = 0; id < 4; ++id) {
        const std::vector<bool> cells = marker_pattern(id);
        const double cell = Sheet::fiducial / marker_cells;
        for (std::size_t k = 0; k < cells.size(); ++k)
            if (cells[k])
                svg += black_square(corners[id][0] + cell * static_cast<double>(k % marker_cells),
                                    corners[id][1] + cell * static_cast<double>(k / marker_cells), cell);
    }
    return svg;
}

std::string scale() {
    std::string svg = fmt::format(
        "<rect x=\"{:g}\" y=\"{:g}\" width=\"{:g}\" height=\"0.4\"/>\n<text x=\"{:g}\" y=\"{:g}\" font-size=\"4\" "
        "font-family=\"sans-serif\">100 mm when printed at 100 %; squares of {:g} mm</text>\n",
        Sheet::scale_left, Sheet::scale_y - 0.2, Sheet::scale_length, Sheet::scale_left, Sheet::scale_y + 8,
        Sheet::square);
    for (int k = 0; k <= 10; ++k)
        svg += fmt::format("<rect x=\"{:g}\" y=\"{:g}\" width=\"0.4\" height=\"3\"/>\n",
                           Sheet::scale_left + 10 * k - 0.2, Sheet::scale_y);
    return svg;
}

}  // namespace

void EdgeSamplesJob::validate() const {
    if (out.empty()) throw UsageError("--out is missing: the folder of the slabs' stack");
    if (roles.empty()) throw UsageError("--resins is missing: the resins to print slabs of");
    if (thickness_mm.empty()) throw UsageError("--thickness: no value; give at least one");
    for (const double t : thickness_mm)
        if (!(t >= 0.05 && t <= 10)) throw InputError(fmt::format("--thickness: {} mm; expected 0.05 to 10", t));
    if (!(allowance_mm >= 0 && allowance_mm <= 2))
        throw InputError(fmt::format("--allowance: {} mm; expected 0 to 2", allowance_mm));
    if (!(edge_mm >= 10 && edge_mm <= 200))
        throw InputError(
            fmt::format("--size: {} mm; a slab is 10 to 200 mm wide, to see 5 mm on both sides of the edge", edge_mm));
    if (!(gap_mm >= 0.5 && gap_mm <= 100)) throw InputError(fmt::format("--gap: {} mm; expected 0.5 to 100", gap_mm));
}

EdgeSlabs edge_slabs(const EdgeSamplesJob& job) {
    EdgeSlabs slabs;
    const double step = job.edge_mm + job.gap_mm;
    for (std::size_t t = 0; t < job.thickness_mm.size(); ++t)
        for (std::size_t r = 0; r < job.roles.size(); ++r) {
            const Eigen::Vector3d corner(step * static_cast<double>(r), step * static_cast<double>(t), 0);
            std::vector<double> fractions(job.roles.size(), 0.0);
            fractions[r] = 1;
            slabs.boxes.push_back(
                {corner, corner + Eigen::Vector3d(job.edge_mm, job.edge_mm, job.thickness_mm[t] + job.allowance_mm),
                 fractions});
            slabs.size_mm = slabs.size_mm.cwiseMax(slabs.boxes.back().max_mm);
        }
    return slabs;
}

std::string edge_sheet_svg() {
    return fmt::format(
               "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0:g}mm\" height=\"{1:g}mm\" viewBox=\"0 0 {0:g} "
               "{1:g}\" shape-rendering=\"crispEdges\">\n<rect width=\"{0:g}\" height=\"{1:g}\" fill=\"white\"/>\n",
               Sheet::width, Sheet::height) +
           board() + fiducials() + scale() + "</svg>\n";
}

JobResult run_edge_samples_job(const EdgeSamplesJob& job, const PrintBoxes& print, Progress& progress) {
    job.validate();
    const EdgeSlabs slabs = edge_slabs(job);
    const io::StackDescription stack = print(slabs.boxes, slabs.size_mm, progress);
    const std::filesystem::path sheet = std::filesystem::path(job.out) / sheet_name;
    io::write_whole_file(sheet, edge_sheet_svg());
    io::JsonWriter json;
    json.begin_object().add("format", "voxtone-calibrate-edge-samples").add("version", 1);
    json.add("slabs", slabs.boxes.size()).add("size_mm", slabs.size_mm).add("layers", stack.layers);
    json.add("sheet", sheet.string()).end_object();
    return {json.text(),
            fmt::format("{}: {} slabs, {:.0f} x {:.0f} x {:.2f} mm, {} layers; print {} on matt waterproof "
                        "paper at 100 %\n",
                        job.out, slabs.boxes.size(), slabs.size_mm.x(), slabs.size_mm.y(), slabs.size_mm.z(),
                        stack.layers, sheet.string())};
}

}  // namespace voxtone::calibration
