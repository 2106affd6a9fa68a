#include "camera_self_calibration/pipeline/bounded_queue.h"

#include <gtest/gtest.h>

#include <atomic>
#include <memory>
#include <thread>
#include <vector>

namespace camera_self_calibration {
namespace {

TEST(BoundedQueue, KeepsTheOrder) {
  BoundedQueue<int> queue(3);
  for (int i = 0; i < 3; ++i) EXPECT_TRUE(queue.push(i));
  for (int i = 0; i < 3; ++i) EXPECT_EQ(queue.pop(), i);
}

TEST(BoundedQueue, DropsTheOldest) {
  BoundedQueue<int> queue(2);
  EXPECT_TRUE(queue.push(1));
  EXPECT_TRUE(queue.push(2));
  EXPECT_FALSE(queue.push(3));
  EXPECT_FALSE(queue.push(4));
  EXPECT_EQ(queue.pop(), 3);
  EXPECT_EQ(queue.pop(), 4);
  EXPECT_TRUE(queue.push(5));
}

TEST(BoundedQueue, HoldsItemsThatOnlyMove) {
  BoundedQueue<std::unique_ptr<int>> queue(1);
  queue.push(std::make_unique<int>(7));
  EXPECT_EQ(**queue.pop(), 7);
}

TEST(BoundedQueue, ClosingWakesEverybodyUp) {
  BoundedQueue<int> queue(2);
  std::atomic<int> woken{0};
  std::thread taker([&] {
    while (queue.pop()) {
    }
    ++woken;
  });
  std::thread waiter([&] {
    queue.waitUntilIdle();
    ++woken;
  });
  queue.close();
  taker.join();
  waiter.join();
  EXPECT_EQ(woken, 2);
  queue.push(1);
  EXPECT_FALSE(queue.pop());  // closed: items waiting are not delivered
  queue.waitUntilIdle();
}

TEST(BoundedQueue, IdleMeansWorkIsDone) {
  BoundedQueue<int> queue(100);
  std::atomic<int> done{0};
  std::thread worker([&] {
    while (queue.pop()) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
      ++done;
    }
  });
  for (int round = 1; round <= 5; ++round) {
    for (int i = 0; i < 10; ++i) queue.push(i);
    queue.waitUntilIdle();
    EXPECT_EQ(done, 10 * round);
  }
  queue.close();
  worker.join();
}

}  // namespace
}  // namespace camera_self_calibration
