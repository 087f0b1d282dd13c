// SPDX-License-Identifier: GPL-3.0-or-later
//
// The door for prints that show something else than colours: what a job asks of them besides the Print itself. A floor
// above that has such prints registers how they are opened; a job that does not ask for one never comes here.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "base/progress.h"
#include "slicer/options/job_input.h"
#include "slicer/options/resolved_job.h"
#include "slicer/part/job_body.h"
#include "slicer/part/job_colour.h"
#include "slicer/part/phase.h"
#include "slicer/part/print.h"
#include "slicer/printer/printer.h"

namespace voxtone::slicer {

struct OpenedJob;

/// What a job is to show, once what its options name has been read.
class OtherPrint {
public:
    /// A phase before layers are made, and the seconds of a processor that it takes.
    struct Work {
        Phase phase;
        double cpu_s;
    };

    OtherPrint() = default;
    OtherPrint(const OtherPrint&) = delete;
    OtherPrint& operator=(const OtherPrint&) = delete;
    virtual ~OtherPrint() = default;

    /// The set of resins where none is named.
    [[nodiscard]] virtual std::string usual_resins(const PrinterProfile& printer) const = 0;
    /// Throws InputError: these resins cannot show it.
    virtual void check(const LoadedResins& resins) const = 0;
    /// Files that decide what is printed; the digests are empty.
    [[nodiscard]] virtual std::vector<JobInput> inputs() const = 0;
    [[nodiscard]] virtual std::vector<Work> work(const LoadedResins& resins) const = 0;
    /// "how light spreads".
    [[nodiscard]] virtual std::string what() const = 0;
    /// A sentence: why nobody knows its resins before it is made.
    [[nodiscard]] virtual std::string why_no_resins() const = 0;
    /// Why its layers cannot be made in parts.
    [[nodiscard]] virtual std::string why_whole() const = 0;
    /// Keeps references to the job and the body.
    [[nodiscard]] virtual std::unique_ptr<Print> make(const OpenedJob& job, const JobBody& body,
                                                      Progress& progress) const = 0;
};

/// Reads what the options name, and fills in what they leave to it. Throws UsageError, InputError, FileError.
using OpenOtherPrint = std::unique_ptr<const OtherPrint> (*)(ResolvedJob& job);

/// Before the first job is opened, by one thread.
void register_other_print(OpenOtherPrint open);

/// Nothing for a job that shows colours. Throws what the registered one throws.
[[nodiscard]] std::unique_ptr<const OtherPrint> open_other_print(ResolvedJob& job);

}  // namespace voxtone::slicer
