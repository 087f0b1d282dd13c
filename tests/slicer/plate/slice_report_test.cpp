// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a finished job says of itself, of a job, a body and measurements that are put down by hand.
#include "slicer/plate/slice_report.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "io/files/whole_file.h"
#include "io/pictures/picture_writer.h"
#include "tests/io/files/temporary_folder.h"
#include "tests/slicer/print/sample_body.h"

using namespace voxtone;
using namespace voxtone::slicer;
using Rows = std::vector<std::vector<std::string>>;

namespace {

/// Says what it is asked, and makes nothing.
class SaysWhatItIs final : public Print {
public:
    void prepare(Progress&) override {}
    void rearrange(Progress&) override {}
    [[nodiscard]] JobResult keep_loop() const override { return {}; }
    [[nodiscard]] std::unique_ptr<const LayerSource> layers() const override { return nullptr; }
    void expect_layers(const LayerRange&) override {}
    void take_layer(int, const io::LayerRuns&) override {}
    void evaluate(const io::StackDescription&, Progress&) override {}
    [[nodiscard]] std::vector<io::ReportStage> stages_before_layers() const override { return {{"separate", 3}}; }
    [[nodiscard]] std::vector<io::ReportStage> stages_after_layers() const override { return {{"predict", 7}}; }
    void add_to(io::Report& report) const override { report.sections.push_back({"Own", {}, {}, {}, {}}); }
    void draw(io::Report&, Progress&) const override {}
    [[nodiscard]] std::string summary(const io::Report&) const override { return "  as asked\n"; }
    [[nodiscard]] std::string written_text() const override { return "  a file besides\n"; }
};

struct Finished {
    Finished() {
        job.printer = find_printer("stratasys-j750-hq");
        job.resins.set = optics::vero_opaque().subset(std::vector<std::string>{"K", "W"});
        job.options.model = "shelf/fox.obj";
        body = test::body_of(shapes::box({0, 0, 0}, {4, 3, 2}), job.printer.sliced_pitch_mm());
        body.warnings = {"of the body"};
        stack.pitch_um = {42.3, 84.7, 14}, stack.size_px = {94, 35};
        stack.layers = std::uint32_t(body.grid.size[2]);
        stack.resins = {{"MakersBlack", "K", {1, 2, 3}, 100, 0.25}, {"MakersWhite", "W", {4, 5, 6}, 300, 0.75}};
        figures.read_s = 1, figures.repair_s = 2, figures.layers_s = 4, figures.finish_s = 5;
        figures.encode_s = 1.5, figures.layer_bytes = 8'000'000;
        figures.counts = {400, 200'000'000, 0, 0.5, 1, 2, 3, 2};
    }
    [[nodiscard]] io::Report report() const { return make_report(job, body, stack, print, figures); }
    [[nodiscard]] static io::ReportSection section(const io::Report& report, const std::string& title) {
        const auto found = std::ranges::find(report.sections, title, &io::ReportSection::title);
        REQUIRE(found != report.sections.end());
        return *found;
    }
    OpenedJob job;
    JobBody body;
    io::StackDescription stack;
    SaysWhatItIs print;
    JobMeasurements figures;
};

}  // namespace

TEST_CASE("A report says what was printed, on what, of which resins, and where the time went") {
    Finished done;
    const io::Report report = done.report();
    CHECK(report.title == "fox.obj");
    CHECK(report.printer_id == "stratasys-j750-hq");
    CHECK(report.printer_name == done.job.printer.name);
    CHECK(report.pitch_um == std::array{42.3, 84.7, 14.0});
    CHECK(report.size_mm == std::array{4.0, 3.0, 2.0});
    CHECK(report.size_px == std::array<std::uint32_t, 3>{94, 35, done.stack.layers});
    CHECK((report.body_voxels == 400 && report.output_bytes == 8'000'000));
    REQUIRE(report.resins.size() == 2);
    const io::ReportResin& white = report.resins[1];
    CHECK(white.name == done.job.resins.set.resins[1].name);
    CHECK((white.role == "W" && white.material_name == "MakersWhite" && white.rgb == io::Rgb{4, 5, 6}));
    CHECK((white.voxels == 300 && white.ml == 0.75 && report.resins[0].role == "K"));
    std::vector<std::string> stages;
    std::vector<double> seconds;
    for (const io::ReportStage& stage : report.stages) stages.push_back(stage.name), seconds.push_back(stage.seconds);
    CHECK(stages == std::vector<std::string>{"read model", "repair and visible surface", "separate", "layers", "finish",
                                             "predict"});
    CHECK(seconds == std::vector<double>{1, 2, 3, 4, 5, 7});
    CHECK(report.total_seconds == 0);
    CHECK(report.printing.passes > 0);
    // A box hangs over nothing.
    CHECK(report.printing.support_ml == 0.0);
    REQUIRE(report.sections.size() == 3);
    CHECK((report.sections[0].title == "Own" && report.sections[1].title == "The mesh"));
    CHECK(std::ranges::find(report.warnings, "of the body") != report.warnings.end());
    // Every option by its key, but for those that stand for others.
    const auto option =
        std::ranges::find(report.job, std::string("printer"), [](const auto& one) { return one.first; });
    CHECK(option != report.job.end());
    // Another name, and a part of the layers, of whose support nothing is known.
    done.body.name = "Fox, large", --done.stack.layers;
    CHECK(done.report().title == "Fox, large");
    CHECK_FALSE(done.report().printing.support_ml.has_value());
}

TEST_CASE("The mesh is told as it was read and as it is printed") {
    Finished done;
    done.body.repair.before = {.triangles = 10, .shells = 1};
    done.body.repair.after = {.triangles = 12, .shells = 2};
    MeshDiagnosis &before = done.body.repair.before, &after = done.body.repair.after;
    before.boundary_edges = 3, before.nonmanifold_edges = 4, before.inconsistent_edges = 5, before.open_edges = 6;
    before.degenerate_faces = 7, before.duplicate_faces = 8;
    after.boundary_edges = 13, after.nonmanifold_edges = 14, after.inconsistent_edges = 15, after.open_edges = 16;
    after.degenerate_faces = 17, after.duplicate_faces = 18;
    io::ReportSection mesh = Finished::section(done.report(), "The mesh");
    CHECK(mesh.paragraphs == std::vector<std::string>{"The mesh encloses a body as it is; nothing was repaired."});
    REQUIRE(mesh.tables.size() == 1);
    CHECK(mesh.tables[0].rows == Rows{{"triangles", "10", "12"},
                                      {"shells", "1", "2"},
                                      {"boundary edges", "3", "13"},
                                      {"non-manifold edges", "4", "14"},
                                      {"inconsistent edges", "5", "15"},
                                      {"edges that do not close", "6", "16"},
                                      {"faces without area", "7", "17"},
                                      {"doubled faces", "8", "18"}});
    done.body.repair.messages = {"One was turned.", "Two were filled."};
    mesh = Finished::section(done.report(), "The mesh");
    CHECK(mesh.paragraphs == done.body.repair.messages);
}

TEST_CASE("Voids are told where there are some, by size, place and what became of them") {
    Finished done;
    done.body.repair.voids.resize(2);
    Cavity &small = done.body.repair.voids[0], &large = done.body.repair.voids[1];
    small.volume_mm3 = 99.94, small.centre_mm = {1.25, 2, 3.04}, small.wall_mm = 0.456, small.filled = true;
    large.volume_mm3 = 1234.4, large.centre_mm = {0, 1, 2}, large.wall_mm = 2, large.filled = false;
    const io::ReportSection voids = Finished::section(done.report(), "Voids");
    REQUIRE(voids.tables.size() == 1);
    REQUIRE(voids.tables[0].rows.size() == 2);
    CHECK(voids.tables[0].rows[0][0] == "99.9");
    CHECK((voids.tables[0].rows[0][2] == "0.46" && voids.tables[0].rows[0][3] == "filled with resin"));
    CHECK(voids.tables[0].rows[1] == std::vector<std::string>{"1234", "0.0, 1.0, 2.0", "2", "kept"});
    CHECK(done.report().sections.size() == 4);
}

TEST_CASE("The speed of the layers is told by kinds of work, of all and of a voxel of the shell") {
    Finished done;
    done.stack.size_px = {1000, 2000}, done.stack.layers = 100;
    const io::ReportSection speed = Finished::section(done.report(), "Speed of the layers");
    CHECK(
        speed.paragraphs[0] ==
        "2e+08 voxels in 4.00 s of layers: 50 million voxels/s; 2e+08 of them in the coloured shell; 8.0 MB of layers "
        "written, 2.0 MB/s.");
    // Ten seconds over 200 million voxels.
    CHECK(speed.tables[0].rows == Rows{{"solid", "0.50", "5 %", "2.5"},
                                       {"nearest surface", "1.00", "10 %", "5.0"},
                                       {"target colour", "2.00", "20 %", "10.0"},
                                       {"separation and screen", "3.00", "30 %", "15.0"},
                                       {"runs", "2.00", "20 %", "10.0"},
                                       {"encode and write", "1.50", "15 %", "7.5"}});
    done.figures.counts = {}, done.figures.encode_s = 0;
    CHECK(Finished::section(done.report(), "Speed of the layers").tables[0].rows[0] ==
          std::vector<std::string>{"solid", "0.00", "0 %", "0.0"});
}

TEST_CASE("Voxels that were added to thin walls are warned of") {
    Finished done;
    const std::size_t usual = done.report().warnings.size();
    done.figures.counts.thin_voxels = 1;
    const std::vector<std::string> warnings = done.report().warnings;
    REQUIRE(warnings.size() == usual + 1);
    CHECK(warnings.back() ==
          "1 voxels were added where the body is thinner than a voxel, so that nothing vanishes "
          "[thin-walls]");
}

TEST_CASE("A summary is some lines, with what took a good part of the time") {
    Finished done;
    io::Report report = done.report();
    report.peak_memory_bytes = std::uint64_t{3} << 30;
    report.stages = {{"layers", 15}, {"predict", 15.1}, {"appearance loop", 60}};
    const auto text = [&](bool has_report) { return summary_text(done.print, report, 100, has_report, "there/out"); };
    const std::string layers = std::to_string(done.stack.layers);
    CHECK(text(false) == "there/out: 4.00 x 3.00 x 2.00 mm, 94 x 35 px, " + layers +
                             " layers of 14 um\n"
                             "  K   MakersBlack          0.250 ml\n"
                             "  W   MakersWhite          0.750 ml\n"
                             "  as asked\n"
                             "  done in 1 min 40 s (predict 15 s, appearance loop 1 min 00 s); peak memory 3.00 GiB\n"
                             "  a file besides\n");
    CHECK(text(true) == text(false) + "  report: there/out/report.html\n");
    report.stages.clear();
    CHECK_THAT(text(false), Catch::Matchers::Contains("done in 1 min 40 s; peak memory"));
}

TEST_CASE("The first pictures of a page lie beside it, for who shows many prints") {
    const io::TemporaryFolder folder;
    const Finished done;
    io::Report report = done.report();
    const auto exists = [&](const char* name) { return std::filesystem::exists(folder.path() / name); };
    write_page(folder.path(), report);
    CHECK(exists("report.html"));
    CHECK_FALSE(exists("preview.webp"));
    const auto picture = [](const char* caption, std::uint8_t grey) {
        const io::Picture8 codes{1, 1, 3, {grey, grey, grey}};
        return io::ReportPicture{caption, io::png_bytes(codes), 1, 1, 0};
    };
    report.views.push_back({"front", {picture("target", 10)}});
    write_page(folder.path(), report);
    CHECK(exists("preview.webp"));
    CHECK_FALSE(exists("preview-target.webp"));
    report.views[0].pictures.push_back(picture("predicted", 200));
    write_page(folder.path(), report);
    CHECK(io::read_whole_file(folder.path() / "preview.webp", 1 << 16) == report.views[0].pictures[1].file);
    CHECK(io::read_whole_file(folder.path() / "preview-target.webp", 1 << 16) == report.views[0].pictures[0].file);
}
