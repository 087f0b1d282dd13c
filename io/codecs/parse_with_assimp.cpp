// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/io/codecs/parse_with_assimp.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <exception>
#include <map>
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
#include "voxtone/io/codecs/mtl_library.h"
#include "voxtone/io/codecs/ply_faces.h"
#include "voxtone/io/codecs/ply_header.h"
#include "voxtone/io/codecs/stl_header.h"

namespace voxtone::io {

namespace {

class MemoryStream : public Assimp::IOStream {
public:
    explicit MemoryStream(std::span<const std::byte> bytes) : bytes_(bytes) {}
    explicit MemoryStream(std::string text) : text_(std::move(text)), bytes_(std::as_bytes(std::span(text_))) {}

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
    std::string text_;
    std::span<const std::byte> bytes_;
    std::size_t at_ = 0;
};

/// All that assimp sees: the model under a made-up name, and for each material library one that only names the
/// materials.
class ModelFiles : public Assimp::IOSystem {
public:
    ModelFiles(ParseContext& context, ModelParts& parts, std::string model)
        : context_(context), parts_(parts), model_(std::move(model)) {}

    bool Exists(const char* file) const override { return file == model_; }
    char getOsSeparator() const override { return '/'; }
    Assimp::IOStream* Open(const char* file, const char*) override {
        if (file == model_) return new MemoryStream(context_.bytes());
        return open_library(file);
    }
    void Close(Assimp::IOStream* stream) override { delete stream; }

    std::map<std::string, MtlMaterial> materials;

private:
    Assimp::IOStream* open_library(const std::string& file) {
        // assimp tries MODEL.mtl when a library is missing; its made-up name leads nowhere.
        if (file.starts_with(model_.substr(0, model_.rfind('.')))) return nullptr;
        const auto bytes = context_.read_side_file(file);
        if (!bytes) {
            parts_.lose_texture(
                fmt::format("The material library '{}' that {} names was not found beside the model: its colours "
                            "and textures are LOST. Put the file into the model's folder.",
                            file, context_.name()));
            return nullptr;
        }
        std::string names;
        for (MtlMaterial& material : parse_mtl({reinterpret_cast<const char*>(bytes->data()), bytes->size()})) {
            names += "newmtl " + material.name + "\n";
            materials.emplace(material.name, std::move(material));
        }
        return new MemoryStream(std::move(names));
    }

    ParseContext& context_;
    ModelParts& parts_;
    std::string model_;
};

bool has_colour(const MtlMaterial& m) { return !m.map_kd.empty() || (m.kd && m.kd->minCoeff() < 0.9f); }
float spread(const Eigen::Vector3f& rgb) { return rgb.maxCoeff() - rgb.minCoeff(); }

/// How the texture coordinates of a material are moved: uv * scale + offset.
struct AssimpUv {
    Eigen::Vector2f scale = Eigen::Vector2f::Ones(), offset = Eigen::Vector2f::Zero();
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
        parts_.format = extension_ == "obj" ? "OBJ" : extension_ == "ply" ? "PLY" : "STL";
        if (extension_ == "ply") ply_ = read_ply_header(context_.bytes(), context_.name());
        if (ply_ && (ply_->face_colours || ply_->corner_coordinates))
            faces_ = read_ply_faces(context_.bytes(), *ply_, context_.name());
        if (ply_) expect_lists_to_fit(context_.bytes(), *ply_, context_.name());
        if (extension_ == "stl") check_stl(context_.bytes(), context_.name(), parts_.lost_colours);
        const std::string virtual_name = "voxtone model." + extension_;
        auto* files = new ModelFiles(context_, parts_, virtual_name);  // owned by the importer
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
        make_materials(*scene, files->materials);
        look_for_library(*scene, files->materials);
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

    void make_materials(const aiScene& scene, const std::map<std::string, MtlMaterial>& library) {
        parts_.materials.resize(std::max(scene.mNumMaterials, 1u));
        transforms_.resize(parts_.materials.size());
        for (unsigned m = 0; m < scene.mNumMaterials; ++m) {
            aiString name;
            scene.mMaterials[m]->Get(AI_MATKEY_NAME, name);
            parts_.materials[m].name = name.C_Str();
            if (const auto found = library.find(name.C_Str()); found != library.end()) use(found->second, m);
        }
        if (ply_ && !ply_->texture_file.empty()) {
            parts_.has_colour = true;
            parts_.materials[0].image = context_.add_image_file(parts_, ply_->texture_file, context_.decode_options());
            for (PartMaterial& material : parts_.materials) material.image = parts_.materials[0].image;
        }
    }

    /// A library of which nothing is used: its colours were meant for something.
    void look_for_library(const aiScene& scene, const std::map<std::string, MtlMaterial>& library) {
        for (unsigned m = 0; m < scene.mNumMeshes; ++m) {
            aiString name;
            scene.mMaterials[scene.mMeshes[m]->mMaterialIndex]->Get(AI_MATKEY_NAME, name);
            if (library.contains(name.C_Str())) return;
        }
        if (std::any_of(library.begin(), library.end(), [](const auto& m) { return has_colour(m.second); }))
            parts_.lose_colour(fmt::format(
                "{} uses none of the materials in its library: their colours are LOST. Look at the names behind usemtl "
                "and newmtl, or export it again.",
                context_.name()));
    }

    void use(const MtlMaterial& mtl, std::size_t m) {
        PartMaterial& material = parts_.materials[m];
        material.alpha = mtl.opacity;
        if (mtl.kd) parts_.has_colour = true;
        if (mtl.has_opacity_map)
            parts_.warnings.push_back(fmt::format(
                "The material '{}' has an opacity map; prints are opaque here, it is left aside.", mtl.name));
        if (!mtl.map_kd.empty()) {
            parts_.has_colour = true;
            material.image = context_.add_image_file(parts_, mtl.map_kd, context_.decode_options());
            material.wrap_u = material.wrap_v = mtl.map_clamp ? Wrap::decal : Wrap::repeat;
            transforms_[m] = {mtl.map_scale, mtl.map_offset};
        }
        if (!mtl.kd) return;
        if (material.image < 0)
            material.rgb = srgb_to_linear(*mtl.kd);
        else if (spread(*mtl.kd) > 0.01f)
            parts_.warnings.push_back(fmt::format(
                "The material '{}' has both a texture and a coloured Kd ({:.2f} {:.2f} {:.2f}); the texture "
                "is printed as it is, Kd is left aside.",
                mtl.name, mtl.kd->x(), mtl.kd->y(), mtl.kd->z()));
    }

    void add_mesh(const aiMesh& mesh) {
        const auto first = static_cast<std::uint32_t>(parts_.positions.size());
        for (unsigned v = 0; v < mesh.mNumVertices; ++v)
            parts_.positions.emplace_back(mesh.mVertices[v].x, mesh.mVertices[v].y, mesh.mVertices[v].z);
        const AssimpUv transform =
            mesh.mMaterialIndex < transforms_.size() ? transforms_[mesh.mMaterialIndex] : AssimpUv{};
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
                    uv[c] =
                        Eigen::Vector2f(coordinate.x, coordinate.y).cwiseProduct(transform.scale) + transform.offset;
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
    std::vector<AssimpUv> transforms_;
    std::size_t points_and_lines_ = 0;
};

}  // namespace

ModelParts parse_with_assimp(ParseContext& context, const std::string& extension) {
    return AssimpParser(context, extension).parse();
}

}  // namespace voxtone::io
