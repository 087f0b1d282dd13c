// SPDX-License-Identifier: GPL-3.0-or-later
//
// Batches that are killed: the program, its jobs or both, at random moments and at changes of the files. Whatever was
// in flight is lost, and nothing else: once the same command has come to its end, all is as if nothing had happened.
#include <dirent.h>
#include <poll.h>
#include <sys/inotify.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <csignal>
#include <fstream>
#include <map>
#include <random>
#include <thread>

#include <fmt/core.h>
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "run_program.h"
#include "tests/outcomes.h"
#include "tests/places.h"

using namespace voxtone::test;
namespace fs = std::filesystem;

namespace {

using Clock = std::chrono::steady_clock;
using Tree = std::vector<std::pair<std::string, std::string>>;

/// Three jobs over small boxes, one with a loop and its checkpoints.
struct Workshop {
    explicit Workshop(const std::string& name) : folder(name) {
        for (int i = 1; i <= 3; ++i) folder.write(fmt::format("box{}.obj", i), soft_box_obj(2 + 0.5 * i, 2, 1));
        folder.write("plan.jsonl",
                     "{\"model\": \"box1.obj\", \"iterations\": 3}\n{\"model\": \"box2.obj\", \"iterations\": 0}\n"
                     "{\"model\": \"box3.obj\", \"iterations\": 0, \"formats\": [\"png\", \"tiff\", \"gcvf\"]}\n");
        folder.write("quick.json", R"({"format": "voxtone-job", "version": 1, "report": false})");
    }
    [[nodiscard]] std::vector<std::string> words(const std::string& out, const std::string& retries) const {
        return {program(),    "batch",  folder / "plan.jsonl", "--preset", folder / "quick.json", "-o",
                folder / out, "--json", "--retries",           retries};
    }
    /// What the jobs have made, but for figures of time and memory.
    [[nodiscard]] Tree stacks(const std::string& out) const {
        Tree all;
        for (const char* job : {"box1", "box2", "box3"})
            for (auto& [name, bytes] : read_tree(folder / (out + "/" + job)))
                if (name != "report.json") all.emplace_back(job + ("/" + name), std::move(bytes));
        return all;
    }
    Folder folder;
};

pid_t start(const std::vector<std::string>& words, const std::string& said) {
    std::vector<char*> arguments;
    for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
    arguments.push_back(nullptr);
    const pid_t child = fork();
    if (child == 0) {
        if (!std::freopen(said.c_str(), "w", stdout) || !std::freopen(said.c_str(), "a", stderr)) _exit(126);
        execv(arguments[0], arguments.data());
        _exit(127);
    }
    return child;
}

/// -1: it runs.
int exit_code_now(pid_t child) {
    int status = 0;
    if (waitpid(child, &status, WNOHANG) != child) return -1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

int exit_code_of(pid_t child) {
    int status = 0;
    waitpid(child, &status, 0);
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

std::vector<pid_t> children_of(pid_t parent) {
    std::ifstream file(fmt::format("/proc/{0}/task/{0}/children", parent));
    std::vector<pid_t> children;
    for (pid_t child = 0; file >> child;) children.push_back(child);
    return children;
}

/// Changes of files in a folder and below it, as they happen.
class Changes {
public:
    explicit Changes(const fs::path& folder) : file_(inotify_init1(IN_NONBLOCK | IN_CLOEXEC)) { watch(folder); }
    Changes(const Changes&) = delete;
    Changes& operator=(const Changes&) = delete;
    ~Changes() { close(file_); }

    /// How many there have been since it was last asked, at once or after a millisecond.
    int count() {
        pollfd waiting{file_, POLLIN, 0};
        if (poll(&waiting, 1, 1) <= 0) return 0;
        alignas(inotify_event) std::array<char, 65536> buffer{};
        const ssize_t size = read(file_, buffer.data(), buffer.size());
        int changes = 0;
        for (ssize_t at = 0; at < size; ++changes) {
            const auto* event = reinterpret_cast<const inotify_event*>(buffer.data() + at);
            if ((event->mask & IN_ISDIR) && (event->mask & (IN_CREATE | IN_MOVED_TO)))
                watch(folders_[event->wd] / event->name);
            at += static_cast<ssize_t>(sizeof(inotify_event) + event->len);
        }
        return changes;
    }

private:
    void watch(const fs::path& folder) {
        const int id = inotify_add_watch(file_, folder.c_str(), IN_CREATE | IN_MOVED_FROM | IN_MOVED_TO | IN_DELETE);
        if (id < 0) return;  // gone again
        folders_[id] = folder;
        std::error_code error;
        for (const auto& entry : fs::directory_iterator(folder, error))
            if (entry.is_directory(error)) watch(entry.path());
    }

    int file_;
    std::map<int, fs::path> folders_;
};

enum class Victim { batch, jobs, both };

/// Lets a batch run to a random moment or change of a file, and kills. False: it ended before that.
bool run_and_kill(const Workshop& shop, std::mt19937& random, double whole_s, int& exit_code) {
    const fs::path out = shop.folder / "out";
    fs::create_directory(out);
    const auto victim = static_cast<Victim>(random() % 3);
    const bool at_change = random() % 2 == 0;
    const int change = 1 + static_cast<int>(random() % 120);
    const double after_s = whole_s * std::uniform_real_distribution<double>(0, 1)(random);
    Changes changes(out);
    const auto began = Clock::now();
    const pid_t batch = start(shop.words("out", "3"), shop.folder / "said");
    for (int seen = 0;;) {
        seen += changes.count();
        if ((exit_code = exit_code_now(batch)) >= 0) return false;
        const double ran_s = std::chrono::duration<double>(Clock::now() - began).count();
        if (at_change ? seen >= change : ran_s > after_s) break;
    }
    const std::vector<pid_t> jobs = children_of(batch);
    INFO("kills " << static_cast<int>(victim) << (at_change ? " at change " : " after ms ")
                  << (at_change ? change : static_cast<int>(1e3 * after_s)));
    if (victim != Victim::batch)
        for (const pid_t job : jobs) kill(job, SIGKILL);
    if (victim != Victim::jobs) kill(batch, SIGKILL);
    exit_code = exit_code_of(batch);
    // What a killed batch has started is gone soon, by itself.
    const auto killed = Clock::now();
    for (const pid_t job : jobs)
        while (kill(job, 0) == 0 && Clock::now() - killed < std::chrono::seconds(10))
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
    for (const pid_t job : jobs) CHECK(kill(job, 0) != 0);
    return true;
}

void expect_undisturbed(const Workshop& shop, const Tree& reference) {
    const Tree stacks = shop.stacks("out");
    REQUIRE(stacks.size() == reference.size());
    for (std::size_t i = 0; i < stacks.size(); ++i) {
        INFO(stacks[i].first);
        CHECK(stacks[i].first == reference[i].first);
        CHECK((stacks[i].second == reference[i].second));
    }
    for (const char* job : {"box1", "box2", "box3"}) {
        CHECK(run_program(fmt::format("verify '{}'", shop.folder / ("out/" + std::string(job)))).exit_code == 0);
        const auto state = nlohmann::json::parse(read_file(shop.folder / fmt::format("out/batch/{}.json", job)));
        const auto manifest = nlohmann::json::parse(read_file(shop.folder / fmt::format("out/{}/manifest.json", job)));
        CHECK(state["state"] == "done");
        CHECK(state["figures"]["content_sha256"] == manifest["content_sha256"]);
    }
    for (const auto& entry : fs::recursive_directory_iterator(shop.folder / "out")) {
        INFO(entry.path());
        CHECK_FALSE(entry.path().filename().string().starts_with('.'));
    }
    CHECK(fs::exists(shop.folder / "out/index.html"));
}

/// So many kills, spread over as many batches as they take.
void kill_many(int kills, unsigned seed) {
    const Workshop shop("batch-kill");
    const auto began = Clock::now();
    REQUIRE(exit_code_of(start(shop.words("reference", "3"), shop.folder / "said")) == 0);
    const double whole_s = std::chrono::duration<double>(Clock::now() - began).count();
    const Tree reference = shop.stacks("reference");
    REQUIRE(reference.size() > 100);
    std::mt19937 random(seed);
    int killed = 0, batches = 0;
    while (killed < kills) {
        fs::remove_all(shop.folder / "out");
        ++batches;
        int exit_code = -1;
        while (killed < kills && run_and_kill(shop, random, whole_s, exit_code)) ++killed;
        if (exit_code != 0) {
            exit_code = exit_code_of(start(shop.words("out", "3"), shop.folder / "said"));
            INFO(read_file(shop.folder / "said"));
            REQUIRE(exit_code == 0);
        }
        expect_undisturbed(shop, reference);
    }
    WARN(fmt::format("{} kills in {} batches of {:.1f} s", killed, batches, whole_s));
}

}  // namespace

#ifdef VOXTONE_MANY_KILLS

TEST_CASE("A batch that is killed a hundred times goes on as if nothing had happened") { kill_many(100, 2); }

#else

TEST_CASE("A batch that is killed goes on as if nothing had happened") { kill_many(6, 1); }

TEST_CASE("A disk that fills up and is freed costs a batch nothing but time") {
    const Workshop shop("batch-disk");
    if (run_shell("unshare -m true 2>/dev/null") != 0) {
        skip("no file system can be mounted here (needs root)");
        return;
    }
    REQUIRE(exit_code_of(start(shop.words("reference", "3"), shop.folder / "said")) == 0);
    fs::create_directory(shop.folder / "disk");
    std::string command;
    for (const std::string& word : shop.words("disk", "6")) command += "'" + word + "' ";
    // The disk is full from the moment the first layers are written; it is freed once a job has told so; what is left
    // is copied out of the file system, which ends with its shell.
    shop.folder.write("run.sh", fmt::format(R"(set -u
mount -t tmpfs -o size=40m none '{0}/disk' || exit 9
{1} >'{0}/said' 2>&1 &
until [ -e '{0}/disk/box2/.voxtone-unfinished' ] || [ -e '{0}/disk/box2/manifest.json' ]; do :; done
dd if=/dev/zero of='{0}/disk/fill' bs=4k >/dev/null 2>&1
for i in 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15; do
  grep -q '"state": "again"' '{0}/said' && break
  sleep 1
done
rm '{0}/disk/fill'
wait $!
code=$?
cp -a '{0}/disk' '{0}/out'
exit $code
)",
                                            shop.folder.path().string(), command));
    const int code = run_shell(fmt::format("unshare -m sh '{}'", shop.folder / "run.sh"));
    const std::string said = read_file(shop.folder / "said");
    INFO(said);
    REQUIRE(code != 9);
    CHECK(code == 0);
    CHECK(said.find("\"state\": \"again\"") != std::string::npos);
    expect_undisturbed(shop, shop.stacks("reference"));
}

#endif
