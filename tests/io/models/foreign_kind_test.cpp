// SPDX-License-Identifier: GPL-3.0-or-later
//
// What people give for a model or a picture and is neither, by its bytes and by its name.
#include "io/models/foreign_kind.h"

#include <algorithm>
#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <catch2/catch.hpp>

#include "model_samples.h"

using namespace voxtone;
using namespace voxtone::io;
using namespace std::string_view_literals;
using Catch::Matchers::Contains;

namespace {

std::string kind_of(const std::string& name, std::string_view bytes, Wanted wanted = Wanted::model_or_picture) {
    const auto all = std::as_bytes(std::span(bytes));
    return foreign_kind(name, all.first(std::min(all.size(), kind_bytes)), all.size(), wanted);
}

std::string at(std::size_t place, std::string_view mark) {
    std::string bytes(place, '\0');
    return bytes.append(mark).append(600, ' ');
}

/// Behind four bytes, as boxes of MPEG-4 and JPEG 2000 begin.
std::string box(char length, std::string_view type) {
    std::string bytes{'\0', '\0', '\0', length};
    return bytes.append(type);
}

/// The name of the first file in an archive.
std::string zip_of(std::string_view name) {
    std::string bytes = "PK\x03\x04";
    return bytes.append(26, '\0').append(name);
}

struct Sample {
    const char* name;
    std::string bytes;
    const char* what;
};

const std::vector<Sample>& samples() {
    static const std::vector<Sample> all{
        {"part.step", "ISO-10303-21;\nHEADER;\n", "a STEP file"},
        {"part.ifc", "ISO-10303-21;\nHEADER;\nFILE_SCHEMA(('IFC4'));\n", "an IFC file"},
        {"part.igs", std::string(72, ' ').append("S      1\n"), "an IGES file"},
        {"part.x3d", "<?xml version=\"1.0\"?>\n<!DOCTYPE X3D PUBLIC \"a\" \"b\">\n<!-- x > y -->\n<X3D>",
         "an X3D scene"},
        {"part.blend", "BLENDER-v300", "a Blender file"},
        {"part.dae", "\xef\xbb\xbf<?xml version=\"1.0\"?><COLLADA xmlns=\"x\">", "a Collada scene"},
        {"part.usdc", "PXR-USDC", "a USD scene"},
        {"part.usda", "#usda 1.0", "a USD scene"},
        {"part.off", "OFF\n3 1 0\n", "an OFF model"},
        {"part.drc", "DRACO\2\2\1\1", "a bare Draco stream"},
        {"part.3ds", std::string("MM\x0a\0\0\0\x02\0\0\0", 10), "a 3D Studio model"},
        {"part.amf", "<?xml version=\"1.0\"?><amf unit=\"millimeter\"></amf>", "an AMF model"},
        {"part.sldprt", "\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1", "a SolidWorks"},
        {"scan.dcm", at(128, "DICM"), "a DICOM file"},
        {"scan.nii", at(344, "n+1\0"sv), "a NIfTI scan"},
        {"scan.nrrd", "NRRD0004\n", "an NRRD volume"},
        {"scan.vtk", "# vtk DataFile Version 3.0\n", "a VTK file"},
        {"scan.vtp", "<VTKFile type=\"PolyData\">", "a VTK file"},
        {"points.las", "LASF", "a point cloud"},
        {"box.rar", "Rar!\x1a\x07\x01", "a RAR archive"},
        {"box.7z", "7z\xbc\xaf\x27\x1c", "a 7-Zip archive"},
        {"box.gz", "\x1f\x8b\x08", "compressed (gzip)"},
        {"art.pdf", "%PDF-1.4", "a PDF document"},
        {"art.eps", "%!PS-Adobe", "a PostScript drawing"},
        {"photo.heic", box('\x18', "ftypheic"), "a HEIC picture"},
        {"photo.avif", box('\x18', "ftypavif"), "an AVIF picture"},
        {"photo.jxl", "\xff\x0a", "a JPEG XL picture"},
        {"photo.jp2", box('\x0c', "jP  \r\n"), "a JPEG 2000 picture"},
        {"film.mp4", box('\x18', "ftypisom"), "a film"},
        {"page.html", "\n<!DOCTYPE HTML>\n<html>", "a web page"},
    };
    return all;
}

}  // namespace

TEST_CASE("A drawing is a picture of a print or a decal, and neither a model nor a texture") {
    const std::string plain = "<svg xmlns=\"http://www.w3.org/2000/svg\"/>";
    const std::string declared =
        "\xef\xbb\xbf<?xml version='1.0'?><!-- a --><!DOCTYPE svg PUBLIC 'x' 'y' [<!ENTITY n 'http://x'>\n<!ENTITY m "
        "'y'>]>\n<x:svg xmlns:x='&n;'/>";
    for (const std::string& drawing : {plain, declared}) {
        for (const char* name : {"art.svg", "art.SVG", "art", "art.png"}) {
            CHECK(kind_of(name, drawing).empty());
            CHECK(kind_of(name, drawing, Wanted::picture).empty());
            CHECK_THAT(kind_of(name, drawing, Wanted::texture), Contains("an SVG drawing") && Contains("as PNG"));
        }
        CHECK_THAT(kind_of("part.obj", drawing), Contains("an SVG drawing, whatever its name says"));
    }
    CHECK(kind_of("art.svgz", "\x1f\x8b\x08").empty());
    CHECK_THAT(kind_of("art.svgz", "\x1f\x8b\x08", Wanted::texture), Contains("SVG"));
    CHECK_THAT(kind_of("art.gz", "\x1f\x8b\x08"), Contains("gzip"));
    CHECK(kind_of("art.svg", "nothing of it").empty());  // its reader says what is wrong
}

TEST_CASE("Neighbours are known by their bytes, whatever their names are") {
    for (const Sample& sample : samples()) {
        INFO(sample.name);
        const std::string by_both = kind_of(sample.name, sample.bytes);
        CHECK_THAT(by_both,
                   Contains(std::string(sample.name) + " is " + sample.what) && !Contains("whatever its name"));
        for (const char* name : {"part.obj", "part.STL", "part.glb", "part.ply", "part.png", "part.csv"})
            CHECK_THAT(kind_of(name, sample.bytes), Contains(sample.what) && Contains("whatever its name says"));
        CHECK_THAT(kind_of("part", sample.bytes), Contains(sample.what) && !Contains("whatever its name says"));
        CHECK_THAT(kind_of("skin.png", sample.bytes, Wanted::picture), Contains(sample.what) && Contains("no picture"));
    }
}

TEST_CASE("Neighbours are known by their names where their bytes do not tell, in any case of letters") {
    for (const char* name :
         {"a.X3D",  "a.x3dv", "a.stp",  "a.STEP",   "a.iges",   "a.igs",     "a.abc",      "a.Blend",  "a.dae",
          "a.usd",  "a.usdz", "a.rar",  "a.7z",     "a.dcm",    "a.nrrd",    "a.nii",      "a.nii.gz", "a.vtk",
          "a.vti",  "a.amf",  "a.off",  "a.3ds",    "a.x3d",    "a.pdf",     "a.ai",       "a.heic",   "a.HEIF",
          "a.avif", "a.jxl",  "a.jp2",  "a.sldprt", "a.ipt",    "a.catpart", "a.x_t",      "a.3dm",    "a.skp",
          "a.f3d",  "a.dwg",  "a.dxf",  "a.gcode",  "a.stl.gz", "a.tar.gz",  "a.las",      "a.xyz",    "a.splat",
          "a.vdb",  "a.cr2",  "a.mp4",  "a.html",   "a.docx",   "a.eps",     "a.kra",      "a.max",    "a.c4d",
          "a.ctm",  "a.vox",  "a.gcvf", "a.mtl",    "a.mha",    "a.fcstd",   "a.b.c.step", "a.objzf"}) {
        INFO(name);
        CHECK_THAT(kind_of(name, ""), Contains(std::string(name) + " is ") && Contains(": "));
        CHECK_THAT(kind_of(name, "no bytes that tell"), Contains("neither a model nor a picture that can be read"));
    }
    // A scan that is compressed is a scan.
    CHECK_THAT(kind_of("brain.nii.gz", "\x1f\x8b\x08"), Contains("a NIfTI scan"));
    CHECK_THAT(kind_of("part.stl.gz", "\x1f\x8b\x08"), Contains("compressed (gzip)") && Contains("unpack"));
    CHECK_THAT(kind_of("scene.usdz", "PK\x03\x04"), Contains("a USD scene"));
    // An archive by its name is looked into by its reader.
    for (const char* name : {"a.zip", "a.obj.ZIP"})
        for (const std::string& bytes : {zip_of("box.obj"), zip_of("x.usda"), std::string(), std::string("none")})
            CHECK(kind_of(name, bytes).empty());
    CHECK_THAT(kind_of("box.obj", zip_of("box.obj")), Contains("a ZIP archive, whatever its name says"));
    CHECK_THAT(kind_of("a.zip", zip_of("a.png"), Wanted::picture), Contains("a ZIP archive") && Contains("no picture"));
    CHECK_THAT(kind_of("a.zip", "<html>"), Contains("a web page"));
    CHECK_THAT(kind_of("art.ai", "%PDF-1.5"), Contains("a drawing"));
    // TIFF is what a camera's raw picture begins as.
    CHECK_THAT(kind_of("photo.nef", "II*\0"sv), Contains("raw picture"));
}

TEST_CASE("What is sent in place of a file is told") {
    CHECK_THAT(kind_of("model.stl", "<html><body>404</body></html>"), Contains("web page") && Contains("download"));
    for (const char* message :
         {"404: Not Found", "{\"error\": 404}", "<?xml version=\"1.0\"?><Error><Code>AccessDenied</Code>"})
        for (const char* name : {"a.stl", "a.glb", "a.3mf", "a.obj"})
            CHECK_THAT(kind_of(name, message), Contains("message of a server") && Contains("download"));
    CHECK(kind_of("a.gltf", "{\"buffers\": []").empty());
    CHECK_THAT(kind_of("model.glb", "version https://git-lfs.github.com/spec/v1\n"), Contains("git lfs pull"));
    CHECK_THAT(kind_of("model.obj", std::string(5000, '\0')), Contains("zeros") && Contains("download"));
    CHECK_THAT(kind_of("job.json", "{\"format\": \"voxtone-job\"}"), Contains("--job"));
}

TEST_CASE("A model under the name of another kind is told how to be named") {
    const std::string obj = "# made by hand\nmtllib a.mtl\nv 0 0 0\nv 1 0 0\n";
    const std::string stl = "solid a\n facet normal 0 0 1\n";
    std::string binary_stl(84 + 50, '\0');
    binary_stl[80] = 1;
    struct Misnamed {
        const char* name;
        std::string bytes;
        const char* better;
    };
    for (const Misnamed& file :
         {Misnamed{"a", obj, "a.obj"}, Misnamed{"a.txt", obj, "a.obj"}, Misnamed{"a.png", obj, "a.obj"},
          Misnamed{"a.stl", obj, "a.obj"}, Misnamed{"a.obj", stl, "a.stl"}, Misnamed{"a.obj", binary_stl, "a.stl"},
          Misnamed{"a.obj", "ply\nformat ascii 1.0\n", "a.ply"}, Misnamed{"a.vrm", "glTF\2\0\0\0", "a.glb"},
          Misnamed{"a.obj", "{\"asset\": {}}", "a.gltf"}, Misnamed{"a.stl", "glTF", "a.glb"},
          Misnamed{"a.fbm", "Kaydara FBX Binary  ", "a.fbx"}, Misnamed{"a.obj", "; FBX 7.3.0 project file\n", "a.fbx"},
          Misnamed{"a.x3d", "#VRML V2.0 utf8\n", "a.wrl"}, Misnamed{"a.wrl", "ply\nformat", "a.ply"},
          Misnamed{"a.zip", zip_of("3D/3dmodel.model"), "a.3mf"}}) {
        INFO(file.name << " better " << file.better);
        CHECK_THAT(kind_of(file.name, file.bytes), Contains(std::string("rename it ") + file.better));
        CHECK(kind_of(file.better, file.bytes).empty());
        CHECK_THAT(kind_of(file.name, file.bytes, Wanted::picture), Contains("no picture"));
    }
    CHECK_THAT(kind_of("a.obj", "BM\x46\0"sv), Contains("a BMP picture"));
    CHECK_THAT(kind_of("a.glb", "\x89PNG\r\n\x1a\n"), Contains("a PNG picture") && Contains("a.png"));
}

TEST_CASE("What can be read is let through") {
    for (const test::Files& sample : test::every_sample()) {
        INFO(sample[0].first);
        CHECK(kind_of(sample[0].first, sample[0].second).empty());
    }
    // Pictures by their bytes, whatever they are called; what has no mark of a foreign kind by the name of one that can
    // be read, or of none.
    for (const char* name : {"a.png", "a", "a.heic", "a.tga"}) CHECK(kind_of(name, test::four_colours()).empty());
    for (const char* name : {"a.png", "a.obj", "a", "a.unheard", "a.3mf", "a.psd"}) CHECK(kind_of(name, "?").empty());
    CHECK(kind_of("a.3mf", "PK\x03\x04 a preview that is long").empty());
    for (const char* name : {"a.wrl", "a.WRZ", "a.vrml"})
        for (const char* bytes : {"#VRML V2.0 utf8\n", "#VRML V1.0 ascii\n", "\x1f\x8b\x08"})
            CHECK(kind_of(name, bytes).empty());
    CHECK(kind_of("a.png", "\x89PNG\r\n\x1a\n", Wanted::picture).empty());
    // The header of a binary STL may hold anything.
    std::string stl = "OFF" + std::string(81 + 50, '\0');
    stl[80] = 1;
    CHECK(kind_of("a.stl", stl).empty());
}

TEST_CASE("A file is looked at where there is one, and is never waited for") {
    const test::Folder folder;
    const auto step = folder.write({{"a.obj", "ISO-10303-21;"}});
    CHECK_THAT(foreign_kind(step), Contains("a STEP file"));
    CHECK(foreign_kind(folder.path() / "absent.obj").empty());
    CHECK_THAT(foreign_kind(folder.path() / "absent.dae"), Contains("a Collada scene"));
    CHECK(foreign_kind(folder.path()).empty());
}
