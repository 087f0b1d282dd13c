// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/codecs/read_here.h"

#include "base/error.h"
#include "io/codecs/decode_device_profile.h"
#include "io/codecs/given_texture.h"
#include "io/codecs/model_archive.h"
#include "io/codecs/parse_3mf.h"
#include "io/codecs/parse_fbx.h"
#include "io/codecs/parse_gltf.h"
#include "io/codecs/parse_obj.h"
#include "io/codecs/parse_ply.h"
#include "io/codecs/parse_stl.h"
#include "io/codecs/parse_vrml.h"
#include "io/decoders/decode_codes.h"
#include "io/decoders/decode_image.h"
#include "io/files/file_reader.h"
#include "io/files/read_bytes.h"
#include "io/files/serve_isolated.h"
#include "io/files/zip_reader.h"
#include "io/models/finish_model.h"
#include "io/pictures/packed_image.h"

namespace voxtone::io {

namespace {

ModelParts parse_in(ParseContext& context, const std::filesystem::path& path) {
    const std::string extension = extension_of(path);
    return extension == "3mf"                          ? parse_3mf(context)
           : extension == "fbx"                        ? parse_fbx(context)
           : extension == "gltf" || extension == "glb" ? parse_gltf(context)
           : extension == "obj"                        ? parse_obj(context)
           : extension == "ply"                        ? parse_ply(context)
           : is_vrml_name(path)                        ? parse_vrml(context)
                                                       : parse_stl(context);
}

ModelParts parse_with_texture(ParseContext& context, const std::filesystem::path& path) {
    ModelParts parts = parse_in(context, path);
    const std::filesystem::path& texture = context.options().texture;
    if (!texture.empty()) lay_given_texture(parts, context, texture);
    return parts;
}

ModelParts parse_model(const std::filesystem::path& path, const ReadOptions& options, const ParseHelp& help) {
    const PathInZip place = path_in_zip(path);
    if (!place.is_zip) {
        ParseContext context(path, options, help);
        ModelParts parts = parse_with_texture(context, path);
        parts.side_files = context.side_files();
        return parts;
    }
    const ModelArchive archive(place.file, place.inner, options);
    const std::string name = place.file.filename().string() + "/" + archive.model().generic_string();
    ParseContext context(archive.model(), options, {.others = help.others}, archive, name);
    ModelParts parts = parse_with_texture(context, archive.model());
    parts.notes = archive.notes();
    return parts;
}

/// What the model names beside itself, whatever is wrong with it or missing. No picture is small enough to be decoded.
ModelParts names_beside(const std::filesystem::path& path, ReadOptions options, const ParseHelp& help) {
    options.max_pixels = 1;
    ModelParts names;
    if (path_in_zip(path).is_zip) return names;  // all came with it
    ParseContext context(path, options, help);
    try {
        (void)parse_in(context, path);
    } catch (const InputError&) {
        // Its job says what it is.
    }
    names.side_files = context.side_files();
    return names;
}

DecodedImage decode_picture(const std::filesystem::path& path, const ReadOptions& options, const OtherDecoder& others) {
    return decode_image(
        read_bytes(path, options.max_file_bytes), path.filename().string(),
        {.max_pixels = options.max_pixels, .turn_upright = true, .others = others, .drawing = options.drawing});
}

/// By the program that started this one.
DecodedImage decode_elsewhere(std::span<const std::byte> bytes, const std::string& format, const std::string& name,
                              const DecodeOptions& options) {
    ReadRequest request;
    request.kind = ReadKind::other_picture;
    request.path = name;
    request.max_pixels = options.max_pixels;
    request.format = format;
    request.use_profile = options.use_profile;
    request.turn_upright = options.turn_upright;
    request.drawing = options.drawing;
    request.bytes.assign(bytes.begin(), bytes.end());
    return unpack_image(ask_starter(pack(request)));
}

Packing codes_of(const ReadRequest& request) {
    if (request.samples.size() != 3) throw InputError("a picture whose codes are to be read has no size");
    LuminanceRaster picture{int(request.samples[0]), int(request.samples[1]), {}};
    for (const std::byte grey : request.bytes) picture.grey.push_back(std::to_integer<std::uint8_t>(grey));
    return packing(decode_codes(picture, int(request.samples[2])));
}

/// The answer is another start of this program, with the folder.
void ask_for_folder() {
    ReadRequest request;
    request.kind = ReadKind::folder;
    (void)ask_starter(pack(request));
}

}  // namespace

ModelFile read_model_here(const std::filesystem::path& path, const ReadOptions& options, const OtherDecoder& others) {
    return finish_model(parse_model(path, options, {.others = others}), path.filename().string(),
                        {options.fill_gutters, options.texture_filter, options.keep_alpha});
}

Picture read_picture_here(const std::filesystem::path& path, const ReadOptions& options, const OtherDecoder& others) {
    return finish_picture(decode_picture(path, options, others), path.filename().string(),
                          options.texture_filter == TextureFilter::nearest);
}

Packing answer(std::span<const std::byte> bytes) {
    const ReadRequest request = unpack_request(bytes);
    ReadOptions options;
    options.texture = request.texture;
    options.max_file_bytes = request.max_file_bytes;
    options.max_pixels = request.max_pixels;
    options.max_unpacked_bytes = request.max_unpacked_bytes;
    options.drawing = request.drawing;
    options.keep_alpha = request.keep_alpha;
    ParseHelp help{.others = decode_elsewhere};
    if (!request.sees_folder) help.ask_for_folder = ask_for_folder;
    switch (request.kind) {
        case ReadKind::model:
            return packing_of(parse_model(request.path, options, help));
        case ReadKind::side_files:
            return packing_of(names_beside(request.path, options, help));
        case ReadKind::picture:
            return packing_of(decode_picture(request.path, options, help.others));
        case ReadKind::device_profile:
            return packing_of(pack(decode_device_profile(read_bytes(request.path, request.max_file_bytes), request.path,
                                                         request.samples)));
        case ReadKind::codes:
            return codes_of(request);
        default:
            break;
    }
    throw InputError("what is to be read is of an unknown kind");
}

}  // namespace voxtone::io
