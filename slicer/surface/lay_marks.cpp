// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/surface/lay_marks.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include <fmt/core.h>

#include "base/error.h"
#include "base/warning.h"
#include "io/pictures/texture.h"
#include "optics/colour/colour.h"
#include "slicer/options/option_words.h"
#include "slicer/surface/mark_place.h"
#include "slicer/surface/mark_shape.h"
#include "slicer/surface/seen_depth.h"
#include "slicer/surface/surface_colour.h"

namespace voxtone::slicer {

namespace {

/// Of the map of what hides what: about a voxel's width.
constexpr double depth_spacing_mm = 0.05;

/// A point of the coloured surface below a mark.
struct Below {
    Eigen::Vector3d point, normal;
    std::uint32_t source;  ///< triangle of the textured mesh
    Eigen::Vector2f uv;    ///< in it
    bool found = false;
};

/// What the mark meets at a place of its rectangle.
Below below(const io::Decal& decal, const BodyToMark& body, double along, double up) {
    const float depth = decal.first_hit.deepest_near(float(along), float(up));
    if (!std::isfinite(depth)) return {};
    const Eigen::Vector3d hit = decal.corner_mm + decal.right * (along * decal.width_mm) +
                                decal.up * (up * decal.height_mm) - decal.out * double(depth);
    const TriangleTree& tree = body.surface.tree();
    const TriangleTree::Nearest nearest = tree.nearest(hit);
    if (nearest.triangle == TriangleTree::none || nearest.distance > 2 * decal.slack_mm) return {};
    const auto [a, b, c] = tree.corners(nearest.triangle);
    const Eigen::Vector3f weight = nearest_weights(nearest.point, a, b, c).cast<float>();
    const auto& uv = body.surface->source_uv[nearest.triangle];
    return {nearest.point, (b - a).cross(c - a).normalized(), body.surface->source_triangle[nearest.triangle],
            weight[0] * uv[0] + weight[1] * uv[1] + weight[2] * uv[2], true};
}

Eigen::Vector3d normal_of(const io::TexturedMesh& mesh, std::size_t t) {
    const auto& [a, b, c] = mesh.triangles[t];
    return (mesh.positions[b] - mesh.positions[a]).cross(mesh.positions[c] - mesh.positions[a]);
}

Eigen::Vector3d face_of_picture(const io::TexturedMesh& mesh) { return normal_of(mesh, 0).normalized(); }

/// The largest triangle of a picture's slab that faces there, but none of its face.
std::optional<std::uint32_t> plain_triangle(const io::TexturedMesh& mesh, const Eigen::Vector3d& out) {
    constexpr double same = 0.99;
    std::optional<std::uint32_t> largest;
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
        const Eigen::Vector3d normal = normal_of(mesh, t);
        if (mesh.material_of_triangle[t] == 0 || !(normal.dot(out) > same * normal.norm())) continue;
        if (!largest || normal.norm() > normal_of(mesh, *largest).norm()) largest = t;
    }
    return largest;
}

/// Where marks lie on the back or the rim of a picture, these take colour as its face does.
void colour_below(const MarkFrame& frame, const BodyToMark& body) {
    const std::optional<std::uint32_t> source = plain_triangle(body.mesh, frame.axes.out);
    if (!source) return;
    const auto& [ia, ib, ic] = body.mesh.triangles[*source];
    const Eigen::Vector3d &a = body.mesh.positions[ia], &b = body.mesh.positions[ib], &c = body.mesh.positions[ic];
    const Eigen::Vector3d normal = (b - a).cross(c - a);
    VisibleSurface surface = *body.surface;
    const auto first = static_cast<std::uint32_t>(surface.positions_mm.size());
    std::array<Eigen::Vector2f, 4> uv;
    for (std::size_t corner = 0; corner < uv.size(); ++corner) {
        Eigen::Vector3d p = frame.at(corner % 2 == 0 ? 0 : frame.width_mm, corner < 2 ? 0 : frame.height_mm);
        p -= frame.axes.out * (normal.dot(p - a) / normal.dot(frame.axes.out));
        uv[corner] = {float((p - a).cross(c - a).dot(normal) / normal.squaredNorm()),
                      float((b - a).cross(p - a).dot(normal) / normal.squaredNorm())};
        surface.positions_mm.push_back(p);
    }
    for (const std::array<std::uint32_t, 3>& t : {std::array{0u, 1u, 3u}, std::array{0u, 3u, 2u}}) {
        surface.triangles.push_back({first + t[0], first + t[1], first + t[2]});
        surface.source_triangle.push_back(*source);
        surface.source_uv.push_back({uv[t[0]], uv[t[1]], uv[t[2]]});
    }
    body.surface = SurfaceIndex(std::move(surface));
}

struct Landing {
    double covered = 0;    ///< share of its ink that lies on the surface
    double luminance = 0;  ///< mean of what lies below it, linear
};

/// By points all over the rectangle.
Landing landing_of(const io::Decal& decal, const MarkShape& shape, const BodyToMark& body) {
    constexpr int points = 64;
    const SurfaceColour colour(body.mesh, decal.width_mm / points);
    const bool any_ink = shape.pixels != nullptr;
    double ink = 0, on_body = 0, light = 0, seen = 0;
    for (int j = 0; j < points; ++j)
        for (int i = 0; i < points; ++i) {
            const double along = (i + 0.5) / points, up = (j + 0.5) / points;
            const Below at = below(decal, body, along, up);
            const bool lies = at.found && std::abs(at.normal.dot(decal.out)) >= io::Decal::least_cos;
            const double weight =
                any_ink ? shape.ink.at(int(along * shape.ink.width_px), int((1 - up) * shape.ink.height_px)) / 255.0
                        : 1.0;
            ink += weight;
            if (!lies) continue;
            on_body += weight;
            seen += 1;
            light += double(Eigen::Vector3f(0.2126f, 0.7152f, 0.0722f).dot(colour.at(at.source, at.uv.x(), at.uv.y())));
        }
    return {ink > 0 ? on_body / ink : 0, seen > 0 ? light / seen : 1};
}

/// Black, where the ground is lighter than halfway between black and white as they are seen (L* 50), else white.
Eigen::Vector3f contrast_to(double luminance) {
    constexpr double halfway = 0.1842;  // CIE 15: L* = 116 Y^(1/3) - 16
    return luminance > halfway ? Eigen::Vector3f::Zero() : Eigen::Vector3f::Ones();
}

double luminance_of(const Eigen::Vector3f& rgb) { return double(Eigen::Vector3f(0.2126f, 0.7152f, 0.0722f).dot(rgb)); }

void expect_on_body(const MarkOptions& mark, const MarkShape& shape, const Landing& landing) {
    constexpr double all = 0.99, nothing = 1e-9;
    if (landing.covered <= nothing)
        throw InputError(
            fmt::format("{}: hits nothing: where it lies there is no surface that could take colour; move "
                        "it (at=right,up in mm), or name another place (place=...)",
                        mark.said));
    if (mark.kind != MarkKind::picture && landing.covered < all)
        throw InputError(
            fmt::format("{}: is {:.1f} x {:.1f} mm, and {:.0f} % of that lie beside the face that it was "
                        "put on: make it smaller (size=...), move it (at=right,up in mm) or let it find "
                        "its place (place=flattest)",
                        mark.said, shape.width_mm, shape.height_mm, 100 * (1 - landing.covered)));
}

std::string side_text(const Eigen::Vector3d& out) {
    constexpr double square = 0.99;
    const std::array<std::string_view, 6> names{"right", "left", "back", "front", "top", "bottom"};
    for (int axis = 0; axis < 3; ++axis)
        if (std::abs(out[axis]) > square)
            return fmt::format("on the {}", names[std::size_t(2 * axis) + (out[axis] > 0 ? 0 : 1)]);
    return fmt::format("facing ({:.2f}, {:.2f}, {:.2f})", out.x(), out.y(), out.z());
}

/// Of a picture that lies on its back.
std::string picture_side_text(const Eigen::Vector3d& out) {
    if (std::abs(out.z()) > 0.5) return out.z() > 0 ? "on the picture" : "on the back of the picture";
    if (std::abs(out.x()) > std::abs(out.y())) return out.x() < 0 ? "on its left rim" : "on its right rim";
    return out.y() > 0 ? "on its upper rim" : "on its lower rim";
}

/// Where a mark lies, as a person would look for it.
std::string where_text(const io::Decal& decal, const BodyToMark& body) {
    const Eigen::Vector3d middle =
        decal.corner_mm + decal.right * (decal.width_mm / 2) + decal.up * (decal.height_mm / 2);
    if (!body.is_picture || face_of_picture(body.mesh).z() < 0.99)
        return fmt::format("{}, its middle at {:.1f}, {:.1f}, {:.1f} mm", side_text(decal.out), middle.x(), middle.y(),
                           middle.z());
    return fmt::format("{}, its middle {:.1f} mm from the picture's left edge and {:.1f} mm up",
                       picture_side_text(decal.out), middle.x(), middle.y());
}

std::string place_text(const MarkOptions& mark, const io::Decal& decal, const Landing& landing,
                       const Eigen::Vector3f& ink, const BodyToMark& body) {
    std::string text =
        fmt::format("{}: {:.1f} x {:.1f} mm {}", mark.said, decal.width_mm, decal.height_mm, where_text(decal, body));
    if (mark.ink == MarkInk::contrast && mark.kind != MarkKind::picture)
        text += ink.x() > 0.5f ? ", in white" : ", in black";
    if (landing.covered < 0.995) text += fmt::format("; {:.0f} % of it lie on the model", 100 * landing.covered);
    return text;
}

/// Fits into the rectangle, in its middle, as wide as high as it is, where texels are square.
io::Decal decal_by_uv(const UvRectangle& uv, const MarkShape& shape, const io::TexturedMesh& mesh) {
    double aspect = 1;
    for (const io::SurfaceMaterial& material : mesh.materials)
        if (material.texture) aspect = double(material.texture->height_px()) / material.texture->width_px();
    const double ratio = shape.height_mm / (shape.width_mm * aspect);  // in texture coordinates
    io::Decal decal;
    decal.by_uv = true;
    decal.width_mm = std::min(uv.right - uv.left, (uv.top - uv.bottom) / ratio);
    decal.height_mm = decal.width_mm * ratio;
    decal.corner_mm = {(uv.left + uv.right - decal.width_mm) / 2, (uv.bottom + uv.top - decal.height_mm) / 2, 0};
    return decal;
}

/// Mean of what lies in the rectangle, by the middles of triangles and their corners.
Landing landing_by_uv(const io::Decal& decal, const BodyToMark& body) {
    const SurfaceColour colour(body.mesh, 0.1);
    double light = 0, seen = 0;
    for (std::size_t t = 0; t < body.mesh.triangles.size() && !body.mesh.corner_uv.empty(); ++t) {
        constexpr int steps = 8;
        const auto& uv = body.mesh.corner_uv[t];
        for (int i = 0; i <= steps; ++i)
            for (int j = 0; i + j <= steps; ++j) {
                const float u = float(i) / steps, v = float(j) / steps;
                const Eigen::Vector2f place = (1 - u - v) * uv[0] + u * uv[1] + v * uv[2];
                if (place.x() < decal.corner_mm.x() || place.x() > decal.corner_mm.x() + decal.width_mm ||
                    place.y() < decal.corner_mm.y() || place.y() > decal.corner_mm.y() + decal.height_mm)
                    continue;
                light += luminance_of(colour.at(std::uint32_t(t), u, v));
                seen += 1;
            }
    }
    return {seen > 0 ? 1.0 : 0.0, seen > 0 ? light / seen : 1};
}

io::Decal decal_in(const MarkFrame& frame, const SolidMesh& body) {
    io::Decal decal;
    decal.width_mm = frame.width_mm;
    decal.height_mm = frame.height_mm;
    decal.corner_mm = frame.corner_mm;
    decal.right = frame.axes.right;
    decal.up = frame.axes.up;
    decal.out = frame.axes.out;
    decal.first_hit = depth_below(frame, body, depth_spacing_mm);
    return decal;
}

/// A label that was told no place, and found none below or behind; empty: none of these.
std::string in_sight_text(const MarkOptions& mark, const MarkedBody& body, const io::Decal& decal,
                          std::span<const MarkFrame> taken) {
    constexpr double square = 0.5, least_mm = 1;  // what is smaller nobody reads
    const MarkSide* const side = std::get_if<MarkSide>(&mark.place);
    if (!side || *side != MarkSide::unseen || body.picture_faces) return {};
    if (decal.out.z() < -square || decal.out.y() > square) return {};
    std::string text =
        fmt::format("{}: lies {}, where it is seen: neither bottom nor back has a face of {:.1f} x {:.1f} mm",
                    mark.said, side_text(decal.out), decal.width_mm, decal.height_mm);
    if (mark.relief_voxels > 0) return text;
    const auto size = [&](double turn) {
        return mark.size_mm * share_that_fits_below(body, decal.width_mm, decal.height_mm, mark.turn_deg + turn, taken);
    };
    const double upright = size(0), across = size(90), best = std::max(upright, across);
    if (best >= least_mm)
        text += fmt::format("; \"size={:.2f}mm; place=bottom{}\" fits", best,
                            across > upright ? fmt::format("; turn={:g}", mark.turn_deg + 90) : "");
    return text;
}

void lay_mark(const MarkOptions& mark, const BodyToMark& body, const io::ReadOptions& reading,
              std::vector<MarkFrame>& taken, LaidMarks& laid) {
    const MarkShape shape = shape_of(mark, reading, body.pitch_mm);
    laid.warnings.insert(laid.warnings.end(), shape.warnings.begin(), shape.warnings.end());
    laid.notes.insert(laid.notes.end(), shape.notes.begin(), shape.notes.end());
    const UvRectangle* const uv = std::get_if<UvRectangle>(&mark.place);
    io::Decal decal;
    if (uv) {
        decal = decal_by_uv(*uv, shape, body.mesh);
    } else {
        MarkedBody marked{body.solid};
        if (body.is_picture) marked.picture_faces = face_of_picture(body.mesh);
        const MarkFrame frame = place_of_mark(mark, shape, marked, taken);
        decal = decal_in(frame, *body.solid);
        if (std::string seen = in_sight_text(mark, marked, decal, taken); !seen.empty())
            laid.warnings.push_back(named_warning("label-in-sight", std::move(seen)));
        if (body.is_picture) colour_below(frame, body);
        taken.push_back(frame);
    }
    const Landing landing = uv ? landing_by_uv(decal, body) : landing_of(decal, shape, body);
    expect_on_body(mark, shape, landing);
    const Eigen::Vector3f ink = mark.ink == MarkInk::contrast
                                    ? contrast_to(mark.ground_rgb ? luminance_of(*mark.ground_rgb) : landing.luminance)
                                    : mark.ink_rgb;
    decal.picture = coloured(shape, mark.ink == MarkInk::none ? nullptr : &ink, mark.ground_rgb);
    laid.notes.push_back(uv ? fmt::format("{}: in the rectangle of the texture", mark.said)
                            : place_text(mark, decal, landing, ink, body));
    if (mark.relief_voxels != 0 && !uv)
        laid.embossed.push_back({taken.back(), decal.first_hit, shape.ink, mark.relief_voxels});
    body.mesh.decals.push_back(std::move(decal));
}

}  // namespace

LaidMarks lay_marks(const std::vector<MarkOptions>& marks, const BodyToMark& body, const io::ReadOptions& reading) {
    LaidMarks laid;
    std::vector<MarkFrame> taken;
    for (const MarkOptions& mark : marks) lay_mark(mark, body, reading, taken, laid);
    return laid;
}

}  // namespace voxtone::slicer
