#include "gi/tracing/alias_table.h"

#include <algorithm>

namespace lucarne::gi::tracing {

AliasTable::AliasTable(std::span<const double> weights) {
    for (const double w : weights) total_ += w;
    if (!(total_ > 0)) return;
    const auto count = static_cast<double>(weights.size());
    cells_.resize(weights.size());
    std::vector<double> share(weights.size());  // weight over the mean weight
    std::vector<uint32_t> small, large;
    for (uint32_t i = 0; i < weights.size(); ++i) {
        share[i] = weights[i] / total_ * count;
        (share[i] < 1 ? small : large).push_back(i);
    }
    while (!small.empty() && !large.empty()) {
        const uint32_t poor = small.back(), rich = large.back();
        small.pop_back();
        cells_[poor] = {static_cast<float>(share[poor]), rich};
        share[rich] -= 1 - share[poor];
        if (share[rich] >= 1) continue;
        large.pop_back();
        small.push_back(rich);
    }
    // The rest has the mean weight up to rounding. An index without weight must never be drawn.
    const auto richest = static_cast<uint32_t>(std::ranges::max_element(weights) - weights.begin());
    for (const auto* rest : {&small, &large})
        for (const uint32_t i : *rest) cells_[i] = {weights[i] > 0 ? 1.0f : 0.0f, richest};
}

uint32_t AliasTable::draw(Random& random) const {
    const double place = random.uniform() * static_cast<double>(cells_.size());
    const auto index = std::min(static_cast<size_t>(place), cells_.size() - 1);
    const bool own = random.uniform() < cells_[index].own;
    return own ? static_cast<uint32_t>(index) : cells_[index].alias;
}

}  // namespace lucarne::gi::tracing
