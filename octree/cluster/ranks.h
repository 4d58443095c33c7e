#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "io/core/error.h"

namespace lucarne::octree {

/// The processes, here called ranks, that build one cache together, as MPI counts them. Every rank runs the
/// same stages. exchange(), sum() and conclude() are meetings: all ranks call them in the same order, each on
/// one thread. A rank that fails goes to conclude(), wherever the others are: they get its error from the
/// meeting that they are in, return it, and come to conclude() as well.
class Ranks {
 public:
    using Bytes = std::vector<std::byte>;
    virtual ~Ranks() = default;

    virtual size_t rank() const = 0;   ///< of this process, from 0
    virtual size_t count() const = 0;  ///< of ranks

    /// Sends parcels[i] to rank i. `received` becomes what each rank sent to this one; its memory is used
    /// again. A parcel may be of any size.
    virtual Result<void> exchange(std::span<const Bytes> parcels, std::vector<Bytes>& received) = 0;
    Result<std::vector<Bytes>> exchange(std::span<const Bytes> parcels) {
        std::vector<Bytes> received;
        LUCARNE_TRY(exchange(parcels, received));
        return received;
    }
    /// Replaces the values by their sums over all ranks, which have equally many of them.
    virtual Result<void> sum(std::span<uint64_t> values) = 0;
    /// Ends a piece of work: returns success if all ranks succeeded, else everywhere the same error, that of
    /// the first rank that failed.
    virtual Result<void> conclude(Result<void> own) = 0;

    /// Answers a question of another rank, on a thread of its own.
    using Answer = std::function<Result<Bytes>(std::span<const std::byte> question)>;
    /// Sets who answers, null for nobody: questions then wait.
    virtual void serve(Answer answer) = 0;
    /// Asks a rank and waits for its answer. Any thread may ask. Errors: what the answer reports; the rank
    /// has failed; an answer of more than 1 GiB.
    virtual Result<Bytes> ask(size_t rank, std::span<const std::byte> question) = 0;

    /// Whether another rank has failed, so that the work is in vain.
    virtual bool stopped() const = 0;
    /// Bytes that this rank has sent to others.
    virtual uint64_t sent() const = 0;
};

/// Answers questions while it lives. It must end after a meeting behind the last question, and the next one
/// must begin after a further meeting, so that it does not get questions that are for the next one.
class Serving {
 public:
    Serving(Ranks& ranks, Ranks::Answer answer) : ranks_(ranks) { ranks_.serve(std::move(answer)); }
    ~Serving() { ranks_.serve(nullptr); }
    Serving(const Serving&) = delete;
    Serving& operator=(const Serving&) = delete;

 private:
    Ranks& ranks_;
};

/// A meeting: sends the same to every rank and returns what each sent.
Result<std::vector<Ranks::Bytes>> share(Ranks& ranks, const Ranks::Bytes& bytes);
/// A meeting: returns what rank 0 says.
Result<Ranks::Bytes> hear_first(Ranks& ranks, Ranks::Bytes bytes);
/// A meeting: returns what each rank says at rank 0, nothing at the others.
Result<std::vector<Ranks::Bytes>> tell_first(Ranks& ranks, Ranks::Bytes bytes);
/// A meeting that waits for all ranks.
Result<void> meet(Ranks& ranks);
/// A meeting. Errors: the ranks differ in `text`, which describes `what` they work on.
Result<void> check_same(Ranks& ranks, const std::string& what, const std::string& text);

/// Divides consecutive pieces among ranks, so that each gets about the same weight. Returns the first piece
/// of each rank, and their number. `first_has`: weight of other work that rank 0 does alone; it gets less.
std::vector<size_t> divide(std::span<const uint64_t> weights, size_t ranks, uint64_t first_has = 0);

/// Errors as bytes for other ranks.
Ranks::Bytes encode_error(const Error& error);
Error decode_error(std::span<const std::byte> bytes);

}  // namespace lucarne::octree
