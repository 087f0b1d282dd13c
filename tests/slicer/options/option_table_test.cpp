// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/options/option_table.h"

#include <algorithm>
#include <set>

#include <catch2/catch.hpp>

#include "base/error.h"
#include "slicer/options/job_file.h"
#include "slicer/options/option_scope.h"
#include "slicer/options/resolve_job.h"
#include "tests/slicer/options/declared_show.h"

using namespace voxtone;
using namespace voxtone::slicer;
using Catch::Matchers::Contains;

namespace {

SliceOptions named(const std::string& model = "a.obj") {
    SliceOptions options;
    options.model = model;
    options.out = "out";
    return options;
}

SliceOptions with(SliceOptions options, const std::string& key, const std::string& value) {
    find_option(key)->set(options, value);
    options.named.push_back(key);
    return options;
}

/// A value of the option that is not its default.
std::string other_value(const OptionSpec& spec) {
    const std::string usual = spec.get({});
    for (const std::string& choice : spec.choices)
        if (choice != usual) return choice;
    switch (spec.kind()) {
        case OptionSpec::Kind::flag:
            return usual == "true" ? "false" : "true";
        case OptionSpec::Kind::number:
        case OptionSpec::Kind::length:
            return "7";
        default:
            return "7";
    }
}

}  // namespace

TEST_CASE("Every option is declared whole, and no two of one name") {
    std::set<std::string> keys;
    for (const OptionSpec& spec : slice_option_table()) {
        INFO(spec.key);
        CHECK(keys.insert(spec.key).second);
        CHECK_FALSE(spec.help.empty());
        CHECK_FALSE(spec.group.empty());
        CHECK((spec.kind() == OptionSpec::Kind::flag) == spec.metavar.empty());
        CHECK((spec.is_preset() || spec.resolve ||
               std::holds_alternative<OptionSpec::Other>(spec.member)));  // otherwise it would be taken and forgotten
        for (const OptionSpec::Preset& preset : spec.presets)
            for (const auto& [key, value] : preset.values) {
                SliceOptions set;
                CHECK_NOTHROW(find_option(key)->set(set, value));
            }
    }
}

TEST_CASE("An option that is new and at its default makes no job another") {
    std::vector<OptionSpec> table(slice_option_table().begin(), slice_option_table().end());
    OptionSpec added = *find_option("depth");
    added.key = "halo";
    added.member = OptionSpec::Length{&SliceOptions::viewing_distance_mm};
    table.push_back(added);
    SliceOptions options = with(named(), "size", "30mm");
    const std::string lines = deciding_lines(options, Decides::looks, table);
    CHECK(lines == deciding_lines(options, Decides::looks));
    CHECK(lines == "size=30mm\n");
    options.viewing_distance_mm = 301;
    CHECK_THAT(deciding_lines(options, Decides::looks, table), Contains("halo=301mm"));
}

TEST_CASE("What an option decides says whom another value makes a stranger, and what job.json keeps") {
    declare_relics();  // `show` has another value then
    for (const OptionSpec& spec : slice_option_table()) {
        if (spec.is_preset()) continue;
        INFO(spec.key);
        SliceOptions without;
        if (std::holds_alternative<OptionSpec::Other>(spec.member)) without.show = spec.only_for;
        const std::string usual = deciding_lines(without, Decides::looks);
        const SliceOptions options = with(without, spec.key, other_value(spec));
        REQUIRE(spec.get(options) != spec.get({}));
        // What is said of a label beside its font's file decides too.
        const bool by_content = spec.names != OptionSpec::Names::nothing && spec.kind() != OptionSpec::Kind::texts;
        CHECK((deciding_lines(options, Decides::looks) == usual) == (by_content || spec.decides > Decides::looks));
        CHECK((deciding_lines(options, Decides::bits) == usual) == (by_content || spec.decides > Decides::bits));
        const bool kept = job_record(options, {}, "/out") != job_record(without, {}, "/out");
        CHECK(kept == (spec.decides != Decides::this_run));
    }
}

TEST_CASE("A quality is a name for other options") {
    const OptionSpec& quality = *find_option("quality");
    CHECK(quality.get({}) == "good");
    SliceOptions options = named();
    quality.set(options, "draft");
    CHECK(resolve(options).loop.iterations == 0);
    CHECK_FALSE(resolve(options).prediction.automatic);
    CHECK_FALSE(resolve(options).prediction.model);
    CHECK(quality.get(options) == "draft");
    CHECK(deciding_lines(options, Decides::looks) == "iterations=0\npredict=none\n");
    quality.set(options, "best");
    CHECK_FALSE(resolve(options).loop.iterations);
    CHECK(resolve(options).loop.patient);
    CHECK_FALSE(resolve(named()).loop.patient);
    CHECK(resolve(options).prediction.model == PredictionModel::transport);
    options.iterations = "3";
    CHECK(quality.get(options).empty());
    CHECK_THROWS_WITH(quality.set(options, "superb"), Contains("draft, good, best"));
    declare_relics();
    const SliceOptions relic = with_relic(named(), "bone.json");
    CHECK_NOTHROW(resolve(relic));
    CHECK_THROWS_WITH(resolve(with(relic, "quality", "draft")), Contains("--quality") && Contains("would be ignored"));
}

TEST_CASE("An option that would do nothing is refused where it is named") {
    struct Case {
        const char *key, *value, *why;
        SliceOptions beside;
    };
    const SliceOptions mesh = named(), picture = named("a.png"), open = with(named(), "quality", "draft");
    declare_relics();
    const SliceOptions relic = with_relic(named(), "bone.json");
    const std::vector<Case> cases{{"size", "3mm", "--width, --height or --dpi decides", with(picture, "height", "2mm")},
                                  {"unit", "cm", "unit of a mesh's numbers", picture},
                                  {"texture", "b.png", "a picture is its own texture", picture},
                                  {"width", "3mm", "it is for pictures", mesh},
                                  {"height", "3mm", "it is for pictures", mesh},
                                  {"dpi", "300", "it is for pictures", mesh},
                                  {"backing", "white", "a mesh floats in light", mesh},
                                  {"intent", "contrast", "no appearance loop", open},
                                  {"loop-method", "descent", "no appearance loop", open},
                                  {"predict-cell", "0.2mm", "neither a loop nor a prediction", open},
                                  {"fingers", "6", "only goes with --show relic", mesh},
                                  {"depth", "0.5mm", "only goes with --show colour", relic},
                                  {"iterations", "3", "only goes with --show colour", relic},
                                  {"predict", "transport", "only goes with --show colour", relic},
                                  {"cut-out", "true", "only goes with --show colour", with_relic(picture, "b.json")}};
    for (const auto& [key, value, why, beside] : cases) {
        INFO(key);
        CHECK_THROWS_WITH(resolve(with(beside, key, value)), Contains(why) && Contains("would be ignored"));
        SliceOptions unnamed = with(beside, key, value);
        unnamed.named.clear();
        if (std::string(key) == "fingers")
            CHECK_THROWS_WITH(resolve(unnamed), Contains("would be ignored"));  // no default of this print's
        else if (std::string(key) != "size")
            CHECK_NOTHROW(resolve(unnamed));  // a default of a job file, say
    }
    CHECK_NOTHROW(resolve(with(with(named(), "scale", "2"), "size", "0")));
    CHECK_THROWS_WITH(resolve(with(with(named(), "scale", "2"), "size", "3mm")), Contains("--size decides"));
    SliceOptions of_file = with(with(picture, "width", "3mm"), "size", "5mm");
    of_file.named.clear();  // as beside `--quality draft` on the command line
    CHECK(resolve(of_file).placement.size_mm == 0);
    CHECK(decides_scope("show"));
    CHECK_FALSE(decides_scope("depth"));
}

TEST_CASE("Labels and decals are said one by one, and names of files are seen from their folder and count by content") {
    const OptionSpec& label = *find_option("label");
    const OptionSpec& decal = *find_option("decal");
    SliceOptions options = with(named(), "label", "A, B; size=4pt; font=letters.ttf\nC; font=DejaVu Sans");
    decal.set(options, "logo.png; size=9mm");
    REQUIRE(options.labels.size() == 2);
    CHECK(label.get(options) == "A, B; size=4pt; font=letters.ttf\nC; font=DejaVu Sans");
    const ResolvedJob job = resolve(options);
    REQUIRE(job.marks.size() == 3);
    CHECK(job.marks[0].file == "logo.png");  // below the labels
    CHECK(job.marks[1].text == "A, B");
    SliceOptions moved = options;
    moved.labels[0] = "A, B; size=4pt; font=other/letters.ttf";
    moved.decals[0] = "other.png; size=9mm";
    CHECK(deciding_lines(moved, Decides::bits) == deciding_lines(options, Decides::bits));
    for (const char* other : {"A, B; size=5pt; font=letters.ttf\nC", "A, B; size=4pt; font=letters.ttf"}) {
        label.set(moved, other);
        CHECK(deciding_lines(moved, Decides::bits) != deciding_lines(options, Decides::bits));
    }
    const std::string record = job_record(options, {}, "out");
    CHECK_THAT(record, Contains("font=../letters.ttf") && Contains("font=DejaVu Sans") && Contains("file=../logo.png"));
}

TEST_CASE("Formats that are each other's negative, and a texture of lines, are refused at the door") {
    for (const std::vector<std::string>& both : {std::vector<std::string>{"tiff", "png1"}, {"png1", "png", "tiff"}}) {
        SliceOptions options = named();
        options.formats = both;
        CHECK_THROWS_WITH(resolve(options), Contains("--formats") && Contains("negative"));
    }
    SliceOptions options = named();
    options.formats = {"tiff", "png", "gcvf"};
    CHECK_NOTHROW(resolve(options));
    CHECK_NOTHROW(resolve(with(named(), "decal", "logo.svg; size=9mm")));
    CHECK_THROWS_WITH(resolve(with(named(), "texture", "logo.svg")),
                      Contains("SVG") && Contains("PNG") && Contains("logo.svg"));
}

TEST_CASE("A texture's filter is a job's own, and the file's unless somebody says") {
    CHECK(resolve(named()).reading.texture_filter == io::TextureFilter::as_file);
    const SliceOptions sharp = with(named(), "texture-filter", "nearest");
    CHECK(resolve(sharp).reading.texture_filter == io::TextureFilter::nearest);
    CHECK(deciding_lines(sharp, Decides::bits) != deciding_lines(named(), Decides::bits));
    CHECK_THROWS_WITH(resolve(with(named(), "texture-filter", "cubic")), Contains("linear"));
}

TEST_CASE("Names in a label stand for the job's when it is resolved, and so in its identity") {
    SliceOptions options = with(named("some/cow.obj"), "label", "{job}-{part}-{copy:03} {{x}}");
    options.out = "shelf/monday/";
    const ResolvedJob job = resolve(options);
    CHECK(job.marks[0].text == "monday-cow-001 {x}");
    CHECK(resolve(job.raw).marks[0].text == "monday-cow-001 {x}");
    options.out = "shelf/tuesday";
    CHECK(deciding_lines(resolve(options).raw, Decides::bits) != deciding_lines(job.raw, Decides::bits));
    options.labels[0] = "{jib}";
    CHECK_THROWS_WITH(resolve(options), Contains("{jib} stands for nothing"));
}

TEST_CASE("What another kind of print declares is in the table, in one spelling, and of its own jobs alone") {
    declare_relics();
    declare_relics();  // takes the place of the first
    CHECK(std::ranges::count(slice_option_table(), std::string("deep"), &OptionSpec::key) == 1);
    const OptionSpec &deep = *find_option("deep"), &fingers = *find_option("fingers"), &holy = *find_option("holy");
    CHECK(deep.group == "Relics");
    CHECK(deep.kind() == OptionSpec::Kind::length);
    CHECK_THAT(find_option("show")->help, Contains("relic: what is left of somebody"));

    SliceOptions options = with_relic(named(), "bone.json");
    CHECK(deep.get(options) == "2mm");
    deep.set(options, "0.15cm");
    CHECK(deep.get(options) == "1.5mm");
    CHECK(resolve(options).shell_mm() == 1.5);
    CHECK(resolve(options).core() == "K");
    CHECK(std::string(resolve(options).core_option()) == "below");
    CHECK(resolve(options).loop.iterations == 0);
    CHECK_FALSE(resolve(options).shows_colours());
    // Said as it is by itself, it is not said.
    const std::size_t before = options.other.size();
    fingers.set(options, "05");
    holy.set(options, "no");
    CHECK(options.other.size() == before);
    CHECK_THROWS_AS(fingers.set(options, "4.5"), UsageError);
    CHECK_THROWS_AS(find_option("guards")->set(options, "W=a,W=a"), UsageError);
    find_option("worth")->set(options, "4.50");
    CHECK(find_option("worth")->get(options) == "4.5");
    deep.set(options, "0");
    CHECK_THROWS_WITH(resolve(options), Contains("--deep 0mm: it would lie on the ground"));

    // A job of colours has none of them: neither to say nor to break.
    CHECK_THAT(job_json(options), Contains("\"fingers\": 5"));
    options.show = "colour";
    CHECK_THROWS_WITH(resolve(options), Contains("would be ignored") && Contains("only goes with --show relic"));
    CHECK_NOTHROW(resolve(named()));
    CHECK_THAT(job_json(named()), !Contains("fingers"));
    CHECK_THROWS_WITH(resolve(with(named(), "show", "nothing")), Contains("none of colour, relic"));
}
