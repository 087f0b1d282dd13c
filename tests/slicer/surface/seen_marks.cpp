// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/slicer/surface/seen_marks.h"

#include <algorithm>
#include <cmath>

#define ZX_USE_UTF8 1
#include <ZXing/ReadBarcode.h>

#include "optics/colour/colour.h"
#include "slicer/surface/mark_frame.h"
#include "slicer/surface/seen_depth.h"
#include "slicer/surface/surface_colour.h"

namespace voxtone::test {

Body body_of(const slicer::SolidMesh& solid, const Eigen::Vector3f& rgb) {
    Body body;
    body.mesh.positions = solid.positions_mm;
    body.mesh.triangles = solid.triangles;
    body.mesh.material_of_triangle.assign(solid.triangles.size(), 0);
    body.mesh.materials.resize(1);
    body.mesh.materials[0].rgb = rgb;
    slicer::VisibleSurface surface;
    surface.positions_mm = solid.positions_mm;
    surface.triangles = solid.triangles;
    for (std::uint32_t t = 0; t < solid.triangles.size(); ++t) {
        surface.source_triangle.push_back(t);
        surface.source_uv.push_back({Eigen::Vector2f(0, 0), Eigen::Vector2f(1, 0), Eigen::Vector2f(0, 1)});
    }
    body.solid = slicer::SolidIndex(solid);
    body.surface = slicer::SurfaceIndex(std::move(surface));
    return body;
}

GreyPicture seen_from(const Body& body, const Eigen::Vector3d& out, double pixel_mm) {
    const slicer::MarkAxes axes = slicer::axes_facing(out);
    Eigen::AlignedBox3d box;
    for (const Eigen::Vector3d& p : body.mesh.positions)
        box.extend(Eigen::Vector3d(axes.right.dot(p), axes.up.dot(p), axes.out.dot(p)));
    const Eigen::Vector3d low(box.min().x(), box.min().y(), box.max().z());
    slicer::MarkFrame frame{axes, low.x() * axes.right + low.y() * axes.up + low.z() * axes.out, box.sizes().x(),
                            box.sizes().y()};
    const io::DepthMap depth = slicer::depth_below(frame, *body.solid, pixel_mm);
    const slicer::SurfaceColour colour(body.mesh, pixel_mm);
    GreyPicture picture{int(depth.columns), int(depth.rows), {}};
    for (int y = 0; y < picture.height; ++y)
        for (int x = 0; x < picture.width; ++x) {
            const int row = picture.height - 1 - y;
            const float deep = depth.depth_mm[std::size_t(row) * depth.columns + std::size_t(x)];
            double light = 1;
            if (std::isfinite(deep)) {
                const auto nearest =
                    body.surface.tree().nearest(frame.at(x * frame.width_mm / (picture.width - 1),
                                                         row * frame.height_mm / (picture.height - 1), double(deep)));
                const auto [a, b, c] = body.surface.tree().corners(nearest.triangle);
                const Eigen::Vector3f w = slicer::nearest_weights(nearest.point, a, b, c).cast<float>();
                const auto& uv = body.surface->source_uv[nearest.triangle];
                const Eigen::Vector2f at = w[0] * uv[0] + w[1] * uv[1] + w[2] * uv[2];
                light = double(Eigen::Vector3f(0.2126f, 0.7152f, 0.0722f)
                                   .dot(colour.at(body.surface->source_triangle[nearest.triangle], at.x(), at.y())));
            }
            picture.pixels.push_back(std::uint8_t(std::lround(255 * optics::srgb_encode(std::clamp(light, 0.0, 1.0)))));
        }
    return picture;
}

std::string code_in(const GreyPicture& picture) {
#if __has_include(<ZXing/ReaderOptions.h>)
    ZXing::ReaderOptions hints;  // its name since ZXing-C++ 2.2
#else
    ZXing::DecodeHints hints;
#endif
    hints.setFormats(ZXing::BarcodeFormat::QRCode | ZXing::BarcodeFormat::DataMatrix | ZXing::BarcodeFormat::Code128)
        .setTryHarder(true);
    for (const ZXing::Binarizer how : {ZXing::Binarizer::LocalAverage, ZXing::Binarizer::GlobalHistogram}) {
        hints.setBinarizer(how);
        const ZXing::Result result =
            ZXing::ReadBarcode({picture.pixels.data(), picture.width, picture.height, ZXing::ImageFormat::Lum}, hints);
        // Bytes: a text is what each version of ZXing makes of them.
        if (result.isValid() && !result.isMirrored()) return {result.bytes().begin(), result.bytes().end()};
    }
    return {};
}

}  // namespace voxtone::test
