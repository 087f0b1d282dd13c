// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/camera/lit_scene.h"

#include <cmath>
#include <limits>

#include <Eigen/LU>

#include "base/contracts.h"
#include "optics/colour/channels.h"
#include "optics/monte_carlo/scalar_paths.h"
#include "optics/numerics/quadrature.h"
#include "optics/scene/fresnel.h"

namespace voxtone::optics {
namespace {

Point less(const Point& a, const Point& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }

// Of all weights that give every colour back, the nearest to these: L + W^T (W W^T)^-1 (1 - W L). Sums stay 1.
void make_exact(const Eigen::Matrix3Xd& to_srgb, std::vector<Light>& light) {
    Eigen::MatrixX3d weights(to_srgb.cols(), 3);
    for (Eigen::Index c = 0; c < weights.rows(); ++c)
        weights.row(c) = Eigen::Map<const Eigen::RowVector3d>(light[static_cast<std::size_t>(c)].data());
    const Eigen::Matrix3d both = to_srgb * to_srgb.transpose();
    weights += to_srgb.transpose() * both.fullPivLu().solve(Eigen::Matrix3d::Identity() - to_srgb * weights);
    for (Eigen::Index c = 0; c < weights.rows(); ++c)
        Eigen::Map<Eigen::RowVector3d>(light[static_cast<std::size_t>(c)].data()) = weights.row(c);
}

std::vector<Light> light_of(const Channels& channels, const Eigen::Matrix3Xd& to_srgb) {
    constexpr Light red{1, 0, 0}, green{0, 1, 0}, blue{0, 0, 1}, grey{1.0 / 3, 1.0 / 3, 1.0 / 3};
    if (channels.is_rgb()) return {red, green, blue};
    std::vector<Light> light;
    for (const double nm : channels.wavelengths_nm) light.push_back(nm >= 580 ? red : nm >= 490 ? green : blue);
    for (Eigen::Index c = 0; channels.is_own() && c < to_srgb.cols(); ++c) {
        const Eigen::Vector3d given = to_srgb.col(c).cwiseMax(0);
        const double sum = given.sum();
        light.push_back(sum > 0 ? Light{given[0] / sum, given[1] / sum, given[2] / sum} : grey);
    }
    if (channels.is_own()) make_exact(to_srgb, light);
    return light;
}

}  // namespace

double mean_reflectance(double eta) {
    constexpr int nodes = 32;  // right to a millionth
    const Rule rule = gauss_legendre(nodes, 0, 1);
    double sum = 0;
    for (std::size_t i = 0; i < rule.x.size(); ++i)
        sum += 2 * rule.w[i] * rule.x[i] * fresnel_reflectance(rule.x[i], eta);
    return sum;
}

LitScene::LitScene(const CameraScene& scene) : scene_(scene), camera_(scene.view) {
    VOXTONE_EXPECT(scene.sky != nullptr || scene.beam != nullptr);
    const Channels channels = scene.prints.empty() ? Channels{} : scene.prints.front().scene->resins->channels;
    const Eigen::Matrix3Xd weights = linear_srgb_weights(channels);
    light_ = light_of(channels, weights);
    if (!channels.is_rgb())
        for (Eigen::Index k = 0; k < 3; ++k) derived_.emplace_back(weights.row(k).begin(), weights.row(k).end());
    std::vector<double>& shares = derived_.emplace_back();
    for (Eigen::Index c = 0; c < weights.cols(); ++c)
        shares.push_back(luminance({weights(0, c), weights(1, c), weights(2, c)}));
    volumes_.reserve(scene.prints.size());
    spheres_.reserve(scene.prints.size());
    for (const ResinBody& print : scene.prints) {
        require_resins(*print.scene);
        VOXTONE_EXPECT(print.boundary && print.scene->resins->channels == channels);
        VOXTONE_EXPECT(print.scene->backing == Backing::none && print.scene->sides == Sides::open);
        volumes_.emplace_back(*print.scene, print.boundary);
        spheres_.emplace_back(*print.scene, volumes_.back());
        for (std::size_t c = 0; c < light_.size(); ++c) {
            PacketScene packet = packet_scene(*print.scene, volumes_.back(), c, default_roulette_weight);
            packet.finish = print.finish;
            packet.tells_exits = true;
            packet.spheres = packet_spheres(spheres_.back(), c);
            packets_.push_back(packet);
        }
    }
}

double LitScene::eta_at(std::size_t print, const Point& at, const BoundaryNormals& normals) const {
    const Scene& scene = *scene_.prints[print].scene;
    const PacketScene& packets = packets_[print * channels()];
    if (!packets.own_eta) return scene.resins->eta;
    std::array<int, 3> voxel{};
    for (std::size_t a = 0; a < 3; ++a)
        voxel[a] = static_cast<int>(
                       std::floor((at[a] - inside_boundary_mm * normals.geometric[a]) / scene.volume->pitch_mm()[a])) +
                   volumes_[print].offset();
    return static_cast<double>(packets.eta_of[volumes_[print].material(voxel)]);
}

MetInAir LitScene::met(const Point& from, const Point& way) const {
    MetInAir first;
    first.distance = std::numeric_limits<double>::infinity();
    BoundaryNormals normals;
    double distance = 0;
    for (std::size_t i = 0; i < scene_.prints.size(); ++i)
        if (scene_.prints[i].boundary->meets(less(from, scene_.prints[i].corner_mm), way, distance, normals) &&
            distance < first.distance)
            first = {MetInAir::What::print, i, distance, normals};
    if (first.what == MetInAir::What::print)
        first.eta = eta_at(first.print, along(less(from, scene_.prints[first.print].corner_mm), way, first.distance),
                           first.normals);
    Light reflectance{};
    for (const DiffuseBody* body : scene_.diffusers)
        if (body->meets(from, way, distance, normals, reflectance) && distance < first.distance)
            first = {MetInAir::What::diffuser,
                     0,
                     distance,
                     normals,
                     1,
                     reflectance,
                     body->coat(along(from, way, distance), normals.geometric)};
    if (scene_.ground && dot(way, scene_.ground->up) < 0) {
        const Point& up = scene_.ground->up;
        distance = (scene_.ground->height_mm - dot(from, up)) / dot(way, up);
        constexpr double off_the_start = 1e-4;
        if (distance > off_the_start && distance < first.distance)
            first = {MetInAir::What::ground, 0, distance, {up, up}, 1, scene_.ground->reflectance, {}};
    }
    return first;
}

Point LitScene::draw_light(double pixel, double u, double v) const {
    if (scene_.beam) return scene_.beam->draw(pixel, u, v);
    const Point d = scene_.sky->draw(pixel, u, v);
    Point way{};
    for (std::size_t a = 0; a < 3; ++a)
        for (std::size_t k = 0; k < 3; ++k) way[k] += d[a] * scene_.sky_axes[a][k];
    return way;
}

bool LitScene::sees_sky(const Point& from, const Point& way) const {
    return met(from, way).what == MetInAir::What::sky;
}

}  // namespace voxtone::optics
