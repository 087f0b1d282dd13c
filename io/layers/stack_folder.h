// SPDX-License-Identifier: GPL-3.0-or-later
//
// The folder of a layer stack, OUT, in the hands of one job.
//
// A new stack is made in OUT/.voxtone-unfinished and put in place by renames when it is whole: until then an old whole
// stack stays what it was, also when the new job is killed, refused or out of disk. The order of the swap:
//   1. all is synced; the old manifest goes to OUT/.voxtone-old, then all else that is ours (OUT is no stack now);
//   2. .voxtone-unfinished becomes .voxtone-new: from here on there is a way forward only;
//   3. its files move to OUT, the manifest last (layers that were made elsewhere, `adopt`, move first); then
//      .voxtone-old goes, and .voxtone-new, empty, after it.
// Who takes the folder after a job that was killed in between (a few milliseconds) goes back from 1, or on from 3.
// What is not ours in OUT is never removed; what of it lies among the old layers goes to OUT/set-aside.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "io/printer/printer_folder.h"

namespace voxtone::io {

inline constexpr std::string_view manifest_name = "manifest.json";
inline constexpr std::string_view job_file_name = "job.json";
inline constexpr std::string_view vdb_name = "volume.vdb", vdb_numbers_name = "volume-int32.vdb";
inline constexpr std::string_view sheet_text_name = "resin-assignment.txt";
inline constexpr std::string_view sheet_page_name = "resin-assignment.html";

/// Where a stack is made, where a whole one waits to be put in place, and where the old one waits to go.
inline constexpr std::string_view unfinished_name = ".voxtone-unfinished", new_name = ".voxtone-new",
                                  old_name = ".voxtone-old";
/// Where strangers among an old stack's layers go.
inline constexpr std::string_view aside_name = "set-aside";
/// Of an interrupted job, to go on with; it is no stack and stays when one is swapped.
inline constexpr std::string_view checkpoint_name = "loop.checkpoint";
/// What the appearance loop came to, and what shards made: no stack either.
inline constexpr std::string_view skin_name = "skin.mixtures", shards_name = "shards";
/// What a tray keeps of its parts, a folder for each.
inline constexpr std::string_view parts_name = "parts";
/// Meshes that were given from a program, which its print keeps (python/voxtone/verbs.py): there before the stack is.
inline constexpr std::string_view models_name = "models";

/// Throws InputError where `out` holds a stack, or something else than what a job without end left and what shards and
/// the appearance loop keep there. Nothing there is free.
void expect_free_for_stack(const std::filesystem::path& out);

/// Throws InputError where a file would lie among the layers of a stack, which is a folder of ours, its manifest, or a
/// folder of bitmaps: a printer takes all that lies there.
void expect_apart_from_layers(const std::filesystem::path& stack, const std::vector<std::filesystem::path>& files);

class StackFolder {
public:
    /// Takes `out`: made if it is not there, locked, ends what a killed job began. An old stack stays untouched.
    /// `companions`: names in `out` of files that go with an old stack because they tell about it. Throws InputError
    /// where `out` is no folder, FileError where the system refuses and where `out` or what would be written in it is a
    /// link that leads elsewhere, TryAgain where another job holds it.
    explicit StackFolder(std::filesystem::path out, std::vector<std::string_view> companions = {});
    StackFolder(StackFolder&&) noexcept;
    /// Without `publish`: `out` is what it was before.
    ~StackFolder();

    [[nodiscard]] const std::filesystem::path& path() const;
    /// FolderLock::doubt of its lock.
    [[nodiscard]] const std::string& doubt() const;
    [[nodiscard]] bool holds_stack() const;
    /// For the user: which files among the old layers `publish` will set aside; empty: there are none.
    [[nodiscard]] std::string strangers_note() const;
    /// expect_free_for_stack of `out`.
    void expect_free() const;

    /// Makes the folder in which the new stack is made and returns it; once.
    [[nodiscard]] std::filesystem::path begin();
    /// The layers of the new stack lie in `out`/shards/NAME/layers (and NAME/resins) already: they stay there until
    /// `publish` moves them. NAME is of letters and digits. Throws FileError.
    void adopt(std::string_view name);
    /// Puts all that is in it in place. Throws FileError, TryAgain.
    void publish();

private:
    struct Held;
    std::unique_ptr<Held> held_;
};

}  // namespace voxtone::io
