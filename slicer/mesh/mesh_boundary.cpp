// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/mesh/mesh_boundary.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#if __has_include(<embree4/rtcore.h>)
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

#include <Eigen/Geometry>

#include "base/contracts.h"
#include "base/error.h"
#include "slicer/mesh/triangle_tree.h"

namespace voxtone::slicer {
namespace {

constexpr auto off_the_start = static_cast<float>(optics::off_the_start_mm);
constexpr double far_away = 1e4;  // mm

using Eigen::Vector3d;
using Eigen::Vector3f;
using Triangle = std::array<std::uint32_t, 3>;

/// Embree 4 wants no context of a plain ray.
void intersect(RTCScene scene, RTCRayHit& ray) {
#if RTC_VERSION_MAJOR >= 4
    rtcIntersect1(scene, &ray);
#else
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcIntersect1(scene, &context, &ray);
#endif
}

Vector3d vector_of(const optics::Point& p) { return {p[0], p[1], p[2]}; }
optics::Point point_of(const Vector3d& v) { return {v[0], v[1], v[2]}; }

double angle_between(const Vector3d& a, const Vector3d& b) { return std::atan2(a.cross(b).norm(), a.dot(b)); }

/// The triangles that have an area, around every vertex.
struct Fans {
    std::vector<std::uint32_t> first, triangle;
    Fans(std::size_t vertices, const std::vector<Triangle>& triangles)
        : first(vertices + 1), triangle(triangles.size() * 3) {
        for (const Triangle& t : triangles)
            for (const std::uint32_t v : t) ++first[v + 1];
        for (std::size_t v = 0; v < vertices; ++v) first[v + 1] += first[v];
        std::vector<std::uint32_t> next(first.begin(), first.end() - 1);
        for (std::uint32_t t = 0; t < triangles.size(); ++t)
            for (const std::uint32_t v : triangles[t]) triangle[next[v]++] = t;
    }
};

}  // namespace

struct MeshBoundary::Data {
    std::vector<Vector3d> positions;
    std::vector<Triangle> triangles;
    std::vector<Vector3d> normal;                    ///< per triangle
    std::vector<std::array<Vector3f, 3>> at_corner;  ///< shading normals
    std::unique_ptr<TriangleTree> tree;
    RTCDevice device = nullptr;
    RTCScene scene = nullptr;

    Data() = default;
    Data(const Data&) = delete;
    Data& operator=(const Data&) = delete;
    ~Data() {
        if (scene) rtcReleaseScene(scene);
        if (device) rtcReleaseDevice(device);
    }
    void find_normals(double crease);
    void build();
    struct Hit {
        double distance = 0;
        std::uint32_t triangle = 0;
        Vector3d weights = Vector3d::Zero();  ///< of its corners
    };
    /// The first triangle that looks along the ray, or against it.
    [[nodiscard]] std::optional<Hit> first_hit(const optics::Point& from, const optics::Point& direction, float near,
                                               double reach, bool along) const;
    [[nodiscard]] optics::BoundaryNormals normals(std::uint32_t t, const Vector3d& weights) const {
        Vector3d shading = Vector3d::Zero();
        for (int c = 0; c < 3; ++c) shading += weights[c] * at_corner[t][static_cast<std::size_t>(c)].cast<double>();
        const double length = shading.norm();
        return {point_of(length > 1e-6 ? Vector3d(shading / length) : normal[t]), point_of(normal[t])};
    }
};

void MeshBoundary::Data::find_normals(double crease) {
    std::vector<Triangle> kept;
    for (const Triangle& t : triangles) {
        const Vector3d &a = positions[t[0]], &b = positions[t[1]], &c = positions[t[2]];
        const Vector3d n = (b - a).cross(c - a);
        const double longest2 = std::max({(b - a).squaredNorm(), (c - a).squaredNorm(), (c - b).squaredNorm()});
        if (n.norm() <= 1e-12 * longest2) continue;  // no area: no light passes
        kept.push_back(t);
        normal.push_back(n.normalized());
    }
    triangles = std::move(kept);

    const Fans fans(positions.size(), triangles);
    const double least = std::cos(crease);
    at_corner.resize(triangles.size());
    for (std::size_t t = 0; t < triangles.size(); ++t)
        for (std::size_t c = 0; c < 3; ++c) {
            const std::uint32_t v = triangles[t][c];
            Vector3d sum = Vector3d::Zero();
            for (std::uint32_t k = fans.first[v]; k < fans.first[v + 1]; ++k) {
                const std::uint32_t other = fans.triangle[k];
                if (normal[other].dot(normal[t]) < least) continue;
                const Triangle& o = triangles[other];
                const std::size_t at = o[0] == v ? 0 : o[1] == v ? 1 : 2;
                sum += normal[other] * angle_between(positions[o[(at + 1) % 3]] - positions[v],
                                                     positions[o[(at + 2) % 3]] - positions[v]);
            }
            at_corner[t][c] = sum.normalized().cast<float>();
        }
}

void MeshBoundary::Data::build() {
    tree = std::make_unique<TriangleTree>(positions, triangles);
    device = rtcNewDevice(nullptr);
    if (!device)
        throw ResourceError(
            "Embree, which finds where light meets the mesh, cannot start on this machine; use the voxel "
            "boundary instead.");
    scene = rtcNewScene(device);
    rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
    rtcSetSceneBuildQuality(scene, RTC_BUILD_QUALITY_HIGH);
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* vertices = static_cast<float*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                                                 3 * sizeof(float), positions.size()));
    auto* indices = static_cast<std::uint32_t*>(rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(std::uint32_t), triangles.size()));
    if (!vertices || !indices)
        throw ResourceError("The mesh with " + std::to_string(triangles.size()) +
                            " triangles does not fit into memory for tracing light; use the voxel boundary instead.");
    for (std::size_t v = 0; v < positions.size(); ++v)
        for (int a = 0; a < 3; ++a) vertices[3 * v + static_cast<std::size_t>(a)] = static_cast<float>(positions[v][a]);
    for (std::size_t t = 0; t < triangles.size(); ++t) std::copy_n(triangles[t].begin(), 3, indices + 3 * t);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene, geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(scene);
    if (rtcGetDeviceError(device) != RTC_ERROR_NONE)
        throw ResourceError("Embree could not take the mesh with " + std::to_string(triangles.size()) +
                            " triangles, for lack of memory; use the voxel boundary instead.");
}

MeshBoundary::MeshBoundary(std::span<const Vector3d> positions_mm, std::span<const Triangle> triangles,
                           const Vector3d& corner_mm, double crease_radians)
    : data_(std::make_unique<Data>()) {
    VOXTONE_EXPECT(!triangles.empty());
    data_->positions.reserve(positions_mm.size());
    for (const Vector3d& p : positions_mm) data_->positions.push_back(p - corner_mm);
    data_->triangles.assign(triangles.begin(), triangles.end());
    data_->find_normals(crease_radians);
    VOXTONE_EXPECT(!data_->triangles.empty());
    data_->build();
}

MeshBoundary::~MeshBoundary() = default;
MeshBoundary::MeshBoundary(MeshBoundary&&) noexcept = default;
MeshBoundary& MeshBoundary::operator=(MeshBoundary&&) noexcept = default;

std::optional<MeshBoundary::Data::Hit> MeshBoundary::Data::first_hit(const optics::Point& from,
                                                                     const optics::Point& direction, float near,
                                                                     double reach, bool along) const {
    const Vector3d d = vector_of(direction);
    // Triangles that look the other way are passed; only a start on the wrong side meets any.
    for (int tries = 0; tries < 8; ++tries) {
        RTCRayHit ray{};
        ray.ray.org_x = static_cast<float>(from[0]);
        ray.ray.org_y = static_cast<float>(from[1]);
        ray.ray.org_z = static_cast<float>(from[2]);
        ray.ray.dir_x = static_cast<float>(direction[0]);
        ray.ray.dir_y = static_cast<float>(direction[1]);
        ray.ray.dir_z = static_cast<float>(direction[2]);
        ray.ray.tnear = near;
        ray.ray.tfar = static_cast<float>(reach);
        ray.ray.mask = ~0u;
        ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
        intersect(scene, ray);
        if (ray.hit.geomID == RTC_INVALID_GEOMETRY_ID) return {};
        const std::uint32_t t = ray.hit.primID;
        if ((d.dot(normal[t]) > 0) == along) {
            const double u = static_cast<double>(ray.hit.u), v = static_cast<double>(ray.hit.v);
            return Hit{static_cast<double>(ray.ray.tfar), t, {1 - u - v, u, v}};
        }
        near = std::nextafter(ray.ray.tfar + 1e-6f, std::numeric_limits<float>::infinity());
        if (!(near < static_cast<float>(reach))) return {};
    }
    return {};
}

bool MeshBoundary::leaves(const optics::Point& from, const optics::Point& direction, double reach, double& distance,
                          optics::BoundaryNormals& normals) const {
    const auto hit = data_->first_hit(from, direction, 0, reach, true);
    if (!hit) return false;
    distance = hit->distance;
    normals = data_->normals(hit->triangle, hit->weights);
    return true;
}

bool MeshBoundary::meets(const optics::Point& from, const optics::Point& direction, double& distance,
                         optics::BoundaryNormals& normals) const {
    const auto hit = data_->first_hit(from, direction, off_the_start, far_away, false);
    if (!hit) return false;
    distance = hit->distance;
    normals = data_->normals(hit->triangle, hit->weights);
    return true;
}

std::optional<std::uint32_t> MeshBoundary::corner_met(const optics::Point& from, const optics::Point& direction) const {
    const auto hit = data_->first_hit(from, direction, off_the_start, far_away, false);
    if (!hit) return {};
    Eigen::Index corner = 0;
    hit->weights.maxCoeff(&corner);
    return data_->triangles[hit->triangle][static_cast<std::size_t>(corner)];
}

std::optional<MeshBoundary::Met> MeshBoundary::triangle_met(const optics::Point& from,
                                                            const optics::Point& direction) const {
    const auto hit = data_->first_hit(from, direction, off_the_start, far_away, false);
    if (!hit) return {};
    Met met{data_->triangles[hit->triangle], {}, hit->distance, data_->normals(hit->triangle, hit->weights)};
    for (std::size_t c = 0; c < 3; ++c) met.weights[c] = static_cast<float>(hit->weights[static_cast<int>(c)]);
    return met;
}

optics::Point MeshBoundary::nearest(const optics::Point& p, optics::BoundaryNormals& normals) const {
    const auto found = data_->tree->nearest(vector_of(p));
    const auto corner = data_->tree->corners(found.triangle);
    normals = data_->normals(found.triangle, nearest_weights(found.point, corner[0], corner[1], corner[2]));
    return point_of(found.point);
}

bool MeshBoundary::comes_within(const optics::Point& p, double radius_mm) const {
    return data_->tree->nearest(vector_of(p), TriangleTree::none, radius_mm).triangle != TriangleTree::none;
}

}  // namespace voxtone::slicer
