// What simulations share is made once, from equal keys only, and goes with the last who holds it.
#include "sutura/cache.h"

#include <gtest/gtest.h>

#include <atomic>
#include <string>
#include <thread>

namespace sutura {
namespace {

struct Name {
  std::string text;
  bool operator==(const Name&) const = default;
};
struct Number {
  int value;
  bool operator==(const Number&) const = default;
};

TEST(Cache, GivesWhatWasMadeFromAnEqualKey) {
  Cache cache;
  int made = 0;
  const auto length = [&](const std::string& text) {
    return cache.get(Name{text}, [&] {
      ++made;
      return std::make_shared<const std::size_t>(text.size());
    });
  };
  const auto a = length("abc"), again = length("abc"), b = length("abcd");
  EXPECT_EQ(a, again);
  EXPECT_NE(a, b);
  EXPECT_EQ(*b, 4u);
  EXPECT_EQ(made, 2);
  // A key of another type is another one, whatever its bits.
  const auto other = cache.get(Number{3}, [] { return std::make_shared<const int>(9); });
  EXPECT_EQ(*other, 9);
}

TEST(Cache, KeepsNothingAlive) {
  Cache cache;
  int made = 0;
  const auto get = [&] {
    return cache.get(Number{1}, [&] {
      ++made;
      return std::make_shared<const int>(7);
    });
  };
  std::weak_ptr<const int> seen;
  {
    const auto held = get();
    seen = held;
    EXPECT_EQ(get(), held);
  }
  EXPECT_TRUE(seen.expired());
  EXPECT_EQ(*get(), 7);
  EXPECT_EQ(made, 2);
}

TEST(Cache, OutlivedByWhatItGave) {
  std::shared_ptr<const int> held;
  {
    Cache cache;
    held = cache.get(Number{1}, [] { return std::make_shared<const int>(7); });
  }
  EXPECT_EQ(*held, 7);
}

TEST(Cache, SeveralWorkersGetTheSame) {
  Cache cache;
  const auto held = cache.get(Number{0}, [] { return std::make_shared<const int>(0); });
  std::atomic<int> wrong{0};
  std::vector<std::thread> workers;
  for (int w = 0; w < 4; ++w)
    workers.emplace_back([&] {
      for (int i = 0; i < 2000; ++i) {
        const int n = i % 5;
        const auto got = cache.get(Number{n}, [n] { return std::make_shared<const int>(n); });
        if (*got != n || (n == 0 && got != held)) ++wrong;
      }
    });
  for (std::thread& w : workers) w.join();
  EXPECT_EQ(wrong.load(), 0);
}

TEST(Cache, NoneMakesAnew) {
  const auto make = [] { return std::make_shared<const int>(1); };
  EXPECT_NE(cached(nullptr, Number{1}, make), cached(nullptr, Number{1}, make));
}

}  // namespace
}  // namespace sutura
