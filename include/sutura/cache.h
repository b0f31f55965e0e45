// What simulations of one scene have in common and never change: meshes, orders of elimination.
#pragma once

#include <algorithm>
#include <memory>
#include <mutex>
#include <type_traits>
#include <typeindex>
#include <utility>
#include <vector>

namespace sutura {

/// Gives what was made from an equal key before, as long as somebody holds it. Keeps nothing alive
/// itself. For several workers at once.
class Cache {
 public:
  /// `make()` gives a shared_ptr to something const. The key, which has an operator== and a type of
  /// its own for each kind of thing, must say all that it depends on.
  template <class Key, class Make>
  auto get(Key key, const Make& make) -> decltype(make()) {
    using Value = std::remove_pointer_t<decltype(make().get())>;
    static_assert(std::is_const_v<Value>);
    if (auto found = find<Key, Value>(key)) return found;
    // Not under the lock, since it may take seconds. If two make the same, one is thrown away.
    auto made = std::make_shared<Pair<Key, Value>>(std::move(key), make());
    const std::lock_guard lock(mutex_);
    if (auto found = search<Key, Value>(made->key)) return found;
    std::erase_if(entries_, [](const Entry& e) { return e.pair.expired(); });
    entries_.push_back({typeid(Key), made});
    return {made, made->value.get()};
  }

 private:
  template <class Key, class Value>
  struct Pair {
    Pair(Key k, std::shared_ptr<Value> v) : key(std::move(k)), value(std::move(v)) {}
    Key key;
    std::shared_ptr<Value> value;
  };
  struct Entry {
    std::type_index kind;  ///< of the key
    std::weak_ptr<const void> pair;
  };

  template <class Key, class Value>
  std::shared_ptr<Value> find(const Key& key) {
    const std::lock_guard lock(mutex_);
    return search<Key, Value>(key);
  }
  template <class Key, class Value>
  std::shared_ptr<Value> search(const Key& key) const {
    for (const Entry& e : entries_) {
      if (e.kind != typeid(Key)) continue;
      const auto pair = std::static_pointer_cast<const Pair<Key, Value>>(e.pair.lock());
      if (pair && pair->key == key) return {pair, pair->value.get()};
    }
    return nullptr;
  }

  std::mutex mutex_;
  std::vector<Entry> entries_;
};

/// The same without a cache, if there is none.
template <class Key, class Make>
auto cached(Cache* cache, Key key, const Make& make) {
  return cache != nullptr ? cache->get(std::move(key), make) : make();
}

}  // namespace sutura
