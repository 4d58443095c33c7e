#include "octree/cluster/ranks.h"

#include <algorithm>
#include <numeric>

#include <fmt/format.h>

namespace lucarne::octree {

Result<std::vector<Ranks::Bytes>> share(Ranks& ranks, const Ranks::Bytes& bytes) {
    return ranks.exchange(std::vector<Ranks::Bytes>(ranks.count(), bytes));
}

Result<Ranks::Bytes> hear_first(Ranks& ranks, Ranks::Bytes bytes) {
    std::vector<Ranks::Bytes> parcels(ranks.count());
    if (ranks.rank() == 0) std::ranges::fill(parcels, bytes);
    LUCARNE_ASSIGN(auto heard, ranks.exchange(parcels));
    return std::move(heard[0]);
}

Result<std::vector<Ranks::Bytes>> tell_first(Ranks& ranks, Ranks::Bytes bytes) {
    std::vector<Ranks::Bytes> parcels(ranks.count());
    parcels[0] = std::move(bytes);
    return ranks.exchange(parcels);
}

Result<void> meet(Ranks& ranks) {
    return ranks.sum({});
}

Result<void> check_same(Ranks& ranks, const std::string& what, const std::string& text) {
    const auto bytes = std::as_bytes(std::span(text));
    LUCARNE_ASSIGN(const auto all, share(ranks, {bytes.begin(), bytes.end()}));
    for (size_t rank = 1; rank < all.size(); ++rank)
        if (all[rank] != all[0])
            return failed(what, fmt::format("rank {} has another one than rank 0", rank),
                          "let all nodes run the same program on the same files");
    return {};
}

std::vector<size_t> divide(std::span<const uint64_t> weights, size_t ranks, uint64_t first_has) {
    const auto sum = std::accumulate(weights.begin(), weights.end(), 0.0L);
    // With more than this, rank 0 gets nothing, and the others share evenly.
    const long double most = ranks > 1 ? sum / static_cast<long double>(ranks - 1) : 0;
    long double before = std::min(static_cast<long double>(first_has), most);
    const long double total = before + sum;
    std::vector<size_t> first{0};
    for (size_t piece = 0; piece < weights.size(); ++piece) {
        // A piece goes to the rank in whose share its middle lies.
        const long double middle = before + static_cast<long double>(weights[piece]) / 2;
        while (first.size() < ranks &&
               middle * static_cast<long double>(ranks) >= total * static_cast<long double>(first.size()))
            first.push_back(piece);
        before += static_cast<long double>(weights[piece]);
    }
    first.resize(ranks + 1, weights.size());
    return first;
}

Ranks::Bytes encode_error(const Error& error) {
    Ranks::Bytes bytes{static_cast<std::byte>(error.kind)};
    for (const std::string* text : {&error.what, &error.why, &error.todo}) {
        const auto part = std::as_bytes(std::span(*text));
        bytes.insert(bytes.end(), part.begin(), part.end());
        bytes.push_back(std::byte{0});
    }
    return bytes;
}

Error decode_error(std::span<const std::byte> bytes) {
    Error error;
    if (bytes.empty()) return error;
    error.kind = static_cast<ErrorKind>(bytes[0]);
    bytes = bytes.subspan(1);
    for (std::string* text : {&error.what, &error.why, &error.todo}) {
        const auto end = std::ranges::find(bytes, std::byte{0});
        text->assign(reinterpret_cast<const char*>(bytes.data()), static_cast<size_t>(end - bytes.begin()));
        bytes = bytes.subspan(std::min(text->size() + 1, bytes.size()));
    }
    return error;
}

}  // namespace lucarne::octree
