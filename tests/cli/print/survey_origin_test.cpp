// SPDX-License-Identifier: GPL-3.0-or-later
//
// Scans keep the coordinates of the survey: a body of 0.2 m whose numbers are 5e6 m. Whatever the format, it prints as
// its twin at the origin does, to a tenth of a voxel.
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>

#include <fmt/format.h>
#include <zlib.h>

#include <catch2/catch.hpp>

#include "body_of_line.h"
#include "glb_sides.h"
#include "stack_voxels.h"
#include "tests/cli/run_program.h"
#include "tests/places.h"

using namespace voxtone::test;

namespace {

using Place = std::array<double, 3>;

/// A box with its corner at `origin`, whose sides are no multiple of a voxel, and an asymmetric step on it: metres.
struct Body {
    std::vector<Place> corners;
    std::vector<std::array<std::size_t, 3>> faces;

    void add_box(const Place& low, const Place& high) {
        const std::size_t first = corners.size();
        for (int c = 0; c < 8; ++c)
            corners.push_back({c & 1 ? high[0] : low[0], c & 2 ? high[1] : low[1], c & 4 ? high[2] : low[2]});
        for (const auto& f : {std::array<std::size_t, 4>{0, 2, 3, 1},
                              {4, 5, 7, 6},
                              {0, 1, 5, 4},
                              {2, 6, 7, 3},
                              {0, 4, 6, 2},
                              {1, 3, 7, 5}}) {
            faces.push_back({first + f[0], first + f[1], first + f[2]});
            faces.push_back({first + f[0], first + f[2], first + f[3]});
        }
    }
};

Body body_at(const Place& o) {
    Body body;
    body.add_box(o, {o[0] + 0.2, o[1] + 0.133, o[2] + 0.077});
    body.add_box({o[0], o[1], o[2] + 0.077}, {o[0] + 0.053, o[1] + 0.031, o[2] + 0.1183});
    return body;
}

std::string obj(const Body& body) {
    std::string text;
    for (const Place& p : body.corners) text += fmt::format("v {:.6f} {:.6f} {:.6f}\n", p[0], p[1], p[2]);
    for (const auto& f : body.faces) text += fmt::format("f {} {} {}\n", f[0] + 1, f[1] + 1, f[2] + 1);
    return text;
}

std::string stl(const Body& body) {
    std::string text = "solid scan\n";
    for (const auto& f : body.faces) {
        text += "facet normal 0 0 0\nouter loop\n";
        for (const std::size_t c : f)
            text += fmt::format("vertex {:.6f} {:.6f} {:.6f}\n", body.corners[c][0], body.corners[c][1],
                                body.corners[c][2]);
        text += "endloop\nendfacet\n";
    }
    return text + "endsolid scan\n";
}

std::string ply(const Body& body, bool binary) {
    std::string text = fmt::format(
        "ply\nformat {} 1.0\nelement vertex {}\nproperty double x\nproperty double y\nproperty double z\n"
        "element face {}\nproperty list uchar int vertex_indices\nend_header\n",
        binary ? "binary_little_endian" : "ascii", body.corners.size(), body.faces.size());
    const auto append = [&](const auto& value) { text.append(reinterpret_cast<const char*>(&value), sizeof value); };
    for (const Place& p : body.corners) {
        if (!binary) text += fmt::format("{:.6f} {:.6f} {:.6f}\n", p[0], p[1], p[2]);
        for (std::size_t k = 0; binary && k < 3; ++k) append(p[k]);
    }
    for (const auto& f : body.faces) {
        if (!binary) text += fmt::format("3 {} {} {}\n", f[0], f[1], f[2]);
        if (binary) text += '\3';
        for (std::size_t k = 0; binary && k < 3; ++k) append(static_cast<std::int32_t>(f[k]));
    }
    return text;
}

/// Parts as they are, not compressed.
std::string stored_zip(const std::vector<std::pair<std::string, std::string>>& parts) {
    std::string file, directory;
    const auto number = [](std::uint64_t value, int bytes) {
        std::string text;
        for (int b = 0; b < bytes; ++b) text += static_cast<char>(value >> (8 * b) & 0xff);
        return text;
    };
    for (const auto& [name, bytes] : parts) {
        const std::uint64_t crc =
            crc32(0, reinterpret_cast<const Bytef*>(bytes.data()), static_cast<uInt>(bytes.size()));
        const std::string common = number(20, 2) + number(0, 2) + number(0, 2) + number(0x21, 4) + number(crc, 4) +
                                   number(bytes.size(), 4) + number(bytes.size(), 4) + number(name.size(), 2) +
                                   number(0, 2);
        directory += "PK\1\2" + number(20, 2) + common + number(0, 2) + number(0, 2) + number(0, 2) + number(0, 4) +
                     number(file.size(), 4) + name;
        file += "PK\3\4" + common + name + bytes;
    }
    const std::uint64_t start = file.size();
    return file + directory + "PK\5\6" + number(0, 4) + number(parts.size(), 2) + number(parts.size(), 2) +
           number(directory.size(), 4) + number(start, 4) + number(0, 2);
}

/// In metres; the item's transform holds `moved` of the place.
std::string threemf(const Body& body, const Place& moved) {
    std::string model =
        "<?xml version=\"1.0\"?><model unit=\"meter\" "
        "xmlns=\"http://schemas.microsoft.com/3dmanufacturing/core/2015/02\"><resources><object id=\"1\" "
        "type=\"model\"><mesh><vertices>";
    for (const Place& p : body.corners)
        model += fmt::format("<vertex x=\"{:.6f}\" y=\"{:.6f}\" z=\"{:.6f}\"/>", p[0], p[1], p[2]);
    model += "</vertices><triangles>";
    for (const auto& f : body.faces)
        model += fmt::format("<triangle v1=\"{}\" v2=\"{}\" v3=\"{}\"/>", f[0], f[1], f[2]);
    model += fmt::format(
        "</triangles></mesh></object></resources><build><item objectid=\"1\" transform=\"1 0 0 0 1 0 0 0 1 {:.6f} "
        "{:.6f} {:.6f}\"/></build></model>",
        moved[0], moved[1], moved[2]);
    return stored_zip(
        {{"[Content_Types].xml",
          "<Types xmlns=\"http://schemas.openxmlformats.org/package/2006/content-types\"><Default Extension=\"rels\" "
          "ContentType=\"application/vnd.openxmlformats-package.relationships+xml\"/><Default Extension=\"model\" "
          "ContentType=\"application/vnd.ms-package.3dmanufacturing-3dmodel+xml\"/></Types>"},
         {"_rels/.rels",
          "<Relationships xmlns=\"http://schemas.openxmlformats.org/package/2006/relationships\"><Relationship "
          "Target=\"/3D/3dmodel.model\" Id=\"r\" "
          "Type=\"http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel\"/></Relationships>"},
         {"3D/3dmodel.model", model}});
}

/// glTF has floats: the place is that of a node.
std::string glb(const Body& body, const Place& moved) {
    std::string binary;
    const auto append = [&](auto value) { binary.append(reinterpret_cast<const char*>(&value), sizeof value); };
    for (const Place& p : body.corners)
        for (const double x : {p[0], p[2], -p[1]}) append(static_cast<float>(x));
    const std::size_t places = binary.size();
    for (const auto& f : body.faces)
        for (const std::size_t c : f) append(static_cast<std::uint32_t>(c));
    std::string json = fmt::format(
        R"({{"asset":{{"version":"2.0"}},"scene":0,"scenes":[{{"nodes":[0]}}],"nodes":[{{"mesh":0,"translation":[{:.6f},{:.6f},{:.6f}]}}],)"
        R"("meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},"indices":1}}]}}],"buffers":[{{"byteLength":{}}}],)"
        R"("bufferViews":[{{"buffer":0,"byteLength":{}}},{{"buffer":0,"byteOffset":{},"byteLength":{}}}],)"
        R"("accessors":[{{"bufferView":0,"componentType":5126,"count":{},"type":"VEC3"}},{{"bufferView":1,"componentType":5125,"count":{},"type":"SCALAR"}}]}})",
        moved[0], moved[2], -moved[1], binary.size(), places, places, binary.size() - places, body.corners.size(),
        3 * body.faces.size());
    while (json.size() % 4) json += ' ';
    const auto word = [](std::size_t value) {
        const auto w = static_cast<std::uint32_t>(value);
        return std::string(reinterpret_cast<const char*>(&w), 4);
    };
    return "glTF" + word(2) + word(28 + json.size() + binary.size()) + word(json.size()) + "JSON" + json +
           word(binary.size()) + std::string("BIN\0", 4) + binary;
}

struct Printed {
    double volume_mm3 = 0;
    std::array<double, 3> size_mm{}, target_mm{};
};

Printed print(const std::string& name, const std::string& bytes) {
    const Folder folder("survey");
    folder.write(name, bytes);
    const Outcome outcome = run_program(
        fmt::format("slice '{}' --size 20mm --iterations 0 --predict none --screen error-diffusion --printer '{}' -o "
                    "'{}'",
                    folder / name, test_data() + "/bugs/printer.json", folder / "out"));
    INFO(name << "\n" << outcome.out << outcome.err);
    REQUIRE(outcome.exit_code == 0);
    CHECK_THAT(outcome.err, !Catch::Contains("hole"));
    const StackVoxels voxels = stack_voxels(folder / "out");
    return {voxels.volume_mm3, voxels.size_mm, glb_sides(folder / "out/target.glb").size_mm};
}

/// The same until there is a body.
Printed body(const std::string& name, const std::string& bytes) {
    const Folder folder("survey");
    folder.write(name, bytes);
    BugLine line;
    line.file = folder / name;
    line.options = "--size 20mm";
    line.sides["+x"] = {};  // its GLB is wanted
    const BodyOfLine made = body_of_line(line, folder / "target.glb");
    INFO(name << "\n" << made.said);
    REQUIRE(made.exit_code == 0);
    CHECK_THAT(made.said, !Catch::Contains("hole"));
    return {made.volume_mm3, made.size_mm, glb_sides(folder / "target.glb").size_mm};
}

}  // namespace

TEST_CASE("a body far from its origin prints as it does at the origin, in every format") {
    const Place origin{0, 0, 0}, survey{512345.678, 5412345.123, 261.5};
    const Body here = body_at(origin), there = body_at(survey);
    const Printed local = print("local.obj", obj(here));
    CHECK(local.volume_mm3 == Approx(20 * 13.3 * 7.7 + 5.3 * 3.1 * 4.13).epsilon(0.03));  // to a voxel at its faces
    const auto check = [&local](const Printed& far) {
        CHECK(far.volume_mm3 == Approx(local.volume_mm3).epsilon(1e-12));
        constexpr double tenth_of_a_voxel = 0.02;
        for (std::size_t k = 0; k < 3; ++k) {
            CHECK(far.size_mm[k] == Approx(local.size_mm[k]).epsilon(1e-12));
            CHECK(std::abs(far.target_mm[k] - local.target_mm[k]) < tenth_of_a_voxel);
        }
    };
    check(print("far.obj", obj(there)));
    for (const auto& [name, bytes] : {std::pair<std::string, std::string>{"far.obj", obj(there)},
                                      {"far.stl", stl(there)},
                                      {"far.ply", ply(there, false)},
                                      {"far-binary.ply", ply(there, true)},
                                      {"far.3mf", threemf(there, origin)},
                                      {"far-item.3mf", threemf(here, survey)},
                                      {"far.glb", glb(here, survey)}}) {
        CAPTURE(name);
        check(body(name, bytes));
    }
}
