// SPDX-License-Identifier: GPL-3.0-or-later
#include "body_of_line.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>

#include <fmt/core.h>

#include "base/error.h"
#include "io/files/whole_file.h"
#include "io/models/glb_writer.h"
#include "optics/colour/colour.h"
#include "slicer/look/vertex_colours.h"
#include "slicer/options/option_table.h"
#include "slicer/part/opened_job.h"
#include "slicer/solid/solid.h"
#include "slicer/solid/thin_features.h"
#include "slicer/surface/surface_colour.h"
#include "tests/said_progress.h"

namespace voxtone::test {

namespace {

using namespace slicer;

/// Of a command line: "--size 15mm". Throws std::runtime_error.
void set_options(const std::string& words, SliceOptions& options) {
    std::istringstream in(words);
    for (std::string name, value; in >> name;) {
        const auto specs = slice_option_table();
        const auto spec = std::ranges::find_if(specs, [&](const OptionSpec& one) { return "--" + one.key == name; });
        if (spec == specs.end() || !(in >> value)) throw std::runtime_error("expected.json: options: " + words);
        spec->set(options, value);
        options.named.push_back(spec->key);
    }
}

/// Voxels of a body, and the box around them.
void count_voxels(const JobBody& body, BodyOfLine& made) {
    const VoxelGrid& grid = body.grid;
    const Solid solid(*body.solid, grid, body.relief);
    SpanSlab spans;
    (void)ThinFeatures(body.solid, solid).slab(0, grid.size[2], spans);
    std::array<int, 3> low = grid.size, high{};
    std::uint64_t voxels = 0;
    for (int k = 0; k < grid.size[2]; ++k)
        for (int j = 0; j < grid.size[1]; ++j)
            for (const Span& span : spans.row(j, k)) {
                voxels += std::uint64_t(span.end - span.begin);
                low = {std::min(low[0], span.begin), std::min(low[1], j), std::min(low[2], k)};
                high = {std::max(high[0], span.end), std::max(high[1], j + 1), std::max(high[2], k + 1)};
            }
    for (std::size_t axis = 0; axis < 3; ++axis)
        made.size_mm[axis] = (high[axis] - low[axis]) * grid.pitch_mm[Eigen::Index(axis)];
    made.volume_mm3 = double(voxels) * grid.voxel_volume_mm3();
}

/// Its surface in the colours that were asked for, filtered as they are for its voxels.
io::ColouredMesh target_mesh(const JobBody& body) {
    const SurfaceColour colour(body.model.mesh, std::sqrt(body.grid.pitch_mm.x() * body.grid.pitch_mm.y()));
    const VisibleSurface& surface = *body.surface;
    ColouredSurface target;
    target.positions_mm = surface.positions_mm;
    target.triangles = surface.triangles;
    target.colour = [&](std::uint32_t t, float u, float v) {
        const auto& corner = surface.source_uv[t];
        const Eigen::Vector2f at = (1 - u - v) * corner[0] + u * corner[1] + v * corner[2];
        return colour.at(surface.source_triangle[t], at.x(), at.y());
    };
    return vertex_colours(target, {}).mesh;
}

/// At the vertex that is nearest to a place of the picture.
Codes seen_from_above(const io::ColouredMesh& mesh, const Spot& spot) {
    Eigen::Array3f low = mesh.positions_mm[0].array(), high = low;
    for (const Eigen::Vector3f& p : mesh.positions_mm) low = low.min(p.array()), high = high.max(p.array());
    const Eigen::Vector2f place(low.x() + float(spot.at[0]) * (high.x() - low.x()),
                                high.y() - float(spot.at[1]) * (high.y() - low.y()));
    std::size_t nearest = 0;
    for (std::size_t v = 0; v < mesh.positions_mm.size(); ++v)
        if ((mesh.positions_mm[v].head<2>() - place).norm() < (mesh.positions_mm[nearest].head<2>() - place).norm())
            nearest = v;
    Codes codes{};
    for (std::size_t c = 0; c < 3; ++c)
        codes[c] = int(std::lround(255 * optics::srgb_encode(double(mesh.rgb[nearest][Eigen::Index(c)]))));
    return codes;
}

}  // namespace

BodyOfLine body_of_line(const BugLine& line, const std::filesystem::path& target, bool strict) {
    BodyOfLine made;
    SaidProgress progress;
    try {
        SliceOptions options;
        options.model = (bug_folder() / line.file).string();
        options.out = target.string();
        options.printer = (bug_folder() / "printer.json").string();
        options.strict = strict;
        set_options(line.options, options);
        const OpenedJob job = open_job(options);
        const JobBody body = prepare_body(job.options, job.printer, progress);
        for (const std::string& warning : body.warnings) progress.warn(warning);
        progress.note(body.placement.summary);
        for (const std::string& note : body.notes) progress.note(note);
        count_voxels(body, made);
        if (!line.sides.empty() || !line.spots.empty()) {
            const io::ColouredMesh mesh = target_mesh(body);
            io::write_whole_file(target, io::glb_bytes(mesh, "target"));
            for (const Spot& spot : line.spots) made.spots.push_back(seen_from_above(mesh, spot));
        }
    } catch (const Error& error) {
        made.exit_code = static_cast<int>(error.exit_code());
        progress.note(fmt::format("voxtone: {}", error.what()));
    }
    made.said = progress.said();
    return made;
}

}  // namespace voxtone::test
