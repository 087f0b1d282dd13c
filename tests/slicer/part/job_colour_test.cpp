// SPDX-License-Identifier: GPL-3.0-or-later
//
// Which resins are loaded, when clear resin is among them, and the shell that colours are separated for.
#include "slicer/part/job_colour.h"

#include <catch2/catch.hpp>

#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "base/error.h"
#include "io/profiles/resin_file.h"
#include "slicer/part/prediction_plan.h"
#include "tests/slicer/print/sample_body.h"

using namespace voxtone;
using namespace voxtone::slicer;
using Catch::Matchers::Message;
using Roles = std::vector<std::string>;

namespace {

/// A printer of so many resins, which carries C, M, Y, K and W where it can.
PrinterProfile printer_of(int resins) {
    PrinterProfile printer = find_printer("stratasys-j750-hq");
    printer.max_resins = resins;
    return printer;
}

Roles roles_of(const LoadedResins& resins) {
    Roles roles;
    for (const io::StackResin& entry : resins.entries) roles.push_back(entry.role);
    return roles;
}

std::string refusal(const ResolvedJob& job, const PrinterProfile& printer) {
    try {
        (void)load_resins(job, printer);
    } catch (const InputError& error) {
        return error.what();
    }
    return {};
}

/// Of a print that shows something else than colours.
class OverBlack final : public OtherOptions {
public:
    [[nodiscard]] double depth_mm() const override { return 3; }
    [[nodiscard]] const std::string& core() const override { return core_; }
    [[nodiscard]] const char* core_option() const override { return "base"; }

private:
    std::string core_ = "K";
};

ResolvedJob with_coat() {
    ResolvedJob job;
    job.colour.coat_mm = 0.3;
    return job;
}

}  // namespace

TEST_CASE("Clear resin is wanted by a core, a coat, what encloses a picture, alpha, and light from behind") {
    CHECK_FALSE(wants_clear({}));
    ResolvedJob job;
    job.colour.core = "T";
    CHECK(wants_clear(job));
    CHECK(wants_clear(with_coat()));
    job = {}, job.colour.enclose_mm = 0.2;
    CHECK(wants_clear(job));
    job = {}, job.colour.alpha = AlphaMeaning::translucency;
    CHECK(wants_clear(job));
    for (const PictureView view : {PictureView::through, PictureView::both}) {
        job = {}, job.picture.view = view;
        CHECK(wants_clear(job));
    }
    job = with_coat(), job.other = std::make_shared<const OverBlack>();  // shows no colours
    CHECK_FALSE(wants_clear(job));
}

TEST_CASE("The set with clear resin of the same cartridges is taken where that is wanted") {
    const PrinterProfile printer = printer_of(6);
    REQUIRE(printer.default_resins == "j750-vivid");
    CHECK(usual_resins({}, printer) == "j750-vivid");
    CHECK(usual_resins(with_coat(), printer) == "j750-vivid-clear");
    PrinterProfile clear = printer;
    clear.default_resins = "vero-opaque-clear";
    CHECK(usual_resins(with_coat(), clear) == "vero-opaque-clear");
}

TEST_CASE("What a printer loads by default is loaded, of a set of its own roles as many as it carries") {
    ResolvedJob job;
    job.resins = "vero-opaque";
    const LoadedResins usual = load_resins(job, printer_of(6));
    CHECK(roles_of(usual) == Roles{"C", "M", "Y", "K", "W"});
    CHECK(usual.core == 4);
    CHECK(usual.core_material() == 5);
    CHECK(usual.entries.size() == usual.set.resins.size());
    // Another order, as it was said.
    job.load = {"W", "K"};
    const LoadedResins two = load_resins(job, printer_of(6));
    CHECK(roles_of(two) == Roles{"W", "K"});
    CHECK((two.core == 0 && two.set.resins.size() == 2));
    CHECK(two.entries[1].rgb == usual.entries[3].rgb);
    CHECK((two.entries[1].name == usual.entries[3].name && two.entries[0].name != two.entries[1].name));
    // However it is written, it is called as the set calls it.
    job.load = {"w", "k"};
    CHECK(roles_of(load_resins(job, printer_of(6))) == Roles{"W", "K"});
    CHECK(load_resins(job, printer_of(6)).entries[0].name == two.entries[0].name);
    // Roles that no printer loads by default: the first that there is room for.
    optics::ResinSet own = optics::vero_opaque();
    job.load.clear(), job.colour.core = "a";
    PrinterProfile printer = printer_of(3);
    printer.default_roles = {"X"};
    for (std::size_t r = 0; r < own.resins.size(); ++r) own.resins[r].role = std::string(1, char('a' + r));
    CHECK(roles_of(load_roles(job, printer, own, {"a", "b"})) == Roles{"a", "b"});
}

TEST_CASE("Clear resin takes a slot that is free, and is asked for where none is") {
    ResolvedJob job = with_coat();
    job.resins = "vero-opaque-clear";
    CHECK(roles_of(load_resins(job, printer_of(6))) == Roles{"C", "M", "Y", "K", "W", "T"});
    CHECK(refusal(job, printer_of(5)) ==
          "--coat 0.3mm takes clear resin (role T), and none is loaded; give --load C,M,Y,W,T");
    job.load = {"C", "T", "W"};
    CHECK(roles_of(load_resins(job, printer_of(3))) == Roles{"C", "T", "W"});
    // Where it is not wanted it is not loaded.
    job.colour.coat_mm = 0, job.load.clear();
    CHECK(roles_of(load_resins(job, printer_of(6))) == Roles{"C", "M", "Y", "K", "W"});
}

TEST_CASE("What takes clear resin is named where there is none, with the set that has some") {
    ResolvedJob job = with_coat();
    job.resins = "vero-opaque";
    const auto said = [&] { return refusal(job, printer_of(6)); };
    CHECK(said() ==
          "--coat 0.3mm takes clear resin (role T), and none is loaded; give --resins vero-opaque-clear "
          "--load C,M,Y,K,W,T");
    job.colour.coat_mm = 0, job.colour.enclose_mm = 0.25;
    CHECK_THAT(said(), Catch::Matchers::StartsWith("--enclose 0.25mm takes clear resin"));
    job.colour.alpha = AlphaMeaning::translucency;
    CHECK_THAT(said(), Catch::Matchers::StartsWith("--alpha translucency takes clear resin"));
    job.picture.view = PictureView::through;
    CHECK_THAT(said(), Catch::Matchers::StartsWith("--view through takes clear resin"));
    job = {}, job.resins = "vero-opaque", job.colour.core = "T";
    CHECK_THAT(said(), Catch::Matchers::StartsWith("--core T takes clear resin"));
    job.resins.clear();
    CHECK_THAT(said(), Catch::Matchers::Contains("give --resins j750-vivid-clear --load "));
}

TEST_CASE("More resins than a printer carries, unknown ones and a core that is not loaded are refused") {
    ResolvedJob job;
    job.resins = "vero-opaque", job.load = {"C", "M", "Y", "W"};
    CHECK(refusal(job, printer_of(3)) ==
          "--load C,M,Y,W: 4 resins, but stratasys-j750-hq carries 3 at once; leave some out");
    CHECK(refusal(job, printer_of(4)).empty());
    job.colour.core = "K";
    CHECK(refusal(job, printer_of(4)) == "--core K: no such resin is loaded; loaded are C, M, Y, W");
    job.other = std::make_shared<const OverBlack>();
    CHECK(refusal(job, printer_of(4)) == "--base K: no such resin is loaded; loaded are C, M, Y, W");
    job = {}, job.resins = "vero-opaque", job.load = {"W", "Q"};
    CHECK_FALSE(refusal(job, printer_of(4)).empty());
    PrinterProfile roomy = printer_of(99);
    CHECK(most_resins(roomy) == halftone::max_resins);
    CHECK(most_resins(printer_of(2)) == 2);
}

TEST_CASE("How deep is looked into a print goes with shell and clear resin, and where alpha thins it to its middle") {
    ResolvedJob job = with_coat();
    job.colour.depth_mm = 1.5;
    CHECK(looked_through_mm(job) == Approx(1.8));
    job.kind = ModelKind::picture, job.picture.thickness_mm = 3;
    CHECK(looked_through_mm(job) == Approx(1.8));
    job.colour.coat_mm = 0, job.colour.enclose_mm = 0.25;
    CHECK(looked_through_mm(job) == Approx(3 + 2 * 0.25 + 1));
    job.colour.enclose_mm = 0, job.picture.view = PictureView::both;
    CHECK(looked_through_mm(job) == Approx(4));
    job.kind = ModelKind::mesh;
    CHECK(looked_through_mm(job) == Approx(1.5));
    JobBody body = test::body_of(shapes::box({0, 0, 0}, {9, 7, 8}), {0.1, 0.1, 0.1});
    job.picture.view = PictureView::front;
    CHECK(looked_through_mm(job, body) == Approx(1.5));
    body.model.mesh.corner_alpha.assign(12, {0.5f, 1, 1});
    CHECK(looked_through_mm(job, body) == Approx(3.5 + 1));
    body.is_picture = true;
    CHECK(looked_through_mm(job, body) == Approx(8 + 1));
    job.colour.depth_mm = 9.5;
    CHECK(looked_through_mm(job, body) == Approx(9.5));
}

TEST_CASE("The shell that colours are separated for is the print's: of a body thick, of a picture over its sheet") {
    ResolvedJob job;
    job.resins = "vero-opaque-clear", job.load = {"C", "K", "W", "T"};
    const LoadedResins resins = load_resins(job, printer_of(6));
    const Eigen::Vector3d pitch(0.04, 0.08, 0.03);
    ColourOptions options;
    options.depth_mm = 1.25;
    optics::ShellGeometry of_body = shell_geometry(options, resins, pitch, std::nullopt);
    CHECK(of_body.shell_mm == 1.25);
    CHECK((of_body.core_resin == 2 && of_body.white_resin == 2 && of_body.clear_resin == -1));
    CHECK(of_body.pitch_mm == std::array{0.04, 0.08, 0.03});
    CHECK(of_body.seen == optics::SeenFrom::all_sides);
    CHECK((of_body.over_mm == 0 && of_body.under_mm == 0));
    CHECK(of_body.core_mm == std::numeric_limits<double>::infinity());
    CHECK(of_body.backing == optics::Backing::none);
    CHECK_FALSE(of_body.from_behind);
    options.mixing = Mixing::ideal, options.coat_mm = 0.25;
    of_body = shell_geometry(options, resins, pitch, std::nullopt);
    CHECK(of_body.pitch_mm == std::array{0.0, 0.0, 0.0});
    CHECK((of_body.over_mm == 0.25 && of_body.clear_resin == 3));
    SlabUnderColour slab;
    slab.thickness_mm = 3, slab.size_mm = {20, 10};
    options.coat_mm = 0, options.enclose_mm = 0.5;
    optics::ShellGeometry of_slab = shell_geometry(options, resins, pitch, slab);
    CHECK((of_slab.shell_mm == 1.25 && of_slab.core_mm == 1.75));
    CHECK((of_slab.over_mm == 0.5 && of_slab.under_mm == 0.5 && of_slab.clear_resin == 3));
    CHECK(of_slab.seen == optics::SeenFrom::above);
    CHECK(of_slab.white_resin == 2);
    slab.thickness_mm = 1, slab.from_behind = true;
    of_slab = shell_geometry(options, resins, pitch, slab);
    CHECK(of_slab.shell_mm == 1);
    CHECK((of_slab.core_mm > 0 && of_slab.core_mm < 1e-5));
    CHECK(of_slab.from_behind);
    CHECK(of_slab.white_resin == 3);
}

TEST_CASE("A picture's slab is what is left of it between clear resin, and a body has none") {
    ResolvedJob job = with_coat();
    job.colour.enclose_mm = 0.1;
    JobBody body;
    body.placement.extent_mm = {20, 10, 4};
    CHECK_FALSE(slab_under_colour(job, body).has_value());
    body.is_picture = true;
    job.picture.view = PictureView::through;
    const auto slab = slab_under_colour(job, body);
    REQUIRE(slab);
    CHECK(slab->thickness_mm == Approx(4 - 0.3 - 2 * 0.1));
    CHECK(slab->size_mm == std::array{20.0, 10.0});
    CHECK(slab->from_behind);
    job.picture.view = PictureView::both;
    CHECK_FALSE(slab_under_colour(job, body)->from_behind);
}

TEST_CASE("A picture whose core lets next to no light through is refused where light comes from behind") {
    ResolvedJob job;
    job.resins = "vero-opaque-clear", job.load = {"C", "K", "W", "T"};
    const LoadedResins resins = load_resins(job, printer_of(6));
    ColourOptions options;
    Progress progress;
    const auto said = [&](double thickness_mm, bool from_behind) {
        SlabUnderColour slab;
        slab.thickness_mm = thickness_mm, slab.size_mm = {20, 10}, slab.from_behind = from_behind;
        try {
            (void)prepare_colour(options, resins, {0.04, 0.08, 0.03}, slab, progress);
        } catch (const InputError& error) {
            return std::string(error.what());
        }
        return std::string();
    };
    options.core = "K";
    CHECK(said(30, false).empty());
    const std::string text = said(30, true);
    CHECK_THAT(text, Catch::Matchers::StartsWith("--view through: 29 mm of K below the colours let "));
    CHECK_THAT(text, Catch::Matchers::EndsWith(
                         " % of the light through at the most, so that the picture would be black; give --core T, or "
                         "a smaller --thickness"));
    CHECK(said(1.2, true).empty());
}

TEST_CASE("What predicts a print follows from what was asked for, how large it is and whether a loop looked at it") {
    OpenedJob job;
    using By = PredictionPlan::By;
    JobBody body;
    const auto area = [&](double mm2) {
        VisibleSurface one;
        one.positions_mm = {{0, 0, 0}, {mm2, 0, 0}, {0, 2, 0}};
        one.triangles = {{0, 1, 2}}, one.source_triangle = {0}, one.source_uv.resize(1);
        body.surface = SurfaceIndex(std::move(one));
    };
    const auto plan = [&](bool all_layers = true, bool looped = false, bool all_white = false) {
        return plan_prediction(job, body, all_layers, looped, all_white);
    };
    area(1000);
    CHECK((plan().by == By::model && plan().model == PredictionModel::transport && plan().why_not.empty()));
    // Up to there the loop looks once more, where it sees as well as the model would: not voxels that are apart.
    CHECK(plan(true, true).by == By::model);
    job.resins.set.dot_spread = 0.8;
    body.grid.pitch_mm.setConstant(0.04);
    CHECK((plan(true, true).by == By::loop && plan(true, true).last_look && !plan().last_look));
    job.options.loop.model = PredictionModel::layered_profile;
    CHECK((plan(true, true).by == By::model && !plan(true, true).last_look));
    job.options.loop.model = PredictionModel::transport;
    job.options.prediction.cell_mm *= 3;  // it sees such cells alone
    CHECK(plan(true, true).by == By::model);
    job.options.prediction.cell_mm /= 3;
    CHECK(plan(true, true, true).by == By::nothing);
    CHECK(plan(true, false, true).why_not ==
          "The print is all of white resin: it is as white as was asked for everywhere.");
    CHECK((plan(false).by == By::nothing &&
           plan(false).why_not == "Only a part of the layers was made: a part is not predicted."));
    area(1001);
    CHECK((plan(true, true).by == By::loop && plan(true, true, true).by == By::loop));
    CHECK_FALSE(plan(true, true).last_look);
    CHECK(plan().by == By::nothing);
    CHECK(plan(true, false, true).why_not ==
          "The coloured surface has 10 cm2; more than 10 cm2 are not predicted without being asked: --predict "
          "transport.");
    job.options.prediction.automatic = false;
    CHECK((plan().by == By::nothing && plan().why_not.empty()));
    job.options.prediction.model = PredictionModel::monte_carlo;
    CHECK((plan().by == By::model && plan().model == PredictionModel::monte_carlo));
    CHECK(plan(true, true, true).by == By::model);
    CHECK(plan(false, true, true).by == By::nothing);
    job.run.why_unpredicted = "It is too large.";
    CHECK((plan().by == By::nothing && plan().why_not == "It is too large."));
    job.options.report = false;
    CHECK((plan().by == By::nothing && plan().why_not.empty()));
}
