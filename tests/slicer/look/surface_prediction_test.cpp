// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/slicer/look/surface_prediction.h"

#include <string>
#include <vector>

#include <catch2/catch.hpp>

using namespace voxtone;
using namespace voxtone::slicer;

namespace {

/// Sees one grey everywhere and has something to say of it.
class Remarks final : public optics::AppearanceModel {
public:
    Remarks(float grey, std::string remark) : grey_(grey), remark_(std::move(remark)) {}
    [[nodiscard]] optics::Appearance predict(const optics::Scene& /*scene*/, const optics::Surface& surface,
                                             const Progress* /*progress*/) const override {
        return {3, std::vector<float>(3 * surface.cells.size(), grey_), {}, {remark_}};
    }

private:
    float grey_;
    std::string remark_;
};

class Listens final : public Progress {
public:
    std::vector<std::string> warnings;

private:
    void on_warning(const std::string& warning) override { warnings.push_back(warning); }
};

}  // namespace

TEST_CASE("What a model remarks of the body and of its white twin is kept and warned of") {
    const optics::ResinSet set = optics::vero_opaque();
    const optics::ResinVolume volume =
        optics::make_resin_volume({4, 4, 4}, {0.1, 0.1, 0.1}, [](int, int, int) { return 1; });
    const optics::Scene scene{&volume, &set, optics::Backing::none, optics::Sides::open};
    const auto model = [](bool white) {
        return std::make_unique<const Remarks>(white ? 0.8f : 0.2f, white ? "of the twin" : "of the body");
    };
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
