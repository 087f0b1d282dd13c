// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/tray/tray_parts.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include <fmt/core.h>

#include "base/error.h"
#include "io/layers/stack_folder.h"
#include "slicer/kept/loop_checkpoint.h"
#include "slicer/solid/solid.h"

namespace voxtone::slicer {

namespace {

namespace fs = std::filesystem;

/// The part as a job of its own, whose folder is below the tray's. What lies there is the tray's: it is taken where it
/// is this job's, and replaced otherwise.
SliceOptions job_options(const TrayPart& part, const fs::path& out, const std::vector<std::string>& roles) {
    SliceOptions options = part.options;
    options.out = (out / io::parts_name / part.name).string();
    options.overwrite = true;
    if (options.load.empty()) options.load = roles;
    return options;
}

OpenedJob open_part(const SliceOptions& options, const Progress& progress) {
    OpenedJob job = open_job(options);
    if (fs::exists(job.options.out / io::checkpoint_name)) try {
            LoopCheckpoint::expect_same_job(job.options.out, opened_loop_identity(job, &progress));
            job.options.resume = true;
        } catch (const InputError&) {
            LoopCheckpoint::remove_from(job.options.out);  // of what the part was before
        }
    return job;
}

std::vector<std::string> roles_of(const OpenedJob& job) {
    std::vector<std::string> roles;
    for (const io::StackResin& resin : job.resins.entries) roles.push_back(resin.role);
    return roles;
}

Eigen::Vector3d size_mm(const VoxelGrid& grid) {
    return grid.pitch_mm.cwiseProduct(Eigen::Vector3d(grid.size[0], grid.size[1], grid.size[2]));
}

/// Where the plan puts the copies of a part.
void place_as_planned(ReadyPart& part, const Eigen::Vector3d& tray_mm) {
    const VoxelGrid& grid = part.ready->body.grid;
    for (const std::array<double, 3>& mm : part.part.at_mm) {
        std::array<int, 3>& at = part.at.emplace_back();
        for (int axis = 0; axis < 3; ++axis) {
            at[std::size_t(axis)] = static_cast<int>(std::lround(mm[std::size_t(axis)] / grid.pitch_mm[axis]));
            const double end = (at[std::size_t(axis)] + grid.size[std::size_t(axis)]) * grid.pitch_mm[axis];
            if (end > tray_mm[axis] * (1 + 1e-9))
                throw InputError(fmt::format(
                    "{}: reaches to {:.1f} mm along {} where the plan puts it, and the tray ends at {:.1f}: move it "
                    "(\"at\"), or make it smaller",
                    part.part.place, end, "xyz"[axis], tray_mm[axis]));
        }
    }
}

/// Edge of the cells in which outlines are laid out: fine enough for a gap of a millimetre.
constexpr double cell_mm = 0.5;

int cells_of(double mm) { return static_cast<int>(std::ceil(mm / cell_mm - 1e-9)); }

struct Waiting {
    std::size_t part;
    Outline outline;
};

/// On a plate without end a square of twice the area of all boxes, or the longest side, holds them.
std::array<int, 2> plate_cells(const Eigen::Vector3d& tray_mm, const std::vector<Waiting>& waiting) {
    double area = 0;
    int longest = 1;
    for (const Waiting& one : waiting) {
        area += double(one.outline.width()) * one.outline.height();
        longest = std::max({longest, one.outline.width(), one.outline.height()});
    }
    const int enough = 2 * (static_cast<int>(std::ceil(std::sqrt(2 * area))) + longest);
    const auto cells = [&](double mm) {
        return std::isfinite(mm) ? static_cast<int>(std::floor(mm / cell_mm + 1e-9)) : enough;
    };
    return {cells(tray_mm.x()), cells(tray_mm.y())};
}

/// Columns and rows of what the plan has put on the plate, as one outline of the whole plate.
std::optional<Outline> planned_outline(const std::vector<ReadyPart>& parts, const std::array<int, 2>& plate) {
    std::optional<Outline> taken;
    for (const ReadyPart& part : parts)
        for (const std::array<int, 3>& at : part.at) {
            if (!taken) taken.emplace(plate[0], plate[1]);
            const VoxelGrid& grid = part.ready->body.grid;
            const Outline outline = outline_of(part.ready->body, cell_mm);
            const int left = static_cast<int>(std::floor(at[0] * grid.pitch_mm.x() / cell_mm)),
                      front = static_cast<int>(std::floor(at[1] * grid.pitch_mm.y() / cell_mm));
            // One cell more: the place is no whole number of cells.
            for (int y = 0; y < outline.height(); ++y)
                for (int x = 0; x < outline.width(); ++x)
                    for (int more = 0; more < 4 && outline.at(x, y); ++more)
                        if (left + x + more % 2 < plate[0] && front + y + more / 2 < plate[1])
                            taken->set(left + x + more % 2, front + y + more / 2);
        }
    return taken;
}

void refuse_for_room(const std::vector<ReadyPart>& parts, const std::vector<int>& left_over,
                     const Eigen::Vector3d& tray_mm) {
    std::string names;
    for (std::size_t p = 0; p < parts.size(); ++p)
        if (left_over[p] > 0)
            names += fmt::format("{}{} of {}", names.empty() ? "" : ", ", left_over[p], parts[p].part.name);
    throw InputError(
        fmt::format("{} find no room on the tray of {:.0f} x {:.0f} mm: print fewer copies, smaller ones, turn them "
                    "(\"rotate\"), or leave less between them (\"gap\")",
                    names, tray_mm.x(), tray_mm.y()));
}

void place_the_others(std::vector<ReadyPart>& parts, double gap_mm, const Eigen::Vector3d& tray_mm) {
    std::vector<Waiting> waiting;
    for (std::size_t p = 0; p < parts.size(); ++p) {
        if (!parts[p].at.empty()) continue;
        const Outline outline = outline_of(parts[p].ready->body, cell_mm);
        for (int copy = 0; copy < parts[p].part.copies; ++copy) waiting.push_back({p, outline});
    }
    if (waiting.empty()) return;
    const std::array<int, 2> plate = plate_cells(tray_mm, waiting);
    std::vector<Outline> outlines;
    for (const Waiting& one : waiting) outlines.push_back(one.outline);
    const auto places = nest(outlines, plate, cells_of(gap_mm), planned_outline(parts, plate));
    std::vector<int> left_over(parts.size());
    for (std::size_t w = 0; w < waiting.size(); ++w) {
        ReadyPart& part = parts[waiting[w].part];
        if (!places[w]) {
            ++left_over[waiting[w].part];
            continue;
        }
        const Eigen::Vector3d& pitch = part.ready->body.grid.pitch_mm;
        part.at.push_back({static_cast<int>(std::ceil((*places[w])[0] * cell_mm / pitch.x() - 1e-9)),
                           static_cast<int>(std::ceil((*places[w])[1] * cell_mm / pitch.y() - 1e-9)), 0});
    }
    if (std::ranges::any_of(left_over, [](int n) { return n > 0; })) refuse_for_room(parts, left_over, tray_mm);
}

/// The box of all copies becomes the print: its corner is the tray's.
VoxelGrid take_box(std::vector<ReadyPart>& parts) {
    std::array<int, 3> low = parts[0].at[0], high = low;
    for (const ReadyPart& part : parts)
        for (const std::array<int, 3>& at : part.at)
            for (std::size_t axis = 0; axis < 3; ++axis) {
                low[axis] = std::min(low[axis], at[axis]);
                high[axis] = std::max(high[axis], at[axis] + part.ready->body.grid.size[axis]);
            }
    low[2] = 0;
    VoxelGrid grid;
    grid.pitch_mm = parts[0].ready->body.grid.pitch_mm;
    // One part alone lies where it lies in a print of its own.
    if (parts.size() == 1 && parts[0].at.size() == 1) grid.origin_mm = parts[0].ready->body.grid.origin_mm;
    for (std::size_t axis = 0; axis < 3; ++axis) grid.size[axis] = high[axis] - low[axis];
    for (ReadyPart& part : parts)
        for (std::array<int, 3>& at : part.at)
            for (std::size_t axis = 0; axis < 3; ++axis) at[axis] -= low[axis];
    return grid;
}

}  // namespace

std::unique_ptr<PreparedJob> open_ready(const SliceOptions& options, std::optional<JobBody> kept, Progress& progress) {
    OpenedJob job = open_part(options, progress);
    fs::create_directories(job.options.out);
    auto ready = std::make_unique<PreparedJob>(std::move(job), std::move(kept), progress);
    if (!ready->plan.loop.does_not_fit.empty()) throw ResourceError(ready->plan.loop.does_not_fit);
    return ready;
}

std::vector<ReadyPart> prepare_parts(const TrayPlan& plan, Progress& progress) {
    const fs::path out = plan.common.out;
    std::vector<std::string> roles;
    // All are opened before the first is worked on: what refuses one refuses the tray.
    for (const TrayPart& part : plan.parts) {
        const OpenedJob opened = open_job(job_options(part, out, roles));
        if (opened.options.layered)
            throw InputError(fmt::format("{}: shows how light spreads, which a tray's parts cannot yet: print it alone",
                                         part.place));
        if (roles.empty()) roles = roles_of(opened);
        if (roles_of(opened) != roles)
            throw InputError(
                fmt::format("{}: loads other resins than the first part: say \"load\" beside \"parts\"", part.place));
    }
    std::vector<ReadyPart> parts;
    for (const TrayPart& part : plan.parts) {
        progress.note(fmt::format("part {} ({} of {})", part.name, parts.size() + 1, plan.parts.size()));
        parts.push_back({part, open_ready(job_options(part, out, roles), std::nullopt, progress), {}, {}, {}});
    }
    return parts;
}

Outline outline_of(const JobBody& body, double cell) {
    const VoxelGrid& grid = body.grid;
    const Eigen::Vector3d size = size_mm(grid);
    Outline outline(std::max(1, static_cast<int>(std::ceil(size.x() / cell - 1e-9))),
                    std::max(1, static_cast<int>(std::ceil(size.y() / cell - 1e-9))));
    const Solid solid(*body.solid, grid);
    constexpr int layers_at_once = 16;
    SpanSlab spans;
    for (int first = 0; first < grid.size[2]; first += layers_at_once) {
        const int last = std::min(first + layers_at_once, grid.size[2]);
        solid.slab(first, last, spans);
        for (int k = first; k < last; ++k)
            for (int j = 0; j < grid.size[1]; ++j) {
                const int y_low = static_cast<int>(j * grid.pitch_mm.y() / cell),
                          y_high = std::min(outline.height() - 1,
                                            static_cast<int>((j + 1) * grid.pitch_mm.y() / cell - 1e-9));
                for (const Span& span : spans.row(j, k)) {
                    const int x_low = static_cast<int>(span.begin * grid.pitch_mm.x() / cell),
                              x_high = std::min(outline.width() - 1,
                                                static_cast<int>(span.end * grid.pitch_mm.x() / cell - 1e-9));
                    for (int y = y_low; y <= y_high; ++y)
                        for (int x = x_low; x <= x_high; ++x) outline.set(x, y);
                }
            }
    }
    return outline;
}

VoxelGrid arrange(std::vector<ReadyPart>& parts, double gap_mm) {
    const Eigen::Vector3d tray_mm = parts[0].ready->job.printer.sliced_tray_mm();
    for (ReadyPart& part : parts) place_as_planned(part, tray_mm);
    place_the_others(parts, gap_mm, tray_mm);
    const VoxelGrid grid = take_box(parts);
    for (ReadyPart& part : parts) part.alone = part.at;
    return grid;
}

}  // namespace voxtone::slicer
