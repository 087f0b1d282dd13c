// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/plate/finished_stack.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <mutex>
#include <utility>

#include <fmt/core.h>
#include <fmt/ranges.h>

#include "base/error.h"
#include "base/parallel.h"
#include "base/units.h"
#include "base/warning.h"
#include "io/layers/gcvf_config.h"
#include "io/layers/layer_digest.h"
#include "io/layers/orient.h"
#include "io/layers/stack_folder.h"
#include "io/layers/stack_reader.h"
#include "slicer/layers/stack_layers.h"
#include "slicer/plate/part_outline.h"

namespace voxtone::slicer {

namespace {

namespace fs = std::filesystem;

/// What a stack says of itself, in the model's frame.
struct StackFacts {
    Eigen::Vector3d pitch_mm = Eigen::Vector3d::Zero();
    std::array<std::uint32_t, 2> size_px{};  ///< of its bitmaps
    io::Orientation orientation;
    std::vector<io::Rgb> palette;
    std::vector<std::string> resins;  ///< names, by material - 1
    Eigen::Vector3d origin_mm = Eigen::Vector3d::Zero();
};

std::shared_ptr<const io::StackReader> open_stack(const TrayComponent& component) {
    const std::string& path = component.path;
    std::error_code none;
    if (!fs::exists(path, none))
        throw FileError(fmt::format("{} {} is not there; check the path", name_of(component.kind), path));
    auto stack = std::make_shared<const io::StackReader>(path);
    const bool ours = component.kind == ComponentKind::stack;
    if (ours && stack->kind() == io::StackReader::Kind::folder)
        throw InputError(
            fmt::format("{}: has no {}, and nothing says how large its voxels are and which colour is which resin: "
                        "name the folder of a "
                        "finished stack, or its GCVF (\"gcvf\")",
                        path, io::manifest_name));
    if (ours != (stack->kind() == io::StackReader::Kind::voxtone))
        throw InputError(fmt::format("{}: is a {}: name it under \"{}\"", path, ours ? "GCVF" : "stack",
                                     name_of(ours ? ComponentKind::gcvf : ComponentKind::stack)));
    if (stack->missing_count() > 0)
        throw InputError(fmt::format(
            "{}: {} of its layers are not there, the first is {}: a body with gaps would be printed; slice it again",
            path, stack->missing_count(), stack->missing().front()));
    if (ours && stack->seal() == io::ManifestSeal::broken)
        throw InputError(
            fmt::format("{}: its {} was changed after it was written, and may name the wrong resins: slice it "
                        "again",
                        path, io::manifest_name));
    return stack;
}

/// The stack's resins as this tray calls them: by name, else by role, which is said.
class ResinNames {
public:
    explicit ResinNames(const OpenedJob& common) : resins_(common.resins) {}

    std::string operator()(const std::string& name, std::string_view role) {
        for (const io::StackResin& entry : resins_.entries)
            if (io::gcvf_material_name(entry) == name) return entry.name;
        if (loaded_resin(resins_, name)) return name;
        for (const io::StackResin& entry : resins_.entries)
            if (entry.role == role) {
                others_.push_back(fmt::format("{} as {}", name, entry.name));
                return entry.name;
            }
        return name;
    }
    void warn(const std::string& path, Progress& progress) const {
        if (others_.empty()) return;
        progress.warn(named_warning(
            "cartridges",
            fmt::format(
                "{}: was made for other resins than this tray's: {} will be printed, and its colours will not be "
                "those that it was made for; slice it again with this tray's resin set.",
                path, fmt::join(others_, ", "))));
    }

private:
    const LoadedResins& resins_;
    std::vector<std::string> others_;
};

StackFacts facts_of(const io::StackReader& stack, const OpenedJob& common, ResinNames& names) {
    StackFacts facts;
    facts.palette = stack.palette();
    if (const auto& description = stack.description()) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
            facts.pitch_mm[Eigen::Index(axis)] = description->pitch_um[axis] * 1e-3;
            facts.origin_mm[Eigen::Index(axis)] = description->origin_mm[axis];
        }
        facts.size_px = description->size_px;
        facts.orientation = description->orientation;
        for (const io::StackResin& resin : description->resins) facts.resins.push_back(names(resin.name, resin.role));
    } else {
        const io::GcvfConfig& config = *stack.gcvf();
        facts.pitch_mm = {mm_per_inch / config.x_dpi, mm_per_inch / config.y_dpi,
                          double(config.slice_thickness_nm) * 1e-6};
        facts.size_px = {config.width_px, config.height_px};
        facts.orientation = common.printer.orientation;
        for (const io::GcvfMaterial& material : config.materials)
            facts.resins.push_back(names(material.name, io::role_of_gcvf_material(material.name)));
    }
    if (facts.orientation.swap_xy) std::swap(facts.pitch_mm[0], facts.pitch_mm[1]);
    return facts;
}

void expect_pitch(const StackFacts& facts, const PrinterProfile& printer, const std::string& path) {
    constexpr double same = 1e-4;  // what dpi and nm round; over the longest tray a voxel
    const Eigen::Vector3d wanted = printer.sliced_pitch_mm();
    for (int axis = 0; axis < 3; ++axis)
        if (!(std::abs(facts.pitch_mm[axis] / wanted[axis] - 1) < same))
            throw InputError(
                fmt::format("{}: its voxels are {:.4g} x {:.4g} x {:.4g} um and this tray's ({}) {:.4g} x {:.4g} x "
                            "{:.4g}: they cannot "
                            "be taken as they are; slice its model for this printer",
                            path, 1e3 * facts.pitch_mm.x(), 1e3 * facts.pitch_mm.y(), 1e3 * facts.pitch_mm.z(),
                            printer.id, 1e3 * wanted.x(), 1e3 * wanted.y(), 1e3 * wanted.z()));
}

/// What is found on a way through all layers.
class StackSurvey {
public:
    StackSurvey(int width, int height)
        : width_(width), height_(height), filled_(std::size_t(width) * std::size_t(height)) {}

    /// In the model's frame; from any thread.
    void take_layer(int k, const io::LayerRuns& layer) {
        std::array<std::uint64_t, io::max_materials> mine{};
        std::vector<std::array<int, 3>> spans;  // row, begin, end
        for (std::uint32_t y = 0; y < layer.height_px(); ++y) {
            const int j = height_ - 1 - int(y);
            int i = 0;
            for (const io::Run& run : layer.row(y)) {
                mine[run.material] += run.length;
                if (run.material != io::background) {
                    if (spans.empty() || spans.back()[0] != j || spans.back()[2] != i) spans.push_back({j, i, i});
                    spans.back()[2] = i + run.length;
                }
                i += run.length;
            }
        }
        const std::scoped_lock lock(mutex_);
        for (std::size_t m = 0; m < mine.size(); ++m) pixels_[m] += mine[m];
        for (const auto& [j, begin, end] : spans) {
            const auto row = filled_.begin() + std::ptrdiff_t(j) * width_;
            std::fill(row + begin, row + end, true);
            low_ = {std::min(low_[0], begin), std::min(low_[1], j), std::min(low_[2], k)};
            high_ = {std::max(high_[0], end), std::max(high_[1], j + 1), std::max(high_[2], k + 1)};
        }
    }
    /// Of each material of the stack.
    [[nodiscard]] const std::array<std::uint64_t, io::max_materials>& pixels() const { return pixels_; }
    /// Of voxels with a resin.
    [[nodiscard]] const std::array<int, 3>& low() const { return low_; }
    [[nodiscard]] const std::array<int, 3>& high() const { return high_; }
    /// Of the part whose corner lies there in the stack.
    [[nodiscard]] Outline outline(const VoxelGrid& grid, const std::array<int, 2>& corner) const {
        Outline outline = empty_outline(grid);
        for (int j = 0; j < grid.size[1]; ++j)
            for (int i = 0; i < grid.size[0]; ++i)
                if (filled_[std::size_t(corner[1] + j) * std::size_t(width_) + std::size_t(corner[0] + i)])
                    take_voxels(outline, grid, j, i, i + 1);
        return outline;
    }

private:
    int width_, height_;
    std::mutex mutex_;
    std::vector<bool> filled_;  ///< columns with a voxel
    std::array<std::uint64_t, io::max_materials> pixels_{};
    static constexpr int none = std::numeric_limits<int>::max();
    std::array<int, 3> low_{none, none, none}, high_{};
};

std::array<int, 2> size_in_frame(const StackFacts& facts) {
    std::array<int, 2> size{int(facts.size_px[0]), int(facts.size_px[1])};
    if (facts.orientation.swap_xy) std::swap(size[0], size[1]);
    return size;
}

/// Reads all layers; the digest of what they hold.
std::string survey(const io::StackReader& stack, const StackFacts& facts, StackSurvey& found, Progress& progress) {
    std::vector<std::uint64_t> digests(stack.layers());
    progress.begin_stage("read a finished stack", stack.layers(), "layers");
    parallel_for(
        0, stack.layers(), 1,
        [&](std::size_t k) {
            const auto index = static_cast<std::uint32_t>(k);
            io::LayerRuns layer = stack.read(index, facts.palette);
            if (layer.width_px() != facts.size_px[0] || layer.height_px() != facts.size_px[1])
                throw InputError(fmt::format("{}: {} x {} px, but the stack has {} x {}: slice it again",
                                             stack.layer_name(index), layer.width_px(), layer.height_px(),
                                             facts.size_px[0], facts.size_px[1]));
            digests[k] = io::layer_digest(layer);
            found.take_layer(int(k), io::as_sliced(std::move(layer), facts.orientation));
            progress.advance();
        },
        &progress);
    progress.end_stage();
    return io::content_sha256(facts.size_px[0], facts.size_px[1], digests);
}

/// The tray's materials by the stack's; resins that the stack names and has not are none.
std::array<io::Material, io::max_materials> materials_of(const StackFacts& facts, const StackSurvey& found,
                                                         const LoadedResins& resins, const std::string& path) {
    std::array<io::Material, io::max_materials> material_of{};
    for (std::size_t m = 1; m <= facts.resins.size(); ++m) {
        if (found.pixels()[m] == 0) continue;
        const auto resin = loaded_resin(resins, facts.resins[m - 1]);
        if (!resin) try {
                refuse_resin(facts.resins[m - 1], resins);
            } catch (const InputError& error) {
                throw InputError(fmt::format("{}: {}", path, error.what()));
            }
        material_of[m] = static_cast<io::Material>(1 + *resin);
    }
    return material_of;
}

}  // namespace

ReadyComponent open_finished_stack(const TrayComponent& component, const OpenedJob& common, Progress& progress) {
    const std::shared_ptr<const io::StackReader> stack = open_stack(component);
    ResinNames names(common);
    const StackFacts facts = facts_of(*stack, common, names);
    names.warn(component.path, progress);
    expect_pitch(facts, common.printer, component.path);
    const std::array<int, 2> size = size_in_frame(facts);
    StackSurvey found(size[0], size[1]);
    const std::string content = survey(*stack, facts, found, progress);
    if (stack->description() && content != stack->description()->content_sha256)
        throw InputError(
            fmt::format("{}: holds other voxels than its {} says (content_sha256): it is torn, or was changed; "
                        "slice it again",
                        component.path, io::manifest_name));
    if (found.high()[2] == 0) throw InputError(fmt::format("{}: holds no voxel of a resin", component.path));
    StackBitmaps bitmaps{
        facts.palette, materials_of(facts, found, common.resins, component.path), facts.orientation, {}, 0};
    VoxelGrid grid;
    grid.pitch_mm = common.printer.sliced_pitch_mm();
    grid.origin_mm = facts.origin_mm;
    grid.size = {size[0], size[1], int(stack->layers())};
    if (component.kind == ComponentKind::gcvf) {
        bitmaps.corner = {found.low()[0], found.low()[1]}, bitmaps.first_layer = found.low()[2];
        for (std::size_t axis = 0; axis < 3; ++axis) grid.size[axis] = found.high()[axis] - found.low()[axis];
    }
    ReadyComponent made{
        nullptr, found.outline(grid, bitmaps.corner), std::vector<std::uint64_t>(common.resins.entries.size()), {}};
    for (std::size_t m = 1; m < bitmaps.material_of.size(); ++m)
        if (bitmaps.material_of[m] > 0) made.voxels[bitmaps.material_of[m] - 1u] += found.pixels()[m];
    const fs::path path = component.path;
    made.files.push_back((stack->description() ? path / io::manifest_name : path).string());
    made.layers = std::make_shared<const StackLayers>(stack, std::move(bitmaps), grid);
    return made;
}

}  // namespace voxtone::slicer
