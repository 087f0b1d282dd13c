// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/look/surface_prediction.h"

#include <algorithm>
#include <array>
#include <stdexcept>
#include <string>
#include <vector>

#include <catch2/catch.hpp>

#include "optics/transport/transport.h"
#include "slicer/look/prediction_files.h"
#include "tests/optics/colour/split_channels.h"

using namespace voxtone;
using namespace voxtone::slicer;

namespace {

bool all_white(const optics::Scene& scene) {
    return scene.volume->at(0, 0, 0) == static_cast<optics::Material>(scene.resins->find("W") + 1);
}

/// Sees one grey everywhere and has something to say of it; another one of a body all of white.
class Remarks final : public optics::AppearanceModel {
public:
    [[nodiscard]] optics::Appearance predict(const optics::Scene& scene, const optics::Surface& surface,
                                             const Progress* /*progress*/) const override {
        const bool white = all_white(scene);
        return {3,
                std::vector<float>(3 * surface.cells.size(), white ? 0.8f : 0.2f),
                {},
                {white ? "of the twin" : "of the body"}};
    }
};

/// The same light everywhere, another in each of four channels.
class FourChannels final : public optics::AppearanceModel {
public:
    [[nodiscard]] optics::Appearance predict(const optics::Scene& scene, const optics::Surface& surface,
                                             const Progress* /*progress*/) const override {
        optics::Appearance seen{4, {}, {}, {}};
        for (std::size_t i = 0; i < surface.cells.size(); ++i)
            for (const float value :
                 all_white(scene) ? std::array{0.8f, 0.9f, 0.7f, 1.0f} : std::array{0.1f, 0.2f, 0.3f, 0.4f})
                seen.value.push_back(value);
        return seen;
    }
};

class Listens final : public Progress {
public:
    std::vector<std::string> warnings;

private:
    void on_warning(const std::string& warning) override { warnings.push_back(warning); }
};

}  // namespace

TEST_CASE("Prints in channels of their own are predicted as the R, G, B prints that show the same colours") {
    const optics::ResinSet rgb = optics::vero_opaque();
    // Stripes of cyan, magenta, yellow and black on white.
    const optics::ResinVolume volume = optics::make_resin_volume(
        {24, 12, 30}, {0.0423, 0.0847, 0.027}, [](int x, int, int z) { return z < 24 ? 5 : 1 + x / 6; });
    const auto predicted = [&](const optics::ResinSet& set, bool relative) {
        const optics::Scene scene{&volume, &set, optics::Backing::black, optics::Sides::open};
        Progress quiet;
        optics::TransportOptions options;
        options.refinement = optics::Refinement::none;
        const optics::TransportPredictor model(options);
        return predict_surface(scene, optics::find_surface(scene, {2, 1, 3}, optics::SurfacePart::top), model,
                               relative ? set.find("W") : -1, quiet);
    };
    for (const bool relative : {true, false}) {
        const SurfacePrediction as_rgb = predicted(rgb, relative);
        for (const optics::testing::Parts& parts : {optics::testing::green_twice, optics::testing::all_twice}) {
            const SurfacePrediction own = predicted(optics::testing::split_set(rgb, parts), relative);
            REQUIRE(own.channels == parts.size());
            REQUIRE(own.rgb.size() == as_rgb.rgb.size());
            float worst = 0;
            for (std::size_t i = 0; i < own.rgb.size(); ++i) {
                worst = std::max(worst, (own.rgb[i] - as_rgb.rgb[i]).cwiseAbs().maxCoeff());
                for (std::size_t c = 0; c < parts.size(); ++c)
                    REQUIRE(own.value[i * parts.size() + c] == Approx(as_rgb.value[3 * i + parts[c]]).epsilon(1e-5));
            }
            CHECK(worst < 1e-5f);
        }
        if (relative) {
            const io::NumberPicture picture =
                top_numbers(volume, optics::testing::split_channels({0, 1, 1, 2}),
                            predicted(optics::testing::split_set(rgb, {0, 1, 1, 2}), true));
            CHECK(picture.names == std::vector<std::string>{"R", "G", "B", "A", "c1", "c2", "c3", "c4"});
        }
    }
}

TEST_CASE("Colours are relative to white as colours, whatever the channels") {
    optics::ResinSet set = optics::testing::split_set(optics::vero_opaque(), optics::testing::green_twice);
    set.channels = optics::testing::overlapping_channels();
    const optics::ResinVolume volume =
        optics::make_resin_volume({4, 4, 4}, {0.1, 0.1, 0.1}, [](int, int, int) { return 1; });
    const optics::Scene scene{&volume, &set, optics::Backing::none, optics::Sides::open};
    Progress quiet;
    const SurfacePrediction prediction = predict_surface(
        scene, optics::find_surface(scene, {1, 1, 1}, optics::SurfacePart::all), FourChannels(), set.find("W"), quiet);
    const Eigen::Matrix3Xd M = optics::linear_srgb_weights(set.channels);
    const Eigen::Vector3d body = M * Eigen::Vector4d(0.1, 0.2, 0.3, 0.4), paper = M * Eigen::Vector4d(0.8, 0.9, 0.7, 1);
    CHECK((prediction.rgb[0].cast<double>() - body.cwiseQuotient(paper)).norm() < 1e-6);
    CHECK(prediction.value[2] == Approx(0.3 / 0.7));
    // White that was seen before is not asked for again.
    class BodyAlone final : public optics::AppearanceModel {
        optics::Appearance predict(const optics::Scene& of, const optics::Surface& surface,
                                   const Progress* progress) const override {
            return FourChannels().predict(of, surface, progress);
        }
        optics::TwinAppearances predict_with_twin(const optics::Scene&, const optics::Surface&,
                                                  const optics::ResinVolume&, const Progress*) const override {
            throw std::logic_error("white was asked for");
        }
    };
    std::vector<float> white;
    for (std::size_t i = 0; i < prediction.rgb.size(); ++i) white.insert(white.end(), {0.8f, 0.9f, 0.5f, 1.0f});
    const SurfacePrediction known =
        predict_surface(scene, optics::find_surface(scene, {1, 1, 1}, optics::SurfacePart::all), BodyAlone(),
                        set.find("W"), quiet, {nullptr, &white});
    CHECK(known.value[2] == Approx(0.3 / 0.5));
    const Eigen::Vector3d other = M * Eigen::Vector4d(0.8, 0.9, 0.5, 1);
    CHECK((known.rgb[0].cast<double>() - body.cwiseQuotient(other)).norm() < 1e-6);
}

TEST_CASE("What a model remarks of the body and of its white twin is kept and warned of") {
    const optics::ResinSet set = optics::vero_opaque();
    const optics::ResinVolume volume =
        optics::make_resin_volume({4, 4, 4}, {0.1, 0.1, 0.1}, [](int, int, int) { return 1; });
    const optics::Scene scene{&volume, &set, optics::Backing::none, optics::Sides::open};
    const Remarks model;
    const auto surface = [&] { return optics::find_surface(scene, {1, 1, 1}, optics::SurfacePart::all); };
    Listens relative, absolute;
    const SurfacePrediction prediction = predict_surface(scene, surface(), model, set.find("W"), relative);
    CHECK(prediction.remarks ==
          std::vector<std::string>{"of the body", "of the white that colours refer to: of the twin"});
    CHECK(relative.warnings == prediction.remarks);
    CHECK(prediction.value.front() == Approx(0.25));
    CHECK(predict_surface(scene, surface(), model, -1, absolute).remarks == std::vector<std::string>{"of the body"});
    CHECK(absolute.warnings == std::vector<std::string>{"of the body"});
}
