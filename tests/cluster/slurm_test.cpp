// The script for Slurm runs with a real Slurm, whose daemons the test starts on this machine.
#include <fstream>
#include <memory>
#include <random>
#include <string>

#include <gtest/gtest.h>
#include <unistd.h>

#include "tests/cluster/ranks.h"

namespace lucarne {
namespace {

using test::Background;
using test::installed;
using test::lucarne;
using test::Outcome;
using test::shell;

/// A cluster of one node, with everything in a folder of its own.
class Slurm {
 public:
    explicit Slurm(const test::TemporaryFolder& folder) : folder_(folder) {
        const std::string host = words("hostname -s"), user = words("id -un"), conf = folder / "slurm.conf";
        std::random_device random;
        const int port = 20000 + static_cast<int>(random() % 12000);  // below those that systems give out
        std::string key;
        for (int i = 0; i < 1024; ++i) key += static_cast<char>(random());
        std::ofstream(folder / "key", std::ios::binary) << key;
        std::filesystem::permissions(folder / "key", std::filesystem::perms::owner_read);
        std::ofstream(conf) << "ClusterName=lucarne\nSlurmctldHost=" << host
                            << "(127.0.0.1)\nAuthType=auth/munge\nAuthInfo=socket=" << folder / "munge"
                            << "\nSlurmUser=" << user << "\nSlurmdUser=" << user << "\nSlurmctldPort=" << port
                            << "\nSlurmdPort=" << port + 1 << "\nStateSaveLocation=" << folder / "state"
                            << "\nSlurmdSpoolDir=" << folder / "spool"
                            << "\nSlurmctldPidFile=" << folder / "slurmctld.pid"
                            << "\nSlurmdPidFile=" << folder / "slurmd.pid"
                            << "\nSlurmctldLogFile=" << folder / "slurmctld.log"
                            << "\nSlurmdLogFile=" << folder / "slurmd.log"
                            << "\nProctrackType=proctrack/linuxproc\nTaskPlugin=task/none\nMpiDefault=pmix"
                               "\nReturnToService=2\nNodeName="
                            << host << " NodeAddr=127.0.0.1 CPUs=2\nPartitionName=all Nodes=" << host
                            << " Default=YES\n";
        for (const char* name : {"state", "spool"}) std::filesystem::create_directory(folder / name);
        munge_ = std::make_unique<Background>(
            "munged --force --foreground --key-file=" + folder / "key" + " --socket=" + folder / "munge" +
            " --pid-file=" + folder / "munge.pid" + " --log-file=" + folder / "munge.log" +
            " --seed-file=" + folder / "munge.seed" + " >" + folder / "munged.out" + " 2>&1");
        test::eventually([&] { return std::filesystem::exists(folder / "munge"); });
        controller_ =
            std::make_unique<Background>("slurmctld -D -f " + conf + " >" + folder / "ctl.out 2>&1");
        daemon_ = std::make_unique<Background>("slurmd -D -f " + conf + " >" + folder / "d.out 2>&1");
    }
    ~Slurm() {
        daemon_.reset();
        controller_.reset();
        munge_.reset();
    }

    /// Whether the node takes jobs. False if a daemon has ended.
    bool ready() {
        test::eventually([&] {
            return words(environment() + "sinfo -h -o %T") == "idle" || !controller_->running() ||
                   !daemon_->running();
        });
        return controller_->running() && daemon_->running();
    }
    std::string environment() const { return "SLURM_CONF=" + folder_ / "slurm.conf" + " "; }
    std::string logs() const {
        return test::bytes_of(folder_ / "slurmctld.log") + test::bytes_of(folder_ / "slurmd.log") +
               test::bytes_of(folder_ / "munged.out");
    }

 private:
    static std::string words(const std::string& command) {
        std::string text = shell(command).output;
        return text.substr(0, text.find('\n'));
    }
    const test::TemporaryFolder& folder_;
    std::unique_ptr<Background> munge_, controller_, daemon_;
};

TEST(SlurmScript, ConvertsToTheSameBytesAsOneProcess) {
    LUCARNE_NEEDS_RANKS();
    for (const char* program : {"munged", "slurmctld", "slurmd", "sbatch", "srun"})
        if (!installed(program)) GTEST_SKIP() << "needs " << program << " (Debian: slurm-wlm munge)";
    const test::TemporaryFolder folder;
    for (const char* scene : {"cornell", "house"})
        ASSERT_EQ(lucarne(std::string("generate ") + scene + " --points 40k -o " +
                          folder / (std::string(scene) + ".las"))
                      .code,
                  0);
    const std::string inputs = folder / "cornell.las" + " " + folder / "house.las" + " --memory 48M -o ";
    const Outcome one = lucarne("convert " + inputs + folder / "one.luc");
    ASSERT_EQ(one.code, 0) << one.output;
    Slurm slurm(folder);
    ASSERT_TRUE(slurm.ready()) << slurm.logs();
    // The container of the test may forbid what OpenMPI does to copy between processes.
    const Outcome job = shell(
        slurm.environment() + "OMPI_MCA_btl_vader_single_copy_mechanism=none LUCARNE=" + LUCARNE_BINARY +
        " LUCARNE_TEMP=" + folder.path().string() +
        " sbatch --wait --ntasks-per-node=2 --output=" + folder / "job.log " +
        LUCARNE_SOURCE_DIR "/data/cluster/convert.sbatch " + inputs + folder / "two.luc");
    const std::string log = test::bytes_of(folder / "job.log");
    ASSERT_EQ(job.code, 0) << job.output << log << slurm.logs();
    EXPECT_NE(log.find("2 ranks exchanged"), std::string::npos) << log;
    EXPECT_TRUE(test::bytes_of(folder / "one.luc") == test::bytes_of(folder / "two.luc"));
}

}  // namespace
}  // namespace lucarne
