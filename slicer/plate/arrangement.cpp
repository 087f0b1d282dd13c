// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/plate/arrangement.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include <fmt/core.h>

#include "base/contracts.h"
#include "base/error.h"
#include "slicer/plate/part_outline.h"
#include "slicer/plate/pass_bands.h"
#include "slicer/printer/tray_room.h"

namespace voxtone::slicer {

namespace {

constexpr int right_angles = 4;

Outline outline_of(const StandingPart& part) {
    return part.body ? slicer::outline_of(*part.body) : part.component->outline;
}

/// A copy that waits for a place.
struct Waiting {
    std::size_t part;
    NestItem item;
};

/// Of the part itself, which its voxels may be longer or shorter than by a part of one.
double length_mm(const StandingPart& part, int axis) {
    const double pitch = part.grid().pitch_mm[axis], voxels = part.grid().size[std::size_t(axis)] * pitch;
    double asked = voxels;
    if (part.body) asked = part.body->placement.extent_mm[axis];
    if (!part.body && part.part->component && part.part->component->is_shape())
        asked = part.part->component->size_mm[std::size_t(axis)];
    return std::abs(asked - voxels) < pitch ? asked : voxels;  // raised letters are longer
}

/// Without cells that it reaches into by a part of its last voxel alone: where the plate ends, and where a gap is left.
Outline without_rest(const StandingPart& part, const Eigen::Vector3d& tray_mm, double gap_mm) {
    const Outline outline = outline_of(part);
    std::array<int, 2> size{outline.width(), outline.height()};
    for (int axis = 0; axis < 2; ++axis) {
        const double length = length_mm(part, axis);
        int& cells = size[std::size_t(axis)];
        if (gap_mm >= nest_cell_mm) cells = std::clamp(cells_above(length - tray_slack_mm), 1, cells);
        if (std::isfinite(tray_mm[axis]) && fits_in(length, tray_mm[axis]))
            cells = std::min(cells, std::max(1, cells_within(tray_mm[axis])));
    }
    if (size[0] == outline.width() && size[1] == outline.height()) return outline;
    Outline cut(size[0], size[1]);
    for (int x = 0; x < cut.width(); ++x)
        for (int y = 0; y < cut.height(); ++y)
            if (outline.at(x, y)) cut.set(x, y);
    return cut;
}

/// `may_turn`: those parts that the plan lets.
std::vector<Waiting> waiting_copies(std::span<const StandingPart> parts, bool may_turn, const Eigen::Vector3d& tray_mm,
                                    double gap_mm) {
    std::vector<Waiting> waiting;
    for (std::size_t p = 0; p < parts.size(); ++p) {
        if (!parts[p].part->at_mm.empty()) continue;
        const Outline outline = without_rest(parts[p], tray_mm, gap_mm);
        NestItem item{{outline}, p};
        for (int turn = 1; may_turn && parts[p].part->turn && turn < right_angles; ++turn)
            item.turns.push_back(outline.turned(turn));
        for (int copy = 0; copy < parts[p].part->copies; ++copy) waiting.push_back({p, item});
    }
    return waiting;
}

/// On a plate without end a square of twice the area of all boxes, or the longest side, holds them.
std::array<int, 2> plate_cells(const Eigen::Vector3d& tray_mm, const std::vector<Waiting>& waiting) {
    double area = 0;
    int longest = 1;
    for (const Waiting& one : waiting) {
        const Outline& outline = one.item.turns[0];
        area += double(outline.width()) * outline.height();
        longest = std::max({longest, outline.width(), outline.height()});
    }
    const int enough = 2 * (static_cast<int>(std::ceil(std::sqrt(2 * area))) + longest);
    const auto cells = [&](double mm) { return std::isfinite(mm) ? cells_within(mm) : enough; };
    return {cells(tray_mm.x()), cells(tray_mm.y())};
}

PassBands bands_of(const HeadPasses& heads) {
    return {heads.along, heads.known() ? std::max(1, cells_within(heads.width_mm)) : 0};
}

/// What the plan has put on the plate.
std::optional<Outline> planned_outline(std::span<const StandingPart> parts, const std::array<int, 2>& plate) {
    std::optional<Outline> taken;
    for (const StandingPart& part : parts) {
        if (part.part->at_mm.empty()) continue;
        if (!taken) taken.emplace(plate[0], plate[1]);
        const Outline outline = outline_of(part);
        for (const std::array<double, 3>& mm : part.part->at_mm) take_at(*taken, outline, mm[0], mm[1]);
    }
    return taken;
}

class Arranger {
public:
    Arranger(std::span<const StandingPart> parts, const Eigen::Vector3d& tray_mm, const TrayOptions& options,
             const HeadPasses& heads)
        : parts_(parts),
          tray_mm_(tray_mm),
          options_(options),
          bands_(bands_of(heads)),
          pitch_(parts[0].grid().pitch_mm) {
        made_.copies.resize(parts.size());
    }

    [[nodiscard]] Arrangement arrange() {
        place_as_planned();
        if (options_.arrange == Arrange::none)
            place_by_coordinates();
        else
            place_the_others();
        for (int tray = 0; tray < trays_; ++tray) take_box(tray);
        return std::move(made_);
    }

private:
    [[nodiscard]] const std::array<int, 3>& size_of(std::size_t part) const { return parts_[part].grid().size; }

    void place_as_planned() {
        for (std::size_t p = 0; p < parts_.size(); ++p) {
            double moved_um = 0;
            for (const std::array<double, 3>& mm : parts_[p].part->at_mm) {
                const std::array<int, 3> at = add(p, Eigen::Vector3d(mm[0], mm[1], mm[2]));
                for (int axis = 0; axis < 3; ++axis)
                    moved_um = std::max(moved_um,
                                        1e3 * std::abs(at[std::size_t(axis)] * pitch_[axis] - mm[std::size_t(axis)]));
            }
            // What the plan's own digits round is not worth a word.
            if (constexpr double least_um = 1; moved_um >= least_um)
                made_.notes.push_back(
                    fmt::format("{}: lies up to {:.0f} um from where \"at\" puts it: parts lie on whole voxels of "
                                "{:.4g} x {:.4g} x "
                                "{:.4g} um",
                                parts_[p].part->name, moved_um, pitch_.x() * 1e3, pitch_.y() * 1e3, pitch_.z() * 1e3));
        }
    }

    /// Not beyond the tray by a part of its last voxel.
    [[nodiscard]] int within_tray(double voxels, std::size_t part, int axis) const {
        const int last = voxels_in_room(tray_mm_[axis], pitch_[axis]) - size_of(part)[std::size_t(axis)];
        return std::min(static_cast<int>(voxels), std::max(0, last));
    }

    /// Where it comes to stand, in voxels. Throws InputError where it is off the tray.
    std::array<int, 3> add(std::size_t part, const Eigen::Vector3d& mm) {
        PlacedCopy copy;
        for (int axis = 0; axis < 3; ++axis) {
            const double end = mm[axis] + length_mm(parts_[part], axis), room = tray_mm_[axis];
            if (!fits_in(end, room))
                throw InputError(fmt::format(
                    "{}: reaches to {:.7g} mm along {} where it is put, and the tray {} {:.7g}, {} less: move it "
                    "(\"at\"), or make it smaller",
                    parts_[part].part->place, std::round(end * 1e3) / 1e3, "xyz"[axis],
                    axis == 2 ? "may be built up to" : "ends at", room, excess_text(end - room)));
            copy.at[std::size_t(axis)] = within_tray(std::round(mm[axis] / pitch_[axis]), part, axis);
        }
        made_.copies[part].push_back(copy);
        return copy.at;
    }

    /// As an assembly that was exported part by part.
    void place_by_coordinates() {
        Eigen::Vector3d low = Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity());
        const auto corner = [&](std::size_t p) -> Eigen::Vector3d {
            return parts_[p].body->placement.corner_mm + parts_[p].body->grid.origin_mm;
        };
        for (std::size_t p = 0; p < parts_.size(); ++p) {
            if (!made_.copies[p].empty()) continue;
            expect_own_place(parts_[p]);
            low = low.cwiseMin(corner(p));
        }
        for (std::size_t p = 0; p < parts_.size(); ++p) {
            if (!made_.copies[p].empty()) continue;
            add(p, corner(p) - low);
        }
    }

    static void expect_own_place(const StandingPart& part) {
        const char* why = nullptr;
        if (!part.body) why = "is a component, which has no place of its own";
        if (part.body && part.body->is_picture) why = "is a picture, which has no place of its own";
        if (part.part->copies > 1) why = "has several copies, which would lie in one place";
        if (part.part->options.size_mm > 0)
            why =
                "is scaled by \"size\", each part by a factor of its own, so that their coordinates do not go together";
        if (why)
            throw InputError(fmt::format(
                "{}: {}: say where it lies (\"at\"), scale by \"scale\", or let it be arranged (--arrange plate)",
                part.part->place, why));
    }

    /// Fills tray after tray, and where parts may lie over each other level after level.
    void place_the_others() {
        std::vector<Waiting> waiting = waiting_copies(parts_, false, tray_mm_, options_.gap_mm);
        if (waiting.empty()) return;
        const std::array<int, 2> plate = plate_cells(tray_mm_, waiting);
        for (int tray = 0; tray < options_.trays && !waiting.empty(); ++tray) {
            const auto taken = tray == 0 ? planned_outline(parts_, plate) : std::nullopt;
            int floor = 0;
            for (bool more = true; more && !waiting.empty();) {
                const int top = fill_level(waiting, plate, taken, {{0, 0, floor}, tray});
                more = top > floor && options_.arrange == Arrange::stacked;
                if (top > floor) trays_ = tray + 1;
                floor = next_level(top);
            }
            if (tray == 0) expect_first(waiting);
        }
        if (!waiting.empty())
            refuse_for_room(waiting, options_.trays == 1 ? "the tray" : fmt::format("{} trays", options_.trays));
    }

    /// Above what ends at `top`, with the gap; where slabs of layers begin, so that none is made twice.
    [[nodiscard]] int next_level(int top) const {
        constexpr int slab_layers = 32;
        const int bottom = top + static_cast<int>(std::ceil(options_.gap_mm / pitch_.z()));
        return (bottom + slab_layers - 1) / slab_layers * slab_layers;
    }

    /// Puts what finds room on the level of `corner`, and takes it from those that wait. Where the level ends.
    int fill_level(std::vector<Waiting>& waiting, const std::array<int, 2>& plate, const std::optional<Outline>& taken,
                   const PlacedCopy& corner) {
        std::vector<NestItem> items;
        std::vector<std::size_t> of_item;
        for (std::size_t w = 0; w < waiting.size(); ++w) {
            if (corner.at[2] + size_of(waiting[w].part)[2] > voxels_in_room(tray_mm_.z(), pitch_.z())) continue;
            items.push_back(waiting[w].item);
            of_item.push_back(w);
        }
        int top = corner.at[2];
        const auto places = places_on_level(items, plate, taken, [&](std::size_t n) {
            return corner.tray == 0 && parts_[waiting[of_item[n]].part].part->first;
        });
        std::vector<bool> stands(waiting.size());
        for (std::size_t n = 0; n < items.size(); ++n) {
            if (!places[n]) continue;
            const std::size_t part = waiting[of_item[n]].part;
            PlacedCopy copy = corner;
            copy.at[0] = within_tray(std::ceil(places[n]->x * nest_cell_mm / pitch_.x() - 1e-9), part, 0);
            copy.at[1] = within_tray(std::ceil(places[n]->y * nest_cell_mm / pitch_.y() - 1e-9), part, 1);
            made_.copies[part].push_back(copy);
            stands[of_item[n]] = true;
            top = std::max(top, corner.at[2] + size_of(part)[2]);
        }
        std::size_t w = 0;
        std::erase_if(waiting, [&](const Waiting&) { return stands[w++]; });
        return top;
    }

    /// What must be there has its place before the others where there is none for all.
    template <class IsFirst>
    [[nodiscard]] std::vector<std::optional<NestPlace>> places_on_level(const std::vector<NestItem>& items,
                                                                        const std::array<int, 2>& plate,
                                                                        const std::optional<Outline>& taken,
                                                                        const IsFirst& is_first) const {
        const int gap = cells_above(options_.gap_mm);
        auto places = nest_in_passes(items, plate, gap, taken, bands_);
        std::array<std::vector<std::size_t>, 2> turns;  // those that must be there, then the others
        bool good = true;
        for (std::size_t n = 0; n < items.size(); ++n) {
            turns[is_first(n) ? 0 : 1].push_back(n);
            good = good && (places[n] || !is_first(n));
        }
        if (good) return places;
        std::optional<Outline> full = taken ? taken : Outline(plate[0], plate[1]);
        for (const std::vector<std::size_t>& now : turns) {
            std::vector<NestItem> some;
            for (const std::size_t n : now) some.push_back(items[n]);
            const auto found = nest_in_passes(some, plate, gap, full, bands_);
            for (std::size_t i = 0; i < now.size(); ++i) {
                places[now[i]] = found[i];
                if (found[i])
                    take_at(*full, some[i].turns[std::size_t(found[i]->turn)], found[i]->x * nest_cell_mm,
                            found[i]->y * nest_cell_mm);
            }
        }
        return places;
    }

    /// Those that must be on the first tray and are not.
    void expect_first(const std::vector<Waiting>& waiting) const {
        std::vector<Waiting> late;
        for (const Waiting& one : waiting)
            if (parts_[one.part].part->first) late.push_back(one);
        if (!late.empty()) refuse_for_room(late, "the first tray, where they must be (\"first\"),");
    }

    [[noreturn]] void refuse_for_room(const std::vector<Waiting>& waiting, const std::string& where) const {
        std::vector<int> left_over(parts_.size());
        for (const Waiting& one : waiting) ++left_over[one.part];
        std::string names;
        for (std::size_t p = 0; p < parts_.size(); ++p)
            if (left_over[p] > 0)
                names += fmt::format("{}{} of {}", names.empty() ? "" : ", ", left_over[p], parts_[p].part->name);
        throw InputError(fmt::format(
            "{} find no room on {} of {:.0f} x {:.0f} x {:.0f} mm: allow more trays (--trays N), parts over each other "
            "(--arrange stacked) or turned (--turn), print fewer or smaller ones, or leave less between them (--gap)",
            names, where, tray_mm_.x(), tray_mm_.y(), tray_mm_.z()));
    }

    /// The box of all copies on a tray becomes the print: its corner is the tray's.
    void take_box(int tray) {
        std::array<int, 3> low{}, high{};
        std::size_t count = 0;
        const auto each = [&](const auto& look) {
            for (std::size_t p = 0; p < parts_.size(); ++p)
                for (PlacedCopy& copy : made_.copies[p])
                    if (copy.tray == tray) look(p, copy.at);
        };
        each([&](std::size_t part, std::array<int, 3>& at) {
            if (count++ == 0) low = high = at;
            for (std::size_t axis = 0; axis < 3; ++axis) {
                low[axis] = std::min(low[axis], at[axis]);
                high[axis] = std::max(high[axis], at[axis] + size_of(part)[axis]);
            }
        });
        VOXTONE_EXPECT(count > 0);
        low[2] = 0;
        VoxelGrid grid;
        grid.pitch_mm = pitch_;
        each([&](std::size_t part, std::array<int, 3>& at) {
            // One part alone lies where it lies in a print of its own.
            if (count == 1 && trays_ == 1 && at[2] == 0) grid.origin_mm = parts_[part].grid().origin_mm;
            for (std::size_t axis = 0; axis < 3; ++axis) at[axis] -= low[axis];
        });
        for (std::size_t axis = 0; axis < 3; ++axis) grid.size[axis] = high[axis] - low[axis];
        made_.trays.push_back(grid);
        made_.corner_mm.push_back({low[0] * pitch_.x(), low[1] * pitch_.y(), 0});
    }

    std::span<const StandingPart> parts_;
    Eigen::Vector3d tray_mm_;
    const TrayOptions& options_;
    PassBands bands_;
    Eigen::Vector3d pitch_;
    Arrangement made_;
    int trays_ = 1;
};

}  // namespace

Arrangement arrange(std::span<const StandingPart> parts, const Eigen::Vector3d& tray_mm, const TrayOptions& options,
                    const HeadPasses& heads) {
    VOXTONE_EXPECT(!parts.empty());
    return Arranger(parts, tray_mm, options, heads).arrange();
}

std::vector<int> turns_on_plate(std::span<const StandingPart> parts, const Eigen::Vector3d& tray_mm, double gap_mm,
                                const HeadPasses& heads) {
    const std::vector<Waiting> waiting = waiting_copies(parts, true, tray_mm, gap_mm);
    std::vector<int> turns(parts.size());
    if (waiting.empty()) return turns;
    const std::array<int, 2> plate = plate_cells(tray_mm, waiting);
    std::vector<NestItem> items;
    for (const Waiting& one : waiting) items.push_back(one.item);
    const auto places =
        nest_in_passes(items, plate, cells_above(gap_mm), planned_outline(parts, plate), bands_of(heads));
    for (std::size_t w = 0; w < waiting.size(); ++w)
        if (places[w]) turns[waiting[w].part] = places[w]->turn;
    return turns;
}

std::string turned_further(const SliceOptions& options, int turn) {
    // The turn stands before the mirrors, which turn it around where they are odd in number.
    const bool is_mirrored = (int(options.flip_x) + int(options.flip_y) + int(options.swap_xy)) % 2 == 1;
    const int degrees = 90 * (is_mirrored ? (right_angles - turn) % right_angles : turn);
    if (degrees == 0) return options.rotate;
    return options.rotate + (options.rotate.empty() ? "" : ",") + fmt::format("z{}", degrees);
}

}  // namespace voxtone::slicer
