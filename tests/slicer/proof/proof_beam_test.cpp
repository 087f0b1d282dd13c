// SPDX-License-Identifier: GPL-3.0-or-later
//
// Where beams fall on slabs, and what is told of how far light goes on beside them.
#include "slicer/proof/proof_beam.h"

#include <cmath>

#include <catch2/catch.hpp>

#include "base/error.h"
#include "base/random.h"
#include "slicer/proof/beam_response.h"
#include "slicer/proof/proof_colours.h"
#include "slicer/proof/solid_boxes.h"

using namespace voxtone;
using namespace voxtone::slicer;
using Catch::Matchers::Contains;
using Eigen::Vector3d;

namespace {

/// Two slabs of 10 x 8 x 2 mm, 2 mm apart, each a print of its own, seen from above; 20 pixels a mm.
struct TwoSlabs {
    TwoSlabs() {
        for (const double left : {0.0, 12.0}) {
            auto print = std::make_unique<ProofPrint>();
            print->boxes = {{Vector3d::Zero(), {10, 8, 2}}};
            scene.prints.push_back(std::move(print));
            scene.camera.prints.push_back({nullptr, &sides, nullptr, {left, 0, 0}});
        }
        scene.camera.view = {.position = {11, 4, 1002},
                             .target = {11, 4, 0},
                             .up = {0, 1, 0},
                             .focal_mm = optics::film_width_mm / 24 * 1000,
                             .width_px = 480,
                             .height_px = 200};
        pieces = seen_pieces(scene, progress);
    }
    optics::FlatSides sides{
        {{{1, 0, 0}, 10}, {{-1, 0, 0}, 0}, {{0, 1, 0}, 8}, {{0, -1, 0}, 0}, {{0, 0, 1}, 2}, {{0, 0, -1}, 0}}};
    ProofScene scene;
    std::vector<SeenPiece> pieces;
    Progress progress;
};

const ProofLamp edge{"edge", ProofLight::edge}, slit{"slit", ProofLight::slit}, spot{"spot", ProofLight::spot};

/// Luminance that falls off by exp(-distance / mm) outside of the beam, as the edge's does on both sides.
std::vector<Eigen::Vector3f> falling(const TwoSlabs& slabs, const optics::Beam& beam, const double (&mm)[2],
                                     double noise) {
    const optics::Camera camera(slabs.scene.camera.view);
    std::vector<Eigen::Vector3f> colours(480 * 200, Eigen::Vector3f::Zero());
    for (std::size_t p = 0; p < colours.size(); ++p) {
        const auto seen = seen_print(slabs.scene, camera, p);
        if (!seen) continue;
        const optics::Point at = optics::along(seen->place_mm, slabs.scene.camera.prints[seen->print].corner_mm, 1);
        double light = 0;
        for (const optics::BeamPlane& plane : beam.planes()) {
            const double outside = beam.outside_mm(plane, at),
                         fall = 0.5 * std::exp(-std::abs(outside) / mm[seen->print]);
            light = std::max(light, outside < 0 ? 1 - fall : fall);
        }
        RandomStream random(3, p);
        colours[p].setConstant(static_cast<float>(light + noise * (random.uniform() - 0.5)));
    }
    return colours;
}

}  // namespace

TEST_CASE("an edge lies across the slab in the middle, a spot on each, and both turn about their place") {
    const TwoSlabs slabs;
    REQUIRE(slabs.pieces.size() == 2);
    CHECK(slabs.pieces[1].slab == 0);
    ResolvedProof job;
    const optics::Beam across = make_beam(job, edge, slabs.scene, slabs.pieces);
    REQUIRE(across.planes().size() == 1);
    CHECK(across.planes()[0].place[1] == Approx(4).margin(0.06));  // a pixel
    CHECK(across.planes()[0].place[2] == Approx(2));
    CHECK(across.planes()[0].normal[2] == Approx(1));
    CHECK(across.outside_mm(across.planes()[0], {5, 6, 2}) == Approx(-2).margin(0.06));  // lit above
    const optics::Beam spots = make_beam(job, spot, slabs.scene, slabs.pieces);
    REQUIRE(spots.planes().size() == 2);
    CHECK(spots.kind().width_mm == 2);
    CHECK(spots.kind().times == 1);
    const optics::Beam laser = make_beam(job, {"laser", ProofLight::laser}, slabs.scene, slabs.pieces);
    CHECK(laser.planes().size() == 2);
    CHECK(laser.kind().width_mm == 1);
    CHECK(laser.kind().times == Approx(4));
    CHECK_THAT(beam_words(laser), Contains("a laser, 1 mm wide, at ("));
    CHECK(spots.planes()[0].place[0] == Approx(5).margin(0.06));
    CHECK(spots.planes()[1].place[0] == Approx(17).margin(0.06));
    job.requested.turn_light_deg = 90;
    job.requested.light_width_mm = 0.5;
    job.requested.light_at = "15,3,2";
    job.light_at = {15, 3, 2};
    const optics::Beam turned = make_beam(job, slit, slabs.scene, slabs.pieces);
    CHECK(turned.kind().width_mm == 0.5);
    CHECK(turned.planes()[0].place[0] == Approx(15));
    CHECK(turned.outside_mm(turned.planes()[0], {16, 7, 2}) == Approx(0.75));
    const optics::Beam left = make_beam(job, edge, slabs.scene, slabs.pieces);
    CHECK(left.outside_mm(left.planes()[0], {14, 7, 2}) == Approx(-1));
    CHECK_THAT(beam_words(turned), Contains("0.5 mm wide, across (15, 3, 2) mm"));
}

TEST_CASE("on a body an edge stands upright, lit on the left, and the lamp above") {
    TwoSlabs slabs;
    auto body = std::make_unique<ProofPrint>();  // as the first, but not known as a slab
    slabs.scene.prints[0] = std::move(body);
    slabs.scene.prints.pop_back();
    slabs.scene.camera.prints.pop_back();
    const auto pieces = seen_pieces(slabs.scene, slabs.progress);
    REQUIRE(pieces.size() == 1);
    CHECK(pieces[0].slab == -1);
    const optics::Beam beam = make_beam({}, edge, slabs.scene, pieces);
    CHECK(beam.planes()[0].along[1] == Approx(1));
    CHECK(beam.outside_mm(beam.planes()[0], {3, 1, 2}) == Approx(-2).margin(0.06));
    CHECK(beam.radiance({3, 1, 2}, optics::Point{0, std::sqrt(0.5), std::sqrt(0.5)})[0] > 0);
    CHECK(beam_responses(slabs.scene, beam, pieces, std::vector(480 * 200, Eigen::Vector3f(1, 1, 1))).empty());
}

TEST_CASE("a beam on nothing that is seen is refused in a sentence") {
    TwoSlabs slabs;
    ResolvedProof job;
    CHECK_THROWS_WITH(make_beam(job, edge, slabs.scene, {}), Contains("sees no print"));
    job.requested.light_at = "11,4,2";  // between them
    job.light_at = {11, 4, 2};
    CHECK_THROWS_AS(make_beam(job, spot, slabs.scene, slabs.pieces), InputError);
    CHECK_THROWS_WITH(make_beam(job, spot, slabs.scene, slabs.pieces), Contains("--light-at 11,4,2"));
}

TEST_CASE("from pixels it is told within which distance light falls to a half and a tenth of the border's") {
    const TwoSlabs slabs;
    const double mm[2] = {0.4, 0.9};
    for (const ProofLamp& lamp : {edge, slit, spot})
        for (const double noise : {0.0, 0.05}) {
            CAPTURE(lamp.words, noise);
            const optics::Beam beam = make_beam({}, lamp, slabs.scene, slabs.pieces);
            const auto responses = beam_responses(slabs.scene, beam, slabs.pieces, falling(slabs, beam, mm, noise));
            REQUIRE(responses.size() == 2);
            for (std::size_t k = 0; k < 2; ++k) {
                CHECK(responses[k].print == k);
                const auto& [half, tenth] = std::tie(responses[k].half, responses[k].tenth);
                REQUIRE(half);
                REQUIRE(tenth);
                // Between rows of a pixel, 0.05 mm, the profile is taken as straight: by so much it falls otherwise.
                CHECK(half->mm == Approx(mm[k] * std::log(2.0)).margin(0.01 + 4 * half->error_mm));
                CHECK(tenth->mm == Approx(mm[k] * std::log(10.0)).margin(0.02 + 4 * tenth->error_mm));
                CHECK((noise > 0 ? half->error_mm > 1e-4 : half->error_mm < 0.02));
                CHECK(half->error_mm < 0.05);
            }
            CHECK(responses[1].half->mm - responses[0].half->mm > 0.3);
        }
}

TEST_CASE("a distance that lies beyond the face is not told") {
    const TwoSlabs slabs;
    const optics::Beam beam = make_beam({}, edge, slabs.scene, slabs.pieces);
    const double mm[2] = {0.4, 3};  // a tenth at 6.9 mm, the face ends at 4
    const auto responses = beam_responses(slabs.scene, beam, slabs.pieces, falling(slabs, beam, mm, 0));
    CHECK(responses[0].tenth);
    CHECK(responses[1].half);
    CHECK_FALSE(responses[1].tenth);
}

TEST_CASE("slabs side by side are known as boxes, and nothing else is") {
    const auto volume = [](auto&& solid) {
        return optics::make_resin_volume({20, 6, 5}, {0.1, 0.2, 0.3},
                                         [&](int x, int y, int z) { return solid(x, y, z) ? 1 : 0; });
    };
    const auto two = [](int x, int, int z) { return (x < 7 && z < 5) || (x >= 10 && x < 18 && z < 3); };
    const std::vector<Box> boxes = solid_boxes(volume(two));
    REQUIRE(boxes.size() == 2);
    CHECK((boxes[0].low - Vector3d(0, 0, 0)).norm() < 1e-9);
    CHECK((boxes[0].high - Vector3d(0.7, 1.2, 1.5)).norm() < 1e-9);
    CHECK((boxes[1].low - Vector3d(1, 0, 0)).norm() < 1e-9);
    CHECK((boxes[1].high - Vector3d(1.8, 1.2, 0.9)).norm() < 1e-9);
    CHECK(solid_boxes(volume([](int, int, int) { return true; })).size() == 1);
    for (const std::array<int, 3> hole : {std::array{3, 2, 2}, std::array{12, 0, 0}, std::array{0, 5, 4}})
        CHECK(solid_boxes(volume([&](int x, int y, int z) {
                  return two(x, y, z) && std::array{x, y, z} != hole;
              })).empty());
    CHECK(solid_boxes(volume([](int x, int, int z) { return z < 2 || x < 8; })).empty());  // a step
    CHECK(solid_boxes(volume([](int, int, int) { return false; })).empty());
}
