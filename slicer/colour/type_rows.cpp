// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/colour/type_rows.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <optional>
#include <utility>

#include <Eigen/Geometry>
#include <Eigen/LU>

#include "base/parallel.h"
#include "optics/colour/colour.h"

namespace voxtone::slicer {

namespace {

constexpr std::size_t all_directions = 24;
constexpr std::size_t quarter = all_directions / 4;
constexpr int no_ground = -1;
constexpr double most_height_mm = 6;  // of capitals of 24 pt
constexpr double alike_heights = 1.8, reach_heights = 2;
constexpr std::size_t least_row = 4;
constexpr double cells_to_tell = 6;  // what a piece's shape is

Eigen::Vector3d seen_oklab(const Eigen::Vector3f& rgb) {
    return optics::oklab_from_linear_srgb(rgb.cast<double>().cwiseMax(0));
}

double luminance_to_eye(const Eigen::Vector3f& rgb) {
    return double(Eigen::Vector3f(0.2126f, 0.7152f, 0.0722f).dot(rgb.cwiseMax(0)));
}

/// What may be a letter.
struct Piece {
    std::vector<std::uint32_t> cells;
    double area_mm2 = 0;
    double ink = 0;  // area times how far its luminance is from the ground's
    Eigen::Vector3d middle = Eigen::Vector3d::Zero(), right, up;  // of the plane that it lies in
    std::array<double, all_directions> far{};                     // from the middle, along each
    double solidity = 0, unruled = 0, cell_mm = 0;

    /// Along a direction, and across it to the left.
    [[nodiscard]] Eigen::Vector3d along(std::size_t k) const {
        const double angle = 2 * std::numbers::pi * double(k) / double(all_directions);
        return std::cos(angle) * right + std::sin(angle) * up;
    }
    [[nodiscard]] double foot(std::size_t k) const { return -far[(k + 3 * quarter) % all_directions]; }
    [[nodiscard]] double height(std::size_t k) const { return far[(k + quarter) % all_directions] - foot(k); }
    [[nodiscard]] double width(std::size_t k) const { return far[k] + far[(k + 2 * quarter) % all_directions]; }
    [[nodiscard]] double widest() const {
        double most = 0;
        for (std::size_t k = 0; k < 2 * quarter; ++k) most = std::max(most, width(k));
        return most;
    }
    [[nodiscard]] double narrowest() const {
        double least = std::numeric_limits<double>::infinity();
        for (std::size_t k = 0; k < 2 * quarter; ++k) least = std::min(least, width(k));
        return least;
    }
};

/// Which of them belong together.
class Groups {
public:
    explicit Groups(std::size_t all) : of_(all) { std::iota(of_.begin(), of_.end(), std::size_t{0}); }
    [[nodiscard]] std::size_t of(std::size_t i) {
        while (of_[i] != i) i = of_[i] = of_[of_[i]];
        return i;
    }
    void join(std::size_t i, std::size_t j) { of_[of(i)] = of(j); }
    [[nodiscard]] std::vector<std::size_t> sizes() {
        std::vector<std::size_t> size(of_.size());
        for (std::size_t i = 0; i < of_.size(); ++i) ++size[of(i)];
        return size;
    }

private:
    std::vector<std::size_t> of_;
};

class PieceFinder {
public:
    explicit PieceFinder(const JobPrediction& p)
        : p_(p), cells_(p.predicted.surface), ground_(p.target.size(), no_ground) {
        for (std::size_t r = 0; r < p.seen.regions.size(); ++r)
            if (p.seen.regions[r].kind != halftone::RegionKind::strokes) lay_ground(r);
    }

    void find(std::vector<Piece>& pieces, std::vector<std::vector<std::uint32_t>>& others) const {
        std::vector<char> taken(ground_.size());
        for (std::uint32_t first = 0; first < ground_.size(); ++first) {
            if (taken[first] || ground_[first] != no_ground) continue;
            Piece piece;
            int on = no_ground;
            if (!collect(first, taken, piece.cells, on)) continue;
            if (!measure(piece, on)) {
                others.push_back(std::move(piece.cells));
                continue;
            }
            for (std::vector<std::uint32_t>& part : parts_of(piece, on)) {
                Piece one;
                one.cells = std::move(part);
                if (measure(one, on))
                    pieces.push_back(std::move(one));
                else
                    others.push_back(std::move(one.cells));
            }
        }
    }

private:
    /// Parts of a region that are large enough; white letters on a solid are paper, too, and so is the inside of an O.
    void lay_ground(std::size_t r) {
        constexpr double least_ground_mm2 = 1;
        const std::vector<std::uint32_t>& all = p_.seen.regions[r].cells;
        std::vector<char> taken(all.size());
        std::vector<std::uint32_t> part;  // places in `all`
        for (std::uint32_t first = 0; first < all.size(); ++first) {
            if (taken[first]) continue;
            part.assign(1, first), taken[first] = 1;
            double area = 0;
            for (std::size_t next = 0; next < part.size(); ++next) {
                const std::uint32_t cell = all[part[next]];
                area += double(p_.predicted.surface.cells[cell].area_mm2);
                cells_.visit_around(cell, [&](std::size_t other) {
                    const auto at = std::ranges::lower_bound(all, static_cast<std::uint32_t>(other));
                    const auto place = static_cast<std::uint32_t>(at - all.begin());
                    if (at == all.end() || *at != other || taken[place]) return;
                    taken[place] = 1;
                    part.push_back(place);
                });
            }
            if (area < least_ground_mm2) continue;
            for (const std::uint32_t place : part) ground_[all[place]] = static_cast<int>(r);
        }
    }

    /// All that hangs together with a cell and is no ground. False where it lies between different grounds, or on none.
    bool collect(std::uint32_t first, std::vector<char>& taken, std::vector<std::uint32_t>& piece, int& on) const {
        bool between = false;
        piece.push_back(first), taken[first] = 1;
        for (std::size_t next = 0; next < piece.size(); ++next)
            cells_.visit_around(piece[next], [&](std::size_t other) {
                if (ground_[other] != no_ground) {
                    between = between || (on != no_ground && ground_[other] != on);
                    on = ground_[other];
                } else if (!taken[other]) {
                    taken[other] = 1;
                    piece.push_back(static_cast<std::uint32_t>(other));
                }
            });
        return on != no_ground && !between;
    }

    /// Letters that touch where a cell has something of both: what is dark hangs together, each other cell goes with
    /// the nearest of it.
    [[nodiscard]] std::vector<std::vector<std::uint32_t>> parts_of(Piece& piece, int on) const {
        constexpr double dark = 0.4;  // of the darkest
        constexpr std::uint32_t none = ~std::uint32_t{0}, faint = none - 1;
        std::vector<std::uint32_t>& all = piece.cells;
        std::ranges::sort(all);
        const double behind = luminance_to_eye(p_.seen.regions[std::size_t(on)].target);
        std::vector<double> apart;
        for (const std::uint32_t i : all) apart.push_back(std::abs(luminance_to_eye(p_.target[i]) - behind));
        const double least = dark * std::ranges::max(apart);
        std::vector<std::uint32_t> part(all.size(), none), last, next;  // places in `all`
        for (std::size_t n = 0; n < all.size(); ++n)
            if (apart[n] < least) part[n] = faint;
        const auto visit_near = [&](std::uint32_t place, const auto& visit) {
            cells_.visit_around(all[place], [&](std::size_t other) {
                const auto at = std::ranges::lower_bound(all, static_cast<std::uint32_t>(other));
                if (at != all.end() && *at == other) visit(static_cast<std::uint32_t>(at - all.begin()));
            });
        };
        std::uint32_t parts = 0;
        for (std::uint32_t first = 0; first < all.size(); ++first) {
            if (part[first] != none) continue;
            last.assign(1, first), part[first] = parts;
            for (std::size_t n = 0; n < last.size(); ++n)
                visit_near(last[n], [&](std::uint32_t other) {
                    if (part[other] == none) part[other] = parts, last.push_back(other);
                });
            ++parts;
        }
        if (parts == 1) return {all};
        last.clear();
        for (std::uint32_t n = 0; n < all.size(); ++n)
            if (part[n] != faint) last.push_back(n);
        for (; !last.empty(); std::swap(last, next)) {
            next.clear();
            for (const std::uint32_t n : last)
                visit_near(n, [&](std::uint32_t other) {
                    if (part[other] == faint) part[other] = part[n], next.push_back(other);
                });
        }
        std::vector<std::vector<std::uint32_t>> found(parts + 1);  // the last: what hangs together with none
        for (std::size_t n = 0; n < all.size(); ++n) found[std::min(part[n], parts)].push_back(all[n]);
        return found;
    }

    [[nodiscard]] Eigen::Vector3d vector_of(const std::array<float, 3>& v) const {
        return Eigen::Vector3f(v[0], v[1], v[2]).cast<double>();
    }

    /// False where it cannot be a letter.
    bool measure(Piece& piece, int on) const {
        constexpr std::size_t least_cells = 3;
        constexpr double differs = 0.12;  // Oklab's lightness: the faintest type that anybody sets
        constexpr double is_ground = 0.03, line_mm = 0.3, line_aspect = 12;
        const Eigen::Vector3d ground = seen_oklab(p_.seen.regions[std::size_t(on)].target);
        std::erase_if(piece.cells,
                      [&](std::uint32_t i) { return (seen_oklab(p_.target[i]) - ground).norm() < is_ground; });
        if (piece.cells.size() < least_cells) return false;
        const double behind = luminance_to_eye(p_.seen.regions[std::size_t(on)].target);
        std::vector<double> apart;  // in light, so that what a cell has of an edge counts by its share
        double differ = 0;
        Eigen::Vector3d normal = Eigen::Vector3d::Zero();
        for (const std::uint32_t i : piece.cells) {
            differ = std::max(differ, std::abs(seen_oklab(p_.target[i])[0] - ground[0]));
            apart.push_back(std::abs(luminance_to_eye(p_.target[i]) - behind));
            const double area = p_.predicted.surface.cells[i].area_mm2;
            normal += area * vector_of(p_.predicted.surface.cells[i].normal), piece.area_mm2 += area;
        }
        if (differ < differs || normal.norm() < 0.5 * piece.area_mm2) return false;
        lay_plane(piece, normal.normalized());
        measure_ink(piece, apart);
        return piece.narrowest() <= most_height_mm &&
               !(piece.narrowest() < line_mm && piece.widest() > line_aspect * piece.narrowest());
    }

    static void lay_plane(Piece& piece, const Eigen::Vector3d& normal) {
        constexpr double lies = 0.9;
        const Eigen::Vector3d upright =
            std::abs(normal.z()) < lies ? Eigen::Vector3d::UnitZ() : Eigen::Vector3d::UnitY();
        piece.up = (upright - upright.dot(normal) * normal).normalized();
        piece.right = piece.up.cross(normal);
    }

    void measure_ink(Piece& piece, const std::vector<double>& apart) const {
        const double most = std::ranges::max(apart);
        piece.cell_mm = std::sqrt(piece.area_mm2 / double(piece.cells.size()));
        const auto centre = [&](std::size_t n) {
            return vector_of(p_.predicted.surface.cells[piece.cells[n]].centre_mm);
        };
        for (std::size_t n = 0; n < apart.size(); ++n) {
            const double ink = apart[n] * double(p_.predicted.surface.cells[piece.cells[n]].area_mm2);
            piece.ink += ink, piece.middle += ink * centre(n);
        }
        piece.middle /= piece.ink;
        std::array<Eigen::Vector3d, all_directions> along;
        for (std::size_t k = 0; k < all_directions; ++k) along[k] = piece.along(k);
        piece.far.fill(-std::numeric_limits<double>::infinity());
        Eigen::Matrix2d moments = Eigen::Matrix2d::Identity() * (piece.cell_mm * piece.cell_mm / 12);
        for (std::size_t n = 0; n < apart.size(); ++n) {
            const Eigen::Vector3d from = centre(n) - piece.middle;
            const Eigen::Vector2d at(from.dot(piece.right), from.dot(piece.up));
            moments += apart[n] * double(p_.predicted.surface.cells[piece.cells[n]].area_mm2) / piece.ink * at *
                       at.transpose();
            // Cells that its edge only touches make it no larger.
            if (apart[n] < most / 2) continue;
            for (std::size_t k = 0; k < all_directions; ++k)
                piece.far[k] = std::max(piece.far[k], from.dot(along[k]) + piece.cell_mm / 2);
        }
        piece.solidity = piece.ink / most / (4 * std::numbers::pi * std::sqrt(moments.determinant()));
        piece.unruled = unruled(piece, apart);
    }

    /// How far it is from bars side by side: along a bar its ink lies the same way in every line.
    [[nodiscard]] double unruled(const Piece& piece, const std::vector<double>& apart) const {
        constexpr std::size_t half_turn = 48;
        struct Line {
            double ink = 0, along = 0, squares = 0;
        };
        std::vector<Eigen::Vector3d> from;  // ink, and where it lies
        for (std::size_t n = 0; n < apart.size(); ++n) {
            const Eigen::Vector3d at = vector_of(p_.predicted.surface.cells[piece.cells[n]].centre_mm) - piece.middle;
            from.emplace_back(apart[n] * double(p_.predicted.surface.cells[piece.cells[n]].area_mm2),
                              at.dot(piece.right), at.dot(piece.up));
        }
        const double half_mm = piece.widest();
        std::vector<Line> lines(std::size_t(2 * half_mm / piece.cell_mm) + 2);
        double least = std::numeric_limits<double>::infinity();
        for (std::size_t k = 0; k < half_turn; ++k) {
            const double angle = std::numbers::pi * double(k) / double(half_turn), c = std::cos(angle),
                         s = std::sin(angle);
            std::ranges::fill(lines, Line{});
            Line all;
            for (const Eigen::Vector3d& one : from) {
                const double along = c * one[1] + s * one[2], across = c * one[2] - s * one[1];
                const auto n = std::clamp(std::ptrdiff_t((across + half_mm) / piece.cell_mm), std::ptrdiff_t{0},
                                          std::ptrdiff_t(lines.size() - 1));
                for (Line* line : {&all, &lines[std::size_t(n)]})
                    line->ink += one[0], line->along += one[0] * along, line->squares += one[0] * along * along;
            }
            const auto spread = [](const Line& line) {
                const double mean = line.along / line.ink;
                return line.squares / line.ink - mean * mean;
            };
            const double mean = all.along / all.ink, whole = spread(all);
            if (!(whole > 0)) continue;
            double off = 0;
            for (const Line& line : lines) {
                if (!(line.ink > 0)) continue;
                const double aside = line.along / line.ink - mean;
                off += line.ink * (aside * aside + std::abs(spread(line) - whole));
            }
            least = std::min(least, off / (all.ink * whole));
        }
        return least;
    }

    const JobPrediction& p_;
    halftone::CellNeighbours cells_;
    std::vector<int> ground_;  ///< number of a flat region
};

struct Pair {
    std::uint32_t a, b;
};

/// Those that may be neighbours in a row of any direction.
std::vector<Pair> near_each_other(const std::vector<Piece>& pieces) {
    constexpr double one_side = 0.7;  // cosine of the angle between what two letters lie in
    std::vector<std::uint32_t> order(pieces.size());
    std::iota(order.begin(), order.end(), 0U);
    std::ranges::stable_sort(order, {}, [&](std::uint32_t i) { return pieces[i].middle.x(); });
    double most = 0;
    for (const Piece& piece : pieces) most = std::max(most, piece.widest());
    std::vector<std::vector<Pair>> found(pieces.size());
    parallel_for(0, order.size(), 16, [&](std::size_t n) {
        const Piece& one = pieces[order[n]];
        const double wide = one.widest(),
                     far = reach_heights * std::min(most_height_mm, alike_heights * wide) + (wide + most) / 2;
        for (std::size_t m = n + 1; m < order.size(); ++m) {
            const Piece& other = pieces[order[m]];
            const Eigen::Vector3d apart = other.middle - one.middle;
            if (apart.x() > far) break;
            const double height = std::min({most_height_mm, alike_heights * wide, alike_heights * other.widest()});
            if (apart.norm() <= reach_heights * height + (wide + other.widest()) / 2 &&
                one.right.cross(one.up).dot(other.right.cross(other.up)) > one_side)
                found[n].push_back({order[n], order[m]});
        }
    });
    std::vector<Pair> pairs;
    for (const auto& some : found) pairs.insert(pairs.end(), some.begin(), some.end());
    return pairs;
}

bool are_of_a_height(const Piece& a, const Piece& b, std::size_t k) {
    const double ratio = a.height(k) / b.height(k);
    return std::max(a.height(k), b.height(k)) <= most_height_mm && ratio <= alike_heights && ratio * alike_heights >= 1;
}

bool stand_on_one_line(const Piece& a, const Piece& b, std::size_t k) {
    constexpr double part = 0.125;
    const double high = std::max(a.height(k), b.height(k));
    const Eigen::Vector3d from = b.middle - a.middle;
    const std::size_t left = (k + quarter) % all_directions;
    const Eigen::Vector3d along = (a.along(k) + b.along(k)).normalized(),
                          across = (a.along(left) + b.along(left)).normalized();
    const double gap = std::abs(from.dot(along)) -
                       (from.dot(along) > 0 ? a.far[k] + b.width(k) - b.far[k] : b.far[k] + a.width(k) - a.far[k]);
    const double foot = from.dot(across) + b.foot(k) - a.foot(k), top = foot + b.height(k) - a.height(k);
    return gap <= reach_heights * high && gap > -std::min(a.width(k), b.width(k)) / 2 &&
           std::min(std::abs(foot), std::abs(top)) <= std::max(part * high, std::max(a.cell_mm, b.cell_mm));
}

double middle_of_all(std::vector<double>& values) {
    if (values.empty()) return 0;
    const auto middle = values.begin() + std::ptrdiff_t(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

/// Which of them stand as dots of a screen do: the way to the nearest is the same for a quarter of those that hang
/// together by being near, to a quarter of a cell. Letters are of many widths; what is large is told by its shape.
std::vector<char> in_lattices(const std::vector<Piece>& pieces, const std::vector<Pair>& pairs) {
    constexpr double same_way = 0.25, repeated = 0.25;
    constexpr std::size_t least = 10;
    Groups near(pieces.size());
    std::vector<Eigen::Vector3d> way(pieces.size(), Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity()));
    for (const Pair& pair : pairs) {
        near.join(pair.a, pair.b);
        Eigen::Vector3d to = pieces[pair.b].middle - pieces[pair.a].middle;
        if (std::pair(to.y(), to.x()) < std::pair(0.0, 0.0)) to = -to;
        for (const std::uint32_t i : {pair.a, pair.b})
            if (to.squaredNorm() < way[i].squaredNorm()) way[i] = to;
    }
    std::vector<std::vector<std::uint32_t>> members(pieces.size());
    for (std::uint32_t i = 0; i < pieces.size(); ++i) members[near.of(i)].push_back(i);
    std::vector<char> found(pieces.size());
    for (const std::vector<std::uint32_t>& group : members) {
        constexpr std::size_t samples = 100;
        std::size_t most = 0;
        for (std::size_t n = 0; n < group.size(); n += 1 + group.size() / samples)
            most = std::max(most, std::size_t(std::ranges::count_if(group, [&](std::uint32_t i) {
                                return (way[i] - way[group[n]]).norm() <= same_way * pieces[i].cell_mm;
                            })));
        std::vector<double> cells_wide;
        for (const std::uint32_t i : group) cells_wide.push_back(pieces[i].widest() / pieces[i].cell_mm);
        if (most >= least && double(most) >= repeated * double(group.size()) &&
            middle_of_all(cells_wide) < cells_to_tell)
            for (const std::uint32_t i : group) found[i] = 1;
    }
    return found;
}

/// What stands in rows along one direction.
class Rows {
public:
    Rows(const std::vector<Piece>& pieces, const std::vector<Pair>& pairs, const std::vector<char>& in_lattice,
         std::size_t k)
        : rows_(pieces.size()) {
        Groups near(pieces.size());
        std::vector<Pair> links;
        for (const Pair& pair : pairs) {
            if (!are_of_a_height(pieces[pair.a], pieces[pair.b], k)) continue;
            near.join(pair.a, pair.b);
            if (!stand_on_one_line(pieces[pair.a], pieces[pair.b], k)) continue;
            rows_.join(pair.a, pair.b);
            links.push_back(pair);
        }
        const std::vector<std::size_t> row_size = rows_.sizes();
        near_.resize(pieces.size()), in_row_.assign(pieces.size(), 0);
        of_near_.resize(pieces.size());
        for (std::size_t i = 0; i < pieces.size(); ++i) {
            Near& near_here = near_[of_near_[i] = near.of(i)];
            ++near_here.all;
            if (row_size[rows_.of(i)] < least_row) continue;
            in_row_[i] = 1, ++near_here.in_rows, near_here.in_lattice += in_lattice[i];
            if (pieces[i].height(k) >= cells_to_tell * pieces[i].cell_mm)
                near_here.solidity.push_back(pieces[i].solidity);
            if (pieces[i].widest() >= cells_to_tell * pieces[i].cell_mm) near_here.unruled.push_back(pieces[i].unruled);
        }
        for (const Pair& link : links) {
            const double a = pieces[link.a].ink, b = pieces[link.b].ink;
            if (!in_row_[link.a]) continue;
            Near& near_here = near_[near.of(link.a)];
            near_here.differ.push_back(std::abs(a - b) / (a + b));
        }
    }
    /// Share of what is near a piece that stands in rows; 0: it is no type.
    [[nodiscard]] double share(std::size_t i) {
        constexpr double enough = 0.6, least_differ = 0.03, filled = 0.75;
        constexpr double ruled = 0.19, ruled_few = 0.25, words_differ = 0.15, ruled_words = 0.115;
        Near& near = near_[of_near_[i]];
        if (!in_row_[i]) return 0;
        if (!near.is_type) {
            const double differ = middle_of_all(near.differ), bars = differ > words_differ             ? ruled_words
                                                                     : near.unruled.size() < least_row ? ruled_few
                                                                                                       : ruled;
            near.is_type = double(near.in_rows) >= enough * double(near.all) && differ >= least_differ &&
                           2 * near.in_lattice < near.in_rows &&
                           (near.solidity.empty() || middle_of_all(near.solidity) <= filled) &&
                           (near.unruled.empty() || middle_of_all(near.unruled) > bars);
        }
        return *near.is_type ? double(near.in_rows) / double(near.all) : 0;
    }
    [[nodiscard]] std::size_t row(std::size_t i) { return rows_.of(i); }
    [[nodiscard]] bool in_row(std::size_t i) const { return in_row_[i] != 0; }

private:
    struct Near {
        std::size_t all = 0, in_rows = 0, in_lattice = 0;
        std::vector<double> differ, solidity, unruled;
        std::optional<bool> is_type;
    };
    Groups rows_;
    std::vector<Near> near_;
    std::vector<std::size_t> of_near_;
    std::vector<char> in_row_;
};

}  // namespace

FoundType find_type(const JobPrediction& p) {
    constexpr double percentile = 0.8;
    FoundType found;
    std::vector<Piece> pieces;
    PieceFinder(p).find(pieces, found.others);
    const std::vector<Pair> pairs = near_each_other(pieces);
    const std::vector<char> in_lattice = in_lattices(pieces, pairs);
    std::vector<double> share(pieces.size()), line_mm(pieces.size());
    for (std::size_t k = 0; k < all_directions; ++k) {
        Rows rows(pieces, pairs, in_lattice, k);
        std::vector<std::vector<double>> heights(pieces.size());
        for (std::size_t i = 0; i < pieces.size(); ++i)
            if (rows.in_row(i)) heights[rows.row(i)].push_back(pieces[i].height(k));
        for (std::vector<double>& of_row : heights) std::ranges::sort(of_row);
        for (std::size_t i = 0; i < pieces.size(); ++i) {
            const double here = rows.share(i);
            if (here <= share[i]) continue;
            const std::vector<double>& of_row = heights[rows.row(i)];
            share[i] = here, line_mm[i] = of_row[std::size_t(percentile * double(of_row.size() - 1))];
        }
    }
    for (std::size_t i = 0; i < pieces.size(); ++i)
        if (share[i] > 0)
            found.letters.push_back({std::move(pieces[i].cells), pieces[i].area_mm2, line_mm[i]});
        else
            found.others.push_back(std::move(pieces[i].cells));
    return found;
}

}  // namespace voxtone::slicer
