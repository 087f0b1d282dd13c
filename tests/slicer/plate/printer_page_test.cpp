// SPDX-License-Identifier: GPL-3.0-or-later
//
// How much of a body's surface support makes matt, of two boxes one above the other, whose faces can be counted.
#include "slicer/plate/printer_page.h"

#include <catch2/catch.hpp>

#include "io/layers/topmost_layers.h"
#include "tests/io/layers/stack_samples.h"
#include "tests/slicer/print/sample_body.h"

using namespace voxtone;
using namespace voxtone::slicer;
using Eigen::Vector3d;
using Eigen::Vector3f;

namespace {

constexpr double below_mm = 4, above_mm = 2, gap_mm = 1;
const Vector3d pitch_mm(0.05, 0.05, 0.05);

/// A white plate of 4 x 4 x 1 mm, and 1 mm above its middle a red one of 2 x 2 x 1 mm.
JobBody two_plates() {
    const SolidMesh below = shapes::box({0, 0, 0}, {below_mm, below_mm, 1}),
                    above = shapes::box({1, 1, 1 + gap_mm}, {1 + above_mm, 1 + above_mm, 2 + gap_mm});
    std::vector<Vector3f> rgb(below.triangles.size(), Vector3f(1, 1, 1));
    rgb.resize(below.triangles.size() + above.triangles.size(), Vector3f(1, 0, 0));
    return test::body_of(shapes::joined(below, above), pitch_mm, rgb);
}

constexpr int columns = 200, rows = 90;

/// The plates' highest layers, for copies whose corners lie there.
io::TopmostLayers topmost_of(const std::vector<std::array<int, 3>>& at) {
    io::TopmostLayers topmost(columns, rows);
    for (const auto& [from, to, top] : {std::array{0, 80, 19}, std::array{20, 60, 59}}) {
        std::vector<io::Material> pixels(std::size_t(columns) * rows, 0);
        for (const std::array<int, 3>& corner : at)
            for (int y = from; y < to; ++y)
                for (int x = from; x < to; ++x)
                    pixels[std::size_t(rows - 1 - y - corner[1]) * columns + std::size_t(x + corner[0])] = 1;
        topmost.add(std::uint32_t(top), io::layer_from_pixels(pixels, columns, rows));
    }
    return topmost;
}

PartFinish finish(const std::vector<std::array<int, 3>>& at, std::uint32_t first_layer = 0) {
    const JobBody body = two_plates();
    io::StackDescription stack = io::sample_description(60, columns, rows);
    stack.pitch_um = {50, 50, 50};
    stack.first_layer = first_layer, stack.layers -= first_layer;
    return finish_of({"plates", body, at}, stack, topmost_of(at));
}

}  // namespace

TEST_CASE("Support makes matt what lies under something, and the tray what lies on it") {
    const PartFinish one = finish({{0, 0, 0}});
    CHECK((one.name == "plates" && one.copies == 1));
    const double lower = 2 * 16 + 4 * 4, upper = 2 * 4 + 4 * 2;  // mm2
    // Of 50,000 points; a column beside a face may be cut by a voxel.
    CHECK(one.surface_mm2 == Approx(lower + upper).epsilon(1e-6));
    CHECK(one.coloured_mm2 == Approx(upper).epsilon(0.03));
    // The bottom on the tray, what lies under the upper plate, and the upper plate's bottom.
    CHECK(one.matt_mm2 == Approx(16 + 4 + 4).epsilon(0.05));
    CHECK(one.coloured_matt_mm2 == Approx(4).epsilon(0.05));
    CHECK(one.coloured_down_mm2 == Approx(4).epsilon(0.05));
    for (const double height_mm : one.coloured_matt_height_mm) CHECK(height_mm == Approx(1 + gap_mm).margin(0.05));
}

TEST_CASE("A picture's slab lies on the tray with its back, which takes no colour") {
    JobBody body = two_plates();
    body.is_picture = true;
    // As of a picture: the coloured surface is its face alone.
    VisibleSurface face = *body.surface;
    face.triangles.resize(1), face.source_triangle.resize(1), face.source_uv.resize(1);
    body.surface = SurfaceIndex(std::move(face));
    io::StackDescription stack = io::sample_description(60, columns, rows);
    stack.pitch_um = {50, 50, 50};
    const PartFinish slab = finish_of({"slab", body, {{0, 0, 0}}}, stack, topmost_of({{0, 0, 0}}));
    const PartFinish whole = finish({{0, 0, 0}});
    CHECK(slab.surface_mm2 == Approx(whole.surface_mm2).epsilon(1e-3));
    CHECK(slab.matt_mm2 == Approx(whole.matt_mm2).epsilon(0.02));
    CHECK(slab.matt_mm2 > 16);  // its lower face
}

TEST_CASE("Figures of a finish are of one copy, in the mean of all") {
    const PartFinish one = finish({{0, 0, 0}}), two = finish({{0, 0, 0}, {100, 5, 0}});
    CHECK(two.copies == 2);
    CHECK(two.surface_mm2 == Approx(one.surface_mm2).epsilon(1e-6));
    CHECK(two.coloured_mm2 == Approx(one.coloured_mm2).epsilon(0.03));
    CHECK(two.matt_mm2 == Approx(one.matt_mm2).epsilon(0.03));
    CHECK(two.coloured_matt_mm2 == Approx(one.coloured_matt_mm2).epsilon(0.05));
    const PartFinish none = finish({});
    CHECK((none.copies == 0 && none.surface_mm2 == 0 && none.matt_mm2 == 0));
}

TEST_CASE("Of faces in layers that a stack does not have nothing is counted") {
    // From the gap on: the upper plate alone.
    const PartFinish upper = finish({{0, 0, 0}}, 30);
    CHECK(upper.surface_mm2 == Approx(16).epsilon(0.03));
    CHECK(upper.coloured_mm2 == Approx(16).epsilon(0.03));
}

TEST_CASE("From above a print has the colours that were asked for, lower places a fifth darker, others grey") {
    JobBody body = two_plates();
    body.model.mesh.corner_rgb.assign(24, {Vector3f(1, 0.2f, 0), Vector3f(1, 0.2f, 0), Vector3f(1, 0.2f, 0)});
    const std::vector<PlacedBody> bodies{{"plates", body, {{0, 0, 0}, {100, 5, 0}}}};
    io::StackDescription stack = io::sample_description(60, columns, rows);
    stack.pitch_um = {50, 50, 50};
    const ColourOfColumn colour = colour_from_above(bodies, stack);
    // sRGB of 0.2 is 0.4845. Of 60 layers the plates end at 20 and 60.
    const io::Rgb upper{255, 124, 0}, lower{221, 107, 0};
    CHECK(colour(40, 40, 60) == upper);
    CHECK(colour(5, 40, 20) == lower);
    CHECK(colour(105, 45, 20) == lower);
    CHECK(colour(90, 40, 20) == io::Rgb{173, 173, 173});  // 200 * 0.8667
    CHECK(colour(90, 40, 60) == io::Rgb{200, 200, 200});
    // Layers of a range count from its first.
    stack.first_layer = 30, stack.layers = 30;
    CHECK(colour_from_above(bodies, stack)(40, 40, 30) == upper);
}
