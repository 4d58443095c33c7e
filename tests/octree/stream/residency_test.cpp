#include "octree/stream/residency.h"

#include <chrono>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <thread>

#include <gtest/gtest.h>

#include "io/core/random.h"
#include "tests/octree/plane_source.h"

namespace lucarne::octree {
namespace {

using test::PlaneSource;
constexpr uint32_t kPoints = 100;
constexpr uint64_t kNode = kPoints * 16;  ///< bytes of a node

Cut cut_of(const NodeSource& source, const std::vector<std::pair<uint32_t, float>>& nodes) {
    Cut cut;
    for (const auto& [node, priority] : nodes)
        cut.nodes.push_back({node, source.nodes()[node].count, priority});
    std::ranges::sort(cut.nodes, {}, &CutNode::node);
    return cut;
}

void want(ResidencyBase& residency, const Cut& cut) {
    const Cut* cuts[] = {&cut};
    residency.want(cuts);
}

/// Replays the events as a caller would, and checks their order and the cap at every step.
class Replay {
 public:
    explicit Replay(uint64_t cap) : cap_(cap) {}
    void play(const std::vector<Residency<>::Event>& events) {
        for (const auto& event : events) {
            switch (event.kind) {
                case ResidencyBase::Kind::loaded:
                    EXPECT_TRUE(held_.insert(event.node).second) << "node " << event.node << " loaded twice";
                    break;
                case ResidencyBase::Kind::replaced:
                    EXPECT_TRUE(held_.contains(event.node)) << "node " << event.node << " replaced unseen";
                    ++replaced_;
                    break;
                case ResidencyBase::Kind::evicted:
                    EXPECT_EQ(held_.erase(event.node), 1u) << "node " << event.node << " evicted unseen";
                    break;
            }
            if (event.kind == ResidencyBase::Kind::evicted) {
                EXPECT_FALSE(event.data);
            } else if (event.data) {
                EXPECT_EQ(event.data->records.front(), static_cast<std::byte>(event.node))
                    << "another node's data";
            } else {
                ADD_FAILURE() << "node " << event.node << " without data";
            }
            EXPECT_LE(held_.size() * kNode, cap_);
        }
    }
    const std::set<uint32_t>& held() const { return held_; }
    size_t replaced() const { return replaced_; }

 private:
    uint64_t cap_;
    std::set<uint32_t> held_;
    size_t replaced_ = 0;
};

TEST(Residency, RecordsInTransitKeepToTheirCapAndAllArriveAllTheSame) {
    const PlaneSource source(4, kPoints, 10.0);
    const uint64_t all = source.nodes().size() * kNode;
    Residency residency(source, {.memory = all, .transit = 5 * kNode + kNode / 2, .threads = 3});
    const Cut cut = full_cut(source);
    want(residency, cut);
    Replay replay(all);
    size_t rounds = 0;
    for (bool done = false; !done; ++rounds) {
        done = residency.wait();
        const auto events = residency.poll(3);
        EXPECT_LE(events.size(), 3u);
        replay.play(events);
    }
    for (auto events = residency.poll(3); !events.empty(); events = residency.poll(3)) replay.play(events);
    EXPECT_EQ(replay.held().size(), source.nodes().size());
    EXPECT_GT(rounds, source.nodes().size() / 6) << "it went on loading without room";
    EXPECT_LE(residency.stats().transit_peak, 5 * kNode);
    EXPECT_EQ(residency.stats().pending, 0u);
}

TEST(Residency, WhatIsLargerThanTheTransitIsRefusedAndBlocksNothing) {
    PlaneSource source(3, kPoints, 10.0);
    source.edit().back().count = 10 * kPoints;
    Residency residency(source, {.memory = 1000 * kNode, .transit = 4 * kNode, .threads = 2});
    const Cut cut = full_cut(source);
    want(residency, cut);
    while (!residency.wait()) residency.poll();
    EXPECT_EQ(residency.stats().refused, 1u);
    EXPECT_EQ(residency.stats().nodes_held, source.nodes().size() - 1);
}

TEST(Residency, LoadsEverythingWantedThatFits) {
    const PlaneSource source(4, kPoints, 10.0);
    Residency residency(source, {.memory = source.nodes().size() * kNode, .threads = 3});
    want(residency, full_cut(source));
    residency.wait();
    Replay replay(source.nodes().size() * kNode);
    replay.play(residency.poll());
    EXPECT_EQ(replay.held().size(), source.nodes().size());
    const ResidencyStats stats = residency.stats();
    EXPECT_EQ(stats.pending, 0u);
    EXPECT_EQ(stats.refused, 0u);
    EXPECT_EQ(stats.bytes_held, source.nodes().size() * kNode);
    EXPECT_EQ(stats.bytes_loaded, stats.bytes_held);
    EXPECT_TRUE(residency.take_error());
}

TEST(Residency, WaitsNoLongerThanItIsToldTo) {
    PlaneSource source(2, kPoints, 10.0);
    source.shut();
    Residency residency(source, {.threads = 2});
    want(residency, full_cut(source));
    EXPECT_FALSE(residency.wait_for(std::chrono::milliseconds(1)));
    EXPECT_TRUE(residency.poll().empty());
    source.open();
    EXPECT_TRUE(residency.wait_for(std::chrono::hours(1)));
    EXPECT_EQ(residency.poll().size(), source.nodes().size());
}

TEST(Residency, LoadsTheMostImportantFirstAndParentsBeforeChildren) {
    const PlaneSource source(3, kPoints, 10.0);
    Residency residency(source, {.threads = 1});
    // Node 2's child 9 is the most important, so its ancestors come before it, and before node 1 and its
    // child 5.
    want(residency, cut_of(source, {{0, 1}, {1, 5}, {2, 0}, {3, 4}, {5, 5}, {9, 9}}));
    residency.wait();
    EXPECT_EQ(source.order(), (std::vector<uint32_t>{0, 2, 9, 1, 5, 3}));
}

TEST(Residency, HoldsTheMostImportantThatFitAndCountsTheRest) {
    const PlaneSource source(5, kPoints, 10.0);
    constexpr uint64_t kFit = 37;
    Residency residency(source, {.memory = kFit * kNode + kNode / 2, .threads = 2});
    Replay replay(kFit * kNode);
    for (int frame = 0; frame < 5; ++frame) {
        want(residency, full_cut(source));
        residency.wait();
        replay.play(residency.poll());
        std::set<uint32_t> expected;
        for (uint32_t node = 0; node < kFit; ++node) expected.insert(node);  // breadth first, so coarse first
        EXPECT_EQ(replay.held(), expected);
        EXPECT_EQ(residency.stats().refused, source.nodes().size() - kFit);
        EXPECT_EQ(residency.stats().pending, 0u);
    }
    EXPECT_EQ(residency.stats().loads, kFit) << "repeating a request loads nothing twice";
    EXPECT_EQ(residency.stats().evictions, 0u);
    EXPECT_LE(residency.stats().bytes_peak, kFit * kNode + kNode / 2);
}

TEST(Residency, EvictsTheLongestUnwantedFirst) {
    const PlaneSource source(3, kPoints, 10.0);
    Residency residency(source, {.memory = 4 * kNode, .threads = 1});
    for (const uint32_t child : {1u, 2u, 3u}) {
        want(residency, cut_of(source, {{0, 9}, {child, 1}}));
        residency.wait();
    }
    want(residency, cut_of(source, {{0, 9}, {1, 1}}));  // wanted again: now 2 is the oldest
    residency.wait();
    EXPECT_EQ(residency.stats().loads, 4u);
    want(residency, cut_of(source, {{0, 9}, {4, 1}}));
    residency.wait();
    EXPECT_FALSE(residency.resident(2));
    for (const uint32_t node : {0u, 1u, 3u, 4u}) EXPECT_TRUE(residency.resident(node)) << node;
}

TEST(Residency, NeverEvictsAWantedNodeForALessImportantOne) {
    const PlaneSource source(5, kPoints, 10.0);
    constexpr uint64_t kFit = 20;
    Residency residency(source, {.memory = kFit * kNode, .threads = 2});
    Replay replay(kFit * kNode);
    for (uint64_t frame = 0; frame < 60; ++frame) {
        std::vector<std::pair<uint32_t, float>> wishes;
        for (uint32_t node = 0; node < source.nodes().size(); ++node) {
            const float level = static_cast<float>(source.nodes()[node].key.level);
            wishes.emplace_back(
                node, static_cast<float>(100 - 20 * level + 15 * unit_double(mix64(frame / 2, node))));
        }
        const Cut cut = cut_of(source, wishes);
        const auto before = replay.held();
        want(residency, cut);
        residency.wait();
        replay.play(residency.poll());
        // The kFit most important nodes are resident, so every evicted node was less important than all
        // others.
        std::ranges::sort(wishes, [](const auto& a, const auto& b) {
            return a.second != b.second ? a.second > b.second : a.first < b.first;
        });
        std::set<uint32_t> best;
        for (size_t i = 0; i < kFit; ++i) best.insert(wishes[i].first);
        ASSERT_EQ(replay.held(), best) << "frame " << frame;
    }
    EXPECT_LE(residency.stats().bytes_peak, kFit * kNode);
}

TEST(Residency, StaysUnderItsCapAndReportsConsistentlyWhileWishesChangeAllTheTime) {
    const PlaneSource source(6, kPoints, 10.0);
    constexpr uint64_t kCap = 100 * kNode;
    Residency residency(source, {.memory = kCap, .threads = 4});
    Replay replay(kCap);
    for (uint64_t frame = 0; frame < 400; ++frame) {
        std::set<uint32_t> closed = {0};
        for (uint64_t i = 0; i < mix64(frame, 0) % 120; ++i)
            for (uint32_t node = mix64(frame, i + 1) % source.nodes().size(); node != kNoNode;
                 node = source.nodes()[node].parent)
                closed.insert(node);
        std::vector<std::pair<uint32_t, float>> wishes;
        for (const uint32_t node : closed) wishes.emplace_back(node, 10.0f - source.nodes()[node].key.level);
        const Cut cut = cut_of(source, wishes);
        want(residency, cut);
        if (frame % 7 == 0) {
            const uint32_t changed[] = {0, static_cast<uint32_t>(mix64(frame) % source.nodes().size())};
            residency.renew(changed);
        }
        if (frame % 5 == 0) residency.wait();
        replay.play(residency.poll(frame % 3 ? 10 : SIZE_MAX));
    }
    residency.wait();
    replay.play(residency.poll());
    for (uint32_t node = 0; node < source.nodes().size(); ++node)
        EXPECT_EQ(replay.held().contains(node), residency.resident(node)) << node;
    const ResidencyStats stats = residency.stats();
    EXPECT_EQ(stats.nodes_held, replay.held().size());
    EXPECT_EQ(stats.bytes_held, replay.held().size() * kNode);
    EXPECT_LE(stats.bytes_peak, kCap);
    EXPECT_GT(stats.evictions, 0u);
    EXPECT_GT(replay.replaced(), 0u);
}

TEST(Residency, DropsLoadsNotStartedThatNobodyWantsAnyMore) {
    PlaneSource source(4, kPoints, 10.0);
    source.shut();
    Residency residency(source, {.threads = 1});
    want(residency, full_cut(source));
    source.await(1);
    want(residency, cut_of(source, {{0, 2}, {3, 1}}));
    EXPECT_EQ(residency.stats().pending, 2u) << "the root, which is being loaded, and node 3";
    source.open();
    residency.wait();
    EXPECT_EQ(source.order(), (std::vector<uint32_t>{0, 3}));
}

TEST(Residency, WhateverALoadOrItsPreparationThrowsIsAnErrorOfItsNodeAlone) {
    PlaneSource source(2, kPoints, 10.0);  // a root and its four children
    source.throw_at(2);
    const auto make = [](uint32_t node, NodeData&& data) {
        if (node == 3) throw node;  // not a std::exception
        return std::move(data);
    };
    const auto most_bytes = [](const NodeInfo&) { return uint64_t{0}; };
    Residency<NodeData> residency(source, {.memory = 100 * kNode, .threads = 2}, {make, most_bytes});
    const Cut cut = full_cut(source);
    want(residency, cut);
    EXPECT_TRUE(residency.wait());
    EXPECT_EQ(residency.stats().failures, 2u);
    EXPECT_EQ(residency.stats().nodes_held, 3u);
    const auto error = residency.take_error();
    ASSERT_FALSE(error);
    EXPECT_TRUE(error.error().what == "node 2" || error.error().what == "node 3") << error.error().line();
    const size_t loads = source.order().size();
    want(residency, cut);
    EXPECT_TRUE(residency.wait());
    EXPECT_EQ(source.order().size(), loads) << "a failed node is not requested again";
    EXPECT_TRUE(residency.take_error());
}

TEST(Residency, ReportsAFailedLoadOnceAndDoesNotTryItAgain) {
    PlaneSource source(4, kPoints, 10.0);
    source.break_node(2);
    source.throw_at(3);
    source.shorten(4);
    Residency residency(source, {.threads = 2});
    for (int frame = 0; frame < 10; ++frame) {
        want(residency, full_cut(source));
        residency.wait();
    }
    EXPECT_EQ(residency.stats().failures, 3u);
    EXPECT_EQ(residency.stats().pending, residency.stats().nodes_held) << "not polled yet";
    residency.poll();
    EXPECT_EQ(residency.stats().pending, 0u);
    EXPECT_EQ(residency.stats().refused, 0u) << "failed nodes do not count as refused";
    EXPECT_FALSE(residency.take_error());
    EXPECT_TRUE(residency.take_error()) << "reported once";
    for (const uint32_t node : {2u, 3u, 4u}) {
        EXPECT_FALSE(residency.resident(node)) << node;
        EXPECT_EQ(std::ranges::count(source.order(), node), 1);
    }
    EXPECT_TRUE(residency.resident(1));

    source.mend_node(2);
    const uint32_t mended[] = {2};
    residency.renew(mended);
    want(residency, full_cut(source));
    residency.wait();
    EXPECT_TRUE(residency.resident(2)) << "a node that changed in the source is tried once more";
}

TEST(Residency, ReplacesNodesThatChangedAndGivesThemUpFirstWhereTwoCopiesDoNotFit) {
    const PlaneSource source(2, kPoints, 10.0);
    for (const uint64_t room : {10u, 5u}) {
        Residency residency(source, {.memory = room * kNode, .threads = 2});
        Replay replay(room * kNode);
        want(residency, full_cut(source));
        residency.wait();
        replay.play(residency.poll());
        const uint32_t changed[] = {1, 3};
        residency.renew(changed);
        want(residency, full_cut(source));
        residency.wait();
        const auto events = residency.poll();
        replay.play(events);
        EXPECT_EQ(replay.held().size(), 5u);
        EXPECT_EQ(events.size(), room == 10 ? 2u : 4u);
        EXPECT_EQ(residency.stats().loads, 7u);
        EXPECT_LE(residency.stats().bytes_peak, room * kNode);
    }
}

TEST(Residency, ANodeLargerThanTheCapIsRefusedWithItsDescendantsAndBlocksNothingElse) {
    PlaneSource source(3, kPoints, 10.0);
    source.edit()[2].count = 50 * kPoints;
    Residency residency(source, {.memory = 18 * kNode, .threads = 2});
    want(residency, full_cut(source));
    residency.wait();
    EXPECT_EQ(residency.stats().nodes_held, 16u);
    EXPECT_EQ(residency.stats().refused, 5u) << "node 2 and its four children";
}

TEST(Residency, CountsWhatANodeCostsItsCallerAgainstTheCap) {
    const PlaneSource source(3, kPoints, 10.0);
    Residency residency(
        source, {.memory = 7000, .threads = 2, .cost = [](const NodeInfo&) { return uint64_t{1000}; }});
    want(residency, full_cut(source));
    residency.wait();
    EXPECT_EQ(residency.stats().nodes_held, 7u);
    EXPECT_EQ(residency.stats().bytes_held, 7000u);
}

TEST(Residency, ShutsDownWithLoadsOnTheirWay) {
    for (int round = 0; round < 20; ++round) {
        PlaneSource source(4, kPoints, 10.0);
        source.shut();
        std::thread opener;
        {
            Residency residency(source, {.threads = 4});
            want(residency, full_cut(source));
            source.await(4);
            opener = std::thread([&] { source.open(); });
        }
        opener.join();
        EXPECT_LE(source.order().size(), source.nodes().size());
    }
}

TEST(Residency, WantsOfNodesThatDoNotExistAreIgnored) {
    const PlaneSource source(2, kPoints, 10.0);
    Residency residency(source, {});
    Cut cut;
    cut.nodes = {{0, 1, 1.0f}, {99, 1, 1.0f}, {kNoNode, 1, 1.0f}};
    want(residency, cut);
    residency.wait();
    EXPECT_EQ(residency.stats().nodes_held, 1u);
}

TEST(Residency, WhatIsAheadIsLoadedAfterWhatIsWantedAndNeverInItsPlace) {
    PlaneSource source(4, kPoints, 1.0);
    Residency residency(source, {.memory = 4 * kNode, .threads = 1});
    const Cut now = cut_of(source, {{0, 1.0f}, {1, 0.1f}, {2, 0.2f}});
    const Cut later = cut_of(source, {{0, 9.0f}, {3, 5.0f}, {4, 4.0f}});
    const Cut *cuts[] = {&now}, *ahead[] = {&later};
    residency.want(cuts, ahead);
    ASSERT_TRUE(residency.wait());
    EXPECT_EQ(source.order(), (std::vector<uint32_t>{0, 2, 1, 3})) << "three wanted, and room for one ahead";
    EXPECT_EQ(residency.stats().refused, 0u) << "prefetched nodes do not count as refused";
    EXPECT_EQ(residency.stats().ahead_loads, 1u);
    residency.poll();
    // The camera has moved on: the prefetched node is wanted and must not be read again.
    const Cut next = cut_of(source, {{0, 1.0f}, {3, 0.5f}});
    want(residency, next);
    ASSERT_TRUE(residency.wait());
    EXPECT_EQ(residency.stats().loads, 4u);
    EXPECT_EQ(residency.stats().ahead_hits, 1u);
}

TEST(Residency, PendingCountsWhatIsWantedNowAlone) {
    PlaneSource source(3, kPoints, 1.0);
    source.shut();
    Residency residency(source, {.threads = 1});
    const Cut now = cut_of(source, {{0, 1.0f}}), later = cut_of(source, {{0, 1.0f}, {1, 1.0f}, {2, 1.0f}});
    const Cut *cuts[] = {&now}, *ahead[] = {&later};
    residency.want(cuts, ahead);
    source.await(1);
    EXPECT_EQ(residency.stats().pending, 1u);
    source.open();
    ASSERT_TRUE(residency.wait());
    EXPECT_EQ(residency.poll().size(), 3u);
    EXPECT_EQ(residency.stats().pending, 0u);
}

TEST(Residency, ACameraThatMovesOnEveryFrameReadsNoNodeTwice) {
    const PlaneSource source(6, kPoints, 100.0);
    Residency residency(source, {.memory = uint64_t{1} << 30, .threads = 3});
    Replay replay(uint64_t{1} << 30);
    for (int frame = 0; frame < 200; ++frame) {
        Cut cut = light_cut(source, {0.4 * frame, 30, 1}, 20'000);
        want(residency, cut);  // long before the last requests have been loaded
        replay.play(residency.poll(5));
    }
    ASSERT_TRUE(residency.wait());
    std::vector<uint32_t> order = source.order();
    std::ranges::sort(order);
    EXPECT_EQ(std::ranges::adjacent_find(order), order.end());
}

/// A payload that can only be moved and that has allocated more than it uses.
struct Packed {
    std::unique_ptr<uint32_t> node;
    std::vector<uint16_t> values;
};
constexpr uint64_t kPacked = 500;  ///< bytes of a Packed

uint64_t allocated_bytes(const Packed& payload) {
    return sizeof(uint32_t) + octree::allocated_bytes(payload.values);
}

Packed pack(uint32_t node) {
    Packed packed{std::make_unique<uint32_t>(node), {}};
    packed.values.reserve((kPacked - sizeof(uint32_t)) / sizeof(uint16_t));
    packed.values.push_back(7);
    return packed;
}

TEST(Residency, APayloadThatOnlyMovesIsMadeOnALoadingThreadAndArrivesUncopied) {
    const PlaneSource source(3, kPoints, 1.0);
    const auto here = std::this_thread::get_id();
    std::mutex mutex;
    std::map<uint32_t, const uint16_t*> made;
    const auto make = [&](uint32_t node, const NodeData& data) {
        EXPECT_NE(std::this_thread::get_id(), here);
        EXPECT_EQ(data.records.size(), kNode);
        Packed packed = pack(node);
        const std::lock_guard lock(mutex);
        made[node] = packed.values.data();
        return packed;
    };
    Residency<Packed> residency(source, {.threads = 2}, {make, [](const NodeInfo&) { return kPacked; }});
    want(residency, full_cut(source));
    ASSERT_TRUE(residency.wait());
    const auto events = residency.poll();
    EXPECT_EQ(events.size(), source.nodes().size());
    for (const auto& event : events) {
        ASSERT_TRUE(event.data);
        EXPECT_EQ(*event.data->node, event.node);
        EXPECT_EQ(event.data->values.data(), made.at(event.node)) << "it was copied";
    }
    EXPECT_EQ(residency.stats().bytes_loaded, source.nodes().size() * kNode);
}

TEST(Residency, WhatAPayloadHasAllocatedCountsInTransit) {
    const PlaneSource source(3, kPoints, 1.0);
    // One node is being read while the payloads of four are waiting; a fifth one would not fit.
    const uint64_t transit = kNode + kPacked + 4 * kPacked;
    Residency<Packed> residency(
        source, {.transit = transit, .threads = 3},
        {[](uint32_t node, NodeData&&) { return pack(node); }, [](const NodeInfo&) { return kPacked; }});
    want(residency, full_cut(source));
    ASSERT_FALSE(residency.wait());
    EXPECT_EQ(residency.stats().nodes_held, 5u);
    EXPECT_EQ(residency.poll().size(), 5u);
    size_t arrived = 5;
    while (arrived < source.nodes().size()) {
        residency.wait();
        const size_t more = residency.poll().size();
        EXPECT_LE(more, 5u);
        arrived += more;
    }
    EXPECT_LE(residency.stats().transit_peak, transit);
    EXPECT_TRUE(residency.take_error());
}

TEST(Residency, APayloadLargerThanAnnouncedIsAnErrorOfItsNode) {
    const PlaneSource source(2, kPoints, 1.0);
    const auto make = [](uint32_t node, NodeData&&) {
        return std::vector<uint32_t>(node == 3 ? kNode : uint64_t{2});
    };
    Residency<std::vector<uint32_t>> residency(source, {.threads = 2},
                                               {make, [](const NodeInfo&) { return uint64_t{8}; }});
    want(residency, full_cut(source));
    ASSERT_TRUE(residency.wait());
    EXPECT_EQ(residency.stats().nodes_held, 4u);
    const auto error = residency.take_error();
    ASSERT_FALSE(error);
    EXPECT_EQ(error.error().what, "node 3");
    EXPECT_EQ(residency.poll().size(), 4u);
}

}  // namespace
}  // namespace lucarne::octree
