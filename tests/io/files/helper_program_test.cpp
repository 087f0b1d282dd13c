// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/io/files/helper_program.h"

#include <cstdlib>
#include <fstream>
#include <optional>

#include <catch2/catch.hpp>

#include "tests/io/files/temporary_folder.h"
#include "voxtone/base/error.h"
#include "voxtone/io/files/file_reader.h"
#include "voxtone/io/files/packed_values.h"
#include "voxtone/io/models/model_reader.h"

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
    std::ofstream(folder.path() / "voxtone-read") << "cannot be run";
    CHECK_THROWS_AS(find_helper("voxtone-read"), FileError);
    write_program(folder.path() / "voxtone-read", "#!/bin/sh\n");
    CHECK(find_helper("voxtone-read") == folder.path() / "voxtone-read");
}

TEST_CASE("a program that only links the library finds the helpers, too") {
    const HelpersIn helpers(nullptr);
    CHECK(fs::is_regular_file(find_helper("voxtone-read")));
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

TEST_CASE("requests come through as they were made, from the same version only") {
    const ReadRequest asked{ReadKind::picture, "a/b c.png", 1, 2, 3, "t.png"};
    const ReadRequest heard = unpack_request(pack(asked));
    CHECK(heard.kind == asked.kind);
    CHECK(heard.path == asked.path);
    CHECK(heard.max_file_bytes == 1);
    CHECK(heard.max_pixels == 2);
    CHECK(heard.max_unpacked_bytes == 3);
    CHECK(heard.texture == "t.png");
    CHECK_THROWS_WITH(unpack_request(packed(std::string("voxtone-read 0"))), Contains("another version"));
    const std::vector<std::byte> whole = pack(asked);
    for (std::size_t size = 0; size < whole.size(); ++size)
        CHECK_THROWS_AS(unpack_request(std::span(whole).first(size)), Error);
}
