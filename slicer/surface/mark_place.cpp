// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/surface/mark_place.h"

#include <array>
#include <cmath>
#include <optional>
#include <span>
#include <vector>

#include <fmt/core.h>

#include "base/error.h"
#include "slicer/options/option_words.h"
#include "slicer/surface/flat_place.h"

namespace voxtone::slicer {

namespace {

/// Of a picture, whichever way it lies, the front is its face.
Eigen::Vector3d out_of(MarkSide side, const std::optional<Eigen::Vector3d>& picture_faces) {
    if (picture_faces && side == MarkSide::front) return *picture_faces;
    if (picture_faces && side == MarkSide::back) return -*picture_faces;
    switch (side) {
        case MarkSide::front:
            return -Eigen::Vector3d::UnitY();
        case MarkSide::back:
            return Eigen::Vector3d::UnitY();
        case MarkSide::left:
            return -Eigen::Vector3d::UnitX();
        case MarkSide::right:
            return Eigen::Vector3d::UnitX();
        case MarkSide::bottom:
            return -Eigen::Vector3d::UnitZ();
        default:
            return Eigen::Vector3d::UnitZ();
    }
}

std::vector<Eigen::Vector3d> outs_of(const MarkOptions& mark, const MarkedBody& body) {
    const MarkSide side = std::get<MarkSide>(mark.place);
    if (side > MarkSide::flattest) return {out_of(side, body.picture_faces)};
    if (body.picture_faces) return {*body.picture_faces};
    return facing_directions(*body.solid);
}

/// How uneven a bottom may be, of a label's diagonal: a belly is, a slanting face has a place of its own. A choice: the
/// bundled cow's belly has place then at 30 mm, and a code on a slanting box keeps straight.
constexpr double curved_part = 0.1;

/// What is least seen first: of a picture its back, then its rim, and never its face; of a model the bottom, the back,
/// a side, and the rest where none of these is flat enough. Raised ones would lift the print, if they were below.
std::optional<MarkFrame> unseen_place(const MarkOptions& mark, const MarkedBody& body, const FlatQuery& query) {
    const Eigen::Vector3d x = Eigen::Vector3d::UnitX(), y = Eigen::Vector3d::UnitY(), z = Eigen::Vector3d::UnitZ();
    std::vector<std::vector<Eigen::Vector3d>> sides{{-z}, {y}, {-x, x}};
    if (const auto& face = body.picture_faces) {
        sides = {{-*face}, {}};
        constexpr double square = 0.5;
        for (const Eigen::Vector3d& out : {y, Eigen::Vector3d(-x), x, Eigen::Vector3d(-y), Eigen::Vector3d(-z), z})
            if (std::abs(out.dot(*face)) < square) sides.back().push_back(out);
    }
    if (mark.relief_voxels > 0)
        for (std::vector<Eigen::Vector3d>& side : sides)
            std::erase_if(side, [](const Eigen::Vector3d& out) { return out.z() < -0.5; });
    // What lies below, or on its face, has no side that is up.
    const std::span first(sides.data(), 1);
    FlatQuery across = query;
    across.turn_deg += 90;
    if (auto found = first_flat_place(*body.solid, first, query)) return found;
    if (auto found = first_flat_place(*body.solid, first, across)) return found;
    if (!body.picture_faces && !sides[0].empty())  // better curved below than flat where it is seen
        for (FlatQuery turned : {query, across}) {
            turned.most_uneven_mm = curved_part * std::hypot(query.width_mm, query.height_mm);
            if (auto found = flattest_place(*body.solid, sides[0], turned)) return found;
        }
    if (auto found = first_flat_place(*body.solid, sides, query); found || body.picture_faces) return found;
    return flattest_place(*body.solid, facing_directions(*body.solid), query);
}

std::optional<MarkFrame> find_place(const MarkOptions& mark, const MarkedBody& body, const FlatQuery& query) {
    if (std::get<MarkSide>(mark.place) == MarkSide::unseen) return unseen_place(mark, body, query);
    return flattest_place(*body.solid, outs_of(mark, body), query);
}

/// How much smaller it would have to be; 0: no size does.
template <class Fits>
double fitting_share(FlatQuery query, Fits&& fits) {
    const double width_mm = query.width_mm, height_mm = query.height_mm;
    for (double share = 0.9; share > 0.05; share *= 0.85) {
        query.width_mm = share * width_mm, query.height_mm = share * height_mm;
        if (fits(query)) return share;
    }
    return 0;
}

/// " on the back", by the side that it faces most; of a picture, and where the side was told, nothing.
std::string place_text(const MarkOptions& mark, const MarkedBody& body, const Eigen::Vector3d& out) {
    if (body.picture_faces || std::get<MarkSide>(mark.place) > MarkSide::flattest) return {};
    Eigen::Index axis = 0;
    out.cwiseAbs().maxCoeff(&axis);
    constexpr std::array<std::array<const char*, 2>, 3> names{
        {{"left", "right"}, {"front", "back"}, {"bottom", "top"}}};
    const bool is_high = out[axis] > 0, hidden = axis == 2 ? !is_high : axis == 1 && is_high;
    return fmt::format(" on the {}{}", names[std::size_t(axis)][is_high ? 1 : 0], hidden ? "" : ", in sight");
}

std::string no_place_text(const MarkOptions& mark, const MarkedBody& body) {
    const MarkSide side = std::get<MarkSide>(mark.place);
    if (side > MarkSide::flattest) return fmt::format("the {} has no face without steps or edges", name_of(side));
    if (body.picture_faces)
        return side == MarkSide::flattest ? "the picture is smaller" : "neither the picture's back nor its rim is";
    return "no side has a face without steps or edges";
}

[[noreturn]] void refuse_size(const MarkOptions& mark, const MarkShape& shape, const MarkedBody& body,
                              const FlatQuery& query) {
    std::optional<MarkFrame> place;
    const double share = fitting_share(query, [&](const FlatQuery& smaller) {
        const std::optional<MarkFrame> found = find_place(mark, body, smaller);
        if (found) place = found;  // the last that fits is the largest
        return found.has_value();
    });
    const bool is_code = shape.module_mm > 0;
    std::string remedy = "make it smaller,";
    if (is_code && share * shape.module_mm < least_module_mm)
        remedy = fmt::format("what would fit no scanner reads, for it needs size={:.1f}mm; print the part larger,",
                             std::ceil(10 * mark.size_mm * least_module_mm / shape.module_mm) / 10);
    else if (share > 0)
        remedy =
            fmt::format("size={:.2f}mm would fit{}{},", mark.size_mm * share, place_text(mark, body, place->axes.out),
                        !is_code && mark.size_mm * share < least_type_mm ? ", if too small to be read" : "");
    throw InputError(fmt::format(
        "{}: is {:.1f} x {:.1f} mm{}, and {} of that size: {}{} or name another place (place=...)", mark.said,
        query.width_mm, query.height_mm, is_code ? " with the quiet zone around it" : "", no_place_text(mark, body),
        remedy,
        mark.kind == MarkKind::text && mark.text.find('\n') == std::string::npos ? " break it into lines (\\n)," : ""));
}

/// In the middle of the body's box as seen from there, and above all of it.
MarkFrame middle_of_side(const MarkOptions& mark, const MarkedBody& body, double width_mm, double height_mm) {
    const MarkAxes axes = axes_facing(out_of(std::get<MarkSide>(mark.place), body.picture_faces));
    Eigen::AlignedBox3d box;
    for (const Eigen::Vector3d& p : body.solid->positions_mm)
        box.extend(Eigen::Vector3d(axes.right.dot(p), axes.up.dot(p), axes.out.dot(p)));
    Eigen::Vector3d seen = box.center();
    seen.z() = box.max().z();
    seen.head<2>() += mark.at_mm.value_or(Eigen::Vector2d::Zero());
    const Eigen::Vector3d middle = seen.x() * axes.right + seen.y() * axes.up + seen.z() * axes.out;
    return MarkFrame::around(middle, axes.turned(mark.turn_deg), width_mm, height_mm);
}

/// On the surface that is nearest to the point, facing as it does on average as far as the mark reaches.
MarkFrame frame_at_point(const MarkOptions& mark, const SolidIndex& body, double width_mm, double height_mm) {
    const Eigen::Vector3d point = std::get<Eigen::Vector3d>(mark.place);
    const TriangleTree::Nearest nearest = body.tree().nearest(point);
    const auto area = [&](std::uint32_t t) -> Eigen::Vector3d {
        const auto [a, b, c] = body.tree().corners(t);
        return 0.5 * (b - a).cross(c - a);
    };
    const Eigen::Vector3d here = area(nearest.triangle).normalized();
    const Eigen::Vector3d reach = Eigen::Vector3d::Constant(std::hypot(width_mm, height_mm) / 2);
    std::vector<std::uint32_t> around;
    body.tree().overlapping(nearest.point - reach, nearest.point + reach, around);
    Eigen::Vector3d sum = here * 1e-9;
    constexpr double same_face = 0.5;
    for (const std::uint32_t t : around) {
        const Eigen::Vector3d normal = area(t);
        if (normal.normalized().dot(here) > same_face) sum += normal;
    }
    return MarkFrame::around(nearest.point, axes_facing(sum).turned(mark.turn_deg), width_mm, height_mm);
}

}  // namespace

MarkFrame place_of_mark(const MarkOptions& mark, const MarkShape& shape, const MarkedBody& body,
                        std::span<const MarkFrame> taken) {
    const double width_mm = shape.width_mm, height_mm = shape.height_mm;
    if (std::holds_alternative<Eigen::Vector3d>(mark.place))
        return frame_at_point(mark, body.solid, width_mm, height_mm);
    const bool on_a_side = std::get<MarkSide>(mark.place) > MarkSide::flattest;
    if (on_a_side && (mark.at_mm || mark.kind == MarkKind::picture))
        return middle_of_side(mark, body, width_mm, height_mm);
    const FlatQuery query{.width_mm = width_mm, .height_mm = height_mm, .turn_deg = mark.turn_deg, .taken = taken};
    const auto found = find_place(mark, body, query);
    if (!found) refuse_size(mark, shape, body, query);
    return *found;
}

double share_that_fits_below(const MarkedBody& body, double width_mm, double height_mm, double turn_deg,
                             std::span<const MarkFrame> taken) {
    const std::vector<Eigen::Vector3d> below{-Eigen::Vector3d::UnitZ()};
    const FlatQuery whole{.width_mm = width_mm, .height_mm = height_mm, .turn_deg = turn_deg, .taken = taken};
    return fitting_share(whole, [&](FlatQuery smaller) {
        smaller.most_uneven_mm = curved_part * std::hypot(smaller.width_mm, smaller.height_mm);
        return flattest_place(*body.solid, below, smaller).has_value();
    });
}

}  // namespace voxtone::slicer
