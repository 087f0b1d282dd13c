// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/colour/printed_labels.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include <Eigen/Geometry>

#include "base/error.h"
#include "io/pictures/codes_in_picture.h"
#include "slicer/colour/slab_picture.h"
#include "slicer/colour/type_size.h"
#include "slicer/surface/mark_shape.h"

namespace voxtone::slicer {

namespace {

constexpr int no_letter = -1;

double luminance(const Eigen::Vector3f& rgb) {
    return double(Eigen::Vector3f(0.2126f, 0.7152f, 0.0722f).dot(rgb.cwiseMax(0)));
}

/// A cell of the print, where a label sees it: mm from its lower left corner.
struct Seen {
    Eigen::Vector2d at;
    std::uint32_t cell;
};

std::vector<Seen> seen_of(const JobPrediction& p, const io::Decal& decal, const Eigen::Vector3d& origin_mm) {
    std::vector<Seen> seen;
    const auto vector_of = [](const std::array<float, 3>& v) { return Eigen::Vector3d(v[0], v[1], v[2]); };
    const double cell_mm = *std::ranges::max_element(p.cell_um) / 1e3;
    for (std::uint32_t i = 0; i < p.predicted.surface.cells.size(); ++i) {
        const optics::SurfaceCell& cell = p.predicted.surface.cells[i];
        if (vector_of(cell.normal).dot(decal.out) < io::Decal::least_cos) continue;
        const Eigen::Vector3d from = vector_of(cell.centre_mm) + origin_mm - decal.corner_mm;
        const Eigen::Vector2d at(from.dot(decal.right), from.dot(decal.up));
        const Eigen::Vector2d share(at.x() / decal.width_mm, at.y() / decal.height_mm);
        if ((share.array() < 0).any() || (share.array() > 1).any()) continue;
        const auto hit = double(decal.first_hit.deepest_near(float(share.x()), float(share.y())));
        if (-from.dot(decal.out) <= hit + decal.slack_mm + cell_mm) seen.push_back({at, i});
    }
    return seen;
}

/// Letters of a text's ink: what hangs together, and what stands above one another.
class Letters {
public:
    explicit Letters(const io::Coverage& ink)
        : ink_(ink), letter_(std::size_t(ink.width_px) * std::size_t(ink.height_px), no_letter) {
        for (std::size_t first = 0; first < letter_.size(); ++first)
            if (letter_[first] == no_letter && is_ink(int(first) % ink_.width_px, int(first) / ink_.width_px))
                fill(int(first));
        join_columns();
    }
    [[nodiscard]] std::size_t count() const { return boxes_.size(); }
    [[nodiscard]] const Eigen::AlignedBox2d& box_mm(std::size_t letter) const { return boxes_[letter]; }
    /// `at`: mm from the lower left corner. Of half-covered pixels: none.
    [[nodiscard]] int at(const Eigen::Vector2d& at) const {
        const int x = column(at), y = row(at);
        return letter_[std::size_t(y) * std::size_t(ink_.width_px) + std::size_t(x)];
    }
    [[nodiscard]] bool is_bare(const Eigen::Vector2d& at) const { return ink_.at(column(at), row(at)) < 25; }

private:
    [[nodiscard]] int column(const Eigen::Vector2d& at) const {
        return std::clamp(int(at.x() / ink_.pixel_mm), 0, ink_.width_px - 1);
    }
    [[nodiscard]] int row(const Eigen::Vector2d& at) const {
        return std::clamp(ink_.height_px - 1 - int(at.y() / ink_.pixel_mm), 0, ink_.height_px - 1);
    }
    [[nodiscard]] bool is_ink(int x, int y) const {
        return x >= 0 && y >= 0 && x < ink_.width_px && y < ink_.height_px && ink_.at(x, y) > 200;
    }
    void fill(int first) {
        const int mine = int(boxes_.size());
        Eigen::AlignedBox2d box;
        std::vector<int> next{first};
        letter_[std::size_t(first)] = mine;
        while (!next.empty()) {
            const int x = next.back() % ink_.width_px, y = next.back() / ink_.width_px;
            next.pop_back();
            box.extend(ink_.pixel_mm * Eigen::Vector2d(x, ink_.height_px - 1 - y));
            box.extend(ink_.pixel_mm * Eigen::Vector2d(x + 1, ink_.height_px - y));
            for (int n = 0; n < 9; ++n) {
                const int to_x = x + n % 3 - 1, to_y = y + n / 3 - 1;
                const auto to = std::size_t(to_y * ink_.width_px + to_x);
                if (!is_ink(to_x, to_y) || letter_[to] != no_letter) continue;
                letter_[to] = mine;
                next.push_back(int(to));
            }
        }
        boxes_.push_back(box);
    }
    /// Dots and accents: half of the narrower one lies above or below the other, no farther than it is wide.
    void join_columns() {
        std::vector<int> into(boxes_.size());
        for (std::size_t n = 0; n < boxes_.size(); ++n) into[n] = int(n);
        for (std::size_t a = 0; a < boxes_.size(); ++a)
            for (std::size_t b = 0; b < a; ++b) {
                const Eigen::Vector2d low = boxes_[a].min().cwiseMax(boxes_[b].min()),
                                      high = boxes_[a].max().cwiseMin(boxes_[b].max());
                const double narrow = std::min(boxes_[a].sizes().x(), boxes_[b].sizes().x());
                if (high.x() - low.x() < narrow / 2 || low.y() - high.y() > narrow) continue;
                for (int& letter : into)
                    if (letter == int(a)) letter = into[b];
            }
        std::vector<int> number(boxes_.size(), no_letter);
        std::vector<Eigen::AlignedBox2d> joined;
        for (std::size_t n = 0; n < boxes_.size(); ++n) {
            int& of = number[std::size_t(into[n])];
            if (of == no_letter) of = int(joined.size()), joined.emplace_back();
            joined[std::size_t(of)].extend(boxes_[n]);
        }
        for (int& letter : letter_)
            if (letter != no_letter) letter = number[std::size_t(into[std::size_t(letter)])];
        boxes_ = std::move(joined);
    }

    const io::Coverage& ink_;
    std::vector<int> letter_;
    std::vector<Eigen::AlignedBox2d> boxes_;
};

void read_letters(const JobPrediction& p, const std::vector<Seen>& seen, const MarkShape& shape,
                  double viewing_distance_mm, PrintedLabel& label) {
    constexpr double around_mm = 0.5, room = 0.01;  // a room's light over both, as in SeenPrint
    constexpr double dash = 0.2;                    // of the em: what is no higher is a dash or a dot, and no letter
    const Letters letters(shape.ink);
    struct Light {
        double ink = 0, ground = 0, on = 0, off = 0;
        [[nodiscard]] double apart() const {  // negative: darker than its ground
            const double a = on > 0 ? ink / on : 0, b = off > 0 ? ground / off : 0;
            return on > 0 && off > 0 ? (a - b) / (a + b + 2 * room) : 0;
        }
    };
    std::vector<Light> light(letters.count());
    const Eigen::Vector2d more = Eigen::Vector2d::Constant(around_mm);
    for (const Seen& one : seen) {
        const double here = luminance(p.predicted.rgb[one.cell]);
        if (const int letter = letters.at(one.at); letter != no_letter)
            light[std::size_t(letter)].ink += here, light[std::size_t(letter)].on += 1;
        if (!letters.is_bare(one.at)) continue;
        for (std::size_t n = 0; n < light.size(); ++n) {
            const Eigen::AlignedBox2d& box = letters.box_mm(n);
            if (Eigen::AlignedBox2d(box.min() - more, box.max() + more).contains(one.at))
                light[n].ground += here, light[n].off += 1;
        }
    }
    // All have one ink: whatever most are, darker or lighter, the others are lost.
    double sum = 0;
    for (const Light& of : light) sum += of.apart();
    label.contrast = 1;
    for (std::size_t n = 0; n < light.size(); ++n) {
        const Light& of = light[n];
        if (letters.box_mm(n).sizes().y() < dash * label.mark->size_mm) continue;
        ++label.letters;
        const double contrast = sum < 0 ? -of.apart() : of.apart();
        label.contrast = std::min(label.contrast, std::max(0.0, contrast));
        if (legibility_of(contrast, 1, label.mark->size_mm, viewing_distance_mm) == Legibility::lost) ++label.unread;
    }
    label.is_read = label.unread == 0;
}

/// What the label's rectangle shows, by its nearest cells.
io::LuminanceRaster raster_of(const JobPrediction& p, const std::vector<Seen>& seen, const io::Decal& decal,
                              bool inverted) {
    const double pixel_mm = *std::ranges::min_element(p.cell_um) / 1e3;
    io::LuminanceRaster raster{
        std::max(1, int(decal.width_mm / pixel_mm)), std::max(1, int(decal.height_mm / pixel_mm)), {}};
    std::vector<double> nearest(std::size_t(raster.columns) * std::size_t(raster.rows), 1e9);
    raster.grey.assign(nearest.size(), inverted ? 0 : 255);
    const int reach = int(std::ceil(*std::ranges::max_element(p.cell_um) / 1e3 / pixel_mm));
    for (const Seen& one : seen) {
        const int x = int(one.at.x() / pixel_mm), y = raster.rows - 1 - int(one.at.y() / pixel_mm);
        for (int row = std::max(0, y - reach); row < std::min(raster.rows, y + reach + 1); ++row)
            for (int column = std::max(0, x - reach); column < std::min(raster.columns, x + reach + 1); ++column) {
                const double far = (Eigen::Vector2d(column + 0.5, raster.rows - row - 0.5) * pixel_mm - one.at).norm();
                const std::size_t n = std::size_t(row) * std::size_t(raster.columns) + std::size_t(column);
                if (far < nearest[n]) nearest[n] = far, raster.grey[n] = grey_of(p.predicted.rgb[one.cell]);
            }
    }
    if (inverted)
        for (std::uint8_t& grey : raster.grey) grey = std::uint8_t(255 - grey);
    return raster;
}

/// Of the code as it was made.
std::string content_of(const MarkShape& shape) {
    io::LuminanceRaster raster{shape.ink.width_px, shape.ink.height_px, {}};
    for (int y = 0; y < shape.ink.height_px; ++y)
        for (int x = 0; x < shape.ink.width_px; ++x) raster.grey.push_back(std::uint8_t(255 - shape.ink.at(x, y)));
    const auto codes = io::codes_in_picture(raster);
    return codes.size() == 1 ? codes[0].content : std::string();
}

/// Nothing where nothing reads codes.
std::optional<bool> is_read(const JobPrediction& p, const std::vector<Seen>& seen, const MarkShape& shape,
                            const io::Decal& decal) {
    try {
        const std::string content = content_of(shape);
        if (content.empty()) return std::nullopt;
        for (const bool inverted : {false, true})
            for (const io::CodeInPicture& code : io::codes_in_picture(raster_of(p, seen, decal, inverted)))
                if (code.content == content) return true;
        return false;
    } catch (const Cancelled&) {
        throw;
    } catch (const Error&) {
        return std::nullopt;
    }
}

}  // namespace

std::vector<PrintedLabel> printed_labels(const JobPrediction& p, std::span<const MarkOptions> marks,
                                         std::span<const io::Decal> decals, const Eigen::Vector3d& origin_mm,
                                         double viewing_distance_mm) {
    std::vector<PrintedLabel> labels;
    for (std::size_t n = 0; n < std::min(marks.size(), decals.size()); ++n) {
        const MarkOptions& mark = marks[n];
        if (mark.kind == MarkKind::picture || mark.ink == MarkInk::none || mark.relief_voxels != 0 || decals[n].by_uv)
            continue;
        const std::vector<Seen> seen = seen_of(p, decals[n], origin_mm);
        if (seen.empty()) continue;
        const MarkShape shape = shape_of(mark, {});
        PrintedLabel label;
        label.mark = &mark;
        for (const Seen& one : seen) label.cells.push_back(one.cell);
        if (mark.kind == MarkKind::text) {
            read_letters(p, seen, shape, viewing_distance_mm, label);
        } else {
            const auto read = is_read(p, seen, shape, decals[n]);
            if (!read) continue;
            label.is_read = *read;
        }
        labels.push_back(std::move(label));
    }
    return labels;
}

}  // namespace voxtone::slicer
