// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/scenes/vrml_shapes.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>
#include <Eigen/Geometry>

#include "base/error.h"

namespace voxtone::io {

namespace {

constexpr int round_segments = 96;  // of a circle
constexpr double no_index = -1;

class VrmlShape {
public:
    VrmlShape(const VrmlScene& scene, const VrmlNode& node, const std::string& file)
        : scene_(scene), node_(node), file_(file), clockwise_(node.number("ccw", 1) == 0) {}

    VrmlFaces faces() {
        if (node_.type == "IndexedFaceSet")
            indexed();
        else if (node_.type == "ElevationGrid")
            grid();
        else if (node_.type == "Box")
            box();
        else if (node_.type == "Sphere")
            sphere();
        else
            cylinder_or_cone();
        return std::move(made_);
    }

private:
    [[noreturn]] void fail(const std::string& what) const {
        throw InputError(
            fmt::format("{}, line {}: {}; the VRML file is damaged, export it again", file_, node_.line, what));
    }

    // ---- faces of any shape

    void take_lists() {
        made_.uv = tuples<Eigen::Vector2f>("texCoord", "point");
        made_.colours = tuples<Eigen::Vector3f>("color", "color");
    }

    /// The numbers of a field's node, some at a time. Were one left over, all behind a mistake would be shifted.
    template <class Vector>
    [[nodiscard]] std::vector<Vector> tuples(const char* field, const char* of_it) const {
        std::vector<Vector> all;
        const VrmlNode* const inner = scene_.node(node_, field);
        if (!inner) return all;
        const std::vector<double>& numbers = inner->numbers(of_it);
        constexpr auto size = static_cast<std::size_t>(Vector::SizeAtCompileTime);
        if (numbers.size() % size != 0)
            fail(
                fmt::format("its {} has {} numbers, which are no {} each (a comma stands between numbers here, and a "
                            "point within one)",
                            field, numbers.size(), size == 2 ? "two" : "three"));
        for (std::size_t i = 0; i < numbers.size(); i += size)
            all.push_back(Eigen::Map<const Eigen::Matrix<double, Vector::SizeAtCompileTime, 1>>(numbers.data() + i)
                              .template cast<typename Vector::Scalar>());
        return all;
    }

    /// One of a list of `size`; -1 where it has none.
    static std::int32_t index(double number, std::size_t size) {
        return number >= 0 && number < static_cast<double>(size) ? static_cast<std::int32_t>(number) : -1;
    }

    void indexed() {
        take_lists();
        made_.points = tuples<Eigen::Vector3d>("coord", "point");
        const std::vector<double>&places = node_.numbers("coordIndex"), &uv = node_.numbers("texCoordIndex"),
              &colours = node_.numbers("colorIndex");
        const bool laid = !made_.uv.empty();
        if (!laid) lay_by_bounds();
        const bool per_vertex = node_.number("colorPerVertex", 1) != 0 && !has_colours_of_faces(places, colours);
        std::vector<VrmlCorner> polygon;
        std::size_t face = 0;
        for (std::size_t k = 0; k <= places.size(); ++k) {
            if (k == places.size() || places[k] < 0) {
                if (!polygon.empty()) ++face;
                add(polygon);
                polygon.clear();
                continue;
            }
            const auto at = [&](const std::vector<double>& list, std::size_t i, double otherwise) {
                return list.empty() ? otherwise : i < list.size() ? list[i] : no_index;
            };
            const std::int32_t point = index(places[k], made_.points.size());
            if (point < 0)
                fail(fmt::format("a face uses point {}, but there are only {}", places[k], made_.points.size()));
            const double colour = per_vertex ? at(colours, k, places[k]) : at(colours, face, static_cast<double>(face));
            polygon.push_back({point, index(laid ? at(uv, k, places[k]) : places[k], made_.uv.size()),
                               index(colour, made_.colours.size())});
        }
    }

    /// VTK writes colours of faces as if they were those of vertices: where there are as many as faces, and too few for
    /// the vertices.
    bool has_colours_of_faces(const std::vector<double>& places, const std::vector<double>& colours) {
        if (made_.colours.empty() || !colours.empty() || places.empty()) return false;
        const auto faces = std::ranges::count_if(places, [](double k) { return k < 0; }) + (places.back() >= 0);
        made_.by_count = static_cast<std::size_t>(faces) == made_.colours.size() &&
                         std::ranges::max(places) >= static_cast<double>(faces) &&
                         node_.number("colorPerVertex", 1) != 0;
        return made_.by_count;
    }

    /// Clause 6.23: S along the longest side, T along the next, both by the length of the longest.
    void lay_by_bounds() {
        if (made_.points.empty()) return;
        Eigen::AlignedBox3d bounds;
        for (const Eigen::Vector3d& point : made_.points) bounds.extend(point);
        const Eigen::Vector3d size = bounds.sizes();
        std::array<Eigen::Index, 3> axes{0, 1, 2};
        std::stable_sort(axes.begin(), axes.end(), [&](auto a, auto b) { return size[a] > size[b]; });
        const double length = size[axes[0]] > 0 ? size[axes[0]] : 1;
        for (const Eigen::Vector3d& point : made_.points) {
            const Eigen::Vector3d part = (point - bounds.min()) / length;
            made_.uv.emplace_back(static_cast<float>(part[axes[0]]), static_cast<float>(part[axes[1]]));
        }
    }

    void add(std::vector<VrmlCorner>& polygon) {
        if (polygon.size() < 3) {
            made_.thin += !polygon.empty();
            return;
        }
        if (clockwise_) std::reverse(polygon.begin(), polygon.end());
        for (const VrmlCorner& corner : polygon) {
            made_.unlaid += corner.uv < 0;
            made_.uncoloured += corner.colour < 0 && !made_.colours.empty();
        }
        made_.corners.insert(made_.corners.end(), polygon.begin(), polygon.end());
        made_.ends.push_back(made_.corners.size());
    }

    void grid() {
        take_lists();
        const double wide = node_.number("xDimension", 0), deep = node_.number("zDimension", 0);
        const std::vector<double>& height = node_.numbers("height");
        const auto given = static_cast<double>(height.size());
        if (!(wide >= 0 && deep >= 0 && std::max({wide, deep, wide * deep}) <= given))
            fail(fmt::format("a grid of {} x {} has {} heights", wide, deep, height.size()));
        const auto columns = static_cast<std::size_t>(wide), rows = static_cast<std::size_t>(deep);
        const bool laid = !made_.uv.empty(), per_vertex = node_.number("colorPerVertex", 1) != 0;
        for (std::size_t k = 0; k < columns * rows; ++k) {
            const auto x = static_cast<double>(k % columns), z = static_cast<double>(k / columns);
            made_.points.emplace_back(x * node_.number("xSpacing", 1), height[k], z * node_.number("zSpacing", 1));
            if (!laid)
                made_.uv.emplace_back(static_cast<float>(x / std::max(wide - 1, 1.0)),
                                      static_cast<float>(z / std::max(deep - 1, 1.0)));
        }
        for (std::size_t z = 0; z + 1 < rows; ++z)
            for (std::size_t x = 0; x + 1 < columns; ++x) {
                const std::size_t k = z * columns + x, face = z * (columns - 1) + x;
                std::vector<VrmlCorner> square;
                for (const std::size_t corner : {k, k + columns, k + columns + 1, k + 1}) {
                    const auto point = static_cast<double>(corner);
                    square.push_back({static_cast<std::int32_t>(corner), index(point, made_.uv.size()),
                                      index(per_vertex ? point : static_cast<double>(face), made_.colours.size())});
                }
                add(square);
            }
    }

    // ---- simple shapes

    [[nodiscard]] double length(const char* field, double otherwise) const {
        const double value = node_.number(field, otherwise);
        if (!(value > 0)) fail(fmt::format("the {} of a {} is {}", field, node_.type, value));
        return value;
    }

    /// A corner of its own, laid at (u, v).
    VrmlCorner corner(const Eigen::Vector3d& point, double u, double v) {
        made_.points.push_back(point);
        made_.uv.emplace_back(static_cast<float>(u), static_cast<float>(v));
        const auto last = static_cast<std::int32_t>(made_.points.size() - 1);
        return {last, last, -1};
    }

    /// Each side shows the whole picture; the upper side with its top at -z, the lower with its top at +z.
    void box() {
        Eigen::Vector3d half(1, 1, 1);
        const std::vector<double>& size = node_.numbers("size");
        for (std::size_t i = 0; i < 3 && i < size.size(); ++i) half[static_cast<Eigen::Index>(i)] = size[i] / 2;
        if (!(half.minCoeff() > 0)) fail("a Box has no size");
        using V = Eigen::Vector3d;
        const std::array<std::array<V, 2>, 6> sides{{{V::UnitX(), V::UnitY()},
                                                     {-V::UnitX(), V::UnitY()},
                                                     {-V::UnitZ(), V::UnitY()},
                                                     {V::UnitZ(), V::UnitY()},
                                                     {V::UnitX(), -V::UnitZ()},
                                                     {V::UnitX(), V::UnitZ()}}};
        for (const auto& [right, up] : sides) {
            std::vector<VrmlCorner> square;
            for (const auto& [u, v] :
                 {std::array{0.0, 0.0}, std::array{1.0, 0.0}, std::array{1.0, 1.0}, std::array{0.0, 1.0}}) {
                const V place = right.cross(up) + (2 * u - 1) * right + (2 * v - 1) * up;
                square.push_back(corner(half.cwiseProduct(place), u, v));
            }
            add(square);
        }
    }

    /// At a share of the way round, which begins at the back (-z) and runs counterclockwise as seen from above.
    static Eigen::Vector3d on_circle(double radius, double y, int step) {
        if (radius == 0) return {0, y, 0};
        const double turn = 2 * std::numbers::pi * (step % round_segments) / round_segments;
        return {-radius * std::sin(turn), y, -radius * std::cos(turn)};
    }

    /// Between two circles, one above the other; either may be a point.
    void ring(double below, double y0, double v0, double above, double y1, double v1) {
        for (int i = 0; i < round_segments; ++i) {
            const double u0 = double(i) / round_segments, u1 = double(i + 1) / round_segments, middle = (u0 + u1) / 2;
            std::vector<VrmlCorner> face;
            if (below > 0) face.push_back(corner(on_circle(below, y0, i), u0, v0));
            face.push_back(corner(on_circle(below, y0, i + 1), below > 0 ? u1 : middle, v0));
            if (above > 0) face.push_back(corner(on_circle(above, y1, i + 1), u1, v1));
            face.push_back(corner(on_circle(above, y1, i), above > 0 ? u0 : middle, v1));
            add(face);
        }
    }

    /// A circle cut out of the picture: the upper side with its top at -z, the lower with its top at +z.
    void cap(double radius, double y, bool upper) {
        std::vector<VrmlCorner> disc;
        for (int i = 0; i < round_segments; ++i) {
            const Eigen::Vector3d place = on_circle(radius, y, upper ? i : round_segments - i);
            const double v = (upper ? -place.z() : place.z()) / radius;
            disc.push_back(corner(place, (place.x() / radius + 1) / 2, (v + 1) / 2));
        }
        add(disc);
    }

    void sphere() {
        const double radius = length("radius", 1);
        constexpr int bands = round_segments / 2;
        for (int band = 0; band < bands; ++band) {
            const auto at = [&](int step) {
                const double turn = std::numbers::pi * step / bands;
                return std::array{step % bands ? radius * std::sin(turn) : 0.0, -radius * std::cos(turn),
                                  double(step) / bands};
            };
            const auto [r0, y0, v0] = at(band);
            const auto [r1, y1, v1] = at(band + 1);
            ring(r0, y0, v0, r1, y1, v1);
        }
    }

    void cylinder_or_cone() {
        const bool cone = node_.type == "Cone";
        const double radius = length(cone ? "bottomRadius" : "radius", 1), half = length("height", 2) / 2;
        if (node_.number("side", 1) != 0) ring(radius, -half, 0, cone ? 0 : radius, half, 1);
        if (node_.number("bottom", 1) != 0) cap(radius, -half, false);
        if (!cone && node_.number("top", 1) != 0) cap(radius, half, true);
    }

    const VrmlScene& scene_;
    const VrmlNode& node_;
    const std::string& file_;
    const bool clockwise_;
    VrmlFaces made_;
};

}  // namespace

bool is_vrml_shape(std::string_view type) {
    return type == "IndexedFaceSet" || type == "ElevationGrid" || type == "Box" || type == "Sphere" ||
           type == "Cylinder" || type == "Cone";
}

VrmlFaces vrml_faces(const VrmlScene& scene, const VrmlNode& geometry, const std::string& file) {
    return VrmlShape(scene, geometry, file).faces();
}

}  // namespace voxtone::io
