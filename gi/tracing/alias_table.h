#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "io/core/random.h"

namespace lucarne::gi::tracing {

/// Draws indices in proportion to weights, in constant time (Walker 1974; built as in Vose 1991, "A linear
/// algorithm for generating random numbers with a given distribution").
class AliasTable {
 public:
    /// `weights` must be finite and not negative. If all are zero the table is empty.
    explicit AliasTable(std::span<const double> weights);

    bool empty() const { return cells_.empty(); }
    double total() const { return total_; }  ///< sum of the weights
    uint32_t draw(Random& random) const;     ///< the table must not be empty

 private:
    struct Cell {
        float own;  ///< probability that a draw keeps this index; otherwise it takes `alias`
        uint32_t alias;
    };
    std::vector<Cell> cells_;
    double total_ = 0;
};

}  // namespace lucarne::gi::tracing
