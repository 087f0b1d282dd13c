// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/files/read_options.h"

#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fstream>
#include <new>
#include <stdexcept>
#include <string_view>

#include <catch2/catch.hpp>

#include "base/error.h"
#include "io/files/whole_file.h"
#include "io/models/model_reader.h"
#include "io/pictures/picture.h"
#include "io/pictures/picture_writer.h"
#include "io/pictures/texture.h"
#include "tests/io/files/temporary_folder.h"
#include "tests/outcomes.h"

using namespace voxtone;
using namespace voxtone::io;
using Catch::Contains;
namespace fs = std::filesystem;

namespace {

constexpr std::uint64_t mib = 1 << 20;

void write_square(const fs::path& file, std::uint32_t side_px) {
    Picture8 picture{side_px, side_px, 4, std::vector<std::uint8_t>(std::size_t{4} * side_px * side_px, 200)};
    write_whole_file(file, png_bytes(picture));
}

fs::path write_textured(const fs::path& folder, std::uint32_t side_px) {
    write_square(folder / "a.png", side_px);
    std::ofstream(folder / "a.mtl") << "newmtl m\nmap_Kd a.png\n";
    std::ofstream(folder / "a.obj") << "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nusemtl m\n"
                                       "f 1/1 2/2 3/3\n";
    return folder / "a.obj";
}

/// The exit code of what reading throws in a process whose address space is limited.
int read_with_address_space(const fs::path& model, std::uint64_t bytes) {
    const pid_t child = fork();
    if (child == 0) {
        const rlimit limit{bytes, bytes};
        int code = 0;
        try {
            setrlimit(RLIMIT_AS, &limit);
            (void)read_model(model);
        } catch (const Error& error) {
            code = static_cast<int>(error.exit_code());
        } catch (const std::bad_alloc&) {
            code = static_cast<int>(ExitCode::unfinished);  // as the program tells it (cli/program/outcome.cpp)
        } catch (const std::runtime_error& error) {         // TBB's thread that finds no room
            code = std::string_view(error.what()).starts_with("pthread_create") ? static_cast<int>(ExitCode::try_again)
                                                                                : 1;
        } catch (...) {
            code = 1;
        }
        _exit(code);
    }
    int status = 0;
    waitpid(child, &status, 0);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

}  // namespace

TEST_CASE("the largest texture fits what its reader may take", "[limits][slow]") {
    if (built_with_address_sanitizer()) return test::skip("a sanitizer's memory cannot be limited");
    const TemporaryFolder folder;
    ReadOptions options;
    CHECK(options.max_pixels == std::uint64_t{16384} * 16384);
    // The pixels once, a piece of them on its way out, and what a decoder needs besides: neither grows with them.
    write_square(folder.path() / "a.png", 4096);
    options.memory_bytes = (64 + 16 + 24) * mib;
    CHECK(read_picture(folder.path() / "a.png", options).width_px == 4096);
}

TEST_CASE("lack of memory is no fault of the file, and no loss of its colours", "[limits][slow]") {
    if (built_with_address_sanitizer()) return test::skip("a sanitizer's memory cannot be limited");
    const TemporaryFolder folder;
    const fs::path model = write_textured(folder.path(), 4096);
    SECTION("a limit that was given") {
        ReadOptions options;
        options.memory_bytes = 48 * mib;
        options.more = "--read-memory";
        CHECK_THROWS_AS(read_model(model, options), ResourceError);
        CHECK_THROWS_WITH(read_model(model, options), Contains("48 MiB") && Contains("--read-memory"));
    }
    SECTION("a limit of the machine, of which the reader has enough to start or not even that") {
        for (const std::uint64_t space : {60 * mib, 100 * mib}) {
            INFO(space / mib << " MiB");
            const int code = read_with_address_space(model, space);
            INFO("exit code " << code);
            // The reader ran out, or it did not and who asked it did.
            CHECK((code == static_cast<int>(ExitCode::try_again) || code == static_cast<int>(ExitCode::unfinished)));
        }
    }
    SECTION("enough") { CHECK(read_model(model).mesh.triangles.size() == 1); }
}

TEST_CASE("the reader is told that alpha is to be kept: by what of a picture light goes through, it alone can tell") {
    const TemporaryFolder folder;
    const std::vector<float> corners{0, 0, 0, 1, 0, 0, 0, 1, 0, /* uv */ 0, 0, 1, 0, 0, 1};
    std::ofstream(folder.path() / "a.bin", std::ios::binary)
        .write(reinterpret_cast<const char*>(corners.data()), std::streamsize(corners.size() * sizeof(float)));
    write_square(folder.path() / "through.png", 2);  // 200 of 255
    std::ofstream(folder.path() / "a.gltf")
        << R"({"asset":{"version":"2.0"},"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],"meshes":[{"primitives":[)"
           R"({"attributes":{"POSITION":0,"TEXCOORD_0":1},"material":0}]}],"buffers":[{"uri":"a.bin","byteLength":60}],)"
           R"("bufferViews":[{"buffer":0,"byteLength":36},{"buffer":0,"byteOffset":36,"byteLength":24}],)"
           R"("accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"},)"
           R"({"bufferView":1,"componentType":5126,"count":3,"type":"VEC2"}],)"
           R"("images":[{"uri":"through.png"}],"textures":[{"source":0}],"materials":[{"extensions":)"
           R"({"KHR_materials_transmission":{"transmissionFactor":1,"transmissionTexture":{"index":0}}}}]})";
    ReadOptions options;
    options.keep_alpha = true;
    const ModelFile clear = read_model(folder.path() / "a.gltf", options);
    CHECK(clear.has_colour);
    REQUIRE(clear.mesh.materials.at(0).alpha_texture);
    CHECK(clear.mesh.materials[0].alpha_texture->sample(0.5f, 0.5f).x() == Approx(1 - 200 / 255.0).margin(1e-3));
    CHECK_FALSE(read_model(folder.path() / "a.gltf").mesh.materials.at(0).alpha_texture);
}
