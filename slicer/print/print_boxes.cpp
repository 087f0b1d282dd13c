// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/print/print_boxes.h"

#include <algorithm>
#include <cmath>
#include <map>

#include <fmt/format.h>

#include "base/parallel.h"
#include "base/random.h"
#include "base/stopwatch.h"
#include "base/warning.h"
#include "slicer/printer/how_to_print.h"
#include "slicer/printer/tray_room.h"

namespace voxtone::slicer {

namespace {

constexpr double rounding = 1e-6;  // of a voxel: sizes that are whole voxels stay so

/// The first voxel whose centre is at or beyond this plane, within [0, size].
std::uint32_t first_voxel(double mm, double pitch_um, std::uint32_t size) {
    const double voxel = std::ceil(mm * 1000 / pitch_um - 0.5 - rounding);
    return static_cast<std::uint32_t>(std::clamp(voxel, 0.0, double(size)));
}

io::StackDescription describe(const BoxPrint& print, const PrinterProfile& printer,
                              const std::array<std::uint32_t, 3>& size) {
    io::StackDescription stack = printer.describe(size);
    const std::vector<io::Rgb> colours = printer.display_colours(print.roles);
    for (std::size_t r = 0; r < print.roles.size(); ++r) {
        const auto known = printer.material_names.find(print.roles[r]);
        stack.resins.push_back(
            {known != printer.material_names.end() ? known->second : print.roles[r], print.roles[r], colours[r], 0, 0});
    }
    return stack;
}

void check(const BoxPrint& print, const PrinterProfile& printer, const std::array<std::uint32_t, 3>& size) {
    if (static_cast<int>(print.roles.size()) > printer.max_resins)
        throw InputError(
            fmt::format("{} resins ({}), but {} carries {} at once; leave some out and print a second target for them",
                        print.roles.size(), fmt::join(print.roles, ", "), printer.id, printer.max_resins));
    const Eigen::Vector3d tray_mm = printer.sliced_tray_mm();
    for (int axis = 0; axis < 3; ++axis)
        if (!fits_in(print.size_mm[axis], tray_mm[axis]))
            throw InputError(
                fmt::format("the print is {:.1f} x {:.1f} x {:.1f} mm, larger than the tray of {} ({:.0f} x {:.0f} x "
                            "{:.0f} mm) along {} by {}; make it smaller",
                            print.size_mm.x(), print.size_mm.y(), print.size_mm.z(), printer.id, tray_mm.x(),
                            tray_mm.y(), tray_mm.z(), "xyz"[axis], excess_text(print.size_mm[axis] - tray_mm[axis])));
    if (static_cast<int>(size[2]) < printer.min_layers)
        throw InputError(fmt::format("the print has {} layers, but {} takes no fewer than {}; make it thicker", size[2],
                                     printer.id, printer.min_layers));
}

}  // namespace

BoxLayers::BoxLayers(std::vector<PrintBox> boxes, const Eigen::Vector3d& size_mm, const Eigen::Vector3d& pitch_um,
                     std::uint64_t seed)
    : seed_(seed) {
    for (int axis = 0; axis < 3; ++axis) {
        const double voxels = std::round(size_mm[axis] * 1000 / pitch_um[axis]);
        if (!(voxels >= 1 && voxels <= 65535))
            throw InputError(
                fmt::format("a print of {:.3g} mm along {} has {:.0f} voxels; from 1 to 65535 are possible",
                            size_mm[axis], "xyz"[axis], voxels));
        size_[std::size_t(axis)] = static_cast<std::uint32_t>(voxels);
        grid_.size[std::size_t(axis)] = static_cast<int>(voxels);
    }
    grid_.pitch_mm = pitch_um * 1e-3;
    for (const PrintBox& box : boxes) {
        double sum = 0;
        Span span;
        for (std::size_t m = 0; m < box.fractions.size(); ++m) {
            if (!(box.fractions[m] >= 0)) throw InputError("a box has a negative share of a resin");
            sum += box.fractions[m];
            span.sums.push_back(sum);
            if (box.fractions[m] >= 1) span.only = static_cast<io::Material>(m + 1);
        }
        if (!(std::abs(sum - 1) < 1e-9) || box.fractions.size() >= io::max_materials)
            throw InputError(fmt::format("the shares of a box sum to {}, not to 1", sum));
        if (box.cell != std::array<int, 2>{}) {
            std::vector<io::Material> resins;
            for (std::size_t m = 0; m < box.fractions.size(); ++m)
                if (box.fractions[m] > 0) resins.push_back(static_cast<io::Material>(m + 1));
            if (box.cell[0] < 1 || box.cell[1] < 1 || resins.size() != 2)
                throw InputError("a checker has two resins, in cells of one column and row or more");
            span.cell = {static_cast<std::uint32_t>(box.cell[0]), static_cast<std::uint32_t>(box.cell[1])};
            span.in_cells = {resins[0], resins[1]};
        }
        if (!((box.max_mm.array() > box.min_mm.array()).all())) throw InputError("a box has no volume");
        for (std::size_t axis = 0; axis < 3; ++axis) {
            span.first[axis] = first_voxel(box.min_mm[Eigen::Index(axis)], pitch_um[Eigen::Index(axis)], size_[axis]);
            span.last[axis] = first_voxel(box.max_mm[Eigen::Index(axis)], pitch_um[Eigen::Index(axis)], size_[axis]);
        }
        boxes_.push_back(std::move(span));
    }
}

io::Material BoxLayers::draw(const Span& box, std::uint32_t i, std::uint32_t j, std::uint32_t k) const {
    if (box.cell[0] > 0) return box.in_cells[((i - box.first[0]) / box.cell[0] + (j - box.first[1]) / box.cell[1]) % 2];
    const double random =
        RandomStream(seed_, std::uint64_t{i} | std::uint64_t{j} << 16 | std::uint64_t{k} << 32).uniform();
    std::size_t m = 0;
    while (m + 1 < box.sums.size() && random >= box.sums[m]) ++m;
    return static_cast<io::Material>(m + 1);
}

io::LayerRuns BoxLayers::layer(std::uint32_t k) const {
    io::LayerRuns runs(size_[0], size_[1]);
    std::vector<const Span*> here;
    for (const Span& box : boxes_)
        if (k >= box.first[2] && k < box.last[2]) here.push_back(&box);
    std::vector<const Span*> owner(size_[0]);
    for (std::uint32_t row = 0; row < size_[1]; ++row) {
        const std::uint32_t j = size_[1] - 1 - row;
        std::fill(owner.begin(), owner.end(), nullptr);
        for (const Span* box : here)
            if (j >= box->first[1] && j < box->last[1])
                std::fill(owner.begin() + box->first[0], owner.begin() + std::max(box->first[0], box->last[0]), box);
        for (std::uint32_t i = 0; i < size_[0]; ++i) {
            const Span* box = owner[i];
            runs.push(1, !box ? io::background : box->only != io::background ? box->only : draw(*box, i, j, k));
        }
        runs.end_row();
    }
    return runs;
}

LayerCounts BoxLayers::make(int slab, int k_begin, int k_end, const LayerSink& sink) const {
    LayerCounts counts;
    if (slab < std::max(k_begin, 0) || slab >= std::min(k_end, grid_.size[2])) return counts;
    const Stopwatch watch;
    const io::LayerRuns runs = layer(static_cast<std::uint32_t>(slab));
    counts.runs_s = watch.total();
    sink(slab, runs);
    return counts;
}

namespace {

/// Few layers are on top somewhere in a print of boxes, and each of these is made once more.
io::PageOfStack page_of(const BoxPrint& print, const PrinterProfile& printer, const BoxLayers& layers,
                        const io::StackOutputs& outputs) {
    return [&, outputs](const io::StackDescription& stack, const io::TopmostLayers& topmost) {
        std::map<std::uint16_t, std::vector<io::Material>> made;
        const std::vector<io::Rgb> palette = stack.palette();
        const auto colour = [&](std::uint32_t i, std::uint32_t j, std::uint16_t top) {
            std::vector<io::Material>& pixels = made[top];
            if (pixels.empty()) {
                const io::LayerRuns runs = layers.layer(top);
                for (std::uint32_t y = 0; y < runs.rows(); ++y)
                    for (const io::Run run : runs.row(y))
                        pixels.insert(pixels.end(), run.length, static_cast<io::Material>(run.material));
            }
            return palette[pixels[std::size_t{layers.size()[1] - 1 - j} * layers.size()[0] + i]];
        };
        const PictureFromAbove from_above = picture_from_above(stack, topmost, colour, "in the colours of the bitmaps");
        return how_to_print_page(stack, printer, {print.title, outputs, {}, from_above, print.remarks});
    };
}

}  // namespace

io::StackDescription print_boxes(const BoxPrint& print, const PrinterProfile& printer, const std::filesystem::path& out,
                                 const io::StackOutputs& outputs, bool overwrite, Progress& progress) {
    const BoxLayers layers(print.boxes, print.size_mm, printer.sliced_pitch_um(), print.seed);
    check(print, printer, layers.size());
    io::StackOutputs with_folder = outputs;
    with_folder.printer_folder = true;
    io::LayerStackWriter writer(out, describe(print, printer, layers.size()), with_folder, overwrite);
    if (const std::string note = writer.strangers_note(); !note.empty())
        progress.warn(named_warning("strange-files", note));
    progress.begin_stage("layers", layers.size()[2], "layers");
    parallel_for(
        0, layers.size()[2], 1,
        [&](std::size_t k) {
            progress.check_cancelled();
            layers.make(int(k), 0, int(layers.size()[2]), [&](int made, const io::LayerRuns& runs) {
                writer.write(static_cast<std::uint32_t>(made), runs);
            });
            progress.advance();
        },
        &progress);
    progress.end_stage();
    progress.begin_stage("finish", 0);
    io::StackDescription stack = writer.finish({}, &progress, page_of(print, printer, layers, outputs));
    progress.end_stage();
    return stack;
}

}  // namespace voxtone::slicer
