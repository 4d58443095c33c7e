#pragma once

#include <cstddef>
#include <list>
#include <optional>
#include <unordered_map>
#include <utility>

namespace lucarne {

/// A map that can give up its least recently used value. Not thread-safe.
template <class Key, class Value>
class RecentlyUsed {
 public:
    /// Returns the value and marks it as the most recently used; null if there is none. The pointer is valid
    /// until the value is taken.
    Value* find(const Key& key) {
        const auto place = places_.find(key);
        if (place == places_.end()) return nullptr;
        kept_.splice(kept_.begin(), kept_, place->second);
        return &kept_.front().second;
    }
    /// Adds a value. The key must not have one yet.
    void add(const Key& key, Value value) {
        kept_.emplace_front(key, std::move(value));
        places_[key] = kept_.begin();
    }
    /// Removes the key's value and returns it; nothing if there is none.
    std::optional<Value> take(const Key& key) {
        const auto place = places_.find(key);
        if (place == places_.end()) return std::nullopt;
        std::optional<Value> value(std::move(place->second->second));
        kept_.erase(place->second);
        places_.erase(place);
        return value;
    }
    /// Removes the least recently used value and returns it. There must be one.
    Value take_oldest() {
        Value value = std::move(kept_.back().second);
        places_.erase(kept_.back().first);
        kept_.pop_back();
        return value;
    }
    size_t size() const { return kept_.size(); }

 private:
    std::list<std::pair<Key, Value>> kept_;  ///< most recently used first
    std::unordered_map<Key, typename std::list<std::pair<Key, Value>>::iterator> places_;
};

}  // namespace lucarne
