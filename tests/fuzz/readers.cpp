// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/fuzz/readers.h"

#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <new>
#include <stdexcept>

#include "base/error.h"
#include "calibration/patches/patch_file.h"
#include "io/codecs/draco_mesh.h"
#include "io/codecs/meshopt_stream.h"
#include "io/codecs/read_here.h"
#include "io/decoders/decode_image.h"
#include "io/drawings/draw_svg.h"
#include "io/layers/stack_service.h"
#include "io/models/model_parts.h"
#include "io/models/mtl_library.h"
#include "io/openimageio/decode_other.h"
#include "io/pictures/packed_image.h"
#include "io/profiles/layer_sequence_file.h"
#include "io/profiles/profile_file.h"
#include "io/profiles/resin_file.h"
#include "slicer/options/job_file.h"
#include "slicer/part/loop_checkpoint.h"

namespace voxtone::test {

namespace {

namespace fs = std::filesystem;

/// A folder in memory where there is one, for readers that want a path.
class Folder {
public:
    Folder() {
        const fs::path memory = "/dev/shm";
        std::string name =
            ((fs::is_directory(memory) ? memory : fs::temp_directory_path()) / "voxtone-XXXXXX").string();
        if (!mkdtemp(name.data())) throw std::runtime_error("no folder for files to read can be made");
        path_ = name;
    }
    Folder(const Folder&) = delete;
    Folder& operator=(const Folder&) = delete;
    ~Folder() {
        std::error_code ignored;
        fs::remove_all(path_, ignored);
    }
    [[nodiscard]] fs::path put(const std::string& name, Bytes bytes) const {
        const fs::path file = path_ / name;
        const std::unique_ptr<std::FILE, int (*)(std::FILE*)> out(std::fopen(file.c_str(), "wb"), &std::fclose);
        if (!out || std::fwrite(bytes.data(), 1, bytes.size(), out.get()) != bytes.size())
            throw std::runtime_error("a file to read cannot be made");
        return file;
    }
    [[nodiscard]] const fs::path& path() const { return path_; }

private:
    fs::path path_;
};

const Folder& folder() {
    static const Folder made;
    return made;
}

std::string_view text_of(Bytes file) { return {reinterpret_cast<const char*>(file.data()), file.size()}; }

constexpr std::uint64_t few_pixels = 1 << 16;  // sizes are limited by a number; a small one keeps runs short

io::ReadOptions small_limits() {
    io::ReadOptions options;
    options.max_pixels = few_pixels;
    options.max_unpacked_bytes = options.max_file_bytes = std::uint64_t{16} << 20;
    return options;
}

void read_model_named(const char* name, Bytes file) {
    (void)io::read_model_here(folder().put(name, file), small_limits());
}

const std::vector<io::Rgb>& some_palette() {
    static const std::vector<io::Rgb> palette = {{0, 0, 0}, {220, 222, 216}, {0, 90, 158}, {166, 33, 98}};
    return palette;
}

void look_into_stack(const fs::path& path) {
    const io::StackFiles stack(path);
    for (std::uint32_t k = 0; k < std::min<std::size_t>(stack.listing().names.size(), 4); ++k)
        (void)io::scan_layer(stack.bytes(k), "layer", some_palette());
}

/// A folder of one foreign layer, or one of ours whose manifest is given.
void read_stack_with(const char* name, Bytes file) {
    static const Folder stack;
    (void)stack.put(name, file);
    look_into_stack(stack.path());
}

void read_checkpoint(Bytes file) {
    static const std::vector<Eigen::Vector3f> target(7, Eigen::Vector3f::Constant(0.5f));
    (void)folder().put("loop.checkpoint", file);
    Progress progress;
    (void)slicer::LoopCheckpoint(folder().path(), "a job", "its loop", target).read(progress);
}

void read_job(Bytes file) {
    slicer::SliceOptions options;
    slicer::read_job(folder().put("job.json", file).string(), options);
}

/// Of any connectivity, with the attributes that most streams have.
void read_draco(Bytes file) {
    static constexpr io::DracoAttribute attributes[] = {{0, 5126}, {1, 5123}};
    constexpr std::uint64_t most_bytes = std::uint64_t{4} << 20;
    (void)io::decode_draco(std::as_bytes(file), attributes, most_bytes);
}

/// The first byte says how it is coded, the second how many elements there are.
void read_meshopt(Bytes file) {
    static constexpr const char* modes[] = {"ATTRIBUTES", "TRIANGLES", "INDICES"};
    static constexpr const char* filters[] = {"NONE", "OCTAHEDRAL", "QUATERNION", "EXPONENTIAL"};
    if (file.size() < 2) return;
    constexpr std::uint64_t most_bytes = std::uint64_t{4} << 20;
    (void)io::decode_meshopt({std::as_bytes(file.subspan(2)), file[1] * 3, 1 << (file[0] >> 5), modes[file[0] % 4 % 3],
                              filters[file[0] / 4 % 4]},
                             most_bytes);
}

constexpr Reader readers[] = {
    {"obj", [](Bytes f) { read_model_named("a.obj", f); }},
    {"mtl", [](Bytes f) { (void)io::parse_mtl(text_of(f)); }},
    {"ply", [](Bytes f) { read_model_named("a.ply", f); }},
    {"stl", [](Bytes f) { read_model_named("a.stl", f); }},
    {"gltf", [](Bytes f) { read_model_named("a.gltf", f); }},
    {"glb", [](Bytes f) { read_model_named("a.glb", f); }},
    {"3mf", [](Bytes f) { read_model_named("a.3mf", f); }},
    {"fbx", [](Bytes f) { read_model_named("a.fbx", f); }},
    {"vrml", [](Bytes f) { read_model_named("a.wrl", f); }},
    {"zip", [](Bytes f) { read_model_named("a.zip", f); }},
    {"draco", read_draco},
    {"meshopt", read_meshopt},
    {"picture",
     [](Bytes f) {
         (void)io::decode_image(std::as_bytes(f), "a",
                                {.max_pixels = few_pixels, .turn_upright = true, .others = io::decode_other});
     }},
    {"svg",
     [](Bytes f) {
         (void)io::draw_svg(std::as_bytes(f), "a",
                            {.max_pixels = few_pixels, .drawing = {.pitch_mm = 0.1, .width_mm = 6}});
     }},
    {"layer", [](Bytes f) { (void)io::scan_layer(f, "a.png", some_palette()); }},
    {"png-stack", [](Bytes f) { read_stack_with("slice_00000.png", f); }},
    {"gcvf", [](Bytes f) { look_into_stack(folder().put("a.gcvf", f)); }},
    {"gcvf-config", [](Bytes f) { (void)io::parse_gcvf_config(text_of(f), "a"); }},
    {"manifest", [](Bytes f) { (void)io::parse_manifest(text_of(f), "a"); }},
    {"job", [](Bytes f) { read_job(f); }},
    {"resins", [](Bytes f) { (void)io::parse_resin_set(text_of(f), "a"); }},
    {"patches", [](Bytes f) { (void)calibration::parse_patches(text_of(f), "a"); }},
    {"profile", [](Bytes f) { (void)io::parse_profile(text_of(f), "a"); }},
    {"sequence", [](Bytes f) { (void)io::parse_layer_sequence(text_of(f), "a"); }},
    {"checkpoint", [](Bytes f) { read_checkpoint(f); }},
    // what a taken reader could send
    {"packed-model", [](Bytes f) { (void)io::unpack_model(std::as_bytes(f)); }},
    {"packed-picture", [](Bytes f) { (void)io::unpack_image(std::as_bytes(f)); }},
    {"packed-listing", [](Bytes f) { (void)io::unpack_listing(std::as_bytes(f)); }},
    {"packed-layer", [](Bytes f) { (void)io::unpack_inspection(std::as_bytes(f), 4); }},
};

}  // namespace

std::span<const Reader> all_readers() { return readers; }

void read_or_refuse(const Reader& reader, Bytes file) {
    try {
        reader.read(file);
    } catch (const Error&) {
    } catch (const std::bad_alloc&) {
    }
}

}  // namespace voxtone::test
