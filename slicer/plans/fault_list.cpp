// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/plans/fault_list.h"

namespace voxtone::slicer {

void FaultList::look(const std::function<void()>& work) {
    try {
        work();
    } catch (const Cancelled&) {
        throw;
    } catch (const TryAgain&) {
        throw;
    } catch (const Error& error) {
        if (faults_.empty()) exit_code_ = error.exit_code();
        faults_.emplace_back(error.what());
    }
}

void FaultList::expect_none(const std::string& head) const {
    if (faults_.empty()) return;
    if (faults_.size() == 1) throw Error(exit_code_, faults_.front());
    std::string text = head + ":";
    for (const std::string& fault : faults_) text += "\n  " + fault;
    throw Error(exit_code_, text);
}

}  // namespace voxtone::slicer
