// SPDX-License-Identifier: GPL-3.0-or-later
#include "model_samples.h"

#include <unistd.h>

#include <cstring>
#include <fstream>
#include <stdexcept>

#include <fmt/format.h>
#include <png.h>
#include <zip.h>

#include "tests/io/codecs/fbx_bytes.h"

namespace voxtone::test {

namespace fs = std::filesystem;

Folder::Folder() {
    std::string name = (fs::temp_directory_path() / "voxtone-test-").string().append(6, 'X');
    if (!mkdtemp(name.data())) throw std::runtime_error("no folder for the test");
    path_ = name;
}

Folder::~Folder() { fs::remove_all(path_); }

fs::path Folder::write(const Files& files) const {
    for (const auto& [name, contents] : files) {
        fs::create_directories((path_ / name).parent_path());
        std::ofstream(path_ / name, std::ios::binary) << contents;
    }
    return path_ / files.front().first;
}

std::string png(std::uint32_t width, std::uint32_t height, const std::vector<std::uint8_t>& rgba, bool deep) {
    std::string out;
    png_structp writer = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
    png_infop info = png_create_info_struct(writer);
    png_set_write_fn(
        writer, &out,
        [](png_structp p, png_bytep data, std::size_t size) {
            static_cast<std::string*>(png_get_io_ptr(p))->append(reinterpret_cast<const char*>(data), size);
        },
        nullptr);
    png_set_IHDR(writer, info, width, height, deep ? 16 : 8, PNG_COLOR_TYPE_RGBA, PNG_INTERLACE_NONE,
                 PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    png_set_pHYs(writer, info, 11811, 11811, PNG_RESOLUTION_METER);  // 300 dpi
    png_write_info(writer, info);
    for (std::uint32_t y = 0; y < height; ++y) {
        std::vector<std::uint8_t> row;
        for (std::uint32_t i = 0; i < 4 * width; ++i) {
            row.push_back(rgba[4 * std::size_t{width} * y + i]);
            if (deep) row.push_back(row.back());
        }
        png_write_row(writer, row.data());
    }
    png_write_end(writer, nullptr);
    png_destroy_write_struct(&writer, &info);
    return out;
}

std::string four_colours() { return png(2, 2, {255, 0, 0, 255, 0, 255, 0, 255, 0, 0, 255, 255, 255, 255, 255, 255}); }

std::string zip(const Files& parts) {
    zip_error_t error;
    zip_error_init(&error);
    zip_source_t* target = zip_source_buffer_create(nullptr, 0, 0, &error);
    zip_source_keep(target);
    zip_t* archive = zip_open_from_source(target, ZIP_TRUNCATE, &error);
    if (!archive) throw std::runtime_error(zip_error_strerror(&error));
    for (const auto& [name, contents] : parts)
        zip_file_add(archive, name.c_str(), zip_source_buffer(archive, contents.data(), contents.size(), 0),
                     ZIP_FL_OVERWRITE);
    if (zip_close(archive) != 0) throw std::runtime_error(zip_strerror(archive));
    zip_stat_t about;
    zip_source_stat(target, &about);
    std::string out(about.size, '\0');
    zip_source_open(target);
    zip_source_read(target, out.data(), out.size());
    zip_source_close(target);
    zip_source_free(target);
    return out;
}

std::string threemf(const std::string& resources, const std::string& build, const Files& others,
                    const std::string& unit, const std::string& model_attributes) {
    Files parts{
        {"_rels/.rels",
         R"(<?xml version="1.0"?><Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships">)"
         R"(<Relationship Target="/3D/main.model" Id="r" Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/>)"
         "</Relationships>"},
        {"3D/main.model", fmt::format(R"(<?xml version="1.0" encoding="UTF-8"?><model unit="{}" {} )"
                                      R"(xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02" )"
                                      R"(xmlns:q="http://schemas.microsoft.com/3dmanufacturing/material/2015/02">)"
                                      "<resources>{}</resources><build>{}</build></model>",
                                      unit, model_attributes, resources, build)}};
    parts.insert(parts.end(), others.begin(), others.end());
    return zip(parts);
}

std::string threemf_tetrahedron(double size, const std::vector<std::string>& triangle_attributes) {
    const char* corners[] = {R"(v1="0" v2="2" v3="1")", R"(v1="0" v2="1" v3="3")", R"(v1="1" v2="2" v3="3")",
                             R"(v1="2" v2="0" v3="3")"};
    std::string text =
        fmt::format(R"(<mesh><vertices><vertex x="0" y="0" z="0"/><vertex x="{0}" y="0" z="0"/>)"
                    R"(<vertex x="0" y="{0}" z="0"/><vertex x="0" y="0" z="{0}"/></vertices><triangles>)",
                    size);
    for (int i = 0; i < 4; ++i)
        text += fmt::format("<triangle {} {}/>", corners[i],
                            std::size_t(i) < triangle_attributes.size() ? triangle_attributes[std::size_t(i)] : "");
    return text + "</triangles></mesh>";
}

std::string glb(const std::string& json, const std::string& binary) {
    const auto word = [](std::size_t value) {
        return raw(std::vector<std::uint32_t>{static_cast<std::uint32_t>(value)});
    };
    std::string text = json, data = binary;
    text.resize((text.size() + 3) / 4 * 4, ' ');
    data.resize((data.size() + 3) / 4 * 4, '\0');
    return "glTF" + word(2) + word(12 + 8 + text.size() + (data.empty() ? 0 : 8 + data.size())) + word(text.size()) +
           "JSON" + text + (data.empty() ? std::string() : word(data.size()) + std::string("BIN\0", 4) + data);
}

std::vector<Files> every_sample() {
    std::vector<Files> samples;
    samples.push_back(
        {{"a.obj",
          "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1 1 0 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n"
          "usemtl m\nf 1/1 2/2 3/3 4/4\nusemtl n\nf 1 2 5\nf -3/-3 -4/-4 -1/-1\n"},
         {"a.mtl", "newmtl m\nKd 0.5 0.5 0.5\nmap_Kd -o 0.5 0 t.png\nnewmtl n\nKd 1 0.5 0\n"},
         {"t.png", four_colours()}});
    samples.push_back(
        {{"a.ply",
          "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
          "property uchar red\nproperty uchar green\nproperty uchar blue\nelement face 1\n"
          "property list uchar int vertex_indices\nend_header\n0 0 0 255 0 0\n1 0 0 0 255 0\n0 1 0 0 0 128\n3 0 1 "
          "2\n"}});
    samples.push_back(
        {{"b.ply",
          "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float "
          "z\n"
          "element face 1\nproperty list uchar int vertex_indices\nend_header\n" +
              raw(std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0}) + "\x03" + raw(std::vector<std::int32_t>{0, 1, 2})}});
    samples.push_back({{"a.stl",
                        "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 "
                        "0\nendloop\nendfacet\nendsolid a\n"}});
    samples.push_back({{"b.stl", std::string(80, ' ') + raw(std::vector<std::uint32_t>{2}) +
                                     raw(std::vector<float>{0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0}) + "  " +
                                     raw(std::vector<float>{0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 1, 0}) + "  "}});
    const std::string positions = raw(std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0}),
                      uv = raw(std::vector<float>{0, 0, 1, 0, 0, 1});
    const std::string indices = raw(std::vector<std::uint16_t>{0, 1, 2, 0}), picture = four_colours();
    samples.push_back(
        {{"a.glb",
          glb(fmt::format(
                  R"({{"asset":{{"version":"2.0"}},"scene":0,"scenes":[{{"nodes":[0]}}],"nodes":[{{"mesh":0,"scale":[1,2,1]}}],)"
                  R"("meshes":[{{"primitives":[{{"attributes":{{"POSITION":0,"TEXCOORD_0":1}},"indices":2,"material":0}}]}}],)"
                  R"("materials":[{{"pbrMetallicRoughness":{{"baseColorTexture":{{"index":0}}}}}}],"textures":[{{"source":0}}],)"
                  R"("images":[{{"bufferView":3,"mimeType":"image/png"}}],"buffers":[{{"byteLength":{}}}],)"
                  R"("bufferViews":[{{"buffer":0,"byteLength":36}},{{"buffer":0,"byteOffset":36,"byteLength":24}},)"
                  R"({{"buffer":0,"byteOffset":60,"byteLength":8}},{{"buffer":0,"byteOffset":68,"byteLength":{}}}],)"
                  R"("accessors":[{{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}},)"
                  R"({{"bufferView":1,"componentType":5126,"count":3,"type":"VEC2"}},)"
                  R"({{"bufferView":2,"componentType":5123,"count":3,"type":"SCALAR"}}]}})",
                  68 + picture.size(), picture.size()),
              positions + uv + indices + picture)}});
    samples.push_back(
        {{"a.gltf", R"({"asset":{"version":"2.0"},"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],)"
                    R"("nodes":[{"mesh":0}],"buffers":[{"byteLength":36,"uri":"a%20b.bin"}],)"
                    R"("bufferViews":[{"buffer":0,"byteLength":36}],)"
                    R"("accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}]})"},
         {"a b.bin", positions}});
    samples.push_back(
        {{"a.3mf",
          threemf(R"(<q:texture2d id="1" path="/3D/t.png" contenttype="image/png"/><q:texture2dgroup id="2" texid="1">)"
                  R"(<q:tex2coord u="0" v="0"/><q:tex2coord u="1" v="0"/><q:tex2coord u="0" v="1"/></q:texture2dgroup>)"
                  R"(<q:colorgroup id="3"><q:color color="#FF0000"/><q:color color="#00FF0080"/></q:colorgroup>)"
                  R"(<object id="4" pid="3" pindex="0">)" +
                      threemf_tetrahedron(1, {R"(pid="2" p1="0" p2="1" p3="2")", R"(p1="1")"}) +
                      R"(</object><object id="5"><components><component objectid="4" )"
                      R"(transform="-1 0 0 0 1 0 0 0 1 5 0 0"/></components></object>)",
                  R"(<item objectid="4"/><item objectid="5"/>)", {{"3D/t.png", four_colours()}})}});
    samples.push_back(
        {{"a.wrl",
          "#VRML V2.0 utf8\nTransform { translation 0 0 1 scale 1 -1 1 children [ DEF s Shape { appearance Appearance "
          "{\n"
          "material Material { diffuseColor 1 0 0 } texture ImageTexture { url \"t.png\" } } geometry IndexedFaceSet "
          "{\n"
          "coord Coordinate { point [0 0 0, 1 0 0, 0 1 0] } coordIndex [0 1 2 -1] texCoord TextureCoordinate {\n"
          "point [0 0, 1 0, 0 1] } } }, Shape { geometry Cone { side FALSE } appearance Appearance { texture\n"
          "PixelTexture { image 1 2 3 0xFF0000 255 } } } USE s ] }\nPROTO P [ field SFNode n NULL ] { Group { } }\n"},
         {"t.png", picture}});
    const std::vector<FbxRecord> z_up{fbx_property("UpAxis", {2}), fbx_property("FrontAxis", {1}),
                                      fbx_property("FrontAxisSign", {-1})};
    const auto layer = [](const std::string& type, const std::string& values, std::size_t count) {
        return FbxRecord{type,
                         {fbx_number(std::int64_t{0})},
                         {{"MappingInformationType", {fbx_text("ByPolygonVertex")}},
                          {"ReferenceInformationType", {fbx_text("Direct")}},
                          {values, {fbx_reals(std::vector<double>(count, 0.25))}}}};
    };
    for (const std::uint32_t version : {7400u, 7700u})
        samples.push_back(
            {{"a.fbx",
              fbx_scene(
                  z_up,
                  {fbx_object("Geometry", 1, "g", "Mesh", {},
                              {{"Vertices", {fbx_reals({0, 0, 0, 1, 0, 0, 0, 1, 0}, true)}},
                               {"PolygonVertexIndex", {fbx_indices(std::vector<std::int32_t>{0, 1, ~2})}},
                               layer("LayerElementUV", "UV", 6),
                               layer("LayerElementColor", "Colors", 12)}),
                   fbx_object("Model", 2, "m", "Mesh", {fbx_property("Lcl Rotation", {0, 90, 30})}),
                   fbx_object("Material", 3, "p", "", {fbx_property("DiffuseColor", {1, 0.5, 0})}),
                   fbx_object("Texture", 4, "t", "", {fbx_property("Scaling", {2, 2, 1})}),
                   fbx_object("Video", 5, "v", "Clip", {}, {{"Content", {fbx_text(picture)}}})},
                  {fbx_link(1, 2), fbx_link(2, 0), fbx_link(3, 2), fbx_link(4, 3, "DiffuseColor"), fbx_link(5, 4)},
                  version)}});
    samples.push_back(
        {{"b.fbx",
          "; FBX 7.4.0 project file\nFBXHeaderExtension: {\n FBXVersion: 7400\n}\nObjects: {\n Geometry: 1, "
          "\"Geometry::g\", \"Mesh\" {\n  Vertices: *9 {\n   a: 0,0,0,1,0,0,0,1,0\n  }\n  PolygonVertexIndex: *3 {\n"
          "   a: 0,1,-3\n  }\n }\n Model: 2, \"Model::m\", \"Mesh\" {\n  Culling: \"off &quot;\"\n }\n}\n"
          "Connections: {\n C: \"OO\",2,0\n C: \"OO\",1,2\n}\n"}});
    return samples;
}

}  // namespace voxtone::test
