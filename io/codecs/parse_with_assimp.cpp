// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/io/codecs/parse_with_assimp.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <exception>
#include <new>
#include <optional>

#include <assimp/config.h>
#include <assimp/material.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <fmt/format.h>
#include <assimp/IOStream.hpp>
#include <assimp/IOSystem.hpp>
#include <assimp/Importer.hpp>

#include "voxtone/base/error.h"
#include "voxtone/io/codecs/ply_faces.h"
#include "voxtone/io/codecs/ply_header.h"

namespace voxtone::io {

namespace {

/// Whether the declared size of an STL file can be true, and whether its attribute words look like colour, which STL
/// has no standard for and which is not carried: those of VisCAM (bit 15 set wherever a word is not zero, more than one
/// word) or Magics ("COLOR=" in the header). Words that are all the same, such as 0x2020 (blanks), are no colour.
void check_stl(std::span<const std::byte> bytes, const std::string& name, std::vector<std::string>& lost_colours) {
    constexpr std::size_t header = 84, facet = 50;
    const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    std::uint32_t count = 0;
    if (bytes.size() >= header) std::memcpy(&count, bytes.data() + 80, 4);
    const bool fits = bytes.size() >= header && std::uint64_t{count} * facet + header <= bytes.size();
    const bool ascii =
        text.substr(0, 512).find("solid") != std::string_view::npos && text.find("facet") != std::string_view::npos;
    if (ascii && (!fits || count == 0)) return;
    if (!fits)
        throw InputError(fmt::format(
            "{} is no STL file, or it is cut short: it declares {} triangles, which need {} bytes, and has {}", name,
            count, std::uint64_t{count} * facet + header, bytes.size()));
    std::uint32_t coloured = 0, plain = 0, first = 0x10000;
    bool differ = false;
    for (std::uint32_t i = 0; i < count; ++i) {
        std::uint16_t word = 0;
        std::memcpy(&word, bytes.data() + header + i * facet + 48, 2);
        if (word == 0) continue;
        ++(word & 0x8000 ? coloured : plain);
        if (first == 0x10000) first = word;
        differ |= word != first;
    }
    const bool of_magics = text.substr(0, 80).find("COLOR=") != std::string_view::npos;
    if (of_magics || (coloured && !plain && (differ || coloured < count)))
        lost_colours.push_back(fmt::format(
            "{} seems to hold facet colours ({} style); STL has no standard for them and they are LOST. Export the "
            "model as 3MF, OBJ, PLY or GLB to keep its colours.",
            name, of_magics ? "Magics" : "VisCAM"));
}

class MemoryStream : public Assimp::IOStream {
public:
    explicit MemoryStream(std::span<const std::byte> bytes) : bytes_(bytes) {}

    std::size_t Read(void* buffer, std::size_t size, std::size_t count) override {
        if (size == 0) return 0;
        const std::size_t items = std::min(count, (bytes_.size() - at_) / size);
        if (items) std::memcpy(buffer, bytes_.data() + at_, items * size);
        at_ += items * size;
        return items;
    }
    std::size_t Write(const void*, std::size_t, std::size_t) override { return 0; }
    aiReturn Seek(std::size_t offset, aiOrigin origin) override {
        const std::size_t base = origin == aiOrigin_SET ? 0 : origin == aiOrigin_CUR ? at_ : bytes_.size();
        if (offset > bytes_.size() - base) return aiReturn_FAILURE;
        at_ = base + offset;
        return aiReturn_SUCCESS;
    }
    std::size_t Tell() const override { return at_; }
    std::size_t FileSize() const override { return bytes_.size(); }
    void Flush() override {}

private:
    std::span<const std::byte> bytes_;
    std::size_t at_ = 0;
};

/// All that assimp sees: the model under a made-up name.
class OneFile : public Assimp::IOSystem {
public:
    OneFile(const ParseContext& context, std::string model) : context_(context), model_(std::move(model)) {}

    bool Exists(const char* file) const override { return file == model_; }
    char getOsSeparator() const override { return '/'; }
    Assimp::IOStream* Open(const char* file, const char*) override {
        return file == model_ ? new MemoryStream(context_.bytes()) : nullptr;
    }
    void Close(Assimp::IOStream* stream) override { delete stream; }

private:
    const ParseContext& context_;
    std::string model_;
};

/// assimp makes words of all that it catches; for lack of memory the file is not to blame.
void rethrow_lack_of_memory(const Assimp::Importer& importer) {
    if (!importer.GetException()) return;
    try {
        std::rethrow_exception(importer.GetException());
    } catch (const std::bad_alloc&) {
        throw;
    } catch (...) {  // its words are told by the caller
    }
}

class AssimpParser {
public:
    AssimpParser(ParseContext& context, const std::string& extension) : context_(context), extension_(extension) {}

    ModelParts parse() {
        parts_.format = extension_ == "ply" ? "PLY" : "STL";
        if (extension_ == "ply") ply_ = read_ply_header(context_.bytes(), context_.name());
        if (ply_ && (ply_->face_colours || ply_->corner_coordinates))
            faces_ = read_ply_faces(context_.bytes(), *ply_, context_.name());
        if (ply_) expect_lists_to_fit(context_.bytes(), *ply_, context_.name());
        if (extension_ == "stl") check_stl(context_.bytes(), context_.name(), parts_.lost_colours);
        const std::string virtual_name = "voxtone model." + extension_;
        auto* files = new OneFile(context_, virtual_name);  // owned by the importer
        Assimp::Importer importer;
        importer.SetIOHandler(files);
        const aiScene* scene = importer.ReadFile(virtual_name, 0);
        rethrow_lack_of_memory(importer);
        if (!scene)
            throw InputError(
                fmt::format("{} is no valid {} file ({})", context_.name(), parts_.format, importer.GetErrorString()));
        const std::size_t expected = check(*scene);
        scene = importer.ApplyPostProcessing(aiProcess_Triangulate);
        rethrow_lack_of_memory(importer);
        if (!scene) throw InputError(fmt::format("the polygons of {} cannot be triangulated", context_.name()));
        make_materials(*scene);
        for (unsigned m = 0; m < scene->mNumMeshes; ++m) add_mesh(*scene->mMeshes[m]);
        if (scene->mNumMeshes == 1) lay_ply_faces();
        if (parts_.triangles.size() < expected)
            parts_.warnings.push_back(
                fmt::format("{} of the {} triangles of polygons in {} could not be made (corners on one line, or "
                            "crossing outlines).",
                            expected - parts_.triangles.size(), expected, context_.name()));
        if (points_and_lines_)
            parts_.warnings.push_back(fmt::format("{} has {} points or lines; they have no volume and are left aside.",
                                                  context_.name(), points_and_lines_));
        for (const std::string& warning : context_.side_file_warnings()) parts_.warnings.push_back(warning);
        return std::move(parts_);
    }

private:
    /// Indices in range (before anything follows them); returns how many triangles the polygons give.
    std::size_t check(const aiScene& scene) {
        std::size_t expected = 0;
        for (unsigned m = 0; m < scene.mNumMeshes; ++m) {
            aiMesh& mesh = *scene.mMeshes[m];
            bool polygons = false;
            for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
                const aiFace& face = mesh.mFaces[f];
                for (unsigned i = 0; i < face.mNumIndices; ++i)
                    if (face.mIndices[i] >= mesh.mNumVertices)
                        throw InputError(
                            fmt::format("a face of {} uses vertex {}, but there are only {}; the file is damaged",
                                        context_.name(), face.mIndices[i], mesh.mNumVertices));
                polygons |= face.mNumIndices > 3;
                if (face.mNumIndices >= 3)
                    expected += face.mNumIndices - 2;
                else
                    ++points_and_lines_;
            }
            // assimp takes a face without corners for a polygon, and then ends the program for want of one to cut;
            // it looks again where no kind is named at all.
            if (!polygons) mesh.mPrimitiveTypes = aiPrimitiveType_TRIANGLE;
        }
        return expected;
    }

    void make_materials(const aiScene& scene) {
        parts_.materials.resize(std::max(scene.mNumMaterials, 1u));
        if (ply_ && !ply_->texture_file.empty()) {
            parts_.has_colour = true;
            parts_.materials[0].image = context_.add_image_file(parts_, ply_->texture_file, context_.decode_options());
            for (PartMaterial& material : parts_.materials) material.image = parts_.materials[0].image;
        }
    }

    void add_mesh(const aiMesh& mesh) {
        const auto first = static_cast<std::uint32_t>(parts_.positions.size());
        for (unsigned v = 0; v < mesh.mNumVertices; ++v)
            parts_.positions.emplace_back(mesh.mVertices[v].x, mesh.mVertices[v].y, mesh.mVertices[v].z);
        const bool decode_colours = !ply_ || ply_->integer_colours;
        for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
            const aiFace& face = mesh.mFaces[f];
            if (face.mNumIndices != 3) continue;
            const unsigned* i = face.mIndices;
            const std::size_t t = parts_.add_triangle({first + i[0], first + i[1], first + i[2]}, mesh.mMaterialIndex);
            if (mesh.HasTextureCoords(0)) {
                std::array<Eigen::Vector2f, 3> uv;
                for (int c = 0; c < 3; ++c) {
                    const aiVector3D& coordinate = mesh.mTextureCoords[0][i[c]];
                    uv[c] = Eigen::Vector2f(coordinate.x, coordinate.y);
                }
                parts_.set_uv(t, uv);
            }
            if (mesh.HasVertexColors(0) && extension_ != "stl") {
                parts_.has_colour = true;
                std::array<Eigen::Vector4f, 3> rgba;
                for (int c = 0; c < 3; ++c) {
                    const aiColor4D& colour = mesh.mColors[0][i[c]];
                    Eigen::Vector3f rgb(colour.r, colour.g, colour.b);
                    if (decode_colours) rgb = srgb_to_linear(Eigen::Vector3f(rgb.cwiseMax(0).cwiseMin(1)));
                    rgba[c] = {rgb.x(), rgb.y(), rgb.z(), colour.a};
                }
                parts_.set_rgba(t, rgba);
            }
        }
    }

    /// Colours of faces count where they are all that tells places apart.
    bool face_colours_count() {
        if (faces_.rgba.empty()) return false;
        parts_.has_colour = true;
        const auto differ = [&](const auto& corners) { return corners != parts_.corner_rgba[0]; };
        const bool vertices_differ =
            std::any_of(parts_.corner_rgba.begin(), parts_.corner_rgba.end(), differ) ||
            (!parts_.corner_rgba.empty() && (parts_.corner_rgba[0][0] != parts_.corner_rgba[0][1] ||
                                             parts_.corner_rgba[0][0] != parts_.corner_rgba[0][2]));
        if (vertices_differ && faces_.has_several_colours())
            parts_.warnings.push_back(fmt::format(
                "{} has colours of vertices and of faces; those of the vertices are printed.", context_.name()));
        return !vertices_differ && (parts_.corner_rgba.empty() || faces_.has_several_colours());
    }

    /// Triangles come in the order of the faces that they were cut from, and have their corners.
    void lay_ply_faces() {
        const bool colours = face_colours_count();
        std::size_t face = 0;
        for (std::size_t t = 0; t < parts_.triangles.size(); ++t) {
            const std::array<std::uint32_t, 3>& corners = parts_.triangles[t];
            while (face < faces_.size() && !faces_.has_corners(face, corners)) ++face;
            if (face == faces_.size()) break;
            if (colours) parts_.set_rgba(t, {faces_.rgba[face], faces_.rgba[face], faces_.rgba[face]});
            if (!faces_.uv.empty())
                parts_.set_uv(t, {faces_.uv_at(face, corners[0]), faces_.uv_at(face, corners[1]),
                                  faces_.uv_at(face, corners[2])});
        }
        if (face == faces_.size() && faces_.size() > 0)
            parts_.lose_colour(fmt::format(
                "{} has faces that could not be matched with their colours or texture coordinates; from the first of "
                "them on these are LOST. Export it with colours per vertex, or as OBJ or GLB.",
                context_.name()));
    }

    ParseContext& context_;
    std::string extension_;
    ModelParts parts_;
    std::optional<PlyHeader> ply_;
    PlyFaces faces_;  // of a PLY file where they have more to say than assimp hands on
    std::size_t points_and_lines_ = 0;
};

}  // namespace

ModelParts parse_with_assimp(ParseContext& context, const std::string& extension) {
    return AssimpParser(context, extension).parse();
}

}  // namespace voxtone::io
