// SPDX-License-Identifier: GPL-3.0-or-later
//
// A ZIP archive as the folder of a model: of one, and what it names, as services and generators give them. Nothing is
// unpacked onto the disk. What systems add (__MACOSX, hidden files) is not looked at; an archive in the archive is
// opened where there is no model beside it, one level deep. Of one model in several formats that which carries colours
// best is taken.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "io/codecs/side_files.h"
#include "io/files/read_options.h"
#include "io/files/zip_reader.h"

namespace voxtone::io {

class ModelArchive final : public ModelFolder {
public:
    /// `inner`: the model that is meant; empty: the one that there is. Throws FileError, InputError: no model, several,
    /// a path that leads out of the archive, more than ReadOptions::max_unpacked_bytes of what is taken.
    ModelArchive(const std::filesystem::path& file, const std::string& inner, const ReadOptions& options);

    /// Its path in the archive.
    [[nodiscard]] const std::filesystem::path& model() const { return model_; }
    /// Which was taken, in whole sentences.
    [[nodiscard]] const std::vector<std::string>& notes() const { return notes_; }

    [[nodiscard]] bool exists(const std::filesystem::path& path) const override;
    [[nodiscard]] bool is_file(const std::filesystem::path& path) const override;
    [[nodiscard]] std::vector<std::filesystem::path> entries(const std::filesystem::path& folder) const override;
    [[nodiscard]] bool lies_below(const std::filesystem::path&, const std::filesystem::path&) const override {
        return true;
    }
    [[nodiscard]] std::vector<std::byte> read(const std::filesystem::path& file,
                                              std::uint64_t max_bytes) const override;
    [[nodiscard]] std::vector<std::filesystem::path> all_files() const override { return files_; }

private:
    struct Part {
        std::size_t archive = 0, index = 0;
    };

    void add_parts(const std::string& below);
    void open_inner_archive(const std::string& inner);
    [[nodiscard]] std::vector<std::string> models() const;
    [[nodiscard]] std::vector<std::string> ending_as(std::string_view extension) const;
    void choose(const std::string& inner);
    [[nodiscard]] std::string meant_by(const std::string& inner, const std::vector<std::string>& all) const;
    [[nodiscard]] std::string best_format(const std::vector<std::string>& all) const;
    [[noreturn]] void refuse_without_model() const;

    std::string name_;
    std::uint64_t most_bytes_;
    mutable std::uint64_t left_bytes_;
    std::vector<std::vector<std::byte>> inner_bytes_;
    std::vector<std::unique_ptr<ZipReader>> archives_;
    std::map<std::string, Part> parts_;  ///< by path, with slashes, from the root
    std::vector<std::filesystem::path> files_;
    std::filesystem::path model_;
    std::vector<std::string> notes_;
};

}  // namespace voxtone::io
