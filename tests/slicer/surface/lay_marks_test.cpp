// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/surface/lay_marks.h"

#include <algorithm>
#include <cmath>

#include <fmt/core.h>
#include <fmt/ranges.h>
#include <catch2/catch.hpp>

#include "base/error.h"
#include "io/files/whole_file.h"
#include "io/pictures/picture_writer.h"
#include "io/programs/helper_program.h"
#include "slicer/options/label_template.h"
#include "slicer/options/mark_words.h"
#include "slicer/surface/mark_frame.h"
#include "slicer/surface/surface_colour.h"
#include "tests/io/files/temporary_folder.h"
#include "tests/outcomes.h"
#include "tests/places.h"
#include "tests/slicer/mesh/shapes.h"
#include "tests/slicer/surface/seen_marks.h"

using namespace voxtone;
using namespace voxtone::slicer;
using Catch::Matchers::Contains;
using test::Body;

namespace {

const Eigen::Vector3f white(1, 1, 1), black(0.01f, 0.01f, 0.01f);

MarkOptions label(const std::string& spelled) { return parse_mark(MarkFamily::label, spelled); }

LaidMarks lay(Body& body, const std::vector<std::string>& labels) {
    std::vector<MarkOptions> marks;
    for (const std::string& one : labels) marks.push_back(label(one));
    return lay_marks(marks, {body.mesh, body.solid, body.surface}, {});
}

Body box(const Eigen::Vector3d& size, const Eigen::Vector3f& rgb) {
    return test::body_of(shapes::box(Eigen::Vector3d::Zero(), size), rgb);
}

Eigen::Vector3f colour_at(const Body& body, const Eigen::Vector3d& point) {
    const auto nearest = body.surface.tree().nearest(point);
    const auto [a, b, c] = body.surface.tree().corners(nearest.triangle);
    const Eigen::Vector3f w = nearest_weights(nearest.point, a, b, c).cast<float>();
    return SurfaceColour(body.mesh, 0.02).at(nearest.triangle, w[1], w[2]);
}

std::size_t dark_pixels(const test::GreyPicture& picture) {
    return std::size_t(std::ranges::count_if(picture.pixels, [](std::uint8_t p) { return p < 128; }));
}

}  // namespace

TEST_CASE("A code is read, and not mirrored, from the side that it was laid on") {
    const std::vector<std::pair<std::string, Eigen::Vector3d>> sides{{"front", {0, -1, 0}}, {"back", {0, 1, 0}},
                                                                     {"left", {-1, 0, 0}},  {"right", {1, 0, 0}},
                                                                     {"top", {0, 0, 1}},    {"bottom", {0, 0, -1}}};
    for (const auto& [side, out] : sides)
        for (const char* kind : {"qr", "datamatrix"}) {
            INFO(side << ", " << kind);
            Body body = box({16, 14, 15}, black);
            lay(body, {std::string(kind) + "=" + side + " 7; place=" + side});
            CHECK(test::code_in(test::seen_from(body, out, 0.1)) == side + " 7");
            CHECK(test::code_in(test::seen_from(body, -out, 0.1)).empty());
        }
}

TEST_CASE("Codes of GS1 lie on a body as others do, bars as wide as they are asked to be") {
    for (const char* words : {"gs1=(01)09501101530003(10)A(21)7", "gs1-qr=(01)09501101530003(10)A(21)7",
                              "gs1-128=(01)09501101530003(10)A(21)7; size=50mm"}) {
        INFO(words);
        Body body = box({60, 20, 15}, black);
        lay(body, {std::string(words) + "; place=front"});
        CHECK(test::code_in(test::seen_from(body, {0, -1, 0}, 0.1)) ==
              "010950110153000310A\x1D"
              "217");
    }
    Body body = box({60, 20, 15}, black);
    CHECK_THROWS_WITH(lay(body, {"gs1=A-17"}), Contains("GS1 DataMatrix") && Contains("(01)"));
    CHECK_THROWS_WITH(lay(body, {"gs1=(01)09501101530004"}), Contains("--label"));
    CHECK(label("gs1=(21)7").size_mm == 8);
    CHECK(label("gs1-128=(21)7").size_mm == 40);
    CHECK(label("gs1=(21)7").ground_rgb);
}

TEST_CASE("A code lies straight on a slanting face, and turned as it was asked for") {
    SolidMesh slanting = shapes::box(Eigen::Vector3d::Zero(), {20, 20, 20});
    const Eigen::Matrix3d turn =
        (Eigen::AngleAxisd(0.5, Eigen::Vector3d::UnitX()) * Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitY()))
            .toRotationMatrix();
    for (Eigen::Vector3d& p : slanting.positions_mm) p = turn * p;
    Body body = test::body_of(slanting, white);
    lay(body, {"qr=slanting; turn=20"});
    REQUIRE(body.mesh.decals.size() == 1);
    const Eigen::Vector3d out = body.mesh.decals[0].out;
    CHECK((turn.transpose() * out).cwiseAbs().maxCoeff() == Approx(1).margin(1e-6));
    CHECK(body.mesh.decals[0].right.dot(axes_facing(out).right) == Approx(std::cos(20 * EIGEN_PI / 180)));
    CHECK(test::code_in(test::seen_from(body, out, 0.1)) == "slanting");
}

TEST_CASE("A label takes the flattest face that is as large as it, and keeps clear of others") {
    // A plate with a step of 1 mm: either part holds 9 mm, neither 13.
    SolidMesh stepped = shapes::box(Eigen::Vector3d::Zero(), {10, 6, 3});
    const SolidMesh other = shapes::box({10, 0, 0}, {20, 6, 4});
    const auto first = std::uint32_t(stepped.positions_mm.size());
    stepped.positions_mm.insert(stepped.positions_mm.end(), other.positions_mm.begin(), other.positions_mm.end());
    for (auto t : other.triangles) stepped.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
    Body body = test::body_of(stepped, white);
    lay(body, {"ABCD; size=3mm; place=top", "EFGH; size=3mm; place=top"});
    REQUIRE(body.mesh.decals.size() == 2);
    const auto& [a, b] = std::pair(body.mesh.decals[0], body.mesh.decals[1]);
    const auto part = [](const io::Decal& d) {
        return d.corner_mm.x() + d.width_mm <= 10 ? 1 : d.corner_mm.x() >= 10 ? 2 : 0;
    };
    CHECK(part(a) > 0);
    CHECK(part(b) > 0);
    CHECK(part(a) != part(b));
    Body again = test::body_of(stepped, white);
    CHECK_THROWS_WITH(lay(again, {"ABCDEFGH; size=3mm; place=top"}),
                      Contains("the top has no face") && Contains("would fit") && Contains("break it into lines"));
    lay(again, {"ABCDEFGH; size=3mm"});  // below there is no step
    CHECK(again.mesh.decals[0].out.z() == -1);
    Body whole = test::body_of(stepped, white);
    CHECK_THROWS_WITH(lay(whole, {"a label that is longer than the whole part; size=4mm"}),
                      Contains("would fit on the bottom"));
    CHECK(whole.mesh.decals.empty());
}

TEST_CASE("A label lies across no step, whichever way that runs") {
    using Eigen::Vector3d;
    const SolidMesh base = shapes::box({0, 0, 0}, {10, 10, 4});
    for (const Vector3d& half : {Vector3d(5, 10, 6), Vector3d(10, 5, 6)}) {
        INFO(half.transpose());
        const SolidMesh stair = shapes::joined(base, shapes::box({0, 0, 3}, half));
        Body narrow = test::body_of(stair, white), wide = test::body_of(stair, white);
        CHECK_NOTHROW(lay(narrow, {"qr=A; size=3mm; place=top"}));
        CHECK_THROWS_WITH(lay(wide, {"qr=A; size=5mm; place=top"}), Contains("without steps or edges"));
    }
}

TEST_CASE("A label that is told no place lies where it is least seen") {
    const auto out_of = [](const SolidMesh& solid) {
        Body body = test::body_of(solid, white);
        lay(body, {"AB; size=2mm"});
        return body.mesh.decals[0].out;
    };
    // Below, where that is flat and large enough, however small it is beside the other faces; else behind; else a side.
    CHECK(out_of(shapes::box(Eigen::Vector3d::Zero(), {10, 6, 20})) == -Eigen::Vector3d::UnitZ());
    CHECK(out_of(shapes::box(Eigen::Vector3d::Zero(), {10, 1, 20})) == Eigen::Vector3d::UnitY());
    const Eigen::Vector3d side = out_of(shapes::box(Eigen::Vector3d::Zero(), {1, 10, 3}));
    CHECK(std::abs(side.y()) < 0.01);
    // Raised letters would lift the print, if they were below.
    Body raised = test::body_of(shapes::box(Eigen::Vector3d::Zero(), {10, 6, 20}), white);
    lay(raised, {"AB; size=2mm; raise=3"});
    CHECK(raised.mesh.decals[0].out == Eigen::Vector3d::UnitY());
    // A belly is better than a flank, and who gets a flank is told, with what fits below; a small ball has no such
    // place.
    const auto warnings_of = [](const SolidMesh& solid, const std::string& mark) {
        Body body = test::body_of(solid, white);
        const LaidMarks laid = lay(body, {mark});
        return fmt::format("{}", fmt::join(laid.warnings, " "));
    };
    const SolidMesh barrel = shapes::moved(shapes::sphere(20, 48), Eigen::Vector3d(20, 20, 20));
    CHECK(out_of(barrel) == -Eigen::Vector3d::UnitZ());
    CHECK(warnings_of(barrel, "AB; size=2mm").empty());
    const SolidMesh flank = shapes::box(Eigen::Vector3d::Zero(), {1.5, 10, 8});
    CHECK_THAT(warnings_of(flank, "ABCD; size=2.5mm"), Contains("where it is seen") &&
                                                           Contains("mm; place=bottom; turn=90\" fits") &&
                                                           Contains("[label-in-sight]"));
    CHECK(warnings_of(flank, "ABCD; size=2.5mm; place=left").empty());
    // A ball has no flat face: it takes what is flattest.
    CHECK(out_of(shapes::sphere(3, 24)).norm() == Approx(1));
    // A picture of the user's is there to be seen, and stays where the face is largest.
    CHECK(std::get<MarkSide>(parse_mark(MarkFamily::decal, "a.png; size=3mm").place) == MarkSide::flattest);
}

TEST_CASE("A label of a picture lies on its back or its rim, and never across its face") {
    const auto slab = [&](double thickness_mm, const Eigen::Vector2d& size_mm) {
        Body body =
            test::body_of(shapes::box(Eigen::Vector3d::Zero(), {size_mm.x(), size_mm.y(), thickness_mm}), white);
        // As a picture's: its face comes first, and has a material of its own and all the colour there is.
        std::ranges::stable_partition(body.mesh.triangles, [&](const auto& t) {
            return std::ranges::all_of(t, [&](std::uint32_t v) { return body.mesh.positions[v].z() == thickness_mm; });
        });
        body.mesh.materials.resize(2);
        body.mesh.material_of_triangle.assign(body.mesh.triangles.size(), 1);
        body.mesh.material_of_triangle[0] = body.mesh.material_of_triangle[1] = 0;
        VisibleSurface face;
        face.positions_mm = body.mesh.positions;
        for (std::uint32_t t = 0; t < 2; ++t) {
            face.triangles.push_back(body.mesh.triangles[t]);
            face.source_triangle.push_back(t);
            face.source_uv.push_back({Eigen::Vector2f(0, 0), Eigen::Vector2f(1, 0), Eigen::Vector2f(0, 1)});
        }
        body.surface = SurfaceIndex(std::move(face));
        return body;
    };
    const auto marked = [](Body& body, const std::string& spelled) {
        return lay_marks({label(spelled)}, {body.mesh, body.solid, body.surface, true}, {});
    };
    Body usual = slab(4, {30, 20});
    const LaidMarks laid = marked(usual, "Klein; size=2mm");
    CHECK(usual.mesh.decals[0].out.z() == -1);
    CHECK_THAT(laid.notes[0], Contains("on the back of the picture") && Contains("from the picture's left edge"));
    // It is read there, and not mirrored.
    Body code = slab(4, {30, 20});
    marked(code, "qr=Klein; size=8mm; place=bottom");
    CHECK(test::code_in(test::seen_from(code, -Eigen::Vector3d::UnitZ(), 0.1)) == "Klein");
    // Of 21 modules: with four more on either side it is 1.38 times as large, and what 8 mm hold has modules of 0.24
    // mm.
    Body low = slab(4, {30, 8});
    CHECK_THROWS_WITH(marked(low, "qr=Klein; size=8mm; place=bottom"), Contains("11.0 x 11.0 mm with the quiet zone") &&
                                                                           Contains("no scanner reads") &&
                                                                           Contains("needs size=6.3mm"));
    Body broad = slab(4, {30, 12});
    CHECK_THROWS_WITH(marked(broad, "qr=Klein; size=12mm; place=bottom"),
                      Contains("would fit,") && !Contains("no scanner"));
    // Across a back that is too narrow for it: nothing is up there.
    Body upright = slab(2, {8, 14});
    CHECK_THAT(marked(upright, "Kleine; size=3mm").notes[0], Contains("on the back of the picture"));
    // What is larger than the back would be, is not put onto the face; the rim takes what fits there.
    Body narrow = slab(4, {30, 1});
    CHECK_THAT(marked(narrow, "AB; size=2mm").notes[0], Contains("rim"));
    CHECK(std::abs(narrow.mesh.decals[0].out.z()) < 0.01);
    Body small = slab(0.5, {3, 3});
    CHECK_THROWS_WITH(marked(small, "Klein und Sohn; size=2mm"),
                      Contains("neither the picture's back nor its rim") && Contains("would fit"));
    CHECK_THAT(marked(small, "AB; size=1mm; place=top").notes[0], Contains("on the picture,"));
    // Whoever holds a picture calls its face the front.
    CHECK_THAT(marked(small, "AB; size=1mm; place=front").notes[0], Contains("on the picture,"));
    CHECK_THAT(marked(small, "AB; size=1mm; place=back").notes[0], Contains("on the back of the picture"));
    const io::TemporaryFolder folder;
    io::write_whole_file(folder.path() / "dot.png", io::png_bytes({1, 1, 3, {200, 0, 0}}));
    const std::string dot = (folder.path() / "dot.png").string() + "; size=2mm; place=back";
    lay_marks({parse_mark(MarkFamily::decal, dot)}, {usual.mesh, usual.solid, usual.surface, true}, {});
    CHECK(usual.mesh.decals.back().out.z() == -1);
}

TEST_CASE("A label contrasts with what lies below it, on the ground that it was given or on the model") {
    for (const Eigen::Vector3f& ground : {white, black}) {
        Body body = box({20, 20, 5}, ground);
        const std::string note = lay(body, {"HHHH; size=4mm; place=top"}).notes[0];
        const bool is_light = ground.x() > 0.5f;
        CHECK_THAT(note, Contains(is_light ? ", in black" : ", in white"));
        const std::size_t dark = dark_pixels(test::seen_from(body, Eigen::Vector3d::UnitZ(), 0.1));
        const std::size_t all = 200 * 200, ink = is_light ? dark : all - dark;
        CHECK(ink > all / 100);
        CHECK(ink < all / 5);
    }
    Body body = box({20, 20, 5}, black);
    lay(body, {"HHHH; size=4mm; place=top; ground=#ffff00"});
    const io::Decal& decal = body.mesh.decals[0];
    const Eigen::Vector3f corner = colour_at(body, decal.corner_mm + 0.1 * (decal.right + decal.up));
    CHECK((corner - Eigen::Vector3f(1, 1, 0)).norm() < 1e-3f);
}

TEST_CASE("A mark lies on what is seen first, and not on what it hides or on its sides") {
    // A small box before a large one, seen from the front.
    SolidMesh solid = shapes::box({0, 10, 0}, {20, 14, 20});
    const SolidMesh before = shapes::box({8, 0, 8}, {12, 6, 12});
    const auto first = std::uint32_t(solid.positions_mm.size());
    solid.positions_mm.insert(solid.positions_mm.end(), before.positions_mm.begin(), before.positions_mm.end());
    for (auto t : before.triangles) solid.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
    Body body = test::body_of(solid, white);
    MarkOptions mark = label("qr=a; place=front; at=0,0; size=8mm; colour=none; ground=black");
    lay_marks({mark}, {body.mesh, body.solid, body.surface}, {});
    CHECK(colour_at(body, {10, 0, 10}).maxCoeff() < 0.01f);    // the small box's front
    CHECK(colour_at(body, {10, 6, 10}).minCoeff() > 0.99f);    // its back
    CHECK(colour_at(body, {8, 3, 10}).minCoeff() > 0.99f);     // its side
    CHECK(colour_at(body, {6.5, 10, 10}).maxCoeff() < 0.01f);  // the large box beside it
    CHECK(colour_at(body, {10, 10, 10}).minCoeff() > 0.99f);   // and behind it
    CHECK(colour_at(body, {10, 14, 10}).minCoeff() > 0.99f);   // its back
    CHECK(colour_at(body, {1, 10, 10}).minCoeff() > 0.99f);    // outside the rectangle
}

TEST_CASE("A decal lies over the model's colour as far as it is opaque, upright and as large as it was said") {
    const io::TemporaryFolder folder;
    // Left half red, half as opaque; right half blue; the lower row is clear.
    io::Picture8 picture{4, 2, 4, {}};
    for (int y = 0; y < 2; ++y)
        for (int x = 0; x < 4; ++x) {
            const bool left = x < 2;
            for (const int code : {left ? 255 : 0, 0, left ? 0 : 255, y == 1 ? 0 : left ? 128 : 255})
                picture.codes.push_back(std::uint8_t(code));
        }
    io::write_whole_file(folder.path() / "two.png", io::png_bytes(picture));
    Body body = box({20, 20, 20}, white);
    const std::string file = (folder.path() / "two.png").string();
    const LaidMarks laid = lay_marks({parse_mark(MarkFamily::decal, file + "; place=left; size=8mm; at=2,3")},
                                     {body.mesh, body.solid, body.surface}, {});
    CHECK_THAT(laid.notes.at(0), Contains("8.0 x 4.0 mm on the left"));
    // Who looks at the left side has -y to the right: the middle of the decal is at y = 10 - 2, z = 10 + 3.
    CHECK((colour_at(body, {0, 10, 14}) - Eigen::Vector3f(1, 127 / 255.0f, 127 / 255.0f)).norm() < 0.01f);
    CHECK((colour_at(body, {0, 6, 14}) - Eigen::Vector3f(0, 0, 1)).norm() < 0.01f);
    for (const Eigen::Vector3d& clear :
         {Eigen::Vector3d(0, 6, 12), {0, 12.2, 14}, {0, 3.8, 14}, {0, 6, 15.2}, {20, 6, 14}})
        CHECK((colour_at(body, clear) - white).norm() < 1e-3f);
    CHECK_THROWS_WITH(lay_marks({parse_mark(MarkFamily::decal, file + "; place=left; size=8mm; at=2,30")},
                                {body.mesh, body.solid, body.surface}, {}),
                      Contains("hits nothing"));
    CHECK_THROWS_WITH(lay_marks({parse_mark(MarkFamily::decal, "nowhere.png; place=left; size=8mm")},
                                {body.mesh, body.solid, body.surface}, {}),
                      Contains("nowhere.png"));
}

TEST_CASE("A decal whose pixels are higher than wide is as high as they are") {
    const io::TemporaryFolder folder;
    const std::filesystem::path file = folder.path() / "tall.png";
    io::write_whole_file(file, io::png_bytes({4, 1, 3, std::vector<std::uint8_t>(12, 40)}, {20, 10}));
    Body body = box({20, 20, 20}, white);
    const LaidMarks laid = lay_marks({parse_mark(MarkFamily::decal, file.string() + "; place=left; size=8mm")},
                                     {body.mesh, body.solid, body.surface}, {});
    CHECK_THAT(laid.notes.at(0), Contains("8.0 x 4.0 mm"));
}

TEST_CASE("What there is to say of a decal's picture is said, and one without any alpha is taken as opaque") {
    const io::TemporaryFolder folder;
    const std::filesystem::path file = folder.path() / "clear.png";
    io::write_whole_file(file, io::png_bytes({2, 1, 4, {200, 40, 40, 0, 200, 40, 40, 0}}));
    Body body = box({20, 20, 20}, white);
    const LaidMarks laid = lay_marks({parse_mark(MarkFamily::decal, file.string() + "; place=left; size=8mm")},
                                     {body.mesh, body.solid, body.surface}, {});
    REQUIRE(laid.warnings.size() == 1);
    CHECK_THAT(laid.warnings[0], Contains("--decal") && Contains("clear.png") && Contains("opaque"));
    CHECK(colour_at(body, {0, 10, 10}).z() < 0.1f);
}

TEST_CASE("A mark in a rectangle of the texture lies where the texture does") {
    Body body = box({10, 10, 10}, white);
    body.mesh.corner_uv.assign(12, {Eigen::Vector2f(2, 2), Eigen::Vector2f(2, 2), Eigen::Vector2f(2, 2)});
    // The top is triangles 2 and 3: (4, 5, 6), (5, 7, 6).
    body.mesh.corner_uv[2] = {Eigen::Vector2f(0, 0), Eigen::Vector2f(1, 0), Eigen::Vector2f(0, 1)};
    body.mesh.corner_uv[3] = {Eigen::Vector2f(1, 0), Eigen::Vector2f(1, 1), Eigen::Vector2f(0, 1)};
    lay(body, {"qr=by texture; place=uv:0.1,0.1,0.9,0.9"});
    CHECK(test::code_in(test::seen_from(body, Eigen::Vector3d::UnitZ(), 0.05)) == "by texture");
    CHECK(colour_at(body, {5, 0, 5}) == white);
}

TEST_CASE("A label at a point faces as the surface does there") {
    Body body = test::body_of(shapes::sphere(10, 64), white);
    const Eigen::Vector3d out = Eigen::Vector3d(1, -1, 0.5).normalized();
    const Eigen::Vector3d point = 10 * out;
    lay(body, {fmt::format("qr=round; size=5mm; place={:.3f},{:.3f},{:.3f}", point.x(), point.y(), point.z())});
    CHECK(body.mesh.decals[0].out.dot(out) > 0.999);
    CHECK(test::code_in(test::seen_from(body, out, 0.05)) == "round");
}

TEST_CASE("What cannot be laid is refused in a sentence") {
    Body body = box({10, 10, 10}, white);
    CHECK_THROWS_WITH(lay(body, {"A; place=front; at=30,0"}), Contains("--label 'A': hits nothing") && Contains("at="));
    CHECK_THROWS_WITH(lay(body, {"AAAA; place=front; at=4,0"}), Contains("beside the face"));
    CHECK_THROWS_WITH(lay(body, {"A\xE2\x98\x83\xF0\x93\x80\x80"}), Contains("has no '\xF0\x93\x80\x80'"));
    CHECK_THROWS_WITH(lay(body, {"A; font=No Such Letters"}), Contains("no font 'No Such Letters'"));
    CHECK_THROWS_WITH(lay(body, {"A; font=" + test::source_dir() + "/README.md/x.ttf"}), Contains("x.ttf"));
    CHECK_THROWS_WITH(lay(body, {"datamatrix=" + std::string(4000, 'x')}), Contains("does not go into a Data Matrix"));
    CHECK_THROWS_WITH(lay(body, {"A; place=uv:0,0,1,1"}), Contains("hits nothing"));
    CHECK(body.mesh.decals.empty());
}

TEST_CASE("A mark is spelled by its subject and words about it") {
    const MarkOptions plain = label("A-17");
    CHECK(plain.text == "A-17");
    CHECK(plain.size_mm == Approx(6 * 25.4 / 72));
    CHECK(std::get<MarkSide>(plain.place) == MarkSide::unseen);
    const MarkOptions long_one = label("a \\; b\\n= c; size=3pt; place=1mm,2,3; turn=-90; colour=#ff0000");
    CHECK(long_one.text == "a ; b\n= c");
    CHECK(long_one.size_mm == Approx(25.4 / 24));
    CHECK(std::get<Eigen::Vector3d>(long_one.place) == Eigen::Vector3d(1, 2, 3));
    CHECK(long_one.ink_rgb == Eigen::Vector3f(1, 0, 0));
    CHECK(label("1 + 1 = 2").text == "1 + 1 = 2");
    const MarkOptions code = label("qr=https://a.example/?b=c");
    CHECK(code.text == "https://a.example/?b=c");
    CHECK(code.ground_rgb == Eigen::Vector3f(1, 1, 1));
    const std::string spelled = spell_mark(split_mark(MarkFamily::label, "a \\; b\\n\\\\; size=3pt"));
    CHECK(label(spelled).text == "a ; b\n\\");
    const auto fault = [](MarkFamily family, const std::string& words) {
        try {
            (void)parse_mark(family, words);
        } catch (const UsageError& error) {
            return std::string(error.what());
        }
        return std::string("taken");
    };
    // Words that stand with the text would be printed with it.
    for (const char* together : {"A-17 size=6pt", "A-17, place=bottom", "A; place=top size=3mm", "text=A, size=3mm"})
        CHECK_THAT(fault(MarkFamily::label, together), Contains("behind semicolons") && Contains("; "));
    CHECK_THAT(fault(MarkFamily::decal, "logo.png size=20mm"), Contains("write '; size='"));
    for (const char* meant : {"y=2 x=3", "A size\\=6pt", "qr=https://example.org/?a=1&size=3", "text=size=6pt"})
        CHECK_NOTHROW(label(meant));
    const std::string literal = spell_mark({{"text", "A size=6pt"}});
    CHECK(label(literal).text == "A size=6pt");
    CHECK_THAT(fault(MarkFamily::label, "A; sise=3pt"), Contains("'sise' is none of its words") && Contains("size"));
    CHECK_THAT(fault(MarkFamily::label, "A; place=beneath"), Contains("unseen, flattest, front"));
    CHECK_THAT(fault(MarkFamily::label, "A; size=0"), Contains("not above 0"));
    CHECK_THAT(fault(MarkFamily::label, "A; size=3pt; size=4pt"), Contains("said twice"));
    CHECK_THAT(fault(MarkFamily::label, "A; qr=B"), Contains("one text or one code"));
    CHECK_THAT(fault(MarkFamily::label, "A; colour=pink"), Contains("#rrggbb"));
    CHECK_THAT(fault(MarkFamily::label, "A; at=1,2"), Contains("say which"));
    CHECK_THAT(fault(MarkFamily::label, "A; engrave=0"), Contains("whole number of voxels"));
    CHECK_THAT(fault(MarkFamily::label, "A; place=uv:0.5,0,0.2,1"), Contains("uv:left,bottom"));
    CHECK_THAT(fault(MarkFamily::label, " "), Contains("says nothing"));
    CHECK_THAT(fault(MarkFamily::label, "A; colour=none"), Contains("nothing to be seen"));
    CHECK_THAT(fault(MarkFamily::label, "A; resin=K; colour=black"), Contains("not both"));
    CHECK_THAT(fault(MarkFamily::label, "A; resin=K; ground=white"), Contains("ground= does not go with it"));
    CHECK_THAT(fault(MarkFamily::decal, "logo.png; place=front"), Contains("size=20mm"));
    CHECK_THAT(fault(MarkFamily::decal, "logo.png; size=9mm; font=x"), Contains("'font' is none"));
}

TEST_CASE("Names in braces stand for values, braces for themselves when doubled") {
    const auto text = [](const std::string& spelled, const TemplateValues& values) {
        const MarkOptions mark = parse_mark(MarkFamily::label, with_values(spelled, values));
        return settled_text(mark.text, mark.said);
    };
    CHECK(text("{job}-{copy:03}; size=4pt", {{"job", "cow"}, {"copy", "7"}}) == "cow-007");
    CHECK(text("qr={a}{a}", {{"a", "{b}"}}) == "{b}{b}");
    CHECK(text("gs1=(21){serial:04}", {{"serial", "17"}}) == "(21)0017");
    CHECK(text("{{job}}", {{"job", "cow"}}) == "{job}");
    CHECK_THROWS_WITH(text("{n:2}", {{"n", "1"}}), Contains("number of digits"));
    CHECK_THROWS_WITH(text("{jib}", {{"job", "cow"}}), Contains("{jib} stands for nothing") && Contains("{copy}"));
    CHECK(names_value("{job}-{copy:03}", "copy"));
    CHECK_FALSE(names_value("{{copy}}", "copy"));
    // Some values come first, others later.
    CHECK(text(with_values("{row} {copy}", {{"row", "{copy}"}}), {{"copy", "2"}}) == "{copy} 2");
}

TEST_CASE("A drawing as a decal is as sharp as the print, whatever its size") {
    try {
        (void)io::find_helper("voxtone-read-drawings");
    } catch (const FileError&) {
        test::skip("no voxtone-read-drawings in this build");
        return;
    }
    const io::TemporaryFolder folder;
    const std::string file = (folder.path() / "half.svg").string();
    io::write_whole_file(
        file, std::string("<svg xmlns='http://www.w3.org/2000/svg' width='2' height='1'><path d='M1 0h1v1h-1z' "
                          "fill='#c82828'/></svg>"));
    constexpr double pitch_mm = 0.05;
    for (const double width_mm : {4.0, 30.0}) {
        Body body = box({40, 20, 5}, white);
        const MarkOptions mark =
            parse_mark(MarkFamily::decal, fmt::format("{}; place=20,10,5; size={}mm", file, width_mm));
        const LaidMarks laid = lay_marks({mark}, {body.mesh, body.solid, body.surface, false, pitch_mm}, {});
        CHECK(laid.warnings.empty());
        CHECK(body.mesh.decals.at(0).picture->width_px() == std::uint32_t(std::lround(width_mm / pitch_mm)));
        const Eigen::Vector3f beside = colour_at(body, {20 - 1.5 * pitch_mm, 10, 5}),
                              inked = colour_at(body, {20 + 1.5 * pitch_mm, 10, 5});
        CHECK(beside.isApprox(white, 1e-3f));
        CHECK(inked.x() == Approx(0.5776).margin(2e-3));  // sRGB 200
        CHECK(inked.y() == Approx(0.0212).margin(2e-3));  // 40
    }
}
