// The device that tests run on: any that there is. Without one they are skipped, and say so.
#pragma once

#include <gtest/gtest.h>

#include "device.h"

namespace sutura::opencl {

class OnDevice : public ::testing::Test {
 protected:
  void SetUp() override {
    try {
      device_ = std::make_unique<Device>(DeviceChoice{});
    } catch (const DeviceError& e) {
      GTEST_SKIP() << e.what();
    }
  }
  std::unique_ptr<Device> device_;
};

}  // namespace sutura::opencl
