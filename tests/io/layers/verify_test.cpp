// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/layers/verify.h"

#include <sys/stat.h>

#include <png.h>
#include <zip.h>
#include <zlib.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <fstream>
#include <functional>

#include "base/error.h"
#include "base/parallel.h"
#include "io/files/whole_file.h"
#include "io/layers/stack_folder.h"
#include "stack_samples.h"
#include "tests/io/files/temporary_folder.h"

using namespace voxtone;
using namespace voxtone::io;
using Catch::Contains;
namespace fs = std::filesystem;

namespace {

void write_png_with_libpng(const fs::path& file, std::uint32_t w, std::uint32_t h, int format,
                           const std::vector<std::uint8_t>& pixels) {
    png_image image{};
    image.version = PNG_IMAGE_VERSION;
    image.width = w;
    image.height = h;
    image.format = static_cast<png_uint_32>(format);
    REQUIRE(png_image_write_to_file(&image, file.c_str(), 0, pixels.data(), 0, nullptr));
}

fs::path slice(const fs::path& out, int k) {
    return out / sample_description(40).layer_path(static_cast<std::uint32_t>(k));
}

}  // namespace

TEST_CASE("a stack of ours passes, and reads back as it was written", "[verify]") {
    TemporaryFolder folder;
    const auto out = folder.path() / "stack";
    const auto stack = write_sample_stack(out, 40, {ResinBitmaps::png1, true, false});
    const auto report = verify_stack(out);
    INFO(report_text(report));
    CHECK(report.passed());
    CHECK(report.kind == StackReader::Kind::voxtone);
    CHECK(report.layers == 40);
    CHECK(report.size_px == std::array<std::uint32_t, 2>{70, 40});
    CHECK(report.content_sha256 == stack.content_sha256);
    const StackReader reader(out);
    for (std::uint32_t k = 0; k < 40; ++k)
        REQUIRE(layer_pixels(reader.read(k, stack.palette())) == layer_pixels(sample_layer(k)));
    CHECK(reader.seal() == ManifestSeal::whole);
    REQUIRE(reader.sheet());
    CHECK_THAT(*reader.sheet(), Contains(stack.resins.front().name));
    CHECK(reader.origin().model.empty());
    // By the rules of the printer that it names.
    std::string named;
    const auto strict = verify_stack(out, [&](const std::string& printer) {
        named = printer;
        VerifyRules rules;
        rules.least_layers = 41;
        return rules;
    });
    CHECK(named == stack.printer);
    CHECK_FALSE(strict.passed());
    // The container tells the same layers.
    const auto gcvf = verify_stack(out / "stack.gcvf");
    INFO(report_text(gcvf));
    CHECK(gcvf.passed());
    CHECK(gcvf.kind == StackReader::Kind::gcvf);
    CHECK(gcvf.content_sha256 == stack.content_sha256);
    // And so does the bare folder, whose palette is found.
    const auto bare = verify_stack(out / "layers");
    INFO(report_text(bare));
    CHECK(bare.passed());
    CHECK(bare.kind == StackReader::Kind::folder);
    CHECK(StackReader(out / "layers").palette().size() == 6);
}

TEST_CASE("layers that say what their colours mean are noted, and pass", "[verify]") {
    TemporaryFolder folder;
    const auto out = folder.path() / "stack";
    (void)write_sample_stack(out, 40);
    const auto with_chunk = [&](int layer, const std::string& name, const std::string& data) {
        const auto bytes = read_whole_file(slice(out, layer), 1 << 20);
        std::string text(bytes.begin(), bytes.end()), chunk = name + data;
        const auto number = [](std::uint32_t value) {
            std::string four;
            for (int shift = 24; shift >= 0; shift -= 8) four += static_cast<char>(value >> shift & 255);
            return four;
        };
        const auto sum = crc32(0, reinterpret_cast<const Bytef*>(chunk.data()), static_cast<uInt>(chunk.size()));
        constexpr std::size_t behind_header = 33;
        text.insert(behind_header, number(std::uint32_t(data.size())) + chunk + number(std::uint32_t(sum)));
        write_whole_file(slice(out, layer), text);
    };
    CHECK(verify_stack(out).notes.empty());
    with_chunk(7, "gAMA", std::string("\0\0\xb1\x8f", 4));
    with_chunk(3, "iCCP", std::string("a\0\0 what a profile holds", 24));
    const StackReport report = verify_stack(out);
    INFO(report_text(report));
    CHECK(report.passed());
    REQUIRE(report.notes.size() == 1);
    CHECK_THAT(report.notes[0], Contains("2 of 40 layers") && Contains("iCCP in") && Contains("slice_00003.png"));
}

TEST_CASE("a stack for layers of another pitch than the printer's is a fault", "[verify]") {
    TemporaryFolder folder;
    const auto out = folder.path() / "stack";
    (void)write_sample_stack(out, 40, {ResinBitmaps::none, true, false});
    VerifyRules rules;
    for (const double layer_um : {14.0, 26.999, 27.001, 60.0}) {
        CAPTURE(layer_um);
        rules.pitch_um = {{25400.0 / 600, 25400.0 / 300, layer_um}};
        for (const fs::path& stack : {out, out / "stack.gcvf"}) {
            const StackReport report = verify_stack(stack, rules);
            CHECK(report.fault_count == 1);
            CHECK(has(report, "resolution", "made for layers of 27 um"));
        }
        // Bitmaps alone do not say it, which is said.
        const StackReport bare = verify_stack(out / "layers", rules);
        CHECK(bare.passed());
        CHECK_THAT(report_text(bare), Contains("note: bitmaps do not say how thick a layer is"));
    }
    rules.pitch_um = {{25400.0 / 600, 25400.0 / 300, 27.0004}};  // as a container rounds it
    CHECK(verify_stack(out, rules).passed());
    CHECK(verify_stack(out / "stack.gcvf", rules).passed());
    CHECK(verify_stack(out).notes.empty());
}

TEST_CASE("layers of another resolution along either side are a fault, a dot per metre is rounding", "[verify]") {
    TemporaryFolder folder;
    const auto out = folder.path() / "stack";
    (void)write_sample_stack(out, 40, {ResinBitmaps::none, false, false});
    const auto pitch_um = [](double dots_per_metre) { return 1e6 / dots_per_metre; };
    const double x = std::round(600 / 0.0254), y = std::round(300 / 0.0254);
    VerifyRules rules;
    struct Sides {
        double columns, rows;
        bool passes;
    };
    for (const auto& [columns, rows, passes] : std::vector<Sides>{{x, y, true},
                                                                  {x + 1, y, true},
                                                                  {x - 1, y, true},
                                                                  {x, y + 1, true},
                                                                  {x, y - 1, true},
                                                                  {x + 2, y, false},
                                                                  {x - 2, y, false},
                                                                  {x, y + 2, false},
                                                                  {x, y - 2, false},
                                                                  {2 * x, y, false},
                                                                  {x, 2 * y, false}}) {
        CAPTURE(columns, rows, passes);
        rules.pitch_um = {{pitch_um(columns), pitch_um(rows), 27}};
        const StackReport report = verify_stack(out / "layers", rules);  // bitmaps alone, which say only this
        CHECK(report.passed() == passes);
        CHECK(has(report, "resolution", "it should be") == !passes);
        CHECK_FALSE(has(report, "resolution", "swapped"));
    }
    // A square of the two resolutions is no exchange of them.
    rules.pitch_um = {{pitch_um(y), pitch_um(y), 27}};
    CHECK_FALSE(has(verify_stack(out / "layers", rules), "resolution", "swapped"));
    rules.pitch_um = {{pitch_um(x), pitch_um(x), 27}};
    CHECK_FALSE(has(verify_stack(out / "layers", rules), "resolution", "swapped"));
}

TEST_CASE("the report is the same for any number of threads", "[verify]") {
    TemporaryFolder folder;
    const auto out = folder.path() / "stack";
    (void)write_sample_stack(out, 40);
    for (int k = 3; k < 30; k += 2) write_whole_file(slice(out, k), std::string_view("no picture"));
    std::string text;
    for (const std::size_t threads : {1u, 2u, 4u}) {
        const ThreadLimit limit(threads);
        const auto now = report_text(verify_stack(out));
        if (text.empty()) text = now;
        CHECK(now == text);
    }
    CHECK_THAT(text, Contains("and 9 more"));
}

namespace {

/// A stack of ours that is spoilt, looked at and made whole again.
struct Spoilt {
    Spoilt() {
        (void)write_sample_stack(whole, 40);
        for (std::size_t i = 3; i < rgba.size(); i += 4) rgba[i] = 255;
        make_whole();
    }
    StackReport report(const std::function<void()>& how, const VerifyRules& rules = {}) const {
        how();
        StackReport found = verify_stack(out, rules);
        make_whole();
        CHECK_FALSE(found.passed());
        return found;
    }
    void make_whole() const {
        fs::remove_all(out);
        fs::copy(whole, out, fs::copy_options::recursive);
    }
    void write(int layer) const { write_png_with_libpng(slice(out, layer), 70, 40, PNG_FORMAT_RGBA, rgba); }

    TemporaryFolder folder;
    fs::path whole = folder.path() / "whole", out = folder.path() / "stack";
    std::vector<std::uint8_t> rgba = std::vector<std::uint8_t>(70 * 40 * 4, 0);  ///< of a layer of nothing
};

}  // namespace

TEST_CASE("layers that are missing, strange or cannot be read are named", "[verify]") {
    const Spoilt stack;
    const fs::path& out = stack.out;
    CHECK(has(stack.report([&] { fs::remove(slice(out, 7)); }), "missing-layer", "slice_00007"));
    CHECK(has(stack.report([&] { fs::copy(slice(out, 7), out / "layers" / "slice_00040.png"); }), "stranger",
              "slice_00040"));
    CHECK(has(stack.report([&] {
        write_whole_file(out / "layers" / "Thumbs.db", std::string_view("x"));
        fs::copy(slice(out, 1), out / "layers" / "x.png");
    }),
              "stranger", "Thumbs.db"));
    // One byte of a compressed layer: a checksum notices.
    CHECK(has(stack.report([&] {
        auto b = text_of(slice(out, 5));
        b[b.size() / 2] ^= 1;
        write_whole_file(slice(out, 5), b);
    }),
              "unreadable", "slice_00005"));
    CHECK(has(stack.report([&] { write_whole_file(slice(out, 5), text_of(slice(out, 5)) + "tail"); }), "unreadable",
              "behind its end"));
    CHECK(verify_stack(out).passed());
}

TEST_CASE("colours that no resin has, transparency and other kinds of bitmaps are named with their place", "[verify]") {
    Spoilt stack;
    const fs::path& out = stack.out;
    const StackReport rgb = stack.report([&] {
        write_png_with_libpng(slice(out, 3), 70, 40, PNG_FORMAT_RGB, std::vector<std::uint8_t>(70 * 40 * 3, 0));
    });
    CHECK(has(rgb, "colour-type", "8-bit RGB"));
    stack.rgba[40] = 1;
    stack.rgba[4 * (70 * 2 + 5) + 1] = 1;
    const StackReport stray = stack.report([&] { stack.write(3); });
    CHECK(
        has(stray, "stray-colour", "1 pixels have the colour 1 0 0, which stands for no resin, the first at (10, 0)"));
    CHECK(has(stray, "stray-colour", "1 pixels have the colour 0 1 0, which stands for no resin, the first at (5, 2)"));
    // What follows from it is not named, but noted.
    CHECK_FALSE((has(stray, "count") || has(stray, "digest")));
    CHECK(stray.content_sha256.empty());
    CHECK_THAT(report_text(stray), Contains("voxel counts and digest were not compared"));
    stack.rgba[40] = stack.rgba[4 * (70 * 2 + 5) + 1] = 0;
    stack.rgba[43] = 254;
    CHECK(has(stack.report([&] { stack.write(3); }), "alpha",
              "1 pixels have alpha 254 instead of 255, the first at (10, 0)"));
    stack.rgba[43] = 255;
    const StackReport nothing = stack.report([&] { stack.write(3); });
    CHECK(has(nothing, "count", "announced"));
    CHECK(has(nothing, "digest"));
    CHECK(nothing.empty_layers == 1);
    CHECK_THAT(report_text(nothing), Contains("1 of 40 layers are empty"));
    // Of many layers of one fault some are named, and all are counted.
    const StackReport many = stack.report([&] {
        for (int k = 10; k < 20; ++k)
            write_png_with_libpng(slice(out, k), 70, 40, PNG_FORMAT_RGB, std::vector<std::uint8_t>(70 * 40 * 3, 0));
    });
    CHECK(std::ranges::count(many.faults, "colour-type", &StackFault::rule) == 6);
    CHECK(has(many, "colour-type", "and 5 more"));
    CHECK(many.fault_count >= 10);
}

TEST_CASE("layers of another size, resolution or order than the stack's are named", "[verify]") {
    const Spoilt stack;
    const fs::path& out = stack.out;
    CHECK(has(stack.report([&] { stack.write(3); }), "resolution", "does not say"));
    CHECK(has(stack.report([&] { write_png_with_libpng(slice(out, 3), 35, 80, PNG_FORMAT_RGBA, stack.rgba); }), "size",
              "is 35 x 80 px, the stack 70 x 40"));
    CHECK(has(stack.report([&] {
        fs::rename(slice(out, 3), out / "t");
        fs::rename(slice(out, 4), slice(out, 3));
        fs::rename(out / "t", slice(out, 4));
    }),
              "digest"));
    VerifyRules rules;
    rules.pitch_um = {{84.667, 84.667, 27}};
    CHECK(has(verify_stack(out, rules), "resolution"));
    rules.pitch_um = {{25400.0 / 300, 25400.0 / 600, 27}};
    CHECK(has(verify_stack(out, rules), "resolution", "swapped"));
}

TEST_CASE("a stack of more colours or fewer layers than the printer takes is a fault, and of just as many none",
          "[verify]") {
    TemporaryFolder folder;
    (void)write_sample_stack(folder.path() / "stack", 29);
    VerifyRules rules;
    for (const auto& [colours, layers] : {std::pair{5, 29}, {4, 29}, {5, 30}, {3, 40}}) {
        CAPTURE(colours, layers);
        rules.most_colours = std::uint32_t(colours), rules.least_layers = std::uint32_t(layers);
        const StackReport report = verify_stack(folder.path() / "stack", rules);
        CHECK(has(report, "colours", "5 colours besides the background") == (colours < 5));
        CHECK(has(report, "few-layers", "29") == (layers > 29));
        CHECK(report.passed() == (colours == 5 && layers == 29));
        CHECK(report.fault_count == std::uint64_t(colours < 5) + std::uint64_t(layers > 29));
    }
}

TEST_CASE("a foreign folder is judged by itself", "[verify]") {
    TemporaryFolder folder;
    const auto out = folder.path();
    const PngLayerEncoder encoder(sample_description(1).palette(), {42.333, 84.667});
    auto name = [](int k, int digits) {
        return "part" + std::string(static_cast<std::size_t>(digits) - std::to_string(k).size(), '0') +
               std::to_string(k) + ".png";
    };
    for (int k = 0; k < 35; ++k)
        write_whole_file(out / name(k, 3), encoder.encode(sample_layer(static_cast<std::uint32_t>(k))));
    CHECK(verify_stack(out).passed());
    fs::rename(out / name(4, 3), out / "part4.png");
    CHECK(has(verify_stack(out), "numbering", "digits"));
    fs::remove(out / "part4.png");
    CHECK(has(verify_stack(out), "numbering", "1 number missing"));
    write_whole_file(out / name(4, 3), encoder.encode(sample_layer(4)));
    fs::copy(out / name(4, 3), out / "Other000.png");
    CHECK(has(verify_stack(out), "stranger", "Other000"));
    fs::remove(out / "Other000.png");
    // Twelve greys of antialiasing.
    std::vector<Rgb> greys = {{0, 0, 0}};
    for (int i = 1; i < 12; ++i) greys.push_back({static_cast<std::uint8_t>(20 * i), 0, 0});
    RandomStream random(1, 1);
    const std::vector<double> weights(12, 1.0);
    write_whole_file(out / name(4, 3),
                     PngLayerEncoder(greys, {42.333, 84.667}).encode(random_layer(random, 70, 40, weights)));
    CHECK(has(verify_stack(out), "colours", "16 colours"));
    // Nothing printed at all.
    LayerRuns air(70, 40);
    for (int y = 0; y < 40; ++y) air.push(70, 0), air.end_row();
    for (int k = 0; k < 35; ++k) write_whole_file(out / name(k, 3), encoder.encode(air));
    CHECK(has(verify_stack(out), "empty"));
    write_whole_file(out / name(4, 3), encoder.encode(sample_layer(4)));
    const auto report = verify_stack(out);
    CHECK(report.passed());
    CHECK(report.empty_layers == 34);
}

TEST_CASE("names of other forms are told, and what is missing among them", "[verify]") {
    const PngLayerEncoder encoder(sample_description(1).palette(), {42.333, 84.667});
    const auto write = [&](const fs::path& out, const std::string& name) {
        write_whole_file(out / name, encoder.encode(sample_layer(0)));
    };
    TemporaryFolder heights;
    for (const char* name : {"z0.1mm.png", "z0.2mm.png", "z0.4mm.png", "z0.5mm.png"}) write(heights.path(), name);
    const StackReport of_heights = verify_stack(heights.path());
    CHECK(has(of_heights, "numbering", "does not end in its number"));
    CHECK(has(of_heights, "missing-layer", "number 0.3 is missing"));
    TemporaryFolder below;
    for (int k = -3; k < 3; ++k) write(below.path(), "s_" + std::to_string(k) + ".png");
    const StackReport of_below = verify_stack(below.path());
    CHECK(has(of_below, "numbering", "below 0"));
    CHECK(of_below.layers == 6);
    for (const StackFault& fault : of_below.faults) CHECK(fault.what.find("18446744") == std::string::npos);
    TemporaryFolder cases;
    for (const char* name : {"slice_1.png", "Slice_2.png", "slice_3.png"}) write(cases.path(), name);
    CHECK(has(verify_stack(cases.path()), "numbering", "begins otherwise"));
    // Of nine names without zeros one is named, and the missing number is not lost among them.
    TemporaryFolder plain;
    for (int k = 1; k < 30; ++k)
        if (k != 17) write(plain.path(), "slice_" + std::to_string(k) + ".png");
    const StackReport of_plain = verify_stack(plain.path());
    CHECK(has(of_plain, "numbering", "and 8 more have 1 digit where most have 2 digits"));
    CHECK(has(of_plain, "numbering", "follows number 16: 1 number missing"));
}

TEST_CASE("what is no stack is an error that says so", "[verify]") {
    TemporaryFolder folder;
    CHECK_THROWS_AS(verify_stack(folder.path() / "nowhere"), FileError);
    CHECK(has(verify_stack(folder.path()), "no-layers", "holds no layer"));
    write_whole_file(folder.path() / "x.gcvf", std::string_view("PK no zip"));
    CHECK(has(verify_stack(folder.path() / "x.gcvf"), "container", "no ZIP"));
    const auto out = folder.path() / "half";
    {
        LayerStackWriter writer(out, sample_description(3));
        writer.write(0, sample_layer(0));
        CHECK(has(verify_stack(out), "unfinished", "stopped"));
        CHECK(verify_stack(out).fault_count == 1);
    }
    CHECK_THROWS_AS(verify_stack(out), FileError);  // who gives up leaves nothing
}

TEST_CASE("a manifest that is gone, broken or changed is a fault of the stack", "[verify]") {
    TemporaryFolder folder;
    const auto out = folder.path() / "stack", manifest = out / "manifest.json";
    (void)write_sample_stack(out, 40);
    const std::string good = text_of(manifest);
    const auto changed = [&](const std::string& from, const std::string& to) {
        std::string text = good;
        for (std::size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size())
            text.replace(at, from.size(), to);
        REQUIRE(text != good);
        write_whole_file(manifest, text);
        return verify_stack(out);
    };
    // Set out otherwise it still says the same.
    CHECK(changed("\n", " ").passed());
    CHECK(has(changed("stratasys-j750-hm", "foo"), "manifest", "was changed"));
    CHECK(has(changed("\"role\": \"C\"", "\"role\": \"M2\""), "manifest", "was changed"));
    CHECK(has(changed("\"flip_x\": false", "\"flip_x\": true"), "manifest", "was changed"));
    // Names of cyan and magenta exchanged: the operator would load the wrong resins.
    (void)changed("VeroCyan", "Vero?");
    std::string text = good;
    text.replace(text.find("VeroCyan"), 8, "Vero____");
    text.replace(text.find("VeroMagenta"), 11, "VeroCyan");
    text.replace(text.find("Vero____"), 8, "VeroMagenta");
    write_whole_file(manifest, text);
    CHECK(has(verify_stack(out), "manifest", "names and roles"));
    // Without its seal nothing says so, and that is said.
    write_whole_file(manifest, good.substr(0, good.find(",\n \"manifest_sha256\"")) + "}\n");
    const auto unsealed = verify_stack(out);
    INFO(report_text(unsealed));
    CHECK(unsealed.passed());
    CHECK_THAT(report_text(unsealed), Contains("was not checked"));

    const auto broken = changed("{\"format\"", "{{");
    CHECK(has(broken, "manifest"));
    CHECK(broken.fault_count == 1);
    CHECK_THAT(report_text(broken), Contains("1 fault\n"));
    fs::remove(manifest);
    CHECK(has(verify_stack(out), "manifest", "manifest.json, which says what their colours mean"));
    write_whole_file(manifest, good);
    fs::remove_all(out / "layers");
    const auto gone = verify_stack(out);
    CHECK(gone.faults.front().rule == "missing-layer");
    CHECK(gone.fault_count == 40);
}

TEST_CASE("the sheet that resins are assigned by says what the manifest says", "[verify]") {
    TemporaryFolder folder;
    const auto out = folder.path() / "stack";
    (void)write_sample_stack(out, 40);
    std::string text = text_of(out / "resin-assignment.txt");
    text.replace(text.find("VeroCyan"), 8, "VeroClay");
    write_whole_file(out / "resin-assignment.txt", text);
    const auto report = verify_stack(out);
    CHECK(has(report, "sheet", "VeroCyan"));
    CHECK(report.fault_count == 1);
}

TEST_CASE("a cause is named before what follows from it, and in words that are said once", "[verify]") {
    TemporaryFolder folder;
    const auto out = folder.path() / "stack";
    (void)write_sample_stack(out, 40);
    write_whole_file(slice(out, 5), text_of(slice(out, 5)).substr(0, 100));
    const auto report = verify_stack(out);
    INFO(report_text(report));
    CHECK(report.fault_count == 1);
    CHECK(report.faults.front().rule == "unreadable");
    CHECK(report.faults.front().what.find("slice_00005") == std::string::npos);
    CHECK_THAT(report_text(report), Contains("were not compared"));
    (void)write_sample_stack(out, 40);
    // Recoloured: counts are the consequence of other pixels.
    write_whole_file(slice(out, 5), text_of(slice(out, 6)));
    const auto other = verify_stack(out);
    CHECK(other.faults.front().rule == "digest");
    CHECK(has(other, "count"));
}

TEST_CASE("What lies beside the layers of a stack from elsewhere is read where the layers are", "[verify]") {
    const TemporaryFolder folder;
    const auto out = folder.path() / "stack";
    (void)write_sample_stack(out, 40, {ResinBitmaps::png1, true, false});
    write_whole_file(out / "job.json",
                     std::string_view(R"({"format": "voxtone-job", "version": 1, "model": "a.png", "resins": "mine",
        "backing": "white", "somebody's": [[[]]]})"));
    {
        const StackReader reader(out);
        CHECK(reader.origin().model == "a.png");
        CHECK(reader.origin().resins == "mine");
        CHECK(reader.origin().backing == "white");
    }
    // Something in their place that never ends, or is no file at all.
    for (const char* name : {"job.json", "resin-assignment.txt"}) {
        fs::remove(out / name);
        REQUIRE(mkfifo((out / name).c_str(), 0600) == 0);
    }
    const StackReader reader(out);
    CHECK(reader.origin().model.empty());
    CHECK_FALSE(reader.sheet());
    CHECK(verify_stack(out).passed());
    fs::remove(out / manifest_name);
    REQUIRE(mkfifo((out / manifest_name).c_str(), 0600) == 0);
    const auto report = verify_stack(out);
    REQUIRE(report.faults.size() == 1);
    CHECK(report.faults.front().rule == "manifest");
    CHECK_THAT(report.faults.front().what, Contains("is no file"));
}

TEST_CASE("What is no file in the place of a layer is called what it is", "[verify]") {
    const TemporaryFolder folder;
    const fs::path out = folder.path() / "stack", elsewhere = folder.path() / "elsewhere.png";
    (void)write_sample_stack(out, 40);
    fs::rename(slice(out, 20), elsewhere);
    const auto check = [&](const std::string& words) {
        for (const fs::path& stack : {out, out / "layers"}) {
            const StackReport report = verify_stack(stack);
            INFO(report_text(report));
            CHECK(report.layers == 40);
            CHECK(report.fault_count == 1);
            CHECK(has(report, "unreadable", words));
            const StackReader reader(stack);
            CHECK_THROWS_WITH(reader.read(20, sample_description(40).palette()),
                              Contains("slice_00020.png") && Contains(words));
        }
        fs::remove(slice(out, 20));
    };
    fs::create_symlink("nowhere.png", slice(out, 20));
    check("is a link that leads nowhere");
    fs::create_symlink(slice(out, 20).filename(), slice(out, 20));
    check("is a link that leads nowhere");
    fs::create_symlink(elsewhere, slice(out, 20));
    check("is a link out of the stack, which is not followed");
    fs::create_directory_symlink(folder.path(), slice(out, 20));
    check("is a link out of the stack, which is not followed");
    fs::create_directory(slice(out, 20));
    check("is a folder");
    REQUIRE(mkfifo(slice(out, 20).c_str(), 0600) == 0);
    check("is a pipe");
    // Within the stack a link is as good as its file: here it is another layer's, which the counts tell.
    fs::create_symlink(slice(out, 21).filename(), slice(out, 20));
    CHECK(has(verify_stack(out), "digest"));
    CHECK(verify_stack(out / "layers").passed());
    // Beside the layers such things are in the way, whatever they are.
    fs::remove(slice(out, 20));
    fs::rename(elsewhere, slice(out, 20));
    fs::create_symlink("nowhere", out / "layers" / "notes");
    CHECK(has(verify_stack(out), "stranger", "layers/notes"));
    CHECK(has(verify_stack(out / "layers"), "stranger", "notes"));
}
