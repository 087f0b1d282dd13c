// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/layers/verify.h"

#include <zip.h>

#include <catch2/catch.hpp>
#include <fstream>
#include <utility>

#include "base/error.h"
#include "base/parallel.h"
#include "io/layers/layer_scan.h"
#include "io/layers/stack_files.h"
#include "stack_samples.h"
#include "tests/io/files/temporary_folder.h"

using namespace voxtone;
using namespace voxtone::io;
namespace fs = std::filesystem;

TEST_CASE("a layer cut anywhere is a fault, never a crash", "[verify][fuzz]") {
    const PngLayerEncoder encoder(sample_description(1).palette(), {42.333, 84.667});
    const auto whole = encoder.encode(sample_layer(1, 40, 12));
    const auto palette = sample_description(1).palette();
    REQUIRE(scan_layer(whole, "whole", palette).runs.has_value());
    for (std::size_t n = 0; n < whole.size(); ++n)
        CHECK_THROWS_AS(scan_layer(std::span(whole).first(n), "cut", palette), InputError);
    // Any byte changed: every one is under a checksum.
    for (std::size_t i = 0; i < whole.size(); ++i)
        for (const int bit : {1, 0x80}) {
            auto spoilt = whole;
            spoilt[i] = static_cast<std::uint8_t>(spoilt[i] ^ bit);
            INFO("byte " << i);
            CHECK_THROWS_AS(scan_layer(spoilt, "spoilt", palette), InputError);
        }
}

TEST_CASE("hostile PNG headers cost nothing", "[verify][fuzz]") {
    auto png = [](std::uint32_t w, std::uint32_t h, std::uint32_t idat) {
        std::vector<std::uint8_t> out = {0x89, 'P', 'N', 'G', 13, 10, 26, 10};
        auto u32 = [&](std::uint32_t v) {
            for (int s = 24; s >= 0; s -= 8) out.push_back(static_cast<std::uint8_t>(v >> s));
        };
        u32(13);
        const std::size_t start = out.size();
        for (const char c : {'I', 'H', 'D', 'R'}) out.push_back(static_cast<std::uint8_t>(c));
        u32(w), u32(h);
        for (const int b : {8, 6, 0, 0, 0}) out.push_back(static_cast<std::uint8_t>(b));
        std::uint32_t crc = 0xffffffffu;
        for (std::size_t i = start; i < out.size(); ++i) {
            crc ^= out[i];
            for (int k = 0; k < 8; ++k) crc = crc & 1 ? 0xEDB88320u ^ (crc >> 1) : crc >> 1;
        }
        u32(~crc);
        u32(idat);
        for (const char c : {'I', 'D', 'A', 'T'}) out.push_back(static_cast<std::uint8_t>(c));
        return out;
    };
    const std::vector<Rgb> palette = {{0, 0, 0}, {1, 2, 3}};
    for (const auto& [w, h] :
         {std::pair{65535u, 65535u}, {0x7fffffffu, 1u}, {1u, 0x7fffffffu}, {0u, 5u}, {65535u, 2048u}})
        for (const std::uint32_t idat : {0u, 1u, 0x7fffffffu, 0xffffffffu})
            CHECK_THROWS_AS(scan_layer(png(w, h, idat), "hostile", palette), InputError);
}

TEST_CASE("a GCVF cut or spoilt anywhere is an error or a fault, never a crash", "[verify][fuzz]") {
    TemporaryFolder folder;
    const auto out = folder.path() / "stack";
    {
        LayerStackWriter writer(out, sample_description(2, 12, 5), {ResinBitmaps::none, true, false});
        for (std::uint32_t k = 0; k < 2; ++k) writer.write(k, sample_layer(k, 12, 5));
        (void)writer.finish();
    }
    const std::string whole = text_of(out / "stack.gcvf");
    VerifyRules rules;
    rules.least_layers = 1;
    REQUIRE(verify_stack(out / "stack.gcvf", rules).passed());
    const auto file = folder.path() / "x.gcvf";
    const auto write = [&](std::string_view bytes) {  // a thousand times: not synced
        std::ofstream(file, std::ios::binary | std::ios::trunc) << bytes;
    };
    // The reader itself, in this process: what would crash it would crash the test. A stack as verify sees it, through
    // a program of its own, now and then.
    constexpr std::size_t now_and_then = 61;
    for (std::size_t n = 0; n < whole.size(); ++n) {
        write(std::string_view(whole).substr(0, n));
        CHECK_THROWS_AS(StackFiles(file), InputError);
        if (n % now_and_then == 0) CHECK(has(verify_stack(file, rules), "container"));
    }
    // Every byte set to one of the ends: whatever happens is an Error or a report.
    const auto palette = sample_description(2, 12, 5).palette();
    for (std::size_t i = 0; i < whole.size(); ++i) {
        auto spoilt = whole;
        spoilt[i] = i % 2 ? '\x00' : '\xff';
        write(spoilt);
        INFO("byte " << i);
        try {
            const StackFiles stack(file);
            for (std::uint32_t k = 0; k < stack.listing().names.size(); ++k)
                (void)scan_layer(stack.bytes(k), "layer", palette);
        } catch (const Error&) {
        }
        if (i % now_and_then == 0) CHECK_NOTHROW(verify_stack(file, rules));
    }
    CHECK(fs::exists(out / "manifest.json"));
}

TEST_CASE("zip bombs and paths that leave the folder", "[verify][fuzz]") {
    TemporaryFolder folder;
    auto config = gcvf_config(sample_description(2, 12, 5));
    auto container = [&](const std::vector<std::pair<std::string, std::string>>& entries) {
        const auto file = folder.path() / "x.gcvf";
        zip_t* zip = zip_open(file.c_str(), ZIP_CREATE | ZIP_TRUNCATE, nullptr);
        REQUIRE(zip);
        for (const auto& [name, bytes] : entries)
            REQUIRE(zip_file_add(zip, name.c_str(), zip_source_buffer(zip, bytes.data(), bytes.size(), 0),
                                 ZIP_FL_OVERWRITE) >= 0);
        REQUIRE(zip_close(zip) == 0);
        return file;
    };
    const PngLayerEncoder encoder(sample_description(1).palette(), {42.333, 84.667});
    auto layer = [&](std::uint32_t k) {
        const auto bytes = encoder.encode(sample_layer(k, 12, 5));
        return std::string(bytes.begin(), bytes.end());
    };
    const std::string bomb(std::size_t{257} << 20, '\0');  // a quarter of a megabyte when packed
    auto report = verify_stack(
        container({{"ConfigFile.xml", gcvf_config_text(config)}, {"layer_0.png", layer(0)}, {"layer_1.png", bomb}}));
    CHECK(has(report, "unreadable", "more than"));
    CHECK(has(verify_stack(container({{"ConfigFile.xml", bomb.substr(0, (16 << 20) + 1)}})), "container"));
    report = verify_stack(container({{"ConfigFile.xml", gcvf_config_text(config)},
                                     {"layer_0.png", layer(0)},
                                     {"layer_1.png", layer(1)},
                                     {"../../etc/passwd", "x"},
                                     {"/abs", "x"},
                                     {"sub/file", "x"}}));
    CHECK(has(report, "stranger", "../../etc/passwd"));
    CHECK(has(report, "stranger", "leads out"));
    CHECK(has(report, "stranger", "sub/file"));
    config.prefix = "../layer_";
    CHECK(has(verify_stack(container({{"ConfigFile.xml", gcvf_config_text(config)}})), "container", "ImageFilePrefix"));
    config.prefix = "layer_";
    config.slices = 1000000;
    report = verify_stack(container({{"ConfigFile.xml", gcvf_config_text(config)}, {"layer_0.png", layer(0)}}));
    CHECK(report.fault_count > 999990);
    CHECK(report.faults.size() < 40);
    for (const auto* xml : {"", "<GCVF>", "<GCVF></GCVF>", "<GCVF><XDpi>nan</XDpi></GCVF>",
                            "<GCVF><XDpi>600</XDpi><YDpi>-1</YDpi></GCVF>"})
        CHECK(has(verify_stack(container({{"ConfigFile.xml", xml}})), "container"));
}
