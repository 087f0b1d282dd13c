// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/machine_memory.h"

#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <limits>

#include <catch2/catch.hpp>

#include "base/control_group.h"
#include "tests/outcomes.h"

using namespace voxtone;
namespace fs = std::filesystem;

namespace {

struct Groups {
    fs::path folder;
    Groups() {
        std::string name = (fs::temp_directory_path() / "voxtone-cgroup-").string().append(6, 'X');
        REQUIRE(mkdtemp(name.data()));
        folder = name;
    }
    Groups(const Groups&) = delete;
    Groups& operator=(const Groups&) = delete;
    ~Groups() { fs::remove_all(folder); }
    void write(const fs::path& file, const std::string& text) const {
        fs::create_directories((folder / file).parent_path());
        std::ofstream(folder / file) << text << '\n';
    }
    [[nodiscard]] std::uint64_t memory() const { return cgroup_memory_bytes(folder / "self", folder / "mount"); }
    [[nodiscard]] double cores() const { return cgroup_cores(folder / "self", folder / "mount"); }
};

}  // namespace

TEST_CASE("the memory of control groups", "[memory]") {
    const Groups groups;
    constexpr std::uint64_t none = std::numeric_limits<std::uint64_t>::max();
    SECTION("version 2: the least of a group and those above it") {
        groups.write("self", "0::/jobs/one/step");
        CHECK(groups.memory() == none);
        groups.write("mount/jobs/one/step/memory.max", "max");
        CHECK(groups.memory() == none);
        groups.write("mount/jobs/memory.max", "3000000000");
        CHECK(groups.memory() == 3000000000);
        groups.write("mount/jobs/one/memory.max", "2000000000");
        CHECK(groups.memory() == 2000000000);
        groups.write("mount/other/memory.max", "5");
        CHECK(groups.memory() == 2000000000);
    }
    SECTION("version 2: above memory.high a process is not killed but slowed down") {
        groups.write("self", "0::/user/one");
        groups.write("mount/user/memory.max", "3000000000");
        groups.write("mount/user/memory.high", "max");
        CHECK(groups.memory() == 3000000000);
        groups.write("mount/user/memory.high", "2000000000");
        CHECK(groups.memory() == 2000000000);
        groups.write("mount/user/one/memory.high", "0");  // all that can be is to be given back: no limit
        CHECK(groups.memory() == 2000000000);
    }
    SECTION("version 2 in a container, where the mount is the group") {
        groups.write("self", "0::/");
        groups.write("mount/memory.max", "1000000000");
        CHECK(groups.memory() == 1000000000);
    }
    SECTION("version 1 among other controllers") {
        groups.write("self", "9:name=systemd:/\n5:cpu,cpuacct:/a\n4:memory:/jobs/7\n0::/");
        groups.write("mount/memory/jobs/7/memory.limit_in_bytes", "9223372036854771712");
        groups.write("mount/memory/jobs/memory.limit_in_bytes", "4000000000");
        CHECK(groups.memory() == 4000000000);
    }
    SECTION("groups are named from their first letter to their last, beside lines that name none") {
        groups.write("self", "no group\n3:cpu:\n4:memory:/jobs/7/x");
        groups.write("mount/memory/jobs/7/x/memory.limit_in_bytes", "5000000000");
        CHECK(groups.memory() == 5000000000);
        groups.write("self", "4:memory:a");
        groups.write("mount/memory/a/memory.limit_in_bytes", "6000000000");
        CHECK(groups.memory() == 6000000000);
        groups.write("self", "4:memories:/a");
        CHECK(groups.memory() == std::numeric_limits<std::uint64_t>::max());
    }
}

TEST_CASE("the processors of control groups", "[memory]") {
    const Groups groups;
    constexpr double none = std::numeric_limits<double>::infinity();
    SECTION("version 2: the least of a group and those above it") {
        groups.write("self", "0::/jobs/one");
        CHECK(groups.cores() == none);
        groups.write("mount/jobs/one/cpu.max", "max 100000");
        CHECK(groups.cores() == none);
        groups.write("mount/jobs/cpu.max", "250000 100000");
        CHECK(groups.cores() == 2.5);
        groups.write("mount/cpu.max", "50000 100000");
        CHECK(groups.cores() == 0.5);
    }
    SECTION("version 1 among other controllers") {
        groups.write("self", "4:memory:/a\n5:cpu,cpuacct:/jobs/7");
        groups.write("mount/cpu/jobs/7/cpu.cfs_quota_us", "-1");
        groups.write("mount/cpu/jobs/7/cpu.cfs_period_us", "100000");
        CHECK(groups.cores() == none);
        groups.write("mount/cpu/jobs/cpu.cfs_quota_us", "400000");
        groups.write("mount/cpu/jobs/cpu.cfs_period_us", "100000");
        CHECK(groups.cores() == 4);
    }
}

TEST_CASE("what Slurm says that its job was given is a limit of memory", "[memory]") {
    const auto with = [](const char* per_node, const char* per_core, const char* cores) {
        const auto set = [](const char* name, const char* value) { value ? setenv(name, value, 1) : unsetenv(name); };
        set("SLURM_MEM_PER_NODE", per_node);
        set("SLURM_MEM_PER_CPU", per_core);
        set("SLURM_CPUS_ON_NODE", cores);
        const std::uint64_t scheduler = granted_memory_bytes(), all = resident_memory_bytes();
        for (const char* name : {"SLURM_MEM_PER_NODE", "SLURM_MEM_PER_CPU", "SLURM_CPUS_ON_NODE"}) unsetenv(name);
        CHECK(all <= scheduler);
        return scheduler;
    };
    constexpr std::uint64_t none = std::numeric_limits<std::uint64_t>::max(), mib = 1 << 20;
    CHECK(with(nullptr, nullptr, nullptr) == none);
    CHECK(with("64", nullptr, nullptr) == 64 * mib);
    CHECK(with(nullptr, "32", "3") == 96 * mib);
    CHECK(with(nullptr, "32", nullptr) == 32 * mib);
    CHECK(with("0", nullptr, "2") == none);
    CHECK(with("much", nullptr, nullptr) == none);
    CHECK(with("18446744073709551615", nullptr, nullptr) == none);
    CHECK(with("17592186044415", nullptr, nullptr) == 17592186044415 * mib);  // the most that fits
    CHECK(with("17592186044416", nullptr, nullptr) == none);
    CHECK(with(nullptr, "268435455", "65536") == mib * 268435455 * 65536);  // that many of the most cores
    CHECK(with(nullptr, "268435455", "99999999") == mib * 268435455 * 65536);
    CHECK(with(nullptr, "268435456", "1") == none);
    CHECK(with("7", "32", "3") == 7 * mib);  // of the node before those of its cores
    CHECK(with("64 ", nullptr, nullptr) == none);
    CHECK(with("-1", nullptr, nullptr) == none);
}

TEST_CASE("cores are those that Slurm gives a task, else a node's, and no more than are seen", "[memory]") {
    const auto with = [](const char* per_task, const char* on_node, std::size_t seen) {
        per_task ? setenv("SLURM_CPUS_PER_TASK", per_task, 1) : unsetenv("SLURM_CPUS_PER_TASK");
        on_node ? setenv("SLURM_CPUS_ON_NODE", on_node, 1) : unsetenv("SLURM_CPUS_ON_NODE");
        const std::size_t cores = granted_cores(seen);
        for (const char* name : {"SLURM_CPUS_PER_TASK", "SLURM_CPUS_ON_NODE"}) unsetenv(name);
        return cores;
    };
    CHECK(with(nullptr, nullptr, 8) == 8);
    CHECK(with("3", nullptr, 8) == 3);
    CHECK(with("3", "6", 8) == 3);
    CHECK(with(nullptr, "6", 8) == 6);
    CHECK(with("12", nullptr, 8) == 8);
    CHECK(with("0", "5", 8) == 5);
    CHECK(with(nullptr, nullptr, 0) == 1);
}

TEST_CASE("a shell's limit of address space is a limit of memory", "[memory]") {
#ifdef __SANITIZE_ADDRESS__
    return test::skip("the address sanitizer maps more address space than any limit leaves");
#endif
    const std::uint64_t before = machine_memory_bytes();
    CHECK(before > 0);
    const pid_t child = fork();
    if (child == 0) {
        const rlimit limit{before / 2, before / 2};
        _exit(setrlimit(RLIMIT_AS, &limit) == 0 && machine_memory_bytes() == before / 2 ? 0 : 1);
    }
    int status = -1;
    waitpid(child, &status, 0);
    CHECK(status == 0);
}

TEST_CASE("what the kernel has killed in a control group for memory is counted", "[memory]") {
    const Groups groups;
    const auto kills = [&] { return cgroup_oom_kills(groups.folder / "self", groups.folder / "mount"); };
    CHECK(kills() == 0);
    SECTION("version 2") {
        groups.write("self", "0::/jobs/one");
        CHECK(kills() == 0);
        groups.write("mount/memory.events", "low 0\noom 9\noom_kill 9");
        groups.write("mount/jobs/one/memory.events", "low 0\nhigh 1\nmax 17\noom 2\noom_kill 3\noom_group_kill 0");
        CHECK(kills() == 3);
    }
    SECTION("version 2 in a container") {
        groups.write("self", "0::/system.slice/docker-1.scope");
        groups.write("mount/memory.events", "oom 2\noom_kill 4");
        CHECK(kills() == 4);
    }
    SECTION("version 1") {
        groups.write("self", "5:cpu:/a\n4:memory:/jobs/7\n0::/");
        groups.write("mount/memory/jobs/7/memory.oom_control", "oom_kill_disable 0\nunder_oom 0\noom_kill 5");
        CHECK(kills() == 5);
    }
}
