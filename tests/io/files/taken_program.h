// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a program would do that a file has taken over: attempts by name, for sandbox_test.cpp and the program that it
// asks (misbehaving_program.cpp).
#pragma once

#include <array>
#include <string>
#include <vector>

namespace voxtone::test {

/// Each is tried on a file or folder that is named behind a blank, and answered by "done" or "refused".
inline constexpr std::array attempts_on_files = {"write",  "append",    "create", "truncate", "remove",
                                                 "rename", "link",      "folder", "mode",     "owner",
                                                 "times",  "attribute", "mount",  "root",     "node"};
inline constexpr std::array attempts = {"connect",
                                        "listen",
                                        "local socket",
                                        "exec",
                                        "fork",
                                        "vfork",
                                        "thread",
                                        "trace",
                                        "kill",
                                        "code",
                                        "limits",
                                        "priority",
                                        "look in",
                                        "namespace",
                                        "keyring",
                                        "io ring",
                                        "events",
                                        "module",
                                        "new filter",
                                        "new call",
                                        "signal by descriptor",
                                        "owner of a descriptor",
                                        "signal at input"};
/// "read PATH" and "list PATH" are allowed on what the parent names.

/// The program that is asked for them, of this build.
std::string misbehaving_program();

/// "done", "refused (why)", or nothing where the wish is none of these.
std::string attempt(const std::string& wish);

}  // namespace voxtone::test
