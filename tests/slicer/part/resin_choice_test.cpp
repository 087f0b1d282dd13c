// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/part/resin_choice.h"

#include <algorithm>
#include <string>
#include <vector>

#include <catch2/catch.hpp>

#include "tests/slicer/mesh/shapes.h"
#include "tests/slicer/print/sample_body.h"

using namespace voxtone;
using namespace voxtone::slicer;
using Catch::Matchers::Contains;

namespace {

const Eigen::Vector3f red(0.4f, 0.02f, 0.02f), yellow(0.7f, 0.5f, 0.02f), cyan(0.02f, 0.3f, 0.5f),
    white(0.75f, 0.75f, 0.7f);

struct Choosing {
    /// A box of 4 mm of these colours, a triangle each in turn.
    explicit Choosing(const std::vector<Eigen::Vector3f>& colours, const std::string& printer = "stratasys-j750-hs") {
        sample.options.printer = printer;
        const SolidMesh mesh = shapes::box({0, 0, 0}, {4, 4, 4});
        std::vector<Eigen::Vector3f> rgb;
        for (std::size_t t = 0; t < mesh.triangles.size(); ++t) rgb.push_back(colours[t % colours.size()]);
        body = test::body_of(mesh, {0.042, 0.085, 0.027}, rgb);
    }
    [[nodiscard]] std::optional<ResinChoice> choice() {
        Progress progress;
        return choose_resins(sample.opened(), body, progress);
    }
    test::SampleJob sample{"0", "none"};
    JobBody body;
};

bool holds(const std::vector<std::string>& roles, const char* role) {
    return std::find(roles.begin(), roles.end(), role) != roles.end();
}

}  // namespace

TEST_CASE("A printer of three resins is loaded for the colours of the model, and white always") {
    const auto of_yellow = Choosing({yellow, white}).choice(), of_cyan = Choosing({cyan, white}).choice();
    REQUIRE(of_yellow);
    REQUIRE(of_cyan);
    for (const auto& choice : {*of_yellow, *of_cyan}) {
        CHECK(choice.roles.size() == 3);
        CHECK(holds(choice.roles, "W"));
        CHECK_FALSE(holds(choice.roles, "T"));
        CHECK_THAT(choice.why, Contains("stratasys-j750-hs carries 3 resins at once: ") && Contains("of 6 sets") &&
                                   Contains("with its default M, K, W") && Contains("--load"));
    }
    CHECK(holds(of_yellow->roles, "Y"));
    CHECK(holds(of_cyan->roles, "C"));
    Choosing both({red, yellow});
    const auto of_red = both.choice();
    REQUIRE(of_red);
    CHECK(of_red->roles == std::vector<std::string>{"M", "Y", "W"});
    Progress progress;
    const OpenedJob chosen = with_best_resins(both.sample.opened(), both.body, progress);
    CHECK(chosen.why_these_resins == of_red->why);
    CHECK(chosen.resins.entries.size() == 3);
    CHECK(chosen.options.raw.load.empty());
}

TEST_CASE("Nothing is chosen where the user did, where all have their slot, and where white is enough") {
    Choosing named({yellow});
    named.sample.options.load = {"M", "C", "W"};
    CHECK_FALSE(named.choice());
    CHECK_FALSE(Choosing({yellow}, "stratasys-j750-hm").choice());
    Choosing coated({yellow});
    coated.sample.options.coat_mm = 0.2;
    coated.sample.options.load.clear();
    Choosing empty({yellow});
    empty.body.surface = SurfaceIndex(VisibleSurface());
    CHECK_FALSE(empty.choice());
    CHECK_FALSE(most_helpful_resin(empty.sample.opened(), empty.body));
}

TEST_CASE("Of a resin that would help it is said which, how much, and whether it has a slot") {
    Choosing of_yellow({yellow, white});
    of_yellow.sample.options.load = {"C", "K", "W"};
    const auto helps = most_helpful_resin(of_yellow.sample.opened(), of_yellow.body);
    REQUIRE(helps);
    CHECK(helps->role == "Y");
    CHECK(helps->mean_de2000 < 0.75 * helps->now_de2000);
    CHECK_FALSE(helps->has_slot);
    CHECK(helps->loaded_with == "C,K,W,Y");
    Choosing roomy({yellow, white}, "stratasys-j750-hm");
    roomy.sample.options.load = {"C", "K", "W"};
    const auto with_slot = most_helpful_resin(roomy.sample.opened(), roomy.body);
    REQUIRE(with_slot);
    CHECK(with_slot->has_slot);
    CHECK(with_slot->now_de2000 == Approx(helps->now_de2000).epsilon(0.05));
    // Nothing helps what is shown already.
    roomy.sample.options.load = {"C", "M", "Y", "K", "W"};
    CHECK_FALSE(most_helpful_resin(roomy.sample.opened(), roomy.body));
}

TEST_CASE("A dark core costs light colours, which is said, and a white one costs nothing") {
    Choosing light({white, yellow}, "stratasys-j750-hm");
    light.sample.options.depth_mm = 0.2;
    CHECK_FALSE(loss_with_white_core(light.sample.opened(), light.body));
    light.sample.options.core = "K";
    const auto loss = loss_with_white_core(light.sample.opened(), light.body);
    REQUIRE(loss);
    CHECK(loss->mean_de2000 < 0.75 * loss->now_de2000);
    CHECK(loss->mean_de2000 < loss->now_de2000 - 0.5);
    light.sample.options.load = {"K", "Y", "M"};
    CHECK_FALSE(loss_with_white_core(light.sample.opened(), light.body));
}

TEST_CASE("Where clear resin is not loaded, the set of the same cartridges that has it is named") {
    for (const auto& [set, twin] :
         {std::pair("j750-opaque", "vero-opaque-clear"), {"j750-vivid", "j750-vivid-clear"}}) {
        test::SampleJob sample;
        sample.options.resins = set;
        sample.options.coat_mm = 0.2;
        CHECK_THROWS_WITH(sample.opened(), Catch::Contains("takes clear resin (role T)") &&
                                               Catch::Contains(std::string("give --resins ") + twin + " --load"));
    }
}
