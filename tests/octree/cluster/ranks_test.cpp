// What ranks agree on before they begin.
#include "octree/cluster/ranks.h"

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace lucarne::octree {
namespace {

/// Two ranks: this one, and one that sends the given text to all.
class WithAnother final : public Ranks {
 public:
    explicit WithAnother(const std::string& text) {
        const auto bytes = std::as_bytes(std::span(text));
        text_.assign(bytes.begin(), bytes.end());
    }
    size_t rank() const override { return 0; }
    size_t count() const override { return 2; }
    using Ranks::exchange;
    Result<void> exchange(std::span<const Bytes> parcels, std::vector<Bytes>& received) override {
        received = {parcels[0], text_};
        return {};
    }
    Result<void> sum(std::span<uint64_t>) override { return {}; }
    Result<void> conclude(Result<void> own) override { return own; }
    void serve(Answer) override {}
    Result<Bytes> ask(size_t, std::span<const std::byte>) override { return Bytes(); }
    bool stopped() const override { return false; }
    uint64_t sent() const override { return 0; }

 private:
    Bytes text_;
};

TEST(Ranks, OfAnotherVersionAreRefused) {
    const std::string own = "version 1.0 abc format 2";
    WithAnother same(own), other("version 1.1 abd format 2");
    EXPECT_TRUE(check_same(same, "lucarne-mpi", own));
    const auto refused = check_same(other, "lucarne-mpi", own);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().what, "lucarne-mpi");
    EXPECT_EQ(refused.error().why, "rank 1 has another one than rank 0");
}

TEST(Ranks, GetAboutEqualWeights) {
    const std::vector<uint64_t> weights{5, 1, 1, 1, 1, 1, 5, 5};
    for (size_t ranks = 1; ranks <= 12; ++ranks) {
        const auto first = divide(weights, ranks);
        ASSERT_EQ(first.size(), ranks + 1);
        EXPECT_EQ(first.front(), 0u);
        EXPECT_EQ(first.back(), weights.size());
        for (size_t rank = 0; rank < ranks; ++rank) {
            EXPECT_LE(first[rank], first[rank + 1]);
            uint64_t sum = 0;
            for (size_t i = first[rank]; i < first[rank + 1]; ++i) sum += weights[i];
            EXPECT_LE(sum, 20 / ranks + 5);
        }
    }
}

TEST(Ranks, TheFirstGetsLessWhereItHasOtherWork) {
    const std::vector<uint64_t> weights(12, 10);
    EXPECT_EQ(divide(weights, 2), (std::vector<size_t>{0, 6, 12}));
    EXPECT_EQ(divide(weights, 2, 40), (std::vector<size_t>{0, 4, 12}));
    EXPECT_EQ(divide(weights, 3, 30), (std::vector<size_t>{0, 2, 7, 12}));
    EXPECT_EQ(divide(weights, 3, 500), (std::vector<size_t>{0, 0, 6, 12})) << "too much for any other";
    EXPECT_EQ(divide(weights, 1, 30), (std::vector<size_t>{0, 12}));
}

}  // namespace
}  // namespace lucarne::octree
