#pragma once

#include <cstddef>
#include <list>
#include <optional>
#include <unordered_map>
#include <utility>

namespace lucarne {

/// Values by key, of which the one that was asked for the longest ago is given up first. Not thread-safe.
template <class Key, class Value>
class RecentlyUsed {
 public:
    /// The value, which now is the last used; null where there is none. Valid until it is taken.
    Value* find(const Key& key) {
        const auto place = places_.find(key);
        if (place == places_.end()) return nullptr;
        kept_.splice(kept_.begin(), kept_, place->second);
        return &kept_.front().second;
    }
    /// The key has no value yet.
    void add(const Key& key, Value value) {
        kept_.emplace_front(key, std::move(value));
        places_[key] = kept_.begin();
    }
    /// Removes a value and returns it.
    std::optional<Value> take(const Key& key) {
        const auto place = places_.find(key);
        if (place == places_.end()) return std::nullopt;
        std::optional<Value> value(std::move(place->second->second));
        kept_.erase(place->second);
        places_.erase(place);
        return value;
    }
    /// Removes the value that was not used for the longest time and returns it. There is one.
    Value take_oldest() {
        Value value = std::move(kept_.back().second);
        places_.erase(kept_.back().first);
        kept_.pop_back();
        return value;
    }
    size_t size() const { return kept_.size(); }

 private:
    std::list<std::pair<Key, Value>> kept_;  ///< the last used first
    std::unordered_map<Key, typename std::list<std::pair<Key, Value>>::iterator> places_;
};

}  // namespace lucarne
