// SPDX-License-Identifier: GPL-3.0-or-later
#include "scattering/jobs/layered_options.h"

#include <string>
#include <utility>
#include <vector>

#include <catch2/catch.hpp>

#include "base/error.h"
#include "scattering/print/layered_profiles.h"
#include "slicer/options/job_file.h"
#include "slicer/options/option_table.h"
#include "slicer/options/resolve_job.h"
#include "tests/io/files/schema.h"

using namespace voxtone;
using namespace voxtone::scattering;
using Catch::Matchers::Contains;

namespace {

slicer::SliceOptions with(slicer::SliceOptions options, const std::string& key, const std::string& value) {
    slicer::find_option(key)->set(options, value);
    options.named.push_back(key);
    return options;
}

slicer::SliceOptions of_colours() {
    register_layered_profiles();
    slicer::SliceOptions options;
    options.model = "a.obj";
    options.out = "out";
    return options;
}

slicer::SliceOptions layered() { return with(with(of_colours(), "show", layered_show), "profiles", "map.json"); }

}  // namespace

TEST_CASE("Options of layers become values, and are at their defaults otherwise") {
    const slicer::ResolvedJob usual = slicer::resolve(layered());
    REQUIRE(layered_options(usual));
    const LayeredOptions& o = *layered_options(usual);
    const LayeredOptions defaults;
    CHECK(o.profiles == "map.json");
    CHECK(o.placement == defaults.placement);
    CHECK(o.base == defaults.base);
    CHECK(o.thickness_mm == defaults.thickness_mm);
    CHECK(o.steps == defaults.steps);
    CHECK(o.blocks == defaults.blocks);
    CHECK_FALSE(o.rounds);
    CHECK(o.materials.empty());
    CHECK(o.dc_weight == defaults.dc_weight);
    CHECK(o.clear_top.empty());
    CHECK(o.smoothing_mm == defaults.smoothing_mm);
    CHECK_FALSE(o.surfaces);
    CHECK(o.surface_cell_mm == defaults.surface_cell_mm);
    CHECK(usual.shell_mm() == o.thickness_mm);
    CHECK(usual.core() == "K");
    CHECK(std::string(usual.core_option()) == "base");
    CHECK(layered_options(slicer::resolve(of_colours())) == nullptr);

    slicer::SliceOptions all = layered();
    for (const auto& [key, value] : std::vector<std::pair<const char*, const char*>>{{"profile-placement", "box"},
                                                                                     {"base", "W"},
                                                                                     {"laminate-thickness", "300um"},
                                                                                     {"laminate-steps", "32"},
                                                                                     {"laminate-blocks", "4"},
                                                                                     {"laminate-rounds", "0"},
                                                                                     {"laminate-materials", "W=w.json"},
                                                                                     {"dc-weight", "2.5"},
                                                                                     {"clear-top", "T=0.2mm"},
                                                                                     {"layer-smoothing", "0.3mm"},
                                                                                     {"surfaces", "true"},
                                                                                     {"surface-cell", "0.05mm"}})
        all = with(all, key, value);
    const slicer::ResolvedJob job = slicer::resolve(all);
    const LayeredOptions& set = *layered_options(job);
    CHECK(set.placement == ProfilePlacement::box);
    CHECK(set.base == "W");
    CHECK(set.thickness_mm == Approx(0.3));
    CHECK(set.steps == 32);
    CHECK(set.blocks == 4);
    CHECK(set.rounds == 0);
    REQUIRE(set.materials.size() == 1);
    CHECK(set.materials[0].file == "w.json");
    CHECK(set.dc_weight == 2.5);
    REQUIRE(set.clear_top.size() == 1);
    CHECK(set.clear_top[0].mm == Approx(0.2));
    CHECK(set.smoothing_mm == 0.3);
    CHECK(set.surfaces);
    CHECK(set.surface_cell_mm == 0.05);
    CHECK(io::schema_faults("job", slicer::job_json(all)) == std::vector<std::string>{});
}

TEST_CASE("A bad value of layers is refused, its key named, and all of them where no layers are asked for") {
    for (const auto& [key, value] : std::vector<std::pair<const char*, const char*>>{{"laminate-thickness", "0mm"},
                                                                                     {"laminate-thickness", "51mm"},
                                                                                     {"laminate-steps", "0"},
                                                                                     {"laminate-steps", "4097"},
                                                                                     {"laminate-blocks", "0"},
                                                                                     {"laminate-blocks", "17"},
                                                                                     {"laminate-rounds", "21"},
                                                                                     {"laminate-materials", "W"},
                                                                                     {"dc-weight", "0"},
                                                                                     {"dc-weight", "2e6"},
                                                                                     {"clear-top", "T"},
                                                                                     {"layer-smoothing", "-1mm"},
                                                                                     {"layer-smoothing", "101mm"},
                                                                                     {"screen", "error-diffusion"},
                                                                                     {"shard", "1/2"},
                                                                                     {"until", "loop"},
                                                                                     {"cut-out", "true"}}) {
        INFO(key << " " << value);
        CHECK_THROWS_AS(slicer::resolve(with(layered(), key, value)), UsageError);
        CHECK_THROWS_WITH(slicer::resolve(with(layered(), key, value)), Contains(std::string("--") + key));
    }
    for (const char* value : {"0.009mm", "5.1mm"})
        CHECK_THROWS_WITH(slicer::resolve(with(with(layered(), "surfaces", "true"), "surface-cell", value)),
                          Contains("must be 0.01 to 5 mm"));
    CHECK_THROWS_WITH(slicer::resolve(with(layered(), "surface-cell", "0.3mm")), Contains("meshes of --surfaces"));
    CHECK_THROWS_WITH(slicer::resolve(with(layered(), "profiles", "")), Contains("needs a map of profiles"));
    CHECK_THROWS_WITH(slicer::resolve(with(with(layered(), "laminate-materials", "W=w.json"), "laminate-rounds", "2")),
                      Contains("measured materials have no medium"));
    CHECK_THROWS_AS(with(layered(), "profile-placement", "sphere"), UsageError);
    slicer::SliceOptions picture = layered();
    picture.model = "a.png";
    CHECK_THROWS_WITH(slicer::resolve(with(picture, "profile-placement", "box")), Contains("lies on the picture"));
    // What is set but not named is no more looked at in a print of colours: nobody would notice.
    for (const auto& [key, value] : std::vector<std::pair<const char*, const char*>>{
             {"profiles", "map.json"}, {"laminate-materials", "W=w.json"}, {"surfaces", "true"}}) {
        slicer::SliceOptions options = with(of_colours(), key, value);
        options.named.clear();
        CHECK_THROWS_WITH(slicer::resolve(options), Contains("only goes with --show layered-profile"));
    }
}

TEST_CASE("Distances from the top are read by role") {
    const auto clear = parse_clear_top({"T=0.2mm", "K=100um"});
    REQUIRE(clear.size() == 2);
    CHECK(clear[0].role == "T");
    CHECK(clear[0].mm == Approx(0.2));
    CHECK(clear[1].mm == Approx(0.1));
    for (const char* bad : {"T", "=0.2mm", "T=", "T=-1mm", "T=deep"})
        CHECK_THROWS_AS(parse_clear_top({bad}), UsageError);
}

TEST_CASE("Rounds of stacks and measured materials are read, and told apart from what is wrong") {
    CHECK_FALSE(parse_laminate_rounds("auto"));
    CHECK(parse_laminate_rounds("0") == 0);
    CHECK(parse_laminate_rounds("20") == 20);
    for (const char* wrong : {"21", "-1", "", "1.5", "some"}) CHECK_THROWS_AS(parse_laminate_rounds(wrong), UsageError);
    const auto files = parse_laminate_materials({"W=a/white=1.json", "K=black.json"});
    REQUIRE(files.size() == 2);
    CHECK(files[0].role == "W");
    CHECK(files[0].file == "a/white=1.json");
    for (const char* wrong : {"W", "=a.json", "W="}) CHECK_THROWS_AS(parse_laminate_materials({wrong}), UsageError);
    CHECK_THROWS_AS(parse_laminate_materials({"W=a.json", "W=b.json"}), UsageError);
}
