#include "octree/cluster/mpi_ranks.h"

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstring>
#include <mutex>
#include <optional>
#include <set>
#include <thread>

#define OMPI_SKIP_MPICXX 1
#define MPICH_SKIP_MPICXX 1
#include <mpi.h>

namespace lucarne::octree {
namespace {

using Bytes = Ranks::Bytes;

/// MPI counts in int. While pieces arrive, waiting is short, so there are many.
constexpr size_t kPiece = size_t{1} << 20;
constexpr size_t kMostAnswer = size_t{1} << 30;  ///< bytes
constexpr size_t kSumPiece = size_t{1} << 20;    ///< values added up at a time
constexpr int kQuestion = 1, kStop = 2;          ///< tags
/// Pauses while waiting: short at first, so that small messages are fast.
constexpr auto kFirstPause = std::chrono::microseconds(20), kLastPause = std::chrono::microseconds(1000);
/// Pauses of the listening thread while no questions are expected, but only news of another rank's failure.
constexpr auto kIdlePause = std::chrono::milliseconds(20);

/// Waits longer from time to time.
class Patience {
 public:
    void wait() {
        std::this_thread::sleep_for(pause_);
        pause_ = std::min(pause_ + pause_ / 2, kLastPause);
    }
    void reset() { pause_ = kFirstPause; }

 private:
    std::chrono::microseconds pause_ = kFirstPause;
};

class MpiRanks final : public Ranks {
 public:
    MpiRanks() {
        int rank = 0, count = 0;
        MPI_Comm_rank(MPI_COMM_WORLD, &rank);
        MPI_Comm_size(MPI_COMM_WORLD, &count);
        rank_ = static_cast<size_t>(rank);
        count_ = static_cast<size_t>(count);
        for (MPI_Comm* comm : {&meetings_, &questions_, &answers_}) MPI_Comm_dup(MPI_COMM_WORLD, comm);
        server_ = std::thread([this] { listen(); });
    }
    ~MpiRanks() override {
        {
            const std::lock_guard lock(answer_mutex_);
            ending_ = true;
            wake_.notify_one();
        }
        server_.join();
        for (MPI_Comm* comm : {&meetings_, &questions_, &answers_}) MPI_Comm_free(comm);
        MPI_Finalize();
    }
    MpiRanks(const MpiRanks&) = delete;
    MpiRanks& operator=(const MpiRanks&) = delete;

    size_t rank() const override { return rank_; }
    size_t count() const override { return count_; }
    bool stopped() const override { return stopped_at_ == epoch_; }
    uint64_t sent() const override { return sent_; }

    using Ranks::exchange;
    Result<void> exchange(std::span<const Bytes> parcels, std::vector<Bytes>& received) override;
    Result<void> sum(std::span<uint64_t> values) override;
    Result<void> conclude(Result<void> own) override;
    void serve(Answer answer) override {
        const std::lock_guard lock(answer_mutex_);
        answer_ = std::move(answer);
        wake_.notify_one();
    }
    Result<Bytes> ask(size_t rank, std::span<const std::byte> question) override;

 private:
    struct Question {  ///< the head of the message
        int tag = 0;   ///< of the answer
    };
    /// Runs `start`, which begins an operation of MPI, and waits until it is complete.
    template <class Start>
    void complete(const Start& start) {
        MPI_Request request = MPI_REQUEST_NULL;
        {
            const std::lock_guard lock(mpi_);
            start(request);
        }
        Patience patience;
        for (int done = 0;;) {
            {
                const std::lock_guard lock(mpi_);
                MPI_Test(&request, &done, MPI_STATUS_IGNORE);
            }
            if (done) return;
            patience.wait();
        }
    }
    void complete_all(std::vector<MPI_Request>& requests);
    Result<void> status(const Error* own);
    Bytes receive(MPI_Comm comm, const MPI_Status& found);
    void send(MPI_Comm comm, size_t rank, int tag, const Bytes& bytes) {
        sent_ += bytes.size();
        complete([&](MPI_Request& request) {
            MPI_Isend(bytes.data(), static_cast<int>(bytes.size()), MPI_BYTE, static_cast<int>(rank), tag,
                      comm, &request);
        });
    }
    std::optional<MPI_Status> found(MPI_Comm comm, int source, int tag) {
        MPI_Status status{};
        int there = 0;
        const std::lock_guard lock(mpi_);
        MPI_Iprobe(source, tag, comm, &there, &status);
        return there ? std::optional(status) : std::nullopt;
    }
    void listen();
    bool answer_next();

    size_t rank_ = 0, count_ = 1;
    MPI_Comm meetings_ = MPI_COMM_NULL, questions_ = MPI_COMM_NULL, answers_ = MPI_COMM_NULL;
    std::mutex mpi_;  ///< one call of MPI at a time
    std::mutex answer_mutex_;
    Answer answer_;
    std::condition_variable wake_;  ///< of the listening thread, when questions are expected or all ends
    std::mutex tag_mutex_;
    std::set<int> tags_;  ///< of answers that are waited for
    std::atomic<bool> ending_{false};
    std::atomic<bool> failing_{false};  ///< this rank has failed, the others may not know it yet
    std::atomic<uint64_t> epoch_{1},
        stopped_at_{0};  ///< which piece of work; which of them another failed in
    std::atomic<uint64_t> sent_{0};
    std::optional<Error> failure_;  ///< that a meeting reported
    std::thread server_;
};

void MpiRanks::complete_all(std::vector<MPI_Request>& requests) {
    const auto count = static_cast<int>(requests.size());
    std::vector<int> which(requests.size());
    Patience patience;
    for (int left = count; left > 0;) {
        int done = 0;
        {
            const std::lock_guard lock(mpi_);
            MPI_Testsome(count, requests.data(), &done, which.data(), MPI_STATUSES_IGNORE);
        }
        left -= done;
        if (done > 0)
            patience.reset();
        else
            patience.wait();
    }
}

/// Begins each meeting: tells whether this rank has failed, and returns the error of the first that has.
Result<void> MpiRanks::status(const Error* own) {
    // A rank that only gave up because of another one comes last.
    const uint64_t none = 2 * count_, mine = !own ? none : stopped() ? count_ + rank_ : rank_;
    uint64_t first = none;
    complete([&](MPI_Request& request) {
        MPI_Iallreduce(&mine, &first, 1, MPI_UINT64_T, MPI_MIN, meetings_, &request);
    });
    if (first == none) return {};
    first %= count_;
    Bytes text = first == rank_ ? encode_error(*own) : Bytes();
    uint64_t bytes = text.size();
    const auto root = static_cast<int>(first);
    complete([&](MPI_Request& request) { MPI_Ibcast(&bytes, 1, MPI_UINT64_T, root, meetings_, &request); });
    text.resize(bytes);
    complete([&](MPI_Request& request) {
        MPI_Ibcast(text.data(), static_cast<int>(bytes), MPI_BYTE, root, meetings_, &request);
    });
    return tl::make_unexpected(decode_error(text));
}

Result<void> MpiRanks::conclude(Result<void> own) {
    if (failure_) {
        Error error = std::move(*failure_);
        failure_.reset();
        return tl::make_unexpected(std::move(error));
    }
    if (!own) {
        failing_ = true;
        Bytes epoch(sizeof(uint64_t));
        const uint64_t now = epoch_;
        std::memcpy(epoch.data(), &now, sizeof now);
        for (size_t rank = 0; rank < count_; ++rank)
            if (rank != rank_) send(questions_, rank, kStop, epoch);
    }
    auto outcome = status(own ? nullptr : &own.error());
    failing_ = false;
    ++epoch_;
    return outcome;
}

Result<void> MpiRanks::sum(std::span<uint64_t> values) {
    if (auto all_well = status(nullptr); !all_well) {
        failure_ = all_well.error();
        ++epoch_;
        return all_well;
    }
    for (; !values.empty(); values = values.subspan(std::min(kSumPiece, values.size()))) {
        const auto part = values.first(std::min(kSumPiece, values.size()));
        complete([&](MPI_Request& request) {
            MPI_Iallreduce(MPI_IN_PLACE, part.data(), static_cast<int>(part.size()), MPI_UINT64_T, MPI_SUM,
                           meetings_, &request);
        });
        sent_ += part.size_bytes();
    }
    return {};
}

Result<void> MpiRanks::exchange(std::span<const Bytes> parcels, std::vector<Bytes>& received) {
    if (auto all_well = status(nullptr); !all_well) {
        failure_ = all_well.error();
        ++epoch_;
        return all_well;
    }
    std::vector<uint64_t> outgoing, incoming(count_);
    for (const Bytes& parcel : parcels) outgoing.push_back(parcel.size());
    complete([&](MPI_Request& request) {
        MPI_Ialltoall(outgoing.data(), 1, MPI_UINT64_T, incoming.data(), 1, MPI_UINT64_T, meetings_,
                      &request);
    });
    received.resize(count_);
    received[rank_] = parcels[rank_];
    std::vector<MPI_Request> requests;
    const auto each_piece = [&](auto& bytes, const auto& use) {
        for (size_t at = 0; at < bytes.size(); at += kPiece) {
            const std::lock_guard lock(mpi_);
            use(bytes.data() + at, static_cast<int>(std::min(kPiece, bytes.size() - at)),
                requests.emplace_back(MPI_REQUEST_NULL));
        }
    };
    for (size_t other = 0; other < count_; ++other) {
        if (other == rank_) continue;
        received[other].resize(incoming[other]);
        each_piece(received[other], [&](std::byte* to, int bytes, MPI_Request& request) {
            MPI_Irecv(to, bytes, MPI_BYTE, static_cast<int>(other), 0, meetings_, &request);
        });
    }
    for (size_t step = 1; step < count_; ++step) {  // each rank begins with another one
        const size_t other = (rank_ + step) % count_;
        sent_ += parcels[other].size();
        each_piece(parcels[other], [&](const std::byte* from, int bytes, MPI_Request& request) {
            MPI_Isend(from, bytes, MPI_BYTE, static_cast<int>(other), 0, meetings_, &request);
        });
    }
    complete_all(requests);
    return {};
}

Bytes MpiRanks::receive(MPI_Comm comm, const MPI_Status& found) {
    int bytes = 0;
    {
        const std::lock_guard lock(mpi_);
        MPI_Get_count(&found, MPI_BYTE, &bytes);
    }
    Bytes message(static_cast<size_t>(bytes));
    complete([&](MPI_Request& request) {
        MPI_Irecv(message.data(), bytes, MPI_BYTE, found.MPI_SOURCE, found.MPI_TAG, comm, &request);
    });
    return message;
}

/// An answer begins with a byte: 1 for bytes, 0 for an error.
Result<Bytes> MpiRanks::ask(size_t rank, std::span<const std::byte> question) {
    if (rank == rank_) {
        const std::lock_guard lock(answer_mutex_);
        return answer_(question);
    }
    Question head;
    {
        const std::lock_guard lock(tag_mutex_);
        while (!tags_.insert(head.tag).second) ++head.tag;
    }
    Bytes message(sizeof head + question.size());
    std::memcpy(message.data(), &head, sizeof head);
    if (!question.empty()) std::memcpy(message.data() + sizeof head, question.data(), question.size());
    send(questions_, rank, kQuestion, message);
    Patience patience;
    std::optional<MPI_Status> there;
    while (!(there = found(answers_, static_cast<int>(rank), head.tag))) patience.wait();
    Bytes answer = receive(answers_, *there);
    {
        const std::lock_guard lock(tag_mutex_);
        tags_.erase(head.tag);
    }
    if (answer.empty() || answer[0] == std::byte{0})
        return tl::make_unexpected(
            decode_error(std::span(answer).subspan(std::min<size_t>(1, answer.size()))));
    answer.erase(answer.begin());
    return answer;
}

bool MpiRanks::answer_next() {
    Bytes reply;
    size_t to = 0;
    Question head;
    {
        const std::lock_guard lock(answer_mutex_);
        if (!answer_ && !failing_) return false;
        const auto next = found(questions_, MPI_ANY_SOURCE, kQuestion);
        if (!next) return false;
        const Bytes question = receive(questions_, *next);
        std::memcpy(&head, question.data(), sizeof head);
        to = static_cast<size_t>(next->MPI_SOURCE);
        Result<Bytes> answer = failed("the conversion", "has failed on another rank");
        if (answer_) answer = answer_(std::span(question).subspan(sizeof head));
        if (answer && answer->size() >= kMostAnswer)
            answer = failed("the conversion", "a rank asked for more than 1 GiB");
        reply = {std::byte{answer.has_value()}};
        const Bytes body = answer ? std::move(*answer) : encode_error(answer.error());
        reply.insert(reply.end(), body.begin(), body.end());
    }
    send(answers_, to, head.tag, reply);
    return true;
}

void MpiRanks::listen() {
    Patience patience;
    while (!ending_) {
        if (const auto stop = found(questions_, MPI_ANY_SOURCE, kStop)) {
            const Bytes message = receive(questions_, *stop);
            uint64_t epoch = 0;
            std::memcpy(&epoch, message.data(), std::min(sizeof epoch, message.size()));
            stopped_at_ = epoch;
        }
        if (answer_next()) {
            patience.reset();
            continue;
        }
        std::unique_lock lock(answer_mutex_);
        if (!answer_ && !failing_ && !ending_) {
            wake_.wait_for(lock, kIdlePause);
            patience.reset();
            continue;
        }
        lock.unlock();
        patience.wait();
    }
}

}  // namespace

Result<std::unique_ptr<Ranks>> start_mpi() {
    int threads = 0;
    MPI_Init_thread(nullptr, nullptr, MPI_THREAD_SERIALIZED, &threads);
    if (threads < MPI_THREAD_SERIALIZED) {
        MPI_Finalize();
        return failed("MPI", "does not allow calls from several threads",
                      "use OpenMPI 4 as Debian builds it");
    }
    return std::make_unique<MpiRanks>();
}

}  // namespace lucarne::octree
