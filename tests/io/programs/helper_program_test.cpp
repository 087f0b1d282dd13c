// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/programs/helper_program.h"

#include <cstdlib>
#include <fstream>
#include <optional>

#include <catch2/catch.hpp>

#include "base/error.h"
#include "io/files/file_reader.h"
#include "io/files/packed_values.h"
#include "io/files/whole_file.h"
#include "io/models/model_reader.h"
#include "io/pictures/picture_writer.h"
#include "tests/io/files/temporary_folder.h"

using namespace voxtone;
using namespace voxtone::io;
using Catch::Contains;
namespace fs = std::filesystem;

namespace {

/// The environment variable for a while.
class HelpersIn {
public:
    explicit HelpersIn(const char* folder) {
        if (const char* old = std::getenv(helpers_variable)) old_ = old;
        if (folder)
            setenv(helpers_variable, folder, 1);
        else
            unsetenv(helpers_variable);
    }
    HelpersIn(const HelpersIn&) = delete;
    HelpersIn& operator=(const HelpersIn&) = delete;
    ~HelpersIn() {
        if (old_)
            setenv(helpers_variable, old_->c_str(), 1);
        else
            unsetenv(helpers_variable);
    }

private:
    std::optional<std::string> old_;
};

void write_program(const fs::path& file, const std::string& text) {
    std::ofstream(file) << text;
    fs::permissions(file, fs::perms::owner_all);
}

}  // namespace

TEST_CASE("helper programs are found where the variable says, and nowhere else") {
    const TemporaryFolder folder;
    const HelpersIn helpers(folder.path().c_str());
    CHECK_THROWS_AS(find_helper("voxtone-read"), FileError);
    CHECK_THROWS_WITH(find_helper("voxtone-read"), Contains("voxtone-read") && Contains(folder.path().string()) &&
                                                       Contains("install voxtone again"));
    CHECK_THROWS_WITH(find_helper("voxtone-calibrate"),
                      Contains("install the package voxtone-calibrate") && Contains("install-packages calibration"));
    std::ofstream(folder.path() / "voxtone-read") << "cannot be run";
    CHECK_THROWS_AS(find_helper("voxtone-read"), FileError);
    write_program(folder.path() / "voxtone-read", "#!/bin/sh\n");
    CHECK(find_helper("voxtone-read") == folder.path() / "voxtone-read");
}

TEST_CASE("without the variable nothing is run from the folder that this was built in") {
    const std::string built = std::getenv(helpers_variable);
    REQUIRE(fs::is_regular_file(fs::path(built) / "voxtone-read"));
    const HelpersIn helpers(nullptr);
    const std::string found = [] {
        try {
            return find_helper("voxtone-read").string();  // of one that is installed
        } catch (const FileError& error) {
            return std::string(error.what());
        }
    }();
    CHECK_THAT(found, Contains("libexec/voxtone") && !Contains(built));
}

TEST_CASE("a reader that is missing, silent, or of another kind is told") {
    const TemporaryFolder folder;
    const fs::path model = folder.path() / "a.stl";
    std::ofstream(model) << "solid a\nendsolid a\n";
    const HelpersIn helpers(folder.path().c_str());
    CHECK_THROWS_AS(read_model(model), FileError);
    write_program(folder.path() / "voxtone-read", "#!/bin/sh\nexit 0\n");
    CHECK_THROWS_WITH(read_model(model), Contains("a.stl") && Contains("crash"));
    write_program(folder.path() / "voxtone-read", "#!/bin/sh\nkill -9 $$\n");
    CHECK_THROWS_AS(read_model(model), TryAgain);
    write_program(folder.path() / "voxtone-read", "#!/bin/sh\nkill -SEGV $$\n");
    CHECK_THROWS_WITH(read_model(model), Contains("signal 11"));
    write_program(folder.path() / "voxtone-read",
                  "#!/bin/sh\nprintf '\\001\\000\\000nonsense' >&4\nprintf x >&5\nexec sleep 1\n");
    CHECK_THROWS_AS(read_model(model), InputError);
    CHECK_THROWS_WITH(read_model(model), Contains("what the reader left"));
}

TEST_CASE("the reader of other pictures is started when one comes, and what becomes of it costs a texture") {
    const fs::path built = find_helper("voxtone-read");
    const TemporaryFolder folder, helpers_folder;
    const fs::path model = folder.path() / "a.obj";
    std::ofstream(model)
        << "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nusemtl m\nf 1/1 2/2 3/3\n";
    std::ofstream(folder.path() / "a.mtl") << "newmtl m\nmap_Kd a.tif\n";
    std::ofstream(folder.path() / "a.tif") << "II*" << '\0' << "and more";
    const HelpersIn helpers(helpers_folder.path().c_str());
    fs::create_symlink(built, helpers_folder.path() / "voxtone-read");
    const auto warnings = [&] {
        std::string all;
        for (const std::string& warning : read_model(model).warnings) all += warning + "\n";
        return all;
    };
    CHECK_THAT(warnings(), Contains("voxtone-read-pictures") && Contains("not installed") && Contains("LOST"));
    const fs::path pictures = helpers_folder.path() / "voxtone-read-pictures";
    write_program(pictures, "#!/bin/sh\nkill -SEGV $$\n");
    CHECK_THAT(warnings(), Contains("crash") && Contains("LOST"));
    write_program(pictures, "#!/bin/sh\nkill -9 $$\n");  // the machine's fault: colours are not lost for that
    CHECK_THROWS_AS(read_model(model), TryAgain);
    fs::remove(pictures);
    fs::create_symlink(built.parent_path() / "voxtone-read-pictures", pictures);
    CHECK_THAT(warnings(), Contains("a.tif cannot be read") || Contains("'a.tif' cannot be read"));
}

TEST_CASE("files beside a model are read where it names them, but for those that begin with a dot") {
    const TemporaryFolder folder;
    const Picture8 red{1, 1, 3, {200, 40, 40}};
    for (const char* name : {"a.png", ".hidden.png"}) write_whole_file(folder.path() / name, png_bytes(red));
    const auto read_with = [&](const std::string& texture) {
        const fs::path model = folder.path() / "a.ply";
        std::ofstream(model) << "ply\nformat ascii 1.0\ncomment TextureFile " << texture
                             << "\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nproperty "
                                "float s\nproperty float t\nelement face 1\nproperty list uchar int "
                                "vertex_indices\nend_header\n0 0 0 0 0\n1 0 0 1 0\n0 1 0 0 1\n3 0 1 2\n";
        return read_model(model);
    };
    const ModelFile textured = read_with("a.png");
    CHECK(textured.warnings.empty());
    CHECK(textured.mesh.materials.at(textured.mesh.material_of_triangle.at(0)).texture != nullptr);
    const ModelFile plain = read_with(".hidden.png");
    REQUIRE_FALSE(plain.warnings.empty());
    CHECK_THAT(plain.warnings[0], Contains(".hidden.png") && Contains("not found"));
}

TEST_CASE("requests come through as they were made, from the same version only") {
    const ReadRequest asked{ReadKind::picture, "a/b c.png", 1, 2, 3, "t.png", {}, false, true, "tiff", false, true, {},
                            {std::byte{9}}};
    const ReadRequest heard = unpack_request(pack(asked));
    CHECK(heard.kind == asked.kind);
    CHECK(heard.path == asked.path);
    CHECK(heard.max_file_bytes == 1);
    CHECK(heard.max_pixels == 2);
    CHECK(heard.max_unpacked_bytes == 3);
    CHECK(heard.texture == "t.png");
    CHECK_FALSE(heard.sees_folder);
    CHECK(heard.keep_alpha);
    CHECK(heard.format == "tiff");
    CHECK_FALSE(heard.use_profile);
    CHECK(heard.turn_upright);
    CHECK(heard.bytes == asked.bytes);
    CHECK_THROWS_WITH(unpack_request(packed(std::string("voxtone-read 0"))), Contains("another version"));
    const std::vector<std::byte> whole = pack(asked);
    for (std::size_t size = 0; size < whole.size(); ++size)
        CHECK_THROWS_AS(unpack_request(std::span(whole).first(size)), Error);
}
